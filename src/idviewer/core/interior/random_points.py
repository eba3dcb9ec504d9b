"""Random points inside a shape: even by volume, and carried along when it is moved, turned or scaled."""

from __future__ import annotations

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.polygon import Polygon
from idviewer.core.shapes.rays import Ray, crossings
from idviewer.core.shapes.shape import Shape

CHORDS_PER_POINT = 2
"""Chords of which one is drawn for each point, by its length; more of them repeat fewer."""

START_DIAGONALS = 2.0
"""Distance before the entry at which a chord's ray starts, in diagonals of the shape: outside in any case."""


def random_interior_points(shape: Shape, count: int, seed: int = 0) -> Floats:
    """Points (count, dimension) inside a shape, even by its volume, or area in the plane.

    Random lines enter the boundary, evenly by its size and with the cosine of their angle to the normal, so
    that they are the uniform lines of integral geometry; of their chords some are drawn by their lengths, and
    a point evenly on each. Everything is drawn in the frames of the facets: the points of a shape that was
    moved, turned or scaled are those of the shape itself, moved, turned and scaled. Source: Santalo 1976,
    "Integral Geometry and Geometric Probability", part I, chapters 3 and 12.

    Args:
        shape: a mesh or a polygon.
        count: how many points.
        seed: of the random numbers.

    >>> points = random_interior_points(Polygon([[0, 0], [4, 0], [4, 2], [0, 2]]), 400)
    >>> points.shape, bool((points > 0.0).all() and (points < [4.0, 2.0]).all())
    ((400, 2), True)
    """
    rng = np.random.default_rng(seed)
    lines = CHORDS_PER_POINT * count
    entries, directions, facets = (
        _lines_into_polygon(shape, lines, rng)
        if isinstance(shape, Polygon)
        else _lines_into_mesh(shape, lines, rng)
    )
    if isinstance(shape, Polygon):
        lengths = _chord_lengths_in_polygon(shape, entries, directions, facets)
    else:
        assert isinstance(shape, Mesh)
        lengths = np.array(
            [_chord_length(shape, *line) for line in zip(entries, directions, strict=True)], dtype=np.float64
        )
    # One draw from each of so many equal parts of the whole length: evener than independent draws.
    ends = np.cumsum(lengths)
    places = (np.arange(count) + rng.random(count)) / count * ends[-1]
    drawn = np.minimum(np.searchsorted(ends, places, side="right"), lines - 1)
    along = ends[drawn] - places
    return entries[drawn] + along[:, None] * directions[drawn]


def _lines_into_polygon(
    polygon: Polygon, count: int, rng: np.random.Generator
) -> tuple[Floats, Floats, np.ndarray]:
    """Entries (count, 2), unit directions and edges of random lines into a polygon."""
    starts, stops = polygon.vertices[polygon.facets[:, 0]], polygon.vertices[polygon.facets[:, 1]]
    sides = stops - starts
    edges = _drawn(np.linalg.norm(sides, axis=1), count, rng)
    tangents = sides[edges] / np.linalg.norm(sides[edges], axis=1)[:, None]
    normals = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)  # the inside is on the left
    entries = starts[edges] + rng.random(count)[:, None] * sides[edges]
    sines = rng.uniform(-1.0, 1.0, count)[:, None]
    return entries, sines * tangents + np.sqrt(1.0 - sines**2) * normals, edges


def _lines_into_mesh(shape: Shape, count: int, rng: np.random.Generator) -> tuple[Floats, Floats, np.ndarray]:
    """Entries (count, 3), unit directions and faces of random lines into a mesh."""
    first, second, third = (shape.vertices[shape.facets[:, corner]] for corner in range(3))
    crosses = np.cross(second - first, third - first)
    faces = _drawn(np.linalg.norm(crosses, axis=1), count, rng)
    inward = -crosses[faces] / np.linalg.norm(crosses[faces], axis=1)[:, None]
    sides = (second - first)[faces]
    tangents = sides / np.linalg.norm(sides, axis=1)[:, None]
    roots, shares = np.sqrt(rng.random(count))[:, None], rng.random(count)[:, None]
    entries = (
        (1.0 - roots) * first[faces] + roots * (1.0 - shares) * second[faces] + roots * shares * third[faces]
    )
    sines, angles = np.sqrt(rng.random(count))[:, None], 2.0 * np.pi * rng.random(count)[:, None]
    flat = np.cos(angles) * tangents + np.sin(angles) * np.cross(inward, tangents)
    return entries, sines * flat + np.sqrt(1.0 - sines**2) * inward, faces


def _drawn(sizes: Floats, count: int, rng: np.random.Generator) -> np.ndarray:
    """Numbers (count,) of facets, drawn by their sizes."""
    ends = np.cumsum(sizes)
    return np.minimum(np.searchsorted(ends, rng.random(count) * ends[-1], side="right"), len(sizes) - 1)


def _chord_length(mesh: Mesh, entry: Floats, direction: Floats) -> float:
    """Length of the chord of a line that enters a mesh there."""
    before = START_DIAGONALS * mesh.diagonal
    start = entry - before * direction
    met = crossings(mesh, Ray(tuple(start.tolist()), tuple(direction.tolist()))).distances
    met = met[: len(met) // 2 * 2].reshape(-1, 2)
    if len(met) == 0:
        return 0.0  # it grazes an edge, where a chord has no length
    nearest = met[np.argmin(np.abs(met[:, 0] - before))]
    return float(nearest[1] - nearest[0])


def _chord_lengths_in_polygon(
    polygon: Polygon, entries: Floats, directions: Floats, edges: np.ndarray
) -> Floats:
    """Lengths of the chords of lines that enter a polygon on its edges of those numbers."""
    starts = polygon.vertices[polygon.facets[:, 0]]
    sides = polygon.vertices[polygon.facets[:, 1]] - starts
    lengths = np.empty(len(entries))
    for number, (entry, direction, edge) in enumerate(zip(entries, directions, edges, strict=True)):
        towards = starts - entry
        areas = direction[0] * sides[:, 1] - direction[1] * sides[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            along = (towards[:, 0] * sides[:, 1] - towards[:, 1] * sides[:, 0]) / areas
            share = (towards[:, 0] * direction[1] - towards[:, 1] * direction[0]) / areas
        ahead = (along > 0.0) & (share >= 0.0) & (share <= 1.0)
        ahead[edge] = False
        lengths[number] = along[ahead].min() if ahead.any() else 0.0
    return lengths
