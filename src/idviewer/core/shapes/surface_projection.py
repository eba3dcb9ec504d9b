"""Closest points on triangles given as arrays."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from idviewer.core._kernels.geometry.closest_points import project
from idviewer.core.arrays import Floats, Ints


class ClosestPoints(NamedTuple):
    """Closest points of a surface.

    Attributes:
        points: (p, 3).
        faces: (p,) the faces that they lie in.
        shares: (p, 3) barycentric coordinates there.
        areas: (p,) of these faces.
    """

    points: Floats
    faces: Ints
    shares: Floats
    areas: Floats


class SurfaceProjection:
    """Closest points on a surface, walked to from the closest vertex and the face with the closest middle.

    Args:
        vertices: (n, 3).
        faces: (m, 3); vertices without faces do not count.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> surface = SurfaceProjection(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    >>> surface.closest(np.array([[0.25, 0.25, -0.1]])).points.tolist()
    [[0.25, 0.25, 0.0]]
    """

    def __init__(self, vertices: Floats, faces: Ints) -> None:
        numbers, corners = np.unique(faces, return_inverse=True)
        self._vertices = np.ascontiguousarray(vertices[numbers])
        self._faces = np.ascontiguousarray(corners.reshape(faces.shape))
        self._around = np.argsort(self._faces.ravel(), kind="stable") // 3
        self._first = np.append(0, np.cumsum(np.bincount(self._faces.ravel(), minlength=len(numbers))))

    @cached_property
    def _areas(self) -> Floats:
        a, b, c = (self._vertices[self._faces[:, corner]] for corner in range(3))
        return np.asarray(np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0)

    @property
    def area(self) -> float:
        """Area of the surface."""
        return float(self._areas.sum())

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self._vertices)

    @cached_property
    def _middles(self) -> cKDTree:
        return cKDTree(self._vertices[self._faces].mean(axis=1))

    def vertex_distances(self, points: Floats) -> Floats:
        """Distance of each point (p, 3) from the closest vertex, (p,)."""
        return np.asarray(self._tree.query(points)[0])

    def closest(self, points: Floats) -> ClosestPoints:
        """The points of the surface that are closest to others.

        Args:
            points: (p, 3).
        """
        points = np.ascontiguousarray(points)
        middles = self._faces[self._middles.query(points)[1]]
        best = np.full(len(points), np.inf)
        places, shares = np.empty(points.shape), np.empty(points.shape)
        faces = np.empty(len(points), np.int64)
        for starts in (self._tree.query(points)[1], *middles.T):
            found, weights = np.empty(len(points), np.int64), np.empty((len(points), 3))
            starts = np.ascontiguousarray(starts, np.int64)
            project(points, starts, self._vertices, self._faces, self._first, self._around, found, weights)
            at = np.einsum("pk,pkc->pc", weights, self._vertices[self._faces[found]])
            off = np.linalg.norm(at - points, axis=1)
            better = off < best
            best[better], places[better], shares[better] = off[better], at[better], weights[better]
            faces[better] = found[better]
        return ClosestPoints(places, faces, shares, self._areas[faces])
