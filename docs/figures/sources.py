"""Figures 1, 3 and 4: the source varies, the boundary's shape varies."""

from __future__ import annotations

from functools import partial

import numpy as np

from figures import flat
from figures.bending import Floats
from figures.registry import Run, Table, figure
from figures.words import number, percent
from idviewer.core import InteriorDistance, Polygon, read_polygon, sample_path

HAND, HEAD, BELLY, FOOT = (-0.36, 0.05), (0.0, 0.38), (0.0, -0.02), (0.32, -0.37)
STEPS = (25, 50, 100, 200)
"""In which the source walks from head to foot."""


@figure("1", "from one source inside a 2D shape")
def one_source(run: Run) -> Table:
    """The interior distance from a point, beside the Euclidean one that knows no shape."""
    polygon = read_polygon(sample_path("gingerbread"))
    filling, solver = flat.Filling.of(polygon, run.samples), InteriorDistance(polygon)
    inner, straight = filling.distances(solver, HAND), np.linalg.norm(filling.points - HAND, axis=1)
    show = partial(flat.show, filling=filling, source=HAND)
    titles = ("interior distance", "Euclidean distance")
    flat.draw_rows(run, "1", titles, [partial(show, values=values) for values in (inner, straight)], 2)
    leg, head = nearest(filling.points, (-0.19, -0.45)), nearest(filling.points, HEAD)
    rows = [
        [name, percent(values[head] / values.max()), percent(values[leg] / values.max())]
        for name, values in zip(titles, (inner, straight), strict=True)
    ]
    header = ("share of the largest distance", "middle of the head", "foot on the same side")
    return Table(header, rows)


@figure("3", "the source varies")
def sources(run: Run) -> Table:
    """Four sources, and how much the distance changes while the source walks in ever smaller steps."""
    polygon = read_polygon(sample_path("gingerbread_waving"))
    filling, solver = flat.Filling.of(polygon, run.samples), InteriorDistance(polygon)
    images = filling.embed(solver)
    places = {"head": HEAD, "belly": BELLY, "waving hand": (0.34, 0.27), "foot": FOOT}
    values = [np.linalg.norm(images - solver.embed([place]), axis=1) for place in places.values()]
    cells = [
        partial(flat.show, filling=filling, values=one, source=place)
        for one, place in zip(values, places.values(), strict=True)
    ]
    flat.draw_rows(run, "3", list(places), cells)
    rows = [[f"{steps}", *map(percent, walk(solver, images, steps))] for steps in STEPS]
    note = "Shares of the largest distance. The third column bounds the second (triangle inequality)."
    return Table(
        ("steps from head to foot", "largest change of any value in a step", "longest step"), rows, note
    )


def walk(solver: InteriorDistance, images: Floats, steps: int) -> tuple[float, float]:
    """The source goes head, belly, foot: the largest change of any value, and the longest step in d."""
    way = np.interp(np.linspace(0.0, 2.0, steps + 1), [0.0, 1.0, 2.0], np.arange(3))
    corners = np.array([HEAD, BELLY, FOOT])
    path = np.stack([np.interp(way, np.arange(3), corners[:, axis]) for axis in range(2)], axis=1)
    sources, some = solver.embed(path), images[:: max(1, len(images) // 500)]
    values = np.linalg.norm(some[None] - sources[:, None], axis=2)
    moves = np.linalg.norm(np.diff(sources, axis=0), axis=1)
    return float(np.abs(np.diff(values, axis=0)).max() / values.max()), float(moves.max() / values.max())


@figure("4", "the shape varies: ever more concave")
def concavity(run: Run) -> Table:
    """A square with an ever deeper bay: where the farthest isoline lies, and how negative the weights are."""
    square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]]).resampled(240)
    polygons = [square, *(read_polygon(sample_path(f"bay_{depth}")) for depth in (1, 2, 3))]
    names, source = ("square", "bay 0.15 deep", "bay 0.5 deep", "bay 0.85 deep"), (0.2, 0.35)
    cells, rows = [], []
    for name, polygon in zip(names, polygons, strict=True):
        filling, solver = flat.Filling.of(polygon, run.samples), InteriorDistance(polygon)
        values = filling.distances(solver, source)
        cells.append(partial(flat.show, filling=filling, values=values, source=source))
        rows.append([name, *concave(solver, filling, values, source)])
    flat.draw_rows(run, "4", names, cells)
    header = (
        "shape",
        "d to the upper right corner / largest d",
        "with maximum entropy coordinates",
        "largest d inside / on the boundary",
        "sum of negative weights, mean",
        "largest",
    )
    return Table(header, rows)


def concave(
    solver: InteriorDistance, filling: flat.Filling, values: Floats, source: tuple[float, float]
) -> list[str]:
    """The numbers of one shape."""
    corner = nearest(filling.points, (1.0, 1.0))
    ends = np.linalg.norm(solver.boundary.embedding - solver.embed([source]), axis=1)
    negative = solver.coordinates.negativity(filling.points[filling.inner])
    negative = negative[np.isfinite(negative)]
    return [
        percent(values[corner] / values.max()),
        percent(corner_share(filling.polygon, source)),
        f"{values[filling.inner].max() / ends.max():.3f}",
        *(number(value) if value > 1e-9 else "0" for value in (negative.mean(), negative.max())),
    ]


def corner_share(polygon: Polygon, source: tuple[float, float]) -> float:
    """d to the upper right corner over the largest d, with coordinates that are never negative."""
    solver, filling = InteriorDistance(polygon, coordinates="maximum_entropy"), flat.Filling.of(polygon, 3000)
    values = filling.distances(solver, source)
    return float(values[nearest(filling.points, (1.0, 1.0))] / values.max())


def nearest(points: Floats, place: tuple[float, float]) -> int:
    """The index of the point next to a place."""
    return int(np.linalg.norm(points - place, axis=1).argmin())
