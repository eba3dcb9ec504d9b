"""Taylor expansion of 1 / |r|^2, the kernel of the mean value coordinates, in three dimensions.

Notation as in docs/treecode.md: beta a multi-index (i, j, k) of degree i + j + k <= ORDER, and b_beta =
(1 / beta!) d^beta |r|^-2 / dr^beta, so that |r + y|^-2 = sum over beta of b_beta(r) y^beta.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import llvmlite.ir as ir
import numba
import numpy as np
from numba import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from idviewer.core._kernels.simd.lanes import LANES, LanesType, load, splat, store
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS

Index = tuple[int, int, int]

ORDER = 5


def _indices(order: int) -> list[Index]:
    """All multi-indices up to an order, by degree."""
    return [
        (i, j, n - i - j) for n in range(order + 1) for i in range(n, -1, -1) for j in range(n - i, -1, -1)
    ]


INDICES = _indices(ORDER)
_PLACE = {index: place for place, index in enumerate(INDICES)}

COEFFICIENTS = len(INDICES) - 1
"""The constant term never matters, as a dipole sees derivatives only; the first belongs to INDICES[1]."""

COUNTS = tuple(len(_indices(degree)) - 1 for degree in range(ORDER + 1))
"""Coefficients up to each degree."""


def _lowered(index: Index, axis: int, by: int = 1) -> Index | None:
    changed = list(index)
    changed[axis] -= by
    return (changed[0], changed[1], changed[2]) if changed[axis] >= 0 else None


class Tables(NamedTuple):
    """Tables of the multi-indices, for kernels.

    Attributes:
        degrees: (COEFFICIENTS,) of each coefficient's multi-index beta.
        exponents: (COEFFICIENTS, 3) beta.
        lowered: (COEFFICIENTS, 3) place in INDICES of beta with one exponent lowered, or 0.
        norms: (COEFFICIENTS,) sqrt(n! / beta!), with which the norm of a degree is invariant to rotation.
        shifts: (s, 3) coefficients c, d and place p in INDICES: y_d times t^p occurs in (y + t)_c ...
        binomials: (s,) ... so many times.
    """

    degrees: NDArray[np.int64]
    exponents: NDArray[np.float64]
    lowered: NDArray[np.int64]
    norms: NDArray[np.float64]
    shifts: NDArray[np.int64]
    binomials: NDArray[np.float64]


def _tables() -> Tables:
    proper = INDICES[1:]
    lowered = [[_PLACE.get(_lowered(index, axis) or (0, 0, 0), 0) for axis in range(3)] for index in proper]
    factorials = [math.prod(math.factorial(part) for part in index) for index in proper]
    norms = [math.sqrt(math.factorial(sum(index)) / f) for index, f in zip(proper, factorials, strict=True)]
    shifts, binomials = [], []
    for c, whole in enumerate(proper):
        for d, part in enumerate(proper):
            if all(a >= b for a, b in zip(whole, part, strict=True)):
                rest = (whole[0] - part[0], whole[1] - part[1], whole[2] - part[2])
                shifts.append((c, d, _PLACE[rest]))
                binomials.append(math.prod(math.comb(a, b) for a, b in zip(whole, part, strict=True)))
    return Tables(
        np.array([sum(index) for index in proper]),
        np.array(proper, dtype=np.float64),
        np.array(lowered),
        np.array(norms),
        np.array(shifts),
        np.array(binomials, dtype=np.float64),
    )


TABLES = _tables()


@numba.njit(**OPTIONS)
def monomials(x, y, z, result):  # type: ignore[no-untyped-def]
    """x^i y^j z^k for all multi-indices, in the order of INDICES."""
    result[0] = 1.0
    place, previous = 1, 0
    for degree in range(1, ORDER + 1):
        start, end = previous, place
        # Those with an x first, then those without but with a y, and z^degree last.
        for i in range(start, end):
            result[place] = result[i] * x
            place += 1
        for i in range(end - degree, end):
            result[place] = result[i] * y
            place += 1
        result[place] = result[end - 1] * z
        place += 1
        previous = end


@numba.njit(**ALLOCATION_FREE)
def vector_monomials(x, y, z, result):  # type: ignore[no-untyped-def]
    """The same of LANES points; result is (COEFFICIENTS + 1, LANES)."""
    store(result, 0, splat(1.0))
    place, previous = LANES, 0
    for degree in range(1, ORDER + 1):
        start, end = previous, place
        for i in range(start, end, LANES):
            store(result, place, load(result, i) * x)
            place += LANES
        for i in range(end - degree * LANES, end, LANES):
            store(result, place, load(result, i) * y)
            place += LANES
        store(result, place, load(result, end - LANES) * z)
        place += LANES
        previous = end


@intrinsic
def expand(typingctx, x, y, z, degree, result):  # type: ignore[no-untyped-def]
    """Store b_beta(x, y, z) of degree 1 to degree (a literal) in result (COEFFICIENTS, LANES).

    By |r|^2 b_beta = -2 sum_i r_i b_(beta - e_i) - sum_i b_(beta - 2 e_i), which follows from comparing
    powers of y in (|r|^2 + 2 r.y + |y|^2) sum b_beta y^beta = 1. All steps are written out.
    """
    if not (isinstance(degree, types.IntegerLiteral) and isinstance(x, LanesType)):
        return None
    indices = _indices(degree.literal_value)

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        data = context.make_array(sig.args[4])(context, builder, values[4]).data
        for place, value in enumerate(_recurrence(builder, values[:3], indices)):
            address = builder.gep(data, [ir.Constant(ir.IntType(64), place * LANES)])
            address = builder.bitcast(address, value.type.as_pointer())
            builder.store(value, address, align=sig.args[0].dtype.bitwidth // 8)
        return context.get_dummy_value()

    return types.none(x, y, z, degree, result), codegen


def _recurrence(builder: Any, r: Any, indices: list[Index]) -> list[Any]:
    """The values b_beta of all multi-indices but the first, as LLVM vectors."""
    flags = ("contract", "nsz")

    def times(a: Any, b: Any) -> Any:
        return builder.fmul(a, b, flags=flags)

    def total(parts: list[Any]) -> Any:
        result = parts[0]
        for part in parts[1:]:
            result = builder.fadd(result, part, flags=flags)
        return result

    vector = r[0].type
    square = total([times(one, one) for one in r])
    inverse = builder.fdiv(ir.Constant(vector, [1.0] * LANES), square, flags=flags)
    minus = builder.fneg(inverse)
    twice = [times(times(minus, ir.Constant(vector, [2.0] * LANES)), one) for one in r]
    b = {indices[0]: inverse}
    for index in indices[1:]:
        two_lower = [b[low] for axis in range(3) if (low := _lowered(index, axis, 2)) is not None]
        one_lower = [(axis, low) for axis in range(3) if (low := _lowered(index, axis)) is not None]
        parts = [times(minus, total(two_lower))] if two_lower else []
        b[index] = total(parts + [times(twice[axis], b[low]) for axis, low in one_lower])
    return [b[index] for index in indices[1:]]
