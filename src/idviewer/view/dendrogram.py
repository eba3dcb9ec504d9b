"""A dendrogram: shapes joined by how little they differ, drawn without a display."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.cluster.hierarchy import dendrogram, linkage
from scipy.spatial.distance import squareform

from idviewer.core.io import atomic_path

GROUPING = "average"
"""How groups are compared: by the mean difference of their members (UPGMA)."""

INCHES_PER_SHAPE, LEAST_INCHES, MOST_INCHES = 0.22, 2.5, 80.0
WIDTH_INCHES, PIXELS_PER_INCH = 8.0, 120
"""Of the picture, whose height grows with the number of shapes."""

NAME_LETTERS = 40
"""Of a shape's name; longer ones lose their middle."""


def groups_of(differences: NDArray[np.float64]) -> NDArray[np.float64]:
    """Groups (s - 1, 4) that shapes are joined to, as SciPy's linkage has them.

    Args:
        differences: (s, s) of the shapes, symmetric.
    """
    symmetric = 0.5 * (differences + differences.T)
    return np.asarray(linkage(squareform(symmetric, checks=False), GROUPING, optimal_ordering=True))


def write_dendrogram(
    path: str | os.PathLike[str], names: Sequence[str], differences: NDArray[np.float64], title: str
) -> None:
    """Draw the dendrogram of some shapes and write it as PNG.

    Args:
        path: of the file.
        names: of the s shapes.
        differences: (s, s) of them.
        title: of the axis, what the differences are.

    Raises:
        OSError: the file cannot be written.
    """
    height = min(MOST_INCHES, LEAST_INCHES + INCHES_PER_SHAPE * len(names))
    figure = Figure(figsize=(WIDTH_INCHES, height), dpi=PIXELS_PER_INCH, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    dendrogram(
        groups_of(differences),
        labels=[_short(name) for name in names],
        orientation="left",
        ax=axes,
        color_threshold=0.0,
        above_threshold_color="0.25",
        leaf_font_size=9,
    )
    axes.set_xlabel(title)
    axes.spines[["top", "left", "right"]].set_visible(False)
    with atomic_path(path) as part, part.open("xb") as file:
        canvas.print_png(file)


def _short(name: str) -> str:
    half = NAME_LETTERS // 2
    # matplotlib takes what stands between dollars for a formula.
    shown = name if len(name) <= NAME_LETTERS else f"{name[: half - 1]}\N{HORIZONTAL ELLIPSIS}{name[-half:]}"
    return shown.replace("$", r"\$")
