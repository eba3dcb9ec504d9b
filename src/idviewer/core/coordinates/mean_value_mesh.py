"""Mean value coordinates of points inside a closed triangle mesh, exact and for many points at once."""

from __future__ import annotations

import math
from collections.abc import Generator
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core import _kernels
from idviewer.core._kernels.mean_value.surface import surface_in_blocks
from idviewer.core.arrays import Bools, Floats, Ints, as_points
from idviewer.core.coordinates.overlap_guard import OverlapGuard
from idviewer.core.coordinates.point_classification import Boundary, PointClassification
from idviewer.core.coordinates.tolerance import Approximation
from idviewer.core.coordinates.weight_sums import WeightSums
from idviewer.core.morton import morton_order
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.winding_numbers import WindingNumbers

BoundaryPoint = tuple[int, Ints, Floats]
"""A point on the surface: its place among the packed ones, three vertices and their shares."""

SUMS_PER_STEP = 1024
"""Points whose absolute weights are summed up between two checkpoints: some 10 ms."""

VISITS_PER_STEP = 2e6
"""Faces times points between two checkpoints: 5 to 10 ms on two cores."""


class MeshMeanValue(Boundary):
    """Evaluates mean value coordinates of one mesh.

    Source: Ju, Schaefer and Warren 2005, evaluated without trigonometry (docs/mean_value.md).

    Where the surface overlaps itself, points that `without_value` names get NaN like those outside.

    Args:
        mesh: n vertices.

    Attributes:
        undefined: how many points inside, of all so far, got no value since the surface overlaps itself.

    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> MeshMeanValue(tetrahedron).weights([[0.25, 0.25, 0.25]]).round(12).tolist()
    [[0.25, 0.25, 0.25, 0.25]]
    """

    def __init__(self, mesh: Mesh) -> None:
        super().__init__(mesh)
        self._mesh, self.elements = mesh, mesh.faces
        self._surface = surface_in_blocks(*self.normalised_mesh)
        self.undefined = 0
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
            hits, _ = self._weigh(packed, self._kept, product, (places, result))
            for point, vertices, shares in hits:
                if point < len(chosen):
                    result[chosen[point]] = 0.0
                    np.add.at(result[chosen[point]], vertices, shares)
        self.blank(points, result)
        return result

    def interpolate_steps(self, points: ArrayLike, values: Floats) -> Generator[float, None, Floats]:
        """Carry values at the vertices to points; yields the share done every few milliseconds.

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
        for chosen, packed in self._batches(points, VISITS_PER_STEP / len(self._surface.faces)):
            hits, interpolated = self._interpolate(packed, len(chosen), columns)
            result[chosen] = interpolated[:, : values.shape[1]]
            for point, vertices, shares in hits:
                if point < len(chosen):
                    result[chosen[point]] = shares @ values[vertices]
            self.blank(points, result, chosen)
            done += len(chosen)
            yield done / len(points)
        return result

    def blank(self, points: Floats, rows: Floats, chosen: Ints | None = None) -> None:
        """Set rows (p, k) of points (p, 3) to NaN where a surface that overlaps itself leaves no value.

        Args:
            points, rows: of all points.
            chosen: numbers of the points to look at; all by default.
        """
        if self._mesh.self_intersections:
            chosen = np.arange(len(points)) if chosen is None else chosen
            blank, inside = self._overlap_guard.without_value(points[chosen], self.normalise(points[chosen]))
            rows[chosen[blank]] = np.nan
            self.undefined += int(np.count_nonzero(blank & inside))

    def have_values(self, points: Floats) -> Bools:
        """Tell which of points (p, 3) inside have values, (p,)."""
        if not self._mesh.self_intersections:
            return np.ones(len(points), dtype=np.bool_)
        return ~self._overlap_guard.without_value(points, self.normalise(points))[0]

    def negativity_bound_steps(self, points: Floats) -> Generator[float, None, Floats]:
        """Bound the sum of negative weights of points (p, 3), or nearly; infinite where W is not positive.

        Yields the share done every few milliseconds.
        """
        result = np.empty(len(points))
        for start in range(0, len(points), SUMS_PER_STEP):
            part = slice(start, start + SUMS_PER_STEP)
            sums, absolute = self.weight_sums.at(self.normalise(points[part])).T
            ratio = np.divide(absolute, sums, out=np.full(len(sums), np.inf), where=sums > 0.0)
            result[part] = np.maximum(0.5 * (ratio - 1.0), 0.0)
            yield min(1.0, (start + SUMS_PER_STEP) / len(points))
        return result

    @cached_property
    def weight_sums(self) -> WeightSums:
        """Sums of weights and of their absolute values, of points that are normalised."""
        return WeightSums(*self.normalised_mesh, self.tolerance)

    @cached_property
    def _overlap_guard(self) -> OverlapGuard:
        return OverlapGuard(WindingNumbers(self._mesh), self.weight_sums)

    def _interpolate(self, packed: Floats, count: int, columns: Floats) -> tuple[list[BoundaryPoint], Floats]:
        """Values carried to packed points: which are on the surface, and (count, k) that hold for the others.

        Args:
            packed: (packets, 3, lanes).
            count: of points; the last packet repeats some.
            columns: see `_columns`.
        """
        packets, lanes = len(packed), min(_kernels.LANES, 4 * -(-count // 4))
        parts = max(1, self._workers // packets)
        sums = np.zeros((packets, parts, lanes, len(columns) * _kernels.LANES))
        kept = np.empty((self._workers, self._workspaces.distances.shape[1], _kernels.LANES))
        nowhere = np.empty((0, 0), dtype=np.int64), np.empty((0, 0))
        hits, totals = self._weigh(packed, kept, (columns, sums), nowhere)
        total = totals.sum(axis=1).ravel()[:count]
        total[~(total > 0.0)] = np.nan  # outside: docs/mean_value.md
        return hits, sums.sum(axis=1).reshape(packets * lanes, -1)[:count] / total[:, None]

    def _weigh(
        self, packed: Floats, kept: Floats, product: tuple[Floats, Floats], weights: tuple[Ints, Floats]
    ) -> tuple[list[BoundaryPoint], Floats]:
        """Run the kernel; the points on the surface, and the weights' sums (packets, parts, lanes)."""
        packets, parts = product[1].shape[:2]
        hits, totals = _kernels.no_boundary_hits(packets * parts), np.empty((packets, parts, _kernels.LANES))
        _kernels.weigh(
            packed, self._surface, self.tolerance, self._workspaces, hits, totals, kept, product, weights
        )
        on_boundary = []
        for unit, lane in np.argwhere(hits.kinds).tolist():
            vertices = self._surface.vertices[hits.vertices[unit, lane]]
            on_boundary.append((unit // parts * _kernels.LANES + lane, vertices, hits.shares[unit, lane]))
        return on_boundary, totals

    def _columns(self, values: Floats) -> Floats:
        """The values at the surface's local vertices as (k / lanes, r, lanes), padded; kept if read-only."""
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
    def _workspaces(self) -> _kernels.Workspace:
        return _kernels.workspaces_for(self._surface, self._workers)

    @cached_property
    def _kept(self) -> Floats:
        return np.empty((self._workers, len(self._surface.vertices), _kernels.LANES))

    def _batches(self, points: Floats, size: float) -> Generator[tuple[Ints, Floats], None, None]:
        """Indices of some points that lie together, about so many, and the points as (packets, 3, lanes).

        The last packet is filled up with copies.
        """
        lanes = _kernels.LANES
        at_once = max(1, math.ceil(size / (lanes * self._workers))) * lanes * self._workers
        normalised = self.normalise(points)
        order = morton_order(np.where(np.isfinite(normalised), normalised, 0.0).clip(-1.0, 1.0))
        for start in range(0, len(points), at_once):
            chosen = order[start : start + at_once]
            packets = -(-len(chosen) // lanes)
            padded = np.resize(chosen, packets * lanes)
            packed = normalised[padded].reshape(packets, lanes, 3).transpose(0, 2, 1)
            yield chosen, np.ascontiguousarray(packed)

    def classify(self, points: Floats) -> PointClassification:
        """Classify points (p, 3) as inside, on the surface or outside."""
        nothing = np.zeros((1, len(self._surface.vertices), _kernels.LANES))
        inside, on_boundary = np.zeros(len(points), dtype=bool), {}
        for chosen, packed in self._batches(points, len(points)):
            hits, interpolated = self._interpolate(packed, len(chosen), nothing)
            inside[chosen] = np.isfinite(interpolated[:, 0])
            on_boundary.update({int(chosen[at]): hit for at, *hit in hits if at < len(chosen)})
        on = np.array(sorted(on_boundary), dtype=np.int64)
        if self._mesh.self_intersections:
            inside = self._overlap_guard.winding_numbers.at(points) > 0
        inside[on] = False
        vertices = np.array([on_boundary[point][0] for point in on], dtype=np.int64).reshape(-1, 3)
        shares = np.array([on_boundary[point][1] for point in on]).reshape(-1, 3)
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
        """Prepare to carry values inside within a tolerance; see `Approximation`.

        Args:
            values: (n, k) at the vertices.
            weights: (k,) an error e (k,) of a point's values is measured as |weights * e|.
        """
        return Approximation(self, values, weights)
