"""The two products of a treecode: with left factors, and with right ones or values."""

from __future__ import annotations

import numba
import numpy as np

from idviewer.core._kernels.simd.lanes import LANES, at, load, splat, store
from idviewer.core._kernels.simd.options import ALLOCATION_FREE
from idviewer.core._kernels.treecode.expansion import COEFFICIENTS
from idviewer.core._kernels.treecode.point_lists import ID


@numba.njit(**ALLOCATION_FREE)
def amounts_of(left, first, end, count, basis, amounts):  # type: ignore[no-untyped-def]
    """amounts = left[first:end, :count] @ basis[:count], four sums at a time."""
    row = first
    while row < end:
        pair = row + 1 if row + 1 < end else row
        a, b = splat(np.float32(0.0)), splat(np.float32(0.0))
        c, d = splat(np.float32(0.0)), splat(np.float32(0.0))
        i, j = row * COEFFICIENTS, pair * COEFFICIENTS
        t = 0
        while t + 1 < count:
            even, odd = load(basis, t * LANES), load(basis, (t + 1) * LANES)
            a, b = a + at(left, i + t) * even, b + at(left, i + t + 1) * odd
            c, d = c + at(left, j + t) * even, d + at(left, j + t + 1) * odd
            t += 2
        if t < count:
            even = load(basis, t * LANES)
            a, c = a + at(left, i + t) * even, c + at(left, j + t) * even
        store(amounts, (row - first) * LANES, a + b)
        store(amounts, (pair - first) * LANES, c + d)
        row += 2


@numba.njit(**ALLOCATION_FREE)
def add_product(amounts, rows, first, end, listed, start, stop, sums):  # type: ignore[no-untyped-def]
    """sums[point i] += amounts[: end - first, i - start] @ rows[first:end] for places start to stop - 1.

    Four rows at a time stay in registers while the points pass by.
    """
    width = rows.shape[1]
    for column in range(0, width, LANES):
        row = first
        while row + 4 <= end:
            a, b = load(rows, row * width + column), load(rows, (row + 1) * width + column)
            c, d = load(rows, (row + 2) * width + column), load(rows, (row + 3) * width + column)
            for i in range(start, stop):
                place, amount = np.int64(listed[ID, i]) * width + column, (row - first) * LANES + i - start
                sum_ = load(sums, place)
                sum_ = sum_ + at(amounts, amount) * a + at(amounts, amount + LANES) * b
                sum_ = sum_ + at(amounts, amount + 2 * LANES) * c + at(amounts, amount + 3 * LANES) * d
                store(sums, place, sum_)
            row += 4
        if row + 2 <= end:
            a, b = load(rows, row * width + column), load(rows, (row + 1) * width + column)
            for i in range(start, stop):
                place, amount = np.int64(listed[ID, i]) * width + column, (row - first) * LANES + i - start
                both = at(amounts, amount) * a + at(amounts, amount + LANES) * b
                store(sums, place, load(sums, place) + both)
            row += 2
        if row < end:
            a = load(rows, row * width + column)
            for i in range(start, stop):
                place, amount = np.int64(listed[ID, i]) * width + column, (row - first) * LANES + i - start
                store(sums, place, load(sums, place) + at(amounts, amount) * a)
