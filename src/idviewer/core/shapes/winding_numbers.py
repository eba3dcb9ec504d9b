"""Winding numbers: how many times a closed surface goes round a point."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Floats, Ints, as_points, counted
from idviewer.core.shapes.mesh import Mesh

CELLS_PER_FACE = 0.25
"""Columns that the faces are sorted into, as seen from above."""

MOST_ENTRIES_PER_FACE = 24
"""Columns that a face lies in, on average; where it would be more, columns are made wider."""

FACES_MET_AT_ONCE = 1 << 19
"""Pairs of a point and a face that are looked at together."""


class WindingNumbers:
    """Winding numbers of a mesh's surface about points: 0 outside, 1 inside, 2 where it covers a place twice.

    Counted along the ray upwards from a point: faces that it leaves through, less those that it enters
    through. Which faces it meets is told by signs of areas that both faces of an edge compute alike, so that
    a ray through an edge or a vertex passes just one of them; a vertex exactly as high as the point counts
    as lower, likewise (the crossing number of Shimrat 1962, with signs).

    Args:
        mesh: m faces.

    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> WindingNumbers(tetrahedron).at([[0.2, 0.2, 0.2], [0.2, 0.2, -0.2], [0.2, 0.9, 0.2]]).tolist()
    [1, 0, 0]
    """

    def __init__(self, mesh: Mesh) -> None:
        self._centre, self._faces = mesh.centre, mesh.faces
        self._vertices = mesh.vertices - mesh.centre
        self._beyond = np.abs(self._vertices).max(axis=0)
        self._lowest = self._vertices[:, :2].min(axis=0)
        self._size = float(np.ptp(self._vertices[:, :2], axis=0).max())
        self._side = max(1, math.ceil(math.sqrt(CELLS_PER_FACE * len(mesh.faces))))
        flat = self._vertices[:, :2][mesh.faces]
        ends = flat.min(axis=1), flat.max(axis=1)
        while True:
            low, high = (self._cells(end) for end in ends)
            counts = (high - low + 1).prod(axis=1)
            if self._side == 1 or counts.sum() <= MOST_ENTRIES_PER_FACE * len(counts):
                break
            self._side = -(-self._side // 2)
        face, step = counted(counts)
        width = (high - low + 1)[face, 1]
        cells = (low[face, 0] + step // width) * self._side + low[face, 1] + step % width
        order = np.argsort(cells, kind="stable")
        self._entries = face[order]
        self._first = np.searchsorted(cells[order], np.arange(self._side**2 + 1))

    def at(self, points: ArrayLike) -> Ints:
        """Winding numbers (p,) about points (p, 3) off the surface.

        Raises:
            ValueError: the points have another dimension.
        """
        places = as_points(points, 3) - self._centre
        places[~np.isfinite(places).all(axis=1)] = 2.0 * self._beyond
        cells = self._cells(places[:, :2]) @ np.array([self._side, 1])
        counts = self._first[cells + 1] - self._first[cells]
        result, start = np.zeros(len(places), dtype=np.int64), 0
        ends = np.cumsum(counts)
        while start < len(places):
            done = ends[start - 1] if start else 0
            stop = max(start + 1, int(np.searchsorted(ends, done + FACES_MET_AT_ONCE)))
            part = slice(start, stop)
            point, step = counted(counts[part])
            faces = self._entries[self._first[cells[part]][point] + step]
            turns = self._turns(places[part][point], self._faces[faces])
            result[part] = np.bincount(point, turns, stop - start).astype(np.int64)
            start = stop
        return result

    def _cells(self, flat: Floats) -> Ints:
        """Columns (p, 2) of points (p, 2); the nearest one for those beside the surface."""
        scaled = (flat - self._lowest) * (self._side / self._size)
        return np.clip(np.nan_to_num(scaled), 0.0, self._side - 1).astype(np.int64)

    def _turns(self, places: Floats, faces: Ints) -> Floats:
        """What each face (q, 3) adds to the winding number about each of as many places (q, 3)."""
        turns = np.zeros(len(faces))
        x, y = places[:, 0], places[:, 1]
        for tail, head in ((0, 1), (1, 2), (2, 0)):
            a, b = faces[:, tail], faces[:, head]
            below, above = self._vertices[a, 1] <= y, self._vertices[b, 1] <= y
            near, far = self._vertices[np.minimum(a, b)], self._vertices[np.maximum(a, b)]
            area = (far[:, 0] - near[:, 0]) * (y - near[:, 1]) - (x - near[:, 0]) * (far[:, 1] - near[:, 1])
            left = (area >= 0.0) == (a < b)
            turns += (below & ~above & left).astype(float) - (~below & above & ~left)
        met = np.flatnonzero(turns)
        corners = self._vertices[faces[met]]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        height = ((corners[:, 0] - places[met]) * normals).sum(axis=1) * np.sign(normals[:, 2])
        upright = normals[:, 2] == 0.0
        height[upright] = corners[upright, :, 2].mean(axis=1) - places[met[upright], 2]
        turns[met[height <= 0.0]] = 0.0
        return turns
