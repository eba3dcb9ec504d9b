"""Figures 10 and 11: other boundary distances, other coordinates."""

from __future__ import annotations

import numpy as np
from matplotlib.patches import Rectangle
from scipy.spatial import cKDTree
from scipy.stats import spearmanr

from figures import flat, solid
from figures.bending import Floats, diameter
from figures.bodies3d import plane_and_source
from figures.registry import Run, Table, figure
from figures.shapes import bundled, tiny_body
from figures.sources import HAND
from figures.words import percent
from idviewer.core import (
    COORDINATES,
    CommuteTime,
    Diffusion,
    Distance,
    Geodesic,
    InteriorDistance,
    Polygon,
    read_polygon,
    sample_path,
)
from idviewer.session import Query

DISTANCES: dict[str, Distance] = {
    "geodesic": Geodesic(),
    "commute time": CommuteTime(),
    "diffusion": Diffusion(),
}


@figure("10", "other boundary distances")
def boundary_distances(run: Run) -> Table:
    """Geodesic, commute time and diffusion distance carried inside a polygon and a body."""
    polygon, mesh = (
        read_polygon(sample_path("gingerbread")),
        tiny_body("hand") if run.tiny else bundled("hand_2k"),
    )
    filling, rows = flat.Filling.of(polygon, run.samples), []
    drawing, axes = flat.row_of(3, 4.4, 4.5, 2)
    plane, source = plane_and_source(mesh, "hand")
    values, slices, pictures = [], [], []
    for distance in DISTANCES.values():
        solver = InteriorDistance(polygon, distance)
        values.append(filling.distances(solver, HAND))
        pixels, frame = solid.picture(
            run, mesh, Query(planes=(plane,), source=source, distance=distance), 480
        )
        slices.append((frame.slices[0].points, frame.slices[0].values))
        pictures.append(pixels)
        rows.append([])
    for index, name in enumerate(DISTANCES):
        flat.show(axes[0, index], filling, values[index], HAND)
        flat.title(axes[0, index], name)
        solid.show_pixels(axes[1, index], solid.cropped(pictures)[index])
        straight = np.linalg.norm(filling.points - HAND, axis=1)
        points, here = slices[index]
        in_space = np.linalg.norm(points - np.array(source), axis=1)
        rows[index] = [
            name,
            *(f"{rank(values[index], other):.2f}" for other in (values[-1], straight)),
            *(f"{rank(here, other):.2f}" for other in (at(*slices[-1], points), in_space)),
        ]
    run.save(drawing, "10")
    left_out = (
        InteriorDistance(polygon, Geodesic()).description,
        InteriorDistance(mesh, Geodesic()).description,
    )
    note = (
        "Rank correlations (Spearman's) of the values in the pictures. Geodesic distances do not embed: "
        f"in 2D, {remark(left_out[0])}; in 3D, {remark(left_out[1])}."
    )
    header = (
        "boundary distance",
        "2D: with diffusion",
        "2D: with Euclidean",
        "3D: with diffusion",
        "3D: with Euclidean",
    )
    return Table(header, rows, note)


def remark(description: str) -> str:
    """What a description says of the embedding."""
    return description.split("; ")[-1]


def at(points: Floats, values: Floats, places: Floats) -> Floats:
    """Values at the nearest of the points where they are known."""
    return values[cKDTree(points).query(places)[1]]


def rank(one: Floats, other: Floats) -> float:
    """Spearman's correlation."""
    known = np.isfinite(one) & np.isfinite(other)
    return float(spearmanr(one[known], other[known]).statistic)


KINDS = {"shepard": "Shepard's weights", "mean_value": "mean value", "maximum_entropy": "maximum entropy"}
COARSE = 110
"""Vertices of the outline: few, so that there is something to see between them."""
WINDOW = ((0.055, -0.16), 0.2)
"""Lower left corner and side of what is magnified."""
DEPTH = 0.35
"""In edges: how deep below the boundary ripples are measured."""
PER_EDGE = 24


@figure("11", "other coordinates")
def coordinates(run: Run) -> Table:
    """Shepard's weights, mean value and maximum entropy coordinates, and a zoom into the boundary."""
    polygon = read_polygon(sample_path("gingerbread")).resampled(COARSE)
    filling = flat.Filling.of(polygon, run.samples)
    close = flat.Filling.of(polygon, 10 * run.samples)
    corner, side = np.array(WINDOW[0]), WINDOW[1]
    drawing, axes = flat.row_of(3, 4.4, 4.5, 2)
    rows = []
    for column, (name, text) in enumerate(KINDS.items()):
        assert name in COORDINATES
        solver = InteriorDistance(polygon, coordinates=name)
        values = filling.distances(solver, HAND)
        flat.show(axes[0, column], filling, values, HAND)
        axes[0, column].add_patch(Rectangle(WINDOW[0], side, side, fill=False, linewidth=1.2))
        flat.title(axes[0, column], text)
        near = np.all((close.points > corner - 0.1 * side) & (close.points < corner + 1.1 * side), axis=1)
        span = 0.0, float(values.max())
        flat.show_part(axes[1, column], close, near, close.distances_of(solver, HAND, near), span)
        axes[1, column].plot(*polygon.vertices.T, ".", color=flat.INK, markersize=6)
        axes[1, column].set(xlim=corner[0] + np.array([0, side]), ylim=corner[1] + np.array([0, side]))
        rows.append([text, *kind_numbers(solver, polygon)])
    run.save(drawing, "11")
    header = (
        "coordinates",
        "linear precision, largest error / diameter",
        "smallest weight",
        "ripples below the boundary / largest d",
        "largest d inside / on the boundary",
    )
    note = (
        f"Outline of {COARSE} vertices. Ripples: what is left of d along a line {DEPTH} edges below the "
        "boundary after a moving average over one edge, root mean square."
    )
    return Table(header, rows, note)


def kind_numbers(solver: InteriorDistance, polygon: Polygon) -> list[str]:
    """The numbers of one kind of coordinates."""
    points = flat.Filling.of(polygon, 3000)
    places = points.points[points.inner]
    weights = solver.coordinates.weights(places)
    error = np.linalg.norm(weights @ polygon.vertices - places, axis=1).max() / diameter(polygon.vertices)
    ends = np.linalg.norm(solver.boundary.embedding - solver.embed([HAND]), axis=1).max()
    inside = solver.field(HAND, places)
    return [
        f"{error:.1g}",
        f"{weights.min():.2g}",
        percent(ripples(solver, polygon) / ends),
        f"{inside.max() / ends:.3f}",
    ]


def ripples(solver: InteriorDistance, polygon: Polygon) -> float:
    """Root mean square of what of d along the boundary has the length of an edge or less."""
    ends = polygon.vertices[polygon.edges[:, 1]]
    along = (ends - polygon.vertices) / polygon.lengths[:, None]
    inward = np.stack([-along[:, 1], along[:, 0]], axis=1)
    share = (np.arange(PER_EDGE) + 0.5) / PER_EDGE
    points = polygon.vertices[:, None] + share[:, None] * (ends - polygon.vertices)[:, None]
    # The normal turns smoothly from that of a vertex to that of the next.
    before = inward + np.roll(inward, 1, axis=0)
    normals = (1 - share)[:, None] * before[:, None] + share[:, None] * np.roll(before, -1, axis=0)[:, None]
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    depth = DEPTH * polygon.perimeter / len(polygon.vertices)
    values = solver.field(HAND, (points + depth * normals).reshape(-1, 2))
    values = np.where(np.isfinite(values), values, np.nanmean(values))
    window = np.ones(PER_EDGE) / PER_EDGE
    smooth = np.convolve(np.concatenate([values[-PER_EDGE:], values, values[:PER_EDGE]]), window, mode="same")
    # An even window lies half a sample off; the mean of both sides does not.
    smooth = 0.5 * (smooth[PER_EDGE:-PER_EDGE] + smooth[PER_EDGE + 1 : len(smooth) - PER_EDGE + 1])
    return float(np.sqrt(np.mean((values - smooth) ** 2)))
