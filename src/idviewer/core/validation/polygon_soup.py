"""Polygon soups: points, and polygons with any number of corners, as files hold them; their triangulation."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import manifold3d
import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Floats, Ints


@dataclass(frozen=True, eq=False)
class PolygonSoup:
    """Polygons as read, nothing checked.

    Attributes:
        vertices: (n, 3) points.
        corners: (k,) vertex indices of all polygons, one after the other.
        sizes: (m,) how many corners each polygon has.
    """

    vertices: Floats
    corners: Ints
    sizes: Ints

    @classmethod
    def of(cls, vertices: ArrayLike, faces: ArrayLike | Sequence[Sequence[int]]) -> PolygonSoup:
        """Make a soup of points and lists of vertex indices.

        Args:
            vertices: (n, 3).
            faces: (m, k) vertex indices, or a sequence of index sequences of any lengths.

        Raises:
            ValueError: these are not points and whole numbers.
        """
        points = np.array(vertices, dtype=np.float64, order="C")
        if points.size == 0:
            points = points.reshape(0, 3)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"vertices must have the shape (n, 3), not {points.shape}")
        if isinstance(faces, np.ndarray) and faces.ndim == 2:
            return cls(points, whole_numbers(faces).ravel(), np.full(len(faces), faces.shape[1]))
        if isinstance(faces, np.ndarray) and faces.ndim != 1:
            raise ValueError(f"faces must have the shape (m, 3), not {faces.shape}")
        rows = [whole_numbers(row).reshape(-1) for row in faces]  # type: ignore[union-attr]
        return cls(points, concatenated(rows), np.array([len(row) for row in rows], dtype=np.int64))

    @classmethod
    def joined(cls, parts: Iterable[PolygonSoup]) -> PolygonSoup:
        """All parts in one, in their order."""
        kept = list(parts)
        offsets = np.cumsum([0] + [len(part.vertices) for part in kept])
        return cls(
            np.concatenate([np.empty((0, 3)), *(part.vertices for part in kept)]),
            concatenated([part.corners + offset for part, offset in zip(kept, offsets, strict=False)]),
            concatenated([part.sizes for part in kept]),
        )


def concatenated(rows: Sequence[Ints]) -> Ints:
    """The rows one after the other; also where there are none.

    >>> concatenated([]).tolist(), concatenated([np.arange(2), np.arange(1)]).tolist()
    ([], [0, 1, 0])
    """
    return np.concatenate([np.empty(0, np.int64), *rows])


def whole_numbers(values: ArrayLike) -> Ints:
    """Convert values to int64.

    Raises:
        ValueError: one is not a whole number, or is 2^62 or more.

    >>> whole_numbers([1.0, 2.0]).tolist()
    [1, 2]
    """
    array = np.asarray(values)
    if array.size == 0:
        return np.zeros(array.shape, np.int64)
    if array.dtype.kind == "f" and np.all(array == np.rint(array)) and np.all(np.abs(array) < 2.0**62):
        return array.astype(np.int64)
    if array.dtype.kind not in "iu" or (array.dtype.kind == "u" and array.max() >= 2**62):
        raise ValueError("faces must hold vertex indices, that is whole numbers")
    return array.astype(np.int64)


def strips(corners: Ints) -> Ints:
    """Triangles (t, 3) of one triangle strip; every other one is turned, so that all are wound alike.

    >>> strips(np.arange(4)).tolist()
    [[0, 1, 2], [2, 1, 3]]
    """
    if len(corners) < 3:
        return np.empty((0, 3), np.int64)
    triangles = np.column_stack([corners[:-2], corners[1:-1], corners[2:]])
    triangles[1::2] = triangles[1::2, [1, 0, 2]]
    return triangles


def triangulated(polygons: PolygonSoup) -> Ints:
    """Triangles (t, 3) with the polygons' corners, winding and order; none for under three corners.

    A convex polygon becomes a fan; any other is cut into ears on the plane that fits it best. Every polygon
    of k corners gives k - 2 triangles, so no corner is lost and neighbours stay joined.

    >>> square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    >>> triangulated(PolygonSoup.of(square, [[0, 1, 2, 3]])).tolist()
    [[0, 1, 2], [0, 2, 3]]
    """
    sizes = polygons.sizes
    if np.all(sizes == 3):
        return polygons.corners.reshape(-1, 3)
    starts = np.cumsum(sizes) - sizes
    counts = np.maximum(sizes - 2, 0)
    places = np.cumsum(counts) - counts
    triangles = np.empty((int(counts.sum()), 3), np.int64)
    for size in np.unique(sizes[sizes >= 3]):
        chosen = np.flatnonzero(sizes == size)
        rings = polygons.corners[starts[chosen, None] + np.arange(size)]
        into = places[chosen, None] + np.arange(size - 2)
        triangles[into] = _cut(polygons.vertices, rings)
    return triangles


def _cut(vertices: Floats, rings: Ints) -> Ints:
    """Triangles (p, k - 2, 3) of rings (p, k) that have the same number of corners."""
    size = rings.shape[1]
    fan = np.column_stack([np.zeros(size - 2, np.int64), np.arange(1, size - 1), np.arange(2, size)])
    triangles = rings[:, fan]
    if size == 3:
        return triangles
    points = vertices[rings] - vertices[rings].mean(axis=1, keepdims=True)
    normals = np.cross(points, np.roll(points, -1, axis=1)).sum(axis=1)
    sides = np.roll(points, -1, axis=1) - points
    turns = np.einsum("pkc,pc->pk", np.cross(np.roll(sides, 1, axis=1), sides), normals)
    # A straight corner counts as not convex: a fan could turn it into a triangle without area.
    lengths = np.einsum("pkc,pkc->pk", sides, sides).max(axis=1)
    straight = 1e-12 * lengths * np.sqrt(np.einsum("pc,pc->p", normals, normals))
    for row in np.flatnonzero(np.any(turns <= straight[:, None], axis=1)):
        triangles[row] = rings[row][_ears(points[row], normals[row], fan)]
    return triangles


def _ears(points: Floats, normal: Floats, fan: Ints) -> Ints:
    """Triangles (k - 2, 3) of one ring, cut on the plane with the given normal; else the fan."""
    axis = int(np.argmax(np.abs(normal)))
    scale = float(np.abs(points).max())
    if normal[axis] == 0.0 or scale == 0.0:
        return fan
    # Dropping the largest axis of the normal is a projection that keeps the ring simple; in this order of
    # the other two it also keeps its sense.
    kept = [(axis + 1) % 3, (axis + 2) % 3]
    flat = points[:, kept if normal[axis] > 0.0 else kept[::-1]] / scale
    triangles = np.asarray(manifold3d.triangulate([flat]), dtype=np.int64).reshape(-1, 3)
    # A ring that crosses itself may come back incomplete; a crack would be worse than poor triangles.
    whole = len(triangles) == len(fan) and len(np.unique(triangles)) == len(flat)
    return triangles if whole else fan
