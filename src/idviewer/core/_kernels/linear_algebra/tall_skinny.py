"""Tall-skinny matrix products: of blocks of LANES long vectors, whose rows several threads share.

A basis here is (blocks, n, LANES), C-contiguous, of which the first blocks are used; a block is (n, LANES).
General matrix products, as BLAS has them, gain little from blocks as narrow as these.
"""

from __future__ import annotations

import numba
import numpy as np

from idviewer.core._kernels.simd.lanes import LANES, at, load, prefetch, store
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS

ROW_RANGES = 16
"""Pieces that the rows are cut into, however many threads there are: sums come out the same."""

ROWS_IN_CACHE = 64
"""Rows of a block that are taken at a time, so that they stay in the processor's nearest cache. The next ones
are fetched meanwhile, without which half the time is spent waiting for them."""

VECTORS_IN_REGISTERS = 8
"""Vectors that are summed up side by side in registers."""

NUMBERS_IN_CACHE_LINE = 8
"""Numbers in a line of the processor's cache."""


@numba.njit(parallel=True, cache=True, **OPTIONS)
def inner_products(basis, blocks, block, sums):  # type: ignore[no-untyped-def]
    """Inner products of a basis with a block, as one sum for each part of the rows.

    Args:
        basis, blocks, block: see above.
        sums: (ROW_RANGES, >= blocks * LANES, LANES) they are added to it.
    """
    count, stride = block.shape[0], sums.shape[1] * LANES
    for part in numba.prange(ROW_RANGES):
        last = (part + 1) * count // ROW_RANGES
        for first in range(part * count // ROW_RANGES, last, ROWS_IN_CACHE):
            end = min(first + ROWS_IN_CACHE, last)
            for i in range(blocks):
                place = part * stride + i * LANES * LANES
                _add_inner_products(basis, i * count * LANES, block, first, end, sums, place)


@numba.njit(**ALLOCATION_FREE)
def _add_inner_products(basis, base, block, first, end, sums, place):  # type: ignore[no-untyped-def]
    """Inner products of some rows of two blocks, added to (LANES, LANES) numbers at a place among sums."""
    for half in range(0, LANES, VECTORS_IN_REGISTERS):
        to = place + half * LANES
        a, b = load(sums, to), load(sums, to + LANES)
        c, d = load(sums, to + 2 * LANES), load(sums, to + 3 * LANES)
        e, f = load(sums, to + 4 * LANES), load(sums, to + 5 * LANES)
        g, h = load(sums, to + 6 * LANES), load(sums, to + 7 * LANES)
        for row in range(first, end):
            x, q = load(block, row * LANES), base + row * LANES + half
            prefetch(basis, q + ROWS_IN_CACHE * LANES)
            a, b = a + at(basis, q) * x, b + at(basis, q + 1) * x
            c, d = c + at(basis, q + 2) * x, d + at(basis, q + 3) * x
            e, f = e + at(basis, q + 4) * x, f + at(basis, q + 5) * x
            g, h = g + at(basis, q + 6) * x, h + at(basis, q + 7) * x
        _store_all(sums, to, a, b, c, d, e, f, g, h)


@numba.njit(**ALLOCATION_FREE)
def _store_all(array, place, a, b, c, d, e, f, g, h):  # type: ignore[no-untyped-def]
    """VECTORS_IN_REGISTERS vectors, one after the other."""
    store(array, place, a)
    store(array, place + LANES, b)
    store(array, place + 2 * LANES, c)
    store(array, place + 3 * LANES, d)
    store(array, place + 4 * LANES, e)
    store(array, place + 5 * LANES, f)
    store(array, place + 6 * LANES, g)
    store(array, place + 7 * LANES, h)


@numba.njit(parallel=True, cache=True, **OPTIONS)
def subtract_products(basis, blocks, coefficients, share, block, out):  # type: ignore[no-untyped-def]
    """out = share * block - basis @ coefficients; out may be the block, and the block the basis.

    Args:
        basis, blocks, block: see above.
        coefficients: (>= blocks * LANES, LANES).
        share: a number.
        out: (n, LANES).
    """
    count = block.shape[0]
    for part in numba.prange(ROW_RANGES):
        first, end = part * count // ROW_RANGES, (part + 1) * count // ROW_RANGES
        whole = end - (end - first) % VECTORS_IN_REGISTERS
        for row in range(first, whole, VECTORS_IN_REGISTERS):
            _subtract_from_rows(basis, blocks, coefficients, 0, share, block, row, out, row)
        for row in range(whole, end):
            _subtract_from_row(basis, blocks, coefficients, 0, share, block, row, out, row)


@numba.njit(parallel=True, cache=True, **OPTIONS)
def subtract_combinations(basis, blocks, coefficients, order, out):  # type: ignore[no-untyped-def]
    """out[order] -= basis @ coefficients, for many combinations.

    Args:
        basis, blocks: see above.
        coefficients: (m, >= blocks * LANES, LANES) of m times LANES combinations; the last may be in excess.
        order: (n,) a permutation.
        out: (n, <= m * LANES).
    """
    count, width = out.shape
    for part in numba.prange(ROW_RANGES):
        room = np.empty((VECTORS_IN_REGISTERS, LANES))
        first, end = part * count // ROW_RANGES, (part + 1) * count // ROW_RANGES
        for row in range(first, end, VECTORS_IN_REGISTERS):
            rows = min(VECTORS_IN_REGISTERS, end - row)
            for start in range(0, width, LANES):
                place = start * coefficients.shape[1]
                if rows == VECTORS_IN_REGISTERS:
                    _subtract_from_rows(basis, blocks, coefficients, place, 0.0, basis, row, room, 0)
                else:
                    for i in range(rows):
                        _subtract_from_row(basis, blocks, coefficients, place, 0.0, basis, row + i, room, i)
                for i in range(rows):
                    to = order[row + i]
                    for k in range(min(LANES, width - start)):
                        out[to, start + k] += room[i, k]


@numba.njit(**ALLOCATION_FREE)
def _subtract_from_rows(basis, blocks, coefficients, place, share, block, row, out, to):  # type: ignore[no-untyped-def]
    """Some rows of share * block less those of basis @ coefficients, VECTORS_IN_REGISTERS of them.

    The coefficients begin at a place among their array, the result with a row of out.
    """
    first, end = row * LANES, to * LANES
    a, b = share * load(block, first), share * load(block, first + LANES)
    c, d = share * load(block, first + 2 * LANES), share * load(block, first + 3 * LANES)
    e, f = share * load(block, first + 4 * LANES), share * load(block, first + 5 * LANES)
    g, h = share * load(block, first + 6 * LANES), share * load(block, first + 7 * LANES)
    for i in range(blocks):
        base = i * basis.shape[1] * LANES + first
        for line in range(
            VECTORS_IN_REGISTERS * LANES, 2 * VECTORS_IN_REGISTERS * LANES, NUMBERS_IN_CACHE_LINE
        ):
            prefetch(basis, base + line)
        for k in range(LANES):
            x, q = load(coefficients, place + (i * LANES + k) * LANES), base + k
            a, b = a - at(basis, q) * x, b - at(basis, q + LANES) * x
            c, d = c - at(basis, q + 2 * LANES) * x, d - at(basis, q + 3 * LANES) * x
            e, f = e - at(basis, q + 4 * LANES) * x, f - at(basis, q + 5 * LANES) * x
            g, h = g - at(basis, q + 6 * LANES) * x, h - at(basis, q + 7 * LANES) * x
    _store_all(out, end, a, b, c, d, e, f, g, h)


@numba.njit(**ALLOCATION_FREE)
def _subtract_from_row(basis, blocks, coefficients, place, share, block, row, out, to):  # type: ignore[no-untyped-def]
    """The same of a single row."""
    left = share * load(block, row * LANES)
    for i in range(blocks):
        base = (i * basis.shape[1] + row) * LANES
        for k in range(LANES):
            left = left - at(basis, base + k) * load(coefficients, place + (i * LANES + k) * LANES)
    store(out, to * LANES, left)
