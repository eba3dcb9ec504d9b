"""Workspaces of the workers that take points through a tree of clusters."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.simd.lanes import LANES
from idviewer.core._kernels.simd.options import ALLOCATION_FREE
from idviewer.core._kernels.treecode.expansion import COEFFICIENTS
from idviewer.core._kernels.treecode.leaf import Leaves
from idviewer.core._kernels.treecode.low_rank_factors import LARGEST_RANK
from idviewer.core._kernels.treecode.point_lists import ROWS
from idviewer.core.arrays import Floats, Ints

Floats32 = NDArray[np.float32]
Bytes = NDArray[np.uint8]

CACHE_LINE = 64

LEVELS = 48
"""More than a tree can have."""


class Workspace(NamedTuple):
    """One worker's intermediate results, for chunks of up to c - LANES points; see `workspaces`.

    Attributes:
        chunk: (ROWS, c) float32 a list of the chunk's points; see `point_lists`.
        active: (LEVELS, c / LANES, 2) those that visit a node of each level, as blocks and bits.
        level_of: (LEVELS,) in which level's part of active they are (all may go on), and
        counts: (LEVELS,) how many blocks.
        picked: (ROWS, c) float32 some of the points.
        basis: (COEFFICIENTS, LANES) float32 derivatives of the kernel.
        amounts: (LARGEST_RANK, LANES) float32 of a node's right factors.
        shares: (3, LANES) of the corners of a leaf's faces.
        weights: (rows of the largest leaf, LANES) float32 of a leaf's rows.
        stack: (2 LEVELS,) nodes that are still to be visited.
        sums: (c, k) float32 of weights times values.
        on_surface: (c,) uint8 1 for points on the surface.
        corners, linear: (c, 3) rows and shares of the linear interpolation of these.
    """

    chunk: Floats32
    active: Ints
    level_of: Ints
    counts: Ints
    picked: Floats32
    basis: Floats32
    amounts: Floats32
    shares: Floats
    weights: Floats32
    stack: Ints
    sums: Floats32
    on_surface: Bytes
    corners: Ints
    linear: Floats


def aligned(shape: tuple[int, ...], dtype: type = np.float32) -> Any:
    """An array of zeros that begins where a line of the processor's cache does: no vector lies across two."""
    size = math.prod(shape) * np.dtype(dtype).itemsize
    memory = np.zeros(size + CACHE_LINE, dtype=np.uint8)
    start = -memory.ctypes.data % CACHE_LINE
    return memory[start : start + size].view(dtype).reshape(shape)


def workspaces(leaves: Leaves, width: int, points: int, workers: int) -> Workspace:
    """For so many workers, chunks of so many points and sums of a width: with one more axis in front."""
    rows = int(np.diff(leaves.first_row).max())
    size = (-(-points // LANES) + 1) * LANES
    return Workspace(
        aligned((workers, ROWS, size)),
        np.empty((workers, LEVELS, size // LANES, 2), dtype=np.int64),
        np.empty((workers, LEVELS), dtype=np.int64),
        np.empty((workers, LEVELS), dtype=np.int64),
        aligned((workers, ROWS, size)),
        aligned((workers, COEFFICIENTS, LANES)),
        aligned((workers, LARGEST_RANK, LANES)),
        aligned((workers, 3, LANES), np.float64),
        aligned((workers, rows, LANES)),
        np.empty((workers, 2 * LEVELS), dtype=np.int64),
        aligned((workers, points, width)),
        np.empty((workers, points), dtype=np.uint8),
        np.empty((workers, points, 3), dtype=np.int64),
        np.empty((workers, points, 3)),
    )


@numba.njit(**ALLOCATION_FREE)
def workspace_of(workspaces, worker):  # type: ignore[no-untyped-def]
    """A workspace for one worker."""
    return Workspace(
        workspaces.chunk[worker],
        workspaces.active[worker],
        workspaces.level_of[worker],
        workspaces.counts[worker],
        workspaces.picked[worker],
        workspaces.basis[worker],
        workspaces.amounts[worker],
        workspaces.shares[worker],
        workspaces.weights[worker],
        workspaces.stack[worker],
        workspaces.sums[worker],
        workspaces.on_surface[worker],
        workspaces.corners[worker],
        workspaces.linear[worker],
    )
