"""Closest points on a mesh, and the matrix that interpolates its functions there."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from idviewer.core._kernels.geometry.closest_points import project
from idviewer.core.arrays import Floats, Ints
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.steps import finish

POINTS_PER_STEP = 5_000
"""Points projected between two checkpoints: some five milliseconds."""


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """Points of a mesh's surface.

    Attributes:
        faces: (p,) the face that each lies in.
        shares: (p, 3) their barycentric coordinates there: not negative, with the sum 1.
    """

    faces: Ints
    shares: Floats

    def matrix(self, mesh: Mesh) -> csr_array:
        """Matrix (p, c) from values at the mesh's c vertices to those at the points: linear in each face."""
        shape = len(self.faces), len(mesh.vertices)
        starts = np.arange(0, self.shares.size + 1, 3)
        return csr_array((self.shares.ravel(), mesh.faces[self.faces].ravel(), starts), shape=shape)


class ClosestPointProjection:
    """Closest-point projection onto a mesh.

    Args:
        mesh: c vertices.

    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> tetrahedron = Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> closest = ClosestPointProjection(tetrahedron).project([[0.25, 0.25, -0.1]])
    >>> (closest.matrix(tetrahedron) @ tetrahedron.vertices).tolist()
    [[0.25, 0.25, 0.0]]
    """

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        self._around = np.argsort(mesh.faces.ravel(), kind="stable") // 3
        self._first = np.append(0, np.cumsum(np.bincount(mesh.faces.ravel(), minlength=len(mesh.vertices))))

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.mesh.vertices)

    def project(self, points: ArrayLike, starts: Ints | None = None) -> SurfacePoints:
        """Find the points of the surface closest to points (p, 3), each walked to from a vertex.

        Args:
            points: (p, 3).
            starts: (p,) vertices; the closest ones by default. Where parts of the surface lie close to each
                other, they say which of them is meant.
        """
        return finish(self.project_steps(points, starts))

    def project_steps(
        self, points: ArrayLike, starts: Ints | None = None
    ) -> Generator[float, None, SurfacePoints]:
        """`project` as a generator that yields the share done every few milliseconds.

        Args:
            points: (p, 3).
            starts: (p,) vertices to walk from; the closest ones by default.
        """
        points = np.ascontiguousarray(points, dtype=np.float64)
        if starts is None:
            starts = self._tree.query(points)[1]
        found, shares = np.empty(len(points), dtype=np.int64), np.empty((len(points), 3))
        for begin in range(0, len(points), POINTS_PER_STEP):
            part = slice(begin, begin + POINTS_PER_STEP)
            mesh = self.mesh.vertices, self.mesh.faces, self._first, self._around
            project(points[part], starts[part], *mesh, found[part], shares[part])
            yield min(1.0, (begin + POINTS_PER_STEP) / len(points))
        return SurfacePoints(found, shares)
