"""Triangular solves with a sparse factor, LANES right-hand sides at a time, on several threads."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.faces import OPTIONS, PLAIN
from idviewer.core._kernels.lanes import LANES, load, splat, store

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Columns(NamedTuple):
    """L of A = L D L^T by columns, without its unit diagonal, cut into parts that can be worked on apart.

    Entries of one part's columns lie in rows of the part, or in rows that separate parts. The latter are
    numbered apart for each part, behind all rows: n + p * separators + s is part p's copy of the s-th.

    Attributes:
        columns: (n,) columns of the parts, one part after the other, then the separating ones.
        first_column: (parts + 1,) where each part begins in columns, and the separating ones.
        starts: (n + 1,) where each column's entries begin.
        rows: (z,) int32 of each entry, as numbered for its column.
        values: (z,) of each entry.
        over: (n,) 1 / D.
        separating: (s,) the rows that separate.
    """

    columns: Ints
    first_column: Ints
    starts: Ints
    rows: NDArray[np.int32]
    values: Floats
    over: Floats
    separating: Ints


@numba.njit(**PLAIN)
def _forward(columns, first, end, starts, rows, values, x):  # type: ignore[no-untyped-def]
    """x = L^-1 x, for some columns."""
    for place in range(first, end):
        column = columns[place]
        known = load(x, column * LANES)
        for entry in range(starts[column], starts[column + 1]):
            target = np.int64(rows[entry]) * LANES
            store(x, target, load(x, target) - values[entry] * known)


@numba.njit(**PLAIN)
def _backward(columns, first, end, starts, rows, values, over, x):  # type: ignore[no-untyped-def]
    """x = L^-T D^-1 x, for some columns."""
    for place in range(end - 1, first - 1, -1):
        column = columns[place]
        a, b = load(x, column * LANES) * over[column], splat(0.0)
        entry, last = starts[column], starts[column + 1]
        while entry + 1 < last:
            a = a - values[entry] * load(x, np.int64(rows[entry]) * LANES)
            b = b - values[entry + 1] * load(x, np.int64(rows[entry + 1]) * LANES)
            entry += 2
        if entry < last:
            a = a - values[entry] * load(x, np.int64(rows[entry]) * LANES)
        store(x, column * LANES, a + b)


@numba.njit(parallel=True, cache=True, **OPTIONS)
def solve(columns, first_column, starts, rows, values, over, separating, x):  # type: ignore[no-untyped-def]
    """Solve A x = b in place.

    Args:
        columns, first_column, starts, rows, values, over, separating: `Columns`.
        x: (n + parts * s, LANES) right-hand sides in the first n rows, then solutions; the others are 0 and
            overwritten.
    """
    parts, count = first_column.shape[0] - 1, over.shape[0]
    extra = separating.shape[0]
    for part in numba.prange(parts):
        _forward(columns, first_column[part], first_column[part + 1], starts, rows, values, x)
    for part in range(parts):
        for i in range(extra):
            row, copy = separating[i] * LANES, (count + part * extra + i) * LANES
            store(x, row, load(x, row) + load(x, copy))
    _forward(columns, first_column[parts], count, starts, rows, values, x)
    _backward(columns, first_column[parts], count, starts, rows, values, over, x)
    for part in range(parts):
        for i in range(extra):
            store(x, (count + part * extra + i) * LANES, load(x, separating[i] * LANES))
    for part in numba.prange(parts):
        _backward(columns, first_column[part], first_column[part + 1], starts, rows, values, over, x)
