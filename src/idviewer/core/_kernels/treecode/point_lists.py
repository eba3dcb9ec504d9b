"""Lists of points that traverse a tree together, and how near nodes may be to each: its opening radius."""

from __future__ import annotations

import math

import llvmlite.ir as ir
import numba
import numpy as np
from numba import types
from numba.core import cgutils

from idviewer.core._kernels.simd.lanes import LANES, at, bits, intrinsic, larger, load, splat, store
from idviewer.core._kernels.simd.options import ALLOCATION_FREE
from idviewer.core._kernels.treecode.clusters import AREA, RADIUS, RECORD
from idviewer.core._kernels.treecode.expansion import ORDER

ALL = (1 << LANES) - 1

LEAST_WEIGHT_SUM = 4.0 * math.pi
"""The weights of a point inside a body of diameter 1 add up to more: the integral of 1 / distance."""

TRUSTED_SHARE = 0.5
"""Share of a roughly estimated weight sum that is relied on."""

OCTAVES = 64
"""Weight sums are told apart by powers of two, from the least one on; so many of them."""

X, Y, Z, OPENING, OCTAVE, ID, ROWS = range(7)
"""Rows of a list of points: places relative to the chunk's first point; the square of the opening radius, in
the unit of the nodes' bounds; the power of two of the weight sum; and which point of the chunk it is."""


@numba.njit(**ALLOCATION_FREE)
def _rough_total(listed, start, origin, depth, records, stack):  # type: ignore[no-untyped-def]
    """Rough sums of some points' weights: every node that is not too near counts as one dipole."""
    width = listed.shape[1]
    px, py, pz = load(listed, start), load(listed, width + start), load(listed, 2 * width + start)
    result = splat(np.float32(0.0))
    stack[0] = 1
    top = 1
    while top:
        top -= 1
        record = RECORD * stack[top]
        rx = at(records, record) - origin[0] - px
        ry, rz = at(records, record + 1) - origin[1] - py, at(records, record + 2) - origin[2] - pz
        square, radius2 = rx * rx + ry * ry + rz * rz, at(records, record + RADIUS)
        if stack[top] >> depth or bits(square > np.float32(2.5) * radius2) == ALL:
            square = larger(square, radius2)
            flux = at(records, record + AREA) * rx + at(records, record + AREA + 1) * ry
            result = result + (flux + at(records, record + AREA + 2) * rz) / (square * square)
        else:
            stack[top], stack[top + 1] = 2 * stack[top], 2 * stack[top] + 1
            top += 2
    return result


@numba.njit(**ALLOCATION_FREE)
def list_all(points, tolerance, depth, records, totals, stack, listed, active):  # type: ignore[no-untyped-def]
    """The list of all points (c, 3), and their blocks, all of which are active.

    The error of a point is that of its sums divided by the sum of its weights: near the surface, where that
    is large, far nodes matter less.
    """
    count = points.shape[0]
    for start in range(0, count, LANES):
        active[start // LANES, 0] = start // LANES
        active[start // LANES, 1] = (1 << min(LANES, count - start)) - 1
        for i in range(start, start + LANES):
            point = min(i, count - 1)
            for axis in range(3):
                listed[axis, i] = points[point, axis] - points[0, axis]
            listed[ID, i] = point
        origin = points[0, 0], points[0, 1], points[0, 2]
        store(totals, 0, _rough_total(listed, start, origin, depth, records, stack))
        for lane in range(LANES):
            i, ratio = start + lane, max(TRUSTED_SHARE * totals[lane] / LEAST_WEIGHT_SUM, 1.0)
            listed[OPENING, i] = (tolerance * LEAST_WEIGHT_SUM * ratio) ** (-2.0 / (ORDER + 3))
            listed[OCTAVE, i] = min(int(math.log2(ratio)), OCTAVES - 1)


@intrinsic
def _lowest(typingctx, lanes):  # type: ignore[no-untyped-def]
    """The lowest bit that is set."""

    def codegen(context, builder, sig, values):  # type: ignore[no-untyped-def]
        word, flag = values[0].type, ir.IntType(1)
        kind = ir.FunctionType(word, [word, flag])
        function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.cttz.i{word.width}")
        return builder.call(function, [values[0], ir.Constant(flag, 1)])

    return types.intp(types.intp), codegen


@numba.njit(**ALLOCATION_FREE)
def pick(listed, block, lanes, picked, count):  # type: ignore[no-untyped-def]
    """Append those points of a block whose bits are set to a list of count points; returns the new count."""
    width, start = listed.shape[1], block * LANES
    if lanes == ALL:
        for row in range(ROWS):
            store(picked, row * picked.shape[1] + count, load(listed, row * width + start))
        return count + LANES
    while lanes:
        lane = _lowest(lanes)
        lanes &= lanes - 1
        for row in range(ROWS):
            picked[row, count] = listed[row, start + lane]
        count += 1
    return count


@numba.njit(**ALLOCATION_FREE)
def split(listed, active, count, x, y, z, bound2, clear2, far, rest):  # type: ignore[no-untyped-def]
    """Tell the points that are far from a node at (x, y, z) from the others.

    active (.., 2) and rest (.., 2) hold blocks of points, and as bits which of them are meant. The last point
    of far is repeated until the last vector is full.

    Returns:
        How many points are far, and how many entries rest has.
    """
    width, far_count, rest_count = listed.shape[1], 0, 0
    for i in range(count):
        block, lanes = active[i, 0], active[i, 1]
        start = block * LANES
        dx, dy = x - load(listed, start), y - load(listed, width + start)
        dz = z - load(listed, 2 * width + start)
        bound = larger(bound2 * load(listed, OPENING * width + start), clear2)
        away = bits(dx * dx + dy * dy + dz * dz > bound) & lanes
        if away:
            far_count = pick(listed, block, away, far, far_count)
        if away != lanes:
            rest[rest_count, 0], rest[rest_count, 1] = block, lanes & ~away
            rest_count += 1
    for i in range(far_count, -(-far_count // LANES) * LANES):
        for row in range(ROWS):
            far[row, i] = far[row, far_count - 1]
    return far_count, rest_count


@numba.njit(**ALLOCATION_FREE)
def least_octave(listed, start):  # type: ignore[no-untyped-def]
    """The least octave of LANES points."""
    least = listed[OCTAVE, start]
    for i in range(start + 1, start + LANES):
        least = min(least, listed[OCTAVE, i])
    return np.int64(least)
