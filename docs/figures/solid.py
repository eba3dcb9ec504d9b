"""Pictures in space, drawn by the program's own renderer, so that they look like its window."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from numpy.typing import ArrayLike, NDArray

from figures.flat import ISOLINES, title
from figures.registry import Run
from idviewer.core import Mesh, Plane
from idviewer.session import Display, Query, State
from idviewer.session.pipeline import Pipeline
from idviewer.session.run_to_end import run_to_end
from idviewer.session.state import Frame
from idviewer.view.images import default_camera, image

Pixels = NDArray[np.uint8]
FRONT = (0.0, -1.0, 0.0)
ABOVE = (0.72, -0.30, 0.62)
TALLEST = 4.0
"""Inches of a row."""


def cut(point: ArrayLike, normal: tuple[float, float, float]) -> Plane:
    """The plane through a point."""
    x, y, z = np.asarray(point, dtype=float).tolist()
    return Plane((x, y, z), normal)


_PIPELINE = Pipeline()


def frame_of(mesh: Mesh, query: Query) -> Frame:
    """The finest frame of a query; what was prepared of the last mesh is used again."""
    return run_to_end(mesh, query, _PIPELINE)


def picture(
    run: Run, mesh: Mesh, query: Query, side: int, around: ArrayLike = (), facing: Plane | None = None
) -> tuple[Pixels, Frame]:
    """A body with its slices, white margins included, and what was computed.

    Args:
        run: tiny pictures take one look at everything.
        mesh: the body.
        query: what is shown on its slices; with the potential, the barycentroid too.
        side: of the square that the body is fitted into, in pixels.
        around: (n, 3) points that are fitted into it instead of the body's own.
        facing: the plane that is looked at; the query's first one by default.
    """
    frame = frame_of(mesh, query)
    shown = query.quantity == "potential"
    display = Display(isolines=ISOLINES, scale_bar=False, handle=False, barycentroid=shown)
    size = 64 if run.tiny else side
    fitted = np.asarray(around) if len(np.asarray(around)) else mesh.vertices
    camera = default_camera(fitted, facing or query.planes[0], 1.0)
    return image(State(mesh, query, display), frame, (size, size), camera), frame


def cropped(pictures: Sequence[Pixels], margin: int = 4) -> list[Pixels]:
    """Without the rows and columns at the sides that are white in all of the pictures, of one size."""
    ink = np.any([(pixels < 250).any(axis=2) for pixels in pictures], axis=0)
    rows, columns = (np.flatnonzero(ink.any(axis=axis)) for axis in (1, 0))
    tall, wide = (slice(max(0, each[0] - margin), each[-1] + margin + 1) for each in (rows, columns))
    return [pixels[tall, wide] for pixels in pictures]


def draw_rows(run: Run, number: str, titles: Sequence[str], pictures: Sequence[Pixels], columns: int) -> None:
    """Pictures of one size in rows of so many, each row as high as it takes, titles above."""
    rows = [cropped(pictures[first : first + columns]) for first in range(0, len(pictures), columns)]
    width = 13.2 / columns
    heights = [min(width * row[0].shape[0] / row[0].shape[1], TALLEST) + 0.3 for row in rows]
    drawing = Drawing(figsize=(13.2, sum(heights)), layout="constrained", facecolor="white")
    drawing.get_layout_engine().set(w_pad=0.03, h_pad=0.07, wspace=0.01, hspace=0.02)
    axes = drawing.subplots(len(rows), columns, squeeze=False, height_ratios=heights)
    for place, text, pixels in zip(axes.flat, titles, itertools.chain(*rows), strict=True):
        show_pixels(place, pixels)
        title(place, text)
    run.save(drawing, number)


def show_pixels(axes: Axes, pixels: Pixels) -> None:
    """A picture as it is."""
    axes.imshow(pixels, interpolation="antialiased")
    axes.axis("off")
