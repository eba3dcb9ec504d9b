"""Mean value coordinates of points inside a closed triangle mesh, exact and for many points at once."""

from __future__ import annotations

from collections.abc import Generator
from functools import cache, cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from threadpoolctl import ThreadpoolController

from idviewer.core import _kernels
from idviewer.core.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FACE_VISITS = 2e6
"""Work between two checkpoints, in faces times points: 5 to 10 ms on two cores."""


class MeanValueCoordinates:
    """Evaluates mean value coordinates of one mesh.

    They are smooth, add up to 1, reproduce linear functions and interpolate on the surface (vertex,
    edge and face alike); they may be negative in concave shapes. Source: Ju, Schaefer and Warren 2005,
    evaluated without trigonometry (docs/mean_value.md).

    Args:
        mesh: n vertices.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> MeanValueCoordinates(tetrahedron).weights([[0.1, 0.2, 0.3]]).round(12).tolist()
    [[0.4, 0.1, 0.2, 0.3]]
    """

    name = "mean_value"
    title = "Mean value coordinates"

    def __init__(self, mesh: Mesh) -> None:
        self._centre = mesh.bounds.mean(axis=0)
        self._scale = 1.0 / mesh.diagonal
        # Neighbours in space become neighbours in memory; on large meshes this decides the speed.
        normalised = self._normalised(mesh.vertices)
        self._order = _along_a_space_filling_curve(normalised)
        rank = np.empty_like(self._order)
        rank[self._order] = np.arange(len(rank))
        self._vertices = np.ascontiguousarray(normalised[self._order])
        faces = rank[mesh.faces].astype(np.int32)
        self._faces = np.ascontiguousarray(faces[np.argsort(faces.min(axis=1), kind="stable")])
        # Rounding of the input coordinates, which is large on a mesh far from the origin.
        reach = float(np.abs(mesh.bounds).max()) * self._scale
        self._tolerance = 64.0 * float(np.finfo(float).eps) * (1.0 + reach)

    def weights(self, points: ArrayLike) -> Floats:
        """Coordinates of points with respect to every vertex.

        Args:
            points: (p, 3).

        Returns:
            (p, n) rows that sum to 1; NaN for points outside the mesh.
        """
        points = as_points(points)
        result = np.empty((len(points), len(self._order)))
        for start, packed in self._batches(points):
            weights = np.empty((len(packed), len(self._order), _kernels.LANES))
            states = np.empty((len(packed), _kernels.LANES), dtype=np.int8)
            view, _ = self._scratch
            _kernels.mean_value_weights(
                packed, self._vertices, self._faces, self._tolerance, view, weights, states
            )
            rows = weights.transpose(0, 2, 1).reshape(states.size, -1)
            self._keep(result[start : start + states.size], rows, states, self._order)
        return result

    def interpolate_steps(self, points: ArrayLike, values: Floats) -> Generator[float, None, Floats]:
        """Values given at the vertices, carried to points; yields the share done every few milliseconds.

        Args:
            points: (p, 3).
            values: (n, k).

        Returns:
            (p, k), NaN for points outside the mesh.
        """
        points = as_points(points)
        ordered = np.ascontiguousarray(values[self._order])
        result = np.empty((len(points), values.shape[1]))
        for start, packed in self._batches(points):
            rows = np.empty((len(packed), _kernels.LANES, values.shape[1]))
            states = np.empty((len(packed), _kernels.LANES), dtype=np.int8)
            # One BLAS thread in each of ours; more would fight over the cores.
            with _blas().limit(limits=1):
                _kernels.interpolate(
                    packed,
                    self._vertices,
                    self._faces,
                    self._tolerance,
                    self._scratch,
                    ordered,
                    rows,
                    states,
                )
            self._keep(result[start : start + states.size], rows.reshape(states.size, -1), states)
            yield min(1.0, (start + states.size) / len(points))
        return result

    @cached_property
    def _scratch(self) -> tuple[Floats, Floats]:
        threads, lanes, n = _kernels.thread_count(), _kernels.LANES, len(self._order)
        return np.empty((threads, n, 4, lanes)), np.empty((threads, n, lanes))

    def _batches(self, points: Floats) -> Generator[tuple[int, Floats], None, None]:
        """Index of the first point, and (blocks, 3, lanes) points, the last block filled up with copies."""
        lanes, threads = _kernels.LANES, _kernels.thread_count()
        rounds = max(1, round(FACE_VISITS / (len(self._faces) * lanes * threads)))
        at_once = rounds * lanes * threads
        normalised = self._normalised(points)
        for start in range(0, len(points), at_once):
            batch = normalised[start : start + at_once]
            blocks = -(-len(batch) // lanes)
            padded = np.concatenate([batch, np.repeat(batch[-1:], blocks * lanes - len(batch), axis=0)])
            yield start, np.ascontiguousarray(padded.reshape(blocks, lanes, 3).transpose(0, 2, 1))

    @staticmethod
    def _keep(result: Floats, rows: Floats, states: NDArray[np.int8], columns: Ints | None = None) -> None:
        """Copy the rows that are no filling, NaN for points outside."""
        count = len(result)
        outside = states.ravel()[:count] == _kernels.OUTSIDE
        result[:, slice(None) if columns is None else columns] = rows[:count]
        result[outside] = np.nan

    def _normalised(self, points: Floats) -> Floats:
        return (points - self._centre) * self._scale


def mean_value_weights(mesh: Mesh, points: ArrayLike) -> Floats:
    """Mean value coordinates of points; for many calls on one mesh keep a `MeanValueCoordinates`.

    Args:
        mesh: n vertices.
        points: (p, 3).

    Returns:
        (p, n) rows that sum to 1; NaN for points outside the mesh.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> mean_value_weights(tetrahedron, [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]).round(12).tolist()
    [[1.0, 0.0, 0.0, 0.0], [nan, nan, nan, nan]]
    """
    return MeanValueCoordinates(mesh).weights(points)


def as_points(points: ArrayLike) -> Floats:
    """points as (p, 3) float64; a ValueError names any other shape."""
    array = np.asarray(points, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"points must have shape (p, 3), not {array.shape}")
    return array


@cache
def _blas() -> ThreadpoolController:
    return ThreadpoolController().select(user_api="blas")


def _along_a_space_filling_curve(points: Floats) -> Ints:
    """Order of the points along a Morton curve of 2^10 cells a side."""
    cells = ((points - points.min(axis=0)) / np.ptp(points, axis=0).max() * 1023.0).astype(np.int64)
    code = np.zeros(len(points), dtype=np.int64)
    for bit in range(10):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return np.argsort(code, kind="stable")
