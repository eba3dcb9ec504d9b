"""Pictures in the plane: values inside a polygon as colours, with isolines, the outline and the source."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure as Drawing
from matplotlib.tri import Triangulation
from numpy.typing import ArrayLike, NDArray

from figures.registry import Run
from idviewer.core import InteriorDistance, Polygon
from idviewer.core.slices import SliceMesh, polygon_section, slice_mesh, spacing_for
from idviewer.view.colormaps import colors

Floats = NDArray[np.float64]

INK = (0.05, 0.06, 0.10)
BARYCENTROID = (0.10, 0.25, 0.85)
COLORS = ListedColormap(colors("paper") / 255.0)
"""Dark blue to dark red: the window's colours."""
ISOLINES = 24
"""Equal steps of the distance, in every picture of the gallery."""


@dataclass(frozen=True, eq=False)
class Filling:
    """A polygon cut into triangles.

    Attributes:
        polygon: what was cut.
        mesh: its triangles.
        points: (p, 2) their corners, those on the outline first.
    """

    polygon: Polygon
    mesh: SliceMesh
    points: Floats

    @classmethod
    def of(cls, polygon: Polygon, samples: int) -> Filling:
        """About so many points inside, and the outline's points as near to each other as those."""
        spacing = spacing_for(polygon_section(polygon), samples)
        mesh = slice_mesh(polygon_section(polygon, spacing), spacing)
        return cls(polygon, mesh, mesh.points[:, :2])

    @property
    def inner(self) -> slice:
        """The points that are not on the outline."""
        return slice(len(self.mesh.section.in_plane), None)

    def embed(self, solver: InteriorDistance) -> Floats:
        """(p, k) the points' images; where rounding puts one of the outline outside, between its ends'."""
        images = solver.embed(self.points)
        lost = np.flatnonzero(~np.isfinite(images[:, 0]))
        images[lost] = self.mesh.section.interpolate(solver.boundary.embedding)[lost]
        return images

    def distances(self, solver: InteriorDistance, source: ArrayLike) -> Floats:
        """(p,) from one source."""
        return np.linalg.norm(self.embed(solver) - solver.embed(np.reshape(source, (1, 2))), axis=1)

    def distances_of(self, solver: InteriorDistance, source: ArrayLike, some: NDArray[np.bool_]) -> Floats:
        """(p,) from one source to some of the points, NaN at the others."""
        values = np.full(len(self.points), np.nan)
        values[some] = solver.field(source, self.points[some])
        return values

    def potential(self, solver: InteriorDistance) -> Floats:
        """(p,) U."""
        return np.linalg.norm(self.embed(solver) - solver.boundary.centre, axis=1)


def show(axes: Axes, filling: Filling, values: Floats, source: ArrayLike | None = None) -> None:
    """Colours and isolines over the values' own range, from the lowest of them or, with a source, from 0."""
    low, high = 0.0 if source is not None else float(values.min()), float(values.max())
    show_within(axes, filling, values, (low, high))
    if source is not None:
        dot(axes, source)


def show_within(axes: Axes, filling: Filling, values: Floats, span: tuple[float, float]) -> None:
    """Colours and isolines over a range that several pictures share."""
    mesh = Triangulation(*filling.points.T, filling.mesh.triangles)
    axes.tripcolor(mesh, values, shading="gouraud", cmap=COLORS, vmin=span[0], vmax=span[1], rasterized=True)
    levels = np.linspace(*span, ISOLINES + 1)[1:-1]
    axes.tricontour(mesh, values, levels=levels, colors=[INK], linewidths=0.55, linestyles="solid")
    outline(axes, filling.polygon)
    axes.set_aspect("equal")
    size = filling.polygon.bounds[1] - filling.polygon.bounds[0]
    frame_by(axes, filling.polygon.bounds.mean(axis=0), 0.5 * size)
    axes.axis("off")


def show_part(
    axes: Axes, filling: Filling, part: NDArray[np.bool_], values: Floats, span: tuple[float, float]
) -> None:
    """The triangles all of whose corners belong to a part, within a range given, and a frame around."""
    corners = filling.mesh.triangles
    shown = (part & np.isfinite(values))[corners].all(axis=1)
    used, triangles = np.unique(corners[shown], return_inverse=True)
    mesh = Triangulation(*filling.points[used].T, triangles.reshape(-1, 3))
    axes.tripcolor(
        mesh, values[used], shading="gouraud", cmap=COLORS, vmin=span[0], vmax=span[1], rasterized=True
    )
    levels = np.linspace(*span, 4 * ISOLINES + 1)[1:-1]
    axes.tricontour(mesh, values[used], levels=levels, colors=[INK], linewidths=0.7)
    outline(axes, filling.polygon, width=1.8)
    axes.set_aspect("equal")
    axes.set(xticks=[], yticks=[])


def outline(axes: Axes, polygon: Polygon, color: ArrayLike = INK, width: float = 1.3) -> None:
    """The boundary, all loops."""
    for loop in polygon.loops:
        closed = polygon.vertices[np.append(loop, loop[0])]
        axes.plot(*closed.T, color=color, linewidth=width, solid_joinstyle="round")


def dot(axes: Axes, point: ArrayLike, color: ArrayLike = (0.0, 0.0, 0.0), size: float = 7.0) -> None:
    """A source, black, or something else."""
    axes.plot(
        *np.asarray(point), "o", color=color, markersize=size, markeredgecolor="white", markeredgewidth=0.8
    )


def row_of(count: int, width: float = 3.3, height: float = 3.3, rows: int = 1) -> tuple[Drawing, NDArray]:
    """A drawing with so many axes side by side, sizes in inches a cell; and the axes (rows, count)."""
    drawing = Drawing(figsize=(width * count, height * rows), layout="constrained", facecolor="white")
    drawing.get_layout_engine().set(w_pad=0.03, h_pad=0.07, wspace=0.01, hspace=0.01)
    return drawing, drawing.subplots(rows, count, squeeze=False)


def title(axes: Axes, text: str) -> None:
    """What a picture shows, above it."""
    axes.set_title(text, fontsize=11, color=INK)


def frame_by(axes: Axes, middle: Floats, half: Floats) -> None:
    """What of the plane is seen: a box, and a little around it."""
    wide, tall = 1.03 * half + 0.005 * half.max()
    axes.set(xlim=(middle[0] - wide, middle[0] + wide), ylim=(middle[1] - tall, middle[1] + tall))


def at_one_scale(axes: Iterable[Axes]) -> None:
    """Gives all axes the size of the largest box in them."""
    axes = list(axes)
    boxes = [np.array([each.get_xlim(), each.get_ylim()]) for each in axes]
    half = 0.5 * np.max([np.ptp(box, axis=1) for box in boxes], axis=0)
    for each, box in zip(axes, boxes, strict=True):
        (left, right), (low, high) = np.stack([box.mean(axis=1) - half, box.mean(axis=1) + half], axis=1)
        each.set(xlim=(left, right), ylim=(low, high))


def draw_rows(
    run: Run, number: str, titles: Sequence[str], cells: Sequence[Callable[[Axes], None]], columns: int = 4
) -> None:
    """One picture of cells in rows, each row at one scale and as high as that takes."""
    count, width = len(cells) // columns, 13.2 / columns
    drawing = Drawing(figsize=(13.2, 3.0 * count), layout="constrained", facecolor="white")
    drawing.get_layout_engine().set(w_pad=0.03, h_pad=0.07, wspace=0.01, hspace=0.02)
    axes = drawing.subplots(count, columns, squeeze=False)
    for place, text, draw in zip(axes.flat, titles, cells, strict=True):
        draw(place)
        title(place, text)
    heights = []
    for row in axes:
        at_one_scale(row)
        heights.append(width * np.ptp(row[0].get_ylim()) / np.ptp(row[0].get_xlim()) + 0.3)
    axes[0, 0].get_gridspec().set_height_ratios(heights)
    drawing.set_size_inches(13.2, sum(heights))
    run.save(drawing, number)
