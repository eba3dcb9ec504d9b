"""Mean value coordinates of points inside a closed triangle mesh, exact and for many points at once."""

from __future__ import annotations

import math
from collections.abc import Generator
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core import _kernels
from idviewer.core._kernels.mean_value.surface import patched
from idviewer.core.arrays import Floats, Ints, as_points
from idviewer.core.coordinates.point_classification import Boundary, PointClassification
from idviewer.core.coordinates.tolerance import Approximation
from idviewer.core.morton import morton_order
from idviewer.core.shapes.mesh import Mesh

Landed = tuple[int, Ints, Floats]
"""A point on the surface: its place among the packed ones, three vertices and their shares."""

FACE_VISITS = 2e6
"""Work between two checkpoints, in faces times points: 5 to 10 ms on two cores."""


class MeshMeanValue(Boundary):
    """Evaluates mean value coordinates of one mesh.

    Source: Ju, Schaefer and Warren 2005, evaluated without trigonometry (docs/mean_value.md).

    Args:
        mesh: n vertices.
    """

    def __init__(self, mesh: Mesh) -> None:
        super().__init__(mesh)
        self._mesh, self.elements = mesh, mesh.faces
        self._surface = patched(*self.normalised_mesh)
        self._arranged: tuple[Floats, Floats] | None = None

    def weights(self, points: ArrayLike) -> Floats:
        """Coordinates of points with respect to every vertex.

        Args:
            points: (p, 3).

        Returns:
            (p, n) rows that sum to 1; NaN for points outside the mesh.
        """
        points = as_points(points, 3)
        result = np.empty((len(points), self._count))
        for chosen, packed in self._batches(points, len(points)):
            places = np.full((len(packed), _kernels.LANES), -1)
            places.ravel()[: len(chosen)] = chosen
            product = np.empty((0, 0, 0)), np.empty((len(packed), 1, 0, 0))
            landing, _ = self._weigh(packed, self._kept, product, (places, result))
            for point, vertices, shares in landing:
                if point < len(chosen):
                    result[chosen[point]] = 0.0
                    np.add.at(result[chosen[point]], vertices, shares)
        return result

    def interpolate_steps(self, points: ArrayLike, values: Floats) -> Generator[float, None, Floats]:
        """Values given at the vertices, carried to points; yields the share done every few milliseconds.

        Args:
            points: (p, 3).
            values: (n, k).

        Returns:
            (p, k), NaN for points outside the mesh.
        """
        points = as_points(points, 3)
        columns = self._columns(values)
        result = np.empty((len(points), values.shape[1]))
        done = 0
        for chosen, packed in self._batches(points, FACE_VISITS / len(self._surface.faces)):
            landing, carried = self._interpolated(packed, len(chosen), columns)
            result[chosen] = carried[:, : values.shape[1]]
            for point, vertices, shares in landing:
                if point < len(chosen):
                    result[chosen[point]] = shares @ values[vertices]
            done += len(chosen)
            yield done / len(points)
        return result

    def _interpolated(self, packed: Floats, count: int, columns: Floats) -> tuple[list[Landed], Floats]:
        """Values carried to packed points: which are on the surface, and (count, k) that hold for the others.

        Args:
            packed: (blocks, 3, lanes).
            count: of points; the last block repeats some.
            columns: see `_columns`.
        """
        blocks, lanes = len(packed), min(_kernels.LANES, 4 * -(-count // 4))
        parts = max(1, self._workers // blocks)
        sums = np.zeros((blocks, parts, lanes, len(columns) * _kernels.LANES))
        kept = np.empty((self._workers, self._scratch.seen.shape[1], _kernels.LANES))
        nowhere = np.empty((0, 0), dtype=np.int64), np.empty((0, 0))
        landing, totals = self._weigh(packed, kept, (columns, sums), nowhere)
        total = totals.sum(axis=1).ravel()[:count]
        total[~(total > 0.0)] = np.nan  # outside: docs/mean_value.md
        return landing, sums.sum(axis=1).reshape(blocks * lanes, -1)[:count] / total[:, None]

    def _weigh(
        self, packed: Floats, kept: Floats, product: tuple[Floats, Floats], weights: tuple[Ints, Floats]
    ) -> tuple[list[Landed], Floats]:
        """Run the kernel; the points on the surface, and the weights' sums (blocks, parts, lanes)."""
        blocks, parts = product[1].shape[:2]
        landing, totals = _kernels.no_boundary_hits(blocks * parts), np.empty((blocks, parts, _kernels.LANES))
        _kernels.weigh(
            packed, self._surface, self.tolerance, self._scratch, landing, totals, kept, product, weights
        )
        landed = []
        for unit, lane in np.argwhere(landing.touched).tolist():
            vertices = self._surface.vertices[landing.rows[unit, lane]]
            landed.append((unit // parts * _kernels.LANES + lane, vertices, landing.shares[unit, lane]))
        return landed, totals

    def _columns(self, values: Floats) -> Floats:
        """The values at the surface's rows as (k / lanes, r, lanes), padded; kept if they cannot change."""
        if self._arranged is not None and self._arranged[0] is values:
            return self._arranged[1]
        count, lanes = values.shape[1], _kernels.LANES
        columns = np.zeros((-(-count // lanes), len(self._surface.vertices), lanes))
        for start in range(0, count, lanes):
            some = values[self._surface.vertices, start : start + lanes]
            columns[start // lanes, :, : some.shape[1]] = some
        if not values.flags.writeable:
            self._arranged = (values, columns)
        return columns

    @cached_property
    def _workers(self) -> int:
        return _kernels.thread_count()

    @cached_property
    def _scratch(self) -> _kernels.Scratch:
        return _kernels.scratch_for(self._surface, self._workers)

    @cached_property
    def _kept(self) -> Floats:
        return np.empty((self._workers, len(self._surface.vertices), _kernels.LANES))

    def _batches(self, points: Floats, size: float) -> Generator[tuple[Ints, Floats], None, None]:
        """Indices of some points that lie together, about so many, and the points as (blocks, 3, lanes).

        The last block is filled up with copies.
        """
        lanes = _kernels.LANES
        at_once = max(1, math.ceil(size / (lanes * self._workers))) * lanes * self._workers
        normalised = self.normalise(points)
        order = morton_order(np.where(np.isfinite(normalised), normalised, 0.0).clip(-1.0, 1.0))
        for start in range(0, len(points), at_once):
            chosen = order[start : start + at_once]
            blocks = -(-len(chosen) // lanes)
            padded = np.resize(chosen, blocks * lanes)
            packed = normalised[padded].reshape(blocks, lanes, 3).transpose(0, 2, 1)
            yield chosen, np.ascontiguousarray(packed)

    def locate(self, points: Floats) -> PointClassification:
        """Which of points (p, 3) are inside, and which on the surface."""
        nothing = np.zeros((1, len(self._surface.vertices), _kernels.LANES))
        inside, landed = np.zeros(len(points), dtype=bool), {}
        for chosen, packed in self._batches(points, len(points)):
            landing, carried = self._interpolated(packed, len(chosen), nothing)
            inside[chosen] = np.isfinite(carried[:, 0])
            landed.update({int(chosen[at]): where for at, *where in landing if at < len(chosen)})
        on = np.array(sorted(landed), dtype=np.int64)
        inside[on] = False
        vertices = np.array([landed[point][0] for point in on], dtype=np.int64).reshape(-1, 3)
        shares = np.array([landed[point][1] for point in on]).reshape(-1, 3)
        # Rounding leaves shares a hair below 0 on edges.
        shares = np.maximum(shares, 0.0)
        return PointClassification(
            np.flatnonzero(inside), on, vertices, shares / shares.sum(axis=1, keepdims=True)
        )

    @property
    def normalised_mesh(self) -> tuple[Floats, Ints]:
        """Positions (n, 3) as the kernels want them, and the faces (m, 3)."""
        return self.normalise(self._mesh.vertices), self._mesh.faces

    def approximation(self, values: Floats, weights: Floats) -> Approximation:
        """Values (n, k) ready to be carried inside within a tolerance; see `Approximation`."""
        return Approximation(self, values, weights)
