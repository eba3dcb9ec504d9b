"""Nearest points of a boundary within a reach: all pieces that can be so near are tried."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from idviewer.core.arrays import Bools, Floats, Ints
from idviewer.core.shapes.shape import Shape

PAIRS_AT_ONCE = 1 << 18
"""Pairs of a point and a piece of the boundary that are looked at together: some 50 MB."""


class NearestPoints(NamedTuple):
    """The nearest point of a boundary to each of many points, where one is within reach.

    Attributes:
        points: (p, dimension) on the boundary; NaN where none is within reach.
        distances: (p,) to it; infinite where none is within reach.
    """

    points: Floats
    distances: Floats


def nearest_points(shape: Shape, points: Floats, reach: Floats) -> NearestPoints:
    """Find the nearest point of a boundary to each point, if it is no farther away than a reach.

    Args:
        shape: a mesh or a polygon.
        points: (p, dimension).
        reach: (p,) how far away it may be, in the shape's unit.

    >>> from idviewer.core import Polygon
    >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> found = nearest_points(square, np.array([[0.25, -0.125], [0.5, 0.5]]), np.array([0.25, 0.25]))
    >>> found.points.tolist(), found.distances.tolist()
    ([[0.25, 0.0], [nan, nan]], [0.125, inf])
    """
    # About the centre and in diagonals: squares of lengths neither vanish nor overflow.
    centre, scale = shape.bounds.mean(axis=0), shape.diagonal
    corners = (shape.vertices[shape.facets] - centre) / scale
    finite: Bools = np.atleast_1d(np.isfinite(points).all(axis=1))
    places = np.where(finite[:, None], (points - centre) / scale, np.inf)
    within: Floats = np.where(finite, reach / scale, -1.0)
    distances: Floats = np.full(len(points), np.inf)
    found = np.full(points.shape, np.nan)
    for some, pieces in _candidates(corners, places, within):
        nearest = _on_pieces(places[some], corners[pieces])
        lengths = np.linalg.norm(places[some] - nearest, axis=1)
        order = np.lexsort((lengths, some))
        first = order[np.unique(some[order], return_index=True)[1]]
        nearer: Bools = lengths[first] < distances[some[first]]
        first = first[nearer]
        distances[some[first]], found[some[first]] = lengths[first], nearest[first]
    beyond = np.flatnonzero(distances > within)
    distances[beyond], found[beyond] = np.inf, np.nan
    return NearestPoints(found * scale + centre, distances * scale)


def _candidates(corners: Floats, places: Floats, within: Floats) -> Iterator[tuple[Ints, Ints]]:
    """Pairs of points and pieces whose bounding spheres are within reach, a portion at a time."""
    centres = 0.5 * (corners.min(axis=1) + corners.max(axis=1))
    radii = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
    near = np.flatnonzero((within >= 0.0) & (np.abs(places).max(axis=1) <= 0.5 + within))
    # Pieces of about one size together, so that small ones are not looked for as far off as large ones.
    sizes = np.frexp(radii)[1]
    for size in np.unique(sizes):
        pieces = np.flatnonzero(sizes == size)
        tree = cKDTree(centres[pieces])
        largest = float(radii[pieces].max())
        for start in range(0, len(near), max(1, PAIRS_AT_ONCE // len(pieces))):
            some = near[start : start + max(1, PAIRS_AT_ONCE // len(pieces))]
            lists = tree.query_ball_point(places[some], within[some] + largest)
            counts = np.fromiter(map(len, lists), dtype=np.int64, count=len(some))
            if counts.sum():
                chosen = np.concatenate([np.asarray(one, dtype=np.int64) for one in lists])
                yield np.repeat(some, counts), pieces[chosen]


def _on_pieces(points: Floats, corners: Floats) -> Floats:
    """The nearest point (p, d) of one piece each, an edge (p, 2, d) or a triangle (p, 3, 3)."""
    sides = [(i, (i + 1) % corners.shape[1]) for i in range(1 if corners.shape[1] == 2 else 3)]
    nearest = np.empty_like(points)
    shortest = np.full(len(points), np.inf)
    for start, end in sides:
        _take_nearer(points, _on_segments(points, corners[:, start], corners[:, end]), nearest, shortest)
    if corners.shape[1] == 3:
        _take_nearer(points, _on_planes(points, corners), nearest, shortest)
    return nearest


def _take_nearer(points: Floats, candidates: Floats, nearest: Floats, shortest: Floats) -> None:
    """Put candidates that are nearer to their points in the place of those so far; NaN is none."""
    lengths = np.linalg.norm(points - candidates, axis=1)
    nearer = lengths < shortest
    nearest[nearer], shortest[nearer] = candidates[nearer], lengths[nearer]


def _on_segments(points: Floats, start: Floats, end: Floats) -> Floats:
    along = end - start
    squares = np.einsum("ij,ij->i", along, along)
    shares = np.einsum("ij,ij->i", points - start, along) / np.where(squares > 0.0, squares, 1.0)
    shares = np.clip(shares, 0.0, 1.0)[:, None]
    # From the nearer end, so that an end itself is met exactly.
    return np.where(shares <= 0.5, start + shares * along, end - (1.0 - shares) * along)


def _on_planes(points: Floats, corners: Floats) -> Floats:
    """Feet of perpendiculars on the planes of triangles; NaN where a foot is outside its triangle."""
    a, b, c = (corners[:, corner] for corner in range(3))
    normals = np.cross(b - a, c - a)
    squares = np.einsum("ij,ij->i", normals, normals)
    safe = np.where(squares > 0.0, squares, 1.0)
    feet = points - (np.einsum("ij,ij->i", points - a, normals) / safe)[:, None] * normals
    inside = squares > 0.0
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(end - start, feet - start), normals) >= 0.0
    feet[~inside] = np.nan
    return feet
