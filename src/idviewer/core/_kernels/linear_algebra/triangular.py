"""Triangular solves with a sparse factor, LANES right-hand sides at a time, on several threads."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.simd.lanes import LANES, load, splat, store
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS
from idviewer.core.arrays import Floats, Ints


class Columns(NamedTuple):
    """L of A = L D L^T by columns, without its unit diagonal, cut into parts that can be worked on apart.

    Entries of one part's columns lie in rows of the part, or in rows that separate parts. The latter are
    numbered apart for each part, behind all rows: n + p * separators + s is part p's copy of the s-th.

    Successive columns of which each has the entries of the one before, but for that in its own row, go
    together: every row is then loaded once for all of them.

    Attributes:
        groups: (g,) the first columns of the groups of one part after the other, then of the separating ones.
        widths: (g,) how many columns each group has: 1, 2 or 4.
        first_group: (parts + 1,) where each part begins in groups, and the separating ones.
        starts: (n + 1,) where each column's entries begin.
        rows: (z,) int32 of each entry, as numbered for its column, in ascending order in a column.
        values: (z,) of each entry.
        inverse_pivots: (n,) 1 / D.
        separating: (s,) the rows that separate.
    """

    groups: Ints
    widths: Ints
    first_group: Ints
    starts: Ints
    rows: NDArray[np.int32]
    values: Floats
    inverse_pivots: Floats
    separating: Ints


@numba.njit(**ALLOCATION_FREE)
def _forward(groups, widths, first, end, starts, rows, values, x):  # type: ignore[no-untyped-def]
    """x = L^-1 x, for some groups of columns."""
    for place in range(first, end):
        column = groups[place]
        at = column * LANES
        if widths[place] == 4:
            p, q, r, s = starts[column], starts[column + 1], starts[column + 2], starts[column + 3]
            a = load(x, at)
            b = load(x, at + LANES) - values[p] * a
            c = load(x, at + 2 * LANES) - values[p + 1] * a - values[q] * b
            d = load(x, at + 3 * LANES) - values[p + 2] * a - values[q + 1] * b - values[r] * c
            store(x, at + LANES, b)
            store(x, at + 2 * LANES, c)
            store(x, at + 3 * LANES, d)
            p, q, r = p + 3, q + 2, r + 1
            for i in range(starts[column + 4] - s):
                target = np.int64(rows[s + i]) * LANES
                left = load(x, target) - values[p + i] * a - values[q + i] * b
                store(x, target, left - values[r + i] * c - values[s + i] * d)
        elif widths[place] == 2:
            p, q = starts[column], starts[column + 1]
            a = load(x, at)
            b = load(x, at + LANES) - values[p] * a
            store(x, at + LANES, b)
            p += 1
            for i in range(starts[column + 2] - q):
                target = np.int64(rows[q + i]) * LANES
                store(x, target, load(x, target) - values[p + i] * a - values[q + i] * b)
        else:
            a = load(x, at)
            for entry in range(starts[column], starts[column + 1]):
                target = np.int64(rows[entry]) * LANES
                store(x, target, load(x, target) - values[entry] * a)


@numba.njit(**ALLOCATION_FREE)
def _backward(groups, widths, first, end, starts, rows, values, inverse_pivots, x):  # type: ignore[no-untyped-def]
    """x = L^-T D^-1 x, for some groups of columns."""
    for place in range(end - 1, first - 1, -1):
        column = groups[place]
        at = column * LANES
        a = load(x, at) * inverse_pivots[column]
        if widths[place] == 4:
            p, q, r, s = starts[column], starts[column + 1], starts[column + 2], starts[column + 3]
            b = load(x, at + LANES) * inverse_pivots[column + 1]
            c = load(x, at + 2 * LANES) * inverse_pivots[column + 2]
            d = load(x, at + 3 * LANES) * inverse_pivots[column + 3]
            for i in range(starts[column + 4] - s):
                known = load(x, np.int64(rows[s + i]) * LANES)
                a = a - values[p + 3 + i] * known
                b = b - values[q + 2 + i] * known
                c = c - values[r + 1 + i] * known
                d = d - values[s + i] * known
            c = c - values[r] * d
            b = b - values[q] * c - values[q + 1] * d
            a = a - values[p] * b - values[p + 1] * c - values[p + 2] * d
            store(x, at + LANES, b)
            store(x, at + 2 * LANES, c)
            store(x, at + 3 * LANES, d)
        elif widths[place] == 2:
            p, q = starts[column], starts[column + 1]
            b = load(x, at + LANES) * inverse_pivots[column + 1]
            for i in range(starts[column + 2] - q):
                known = load(x, np.int64(rows[q + i]) * LANES)
                a = a - values[p + 1 + i] * known
                b = b - values[q + i] * known
            a = a - values[p] * b
            store(x, at + LANES, b)
        else:
            b = splat(0.0)
            entry, last = starts[column], starts[column + 1]
            while entry + 1 < last:
                a = a - values[entry] * load(x, np.int64(rows[entry]) * LANES)
                b = b - values[entry + 1] * load(x, np.int64(rows[entry + 1]) * LANES)
                entry += 2
            if entry < last:
                a = a - values[entry] * load(x, np.int64(rows[entry]) * LANES)
            a = a + b
        store(x, at, a)


@numba.njit(parallel=True, cache=True, **OPTIONS)
def solve(groups, widths, first_group, starts, rows, values, inverse_pivots, separating, x):  # type: ignore[no-untyped-def]
    """Solve A x = b in place.

    Args:
        groups, widths, first_group, starts, rows, values, inverse_pivots, separating: `Columns`.
        x: (n + parts * s, LANES) right-hand sides in the first n rows, then solutions; the others are 0 and
            overwritten.
    """
    parts, count = first_group.shape[0] - 1, inverse_pivots.shape[0]
    extra = separating.shape[0]
    for part in numba.prange(parts):
        _forward(groups, widths, first_group[part], first_group[part + 1], starts, rows, values, x)
    for part in range(parts):
        for i in range(extra):
            row, copy = separating[i] * LANES, (count + part * extra + i) * LANES
            store(x, row, load(x, row) + load(x, copy))
    _forward(groups, widths, first_group[parts], len(groups), starts, rows, values, x)
    _backward(groups, widths, first_group[parts], len(groups), starts, rows, values, inverse_pivots, x)
    for part in range(parts):
        for i in range(extra):
            store(x, (count + part * extra + i) * LANES, load(x, separating[i] * LANES))
    for part in numba.prange(parts):
        _backward(
            groups, widths, first_group[part], first_group[part + 1], starts, rows, values, inverse_pivots, x
        )
