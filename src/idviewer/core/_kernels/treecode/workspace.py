"""Room in which points go down a tree of clusters."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.simd.lanes import LANES
from idviewer.core._kernels.treecode.expansion import COEFFICIENTS
from idviewer.core._kernels.treecode.factors import RANK
from idviewer.core._kernels.treecode.leaf import Leaves
from idviewer.core._kernels.treecode.point_lists import ROWS
from idviewer.core.arrays import Floats, Ints

Floats32 = NDArray[np.float32]
Bytes = NDArray[np.uint8]

CACHE_LINE = 64

LEVELS = 48
"""More than a tree can have."""


class Room(NamedTuple):
    """Room for one worker's intermediate results, for chunks of up to c - LANES points.

    Attributes:
        list_: (ROWS, c) float32 the points of a chunk.
        active: (LEVELS, c / LANES, 2) those that visit a node of each level, as blocks and bits.
        held: (LEVELS,) in which level's part of active they are (all may go on), and
        counts: (LEVELS,) how many blocks.
        picked: (ROWS, c) float32 some of the points.
        basis: (COEFFICIENTS, LANES) float32 derivatives of the kernel.
        amounts: (RANK, LANES) float32 of a node's profiles.
        shares: (3, LANES) of the corners of a leaf's faces.
        weights: (rows of the largest leaf, LANES) float32 of a leaf's rows.
        stack: (2 LEVELS,) nodes that are still to be visited.
        sums: (c, k) float32 of weights times values.
        touched: (c,) 1 for points on the surface.
        rows, linear: (c, 3) rows and shares of the linear interpolation of these.
    """

    list_: Floats32
    active: Ints
    held: Ints
    counts: Ints
    picked: Floats32
    basis: Floats32
    amounts: Floats32
    shares: Floats
    weights: Floats32
    stack: Ints
    sums: Floats32
    touched: Bytes
    rows: Ints
    linear: Floats


def aligned(shape: tuple[int, ...], dtype: type = np.float32) -> Any:
    """An array of zeros that begins where a line of the processor's cache does: no vector lies across two."""
    size = math.prod(shape) * np.dtype(dtype).itemsize
    memory = np.zeros(size + CACHE_LINE, dtype=np.uint8)
    start = -memory.ctypes.data % CACHE_LINE
    return memory[start : start + size].view(dtype).reshape(shape)


def rooms(leaves: Leaves, width: int, points: int, workers: int) -> Room:
    """Room for workers, for chunks and sums of a size: all arrays have one more axis in front."""
    rows = int(np.diff(leaves.first_row).max())
    size = (-(-points // LANES) + 1) * LANES
    return Room(
        aligned((workers, ROWS, size)),
        np.empty((workers, LEVELS, size // LANES, 2), dtype=np.int64),
        np.empty((workers, LEVELS), dtype=np.int64),
        np.empty((workers, LEVELS), dtype=np.int64),
        aligned((workers, ROWS, size)),
        aligned((workers, COEFFICIENTS, LANES)),
        aligned((workers, RANK, LANES)),
        aligned((workers, 3, LANES), np.float64),
        aligned((workers, rows, LANES)),
        np.empty((workers, 2 * LEVELS), dtype=np.int64),
        aligned((workers, points, width)),
        np.empty((workers, points), dtype=np.uint8),
        np.empty((workers, points, 3), dtype=np.int64),
        np.empty((workers, points, 3)),
    )
