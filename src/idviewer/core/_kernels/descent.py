"""Points descend a tree of clusters: far nodes act through their moments, near leaves face by face.

A chunk of points goes down together. At every node it splits: the points that are far from the node are done
with it, the others go on to its children. So vectors are as full as they can be at every step.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.clusters import CLEARANCE, RANK, Factors, Nodes
from idviewer.core._kernels.expansion import COEFFICIENTS, COUNTS, ORDER, expand
from idviewer.core._kernels.faces import OPTIONS, PLAIN
from idviewer.core._kernels.lanes import LANES, at, bits, larger, load, splat, store
from idviewer.core._kernels.leaf import Leaves, weigh_leaf

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]
Ints = NDArray[np.int64]

ALL = (1 << LANES) - 1
CACHE_LINE = 64

LEVELS = 48
"""More than a tree can have."""

LEAST_TOTAL = 4.0 * math.pi
"""The weights of a point inside a body of diameter 1 add up to more: the integral of 1 / distance."""

TRUSTED = 0.5
"""Share of the roughly estimated total that is relied on."""

OCTAVES = 64
"""Totals are known by their power of two; so many times as large as the least they may become."""


class Tree(NamedTuple):
    """All that `descend` needs to know of a surface.

    Attributes:
        depth: level of the leaves.
        nodes: a `Nodes`.
        factors: of all nodes.
        leaves: a `Leaves`.
        values: (rows of the leaves, k) float32.
    """

    depth: int
    nodes: Nodes
    factors: Factors
    leaves: Leaves
    values: Floats32


X, Y, Z, NEARNESS, OCTAVE, ID = range(6)
"""Rows of a list of points: places relative to the chunk's first point; the square of how near nodes may be,
in the unit of their bounds; the power of two of the total; and which point of the chunk it is."""


class Room(NamedTuple):
    """Room for one worker's intermediate results, for chunks of up to c - LANES points.

    Attributes:
        lists: (LEVELS, 6, c) float32 the points that visit a node of each level.
        held: (LEVELS,) in which list these are (all that visit a node may visit its children), and
        counts: (LEVELS,) how many.
        far: (6, c) float32 list of those that are far from a node.
        marks: (c / LANES,) for each LANES of a list which are far, as bits.
        packed: (3, LANES) some points.
        basis: (COEFFICIENTS, LANES) float32 derivatives of the kernel.
        amounts: (RANK, LANES) float32 of a node's profiles.
        shares: (3, LANES) of the corners of a leaf's faces.
        weights: (rows of the largest leaf, LANES) float32 of a leaf's rows.
        stack: (2 LEVELS,) nodes that are still to be visited.
    """

    lists: Floats32
    held: Ints
    counts: Ints
    far: Floats32
    marks: Ints
    packed: Floats
    basis: Floats32
    amounts: Floats32
    shares: Floats
    weights: Floats32
    stack: Ints


def aligned(shape: tuple[int, ...], dtype: type = np.float32) -> Any:
    """An array of zeros that begins where a line of the processor's cache does: no vector lies across two."""
    size = math.prod(shape) * np.dtype(dtype).itemsize
    memory = np.zeros(size + CACHE_LINE, dtype=np.uint8)
    start = -memory.ctypes.data % CACHE_LINE
    return memory[start : start + size].view(dtype).reshape(shape)


def rooms(leaves: Leaves, points: int, workers: int) -> Room:
    """Room for workers and chunks of so many points: every array has one more axis, in front."""
    rows = int(np.diff(leaves.first_row).max())
    size = (-(-points // LANES) + 1) * LANES
    return Room(
        aligned((workers, LEVELS, 6, size)),
        np.empty((workers, LEVELS), dtype=np.int64),
        np.empty((workers, LEVELS), dtype=np.int64),
        aligned((workers, 6, size)),
        np.empty((workers, size // LANES), dtype=np.int64),
        aligned((workers, 3, LANES), np.float64),
        aligned((workers, COEFFICIENTS, LANES)),
        aligned((workers, RANK, LANES)),
        aligned((workers, 3, LANES), np.float64),
        aligned((workers, rows, LANES)),
        np.empty((workers, 2 * LEVELS), dtype=np.int64),
    )


@numba.njit(**PLAIN)
def _rough_total(x, depth, centres, radii, areas, stack):  # type: ignore[no-untyped-def]
    """A first idea of the sums of some points' weights: every node not too near counts as one dipole."""
    px, py, pz = load(x, 0), load(x, LANES), load(x, 2 * LANES)
    result = splat(0.0)
    stack[0] = 1
    top = 1
    while top:
        top -= 1
        node = stack[top]
        rx, ry, rz = centres[node, 0] - px, centres[node, 1] - py, centres[node, 2] - pz
        square = rx * rx + ry * ry + rz * rz
        radius2 = radii[node] ** 2
        if node >> depth or bits(square > 2.5 * radius2) == ALL:
            square = larger(square, radius2)
            flux = areas[node, 0] * rx + areas[node, 1] * ry + areas[node, 2] * rz
            result = result + flux / (square * square)
        else:
            stack[top], stack[top + 1] = 2 * node, 2 * node + 1
            top += 2
    return result


@numba.njit(**PLAIN)
def _prepare(points, tolerance, depth, centres, radii, areas, packed, totals, stack, list_):  # type: ignore[no-untyped-def]
    """The list of all points (c, 3).

    The error of a point is that of its sums divided by the total of its weights: near the surface, where
    the total is large, far nodes matter less.
    """
    count = points.shape[0]
    for start in range(0, count, LANES):
        for lane in range(LANES):
            i = min(start + lane, count - 1)
            for axis in range(3):
                packed[axis, lane] = points[i, axis]
        store(totals, 0, _rough_total(packed, depth, centres, radii, areas, stack))
        for lane in range(LANES):
            i, ratio = start + lane, max(TRUSTED * totals[lane] / LEAST_TOTAL, 1.0)
            for axis in range(3):
                list_[axis, i] = packed[axis, lane] - points[0, axis]
            list_[NEARNESS, i] = (tolerance * LEAST_TOTAL * ratio) ** (-2.0 / (ORDER + 3))
            list_[OCTAVE, i] = min(int(math.log2(ratio)), OCTAVES - 1)
            list_[ID, i] = min(i, count - 1)


@numba.njit(**PLAIN)
def _mark_far(list_, count, x, y, z, bound2, clear2, marks):  # type: ignore[no-untyped-def]
    """Mark the points that are far from a node at (x, y, z); returns whether any are."""
    width, any_far = list_.shape[1], np.int64(0)
    for start in range(0, count, LANES):
        dx, dy = x - load(list_, start), y - load(list_, width + start)
        dz = z - load(list_, 2 * width + start)
        square = dx * dx + dy * dy + dz * dz
        bound = larger(bound2 * load(list_, NEARNESS * width + start), clear2)
        marked = bits(square > bound)
        if count - start < LANES:
            marked &= (1 << (count - start)) - 1
        marks[start // LANES] = marked
        any_far |= marked
    return any_far != 0


@numba.njit(**PLAIN)
def _part(list_, count, marks, far, rest):  # type: ignore[no-untyped-def]
    """Put the marked points of a list into far, the others into rest; returns how many are far.

    The last point of far is repeated until the last vector is full.
    """
    fars = rests = 0
    for start in range(0, count, LANES):
        marked, size = marks[start // LANES], min(LANES, count - start)
        if marked == 0 or marked == (1 << size) - 1:
            to, end = (far, fars) if marked else (rest, rests)
            for row in range(6):
                store(to, row * to.shape[1] + end, load(list_, row * list_.shape[1] + start))
            fars, rests = (fars + size, rests) if marked else (fars, rests + size)
            continue
        for i in range(start, start + size):
            is_far = (marked >> (i - start)) & 1
            for row in range(6):
                far[row, fars] = list_[row, i]
                rest[row, rests] = list_[row, i]
            fars, rests = fars + is_far, rests + 1 - is_far
    for i in range(fars, -(-fars // LANES) * LANES):
        for row in range(6):
            far[row, i] = far[row, fars - 1]
    return fars


@numba.njit(**PLAIN)
def _amounts(shapes, first, end, count, basis, amounts):  # type: ignore[no-untyped-def]
    """amounts = shapes[first:end, :count] @ basis[:count], four sums at a time."""
    row = first
    while row < end:
        pair = row + 1 if row + 1 < end else row
        a, b = splat(np.float32(0.0)), splat(np.float32(0.0))
        c, d = splat(np.float32(0.0)), splat(np.float32(0.0))
        i, j = row * COEFFICIENTS, pair * COEFFICIENTS
        t = 0
        while t + 1 < count:
            even, odd = load(basis, t * LANES), load(basis, (t + 1) * LANES)
            a, b = a + at(shapes, i + t) * even, b + at(shapes, i + t + 1) * odd
            c, d = c + at(shapes, j + t) * even, d + at(shapes, j + t + 1) * odd
            t += 2
        if t < count:
            even = load(basis, t * LANES)
            a, c = a + at(shapes, i + t) * even, c + at(shapes, j + t) * even
        store(amounts, (row - first) * LANES, a + b)
        store(amounts, (pair - first) * LANES, c + d)
        row += 2


@numba.njit(**PLAIN)
def _add_product(amounts, rows, first, end, list_, start, stop, sums):  # type: ignore[no-untyped-def]
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
                place, amount = np.int64(list_[ID, i]) * width + column, (row - first) * LANES + i - start
                sum_ = load(sums, place)
                sum_ = sum_ + at(amounts, amount) * a + at(amounts, amount + LANES) * b
                sum_ = sum_ + at(amounts, amount + 2 * LANES) * c + at(amounts, amount + 3 * LANES) * d
                store(sums, place, sum_)
            row += 4
        if row + 2 <= end:
            a, b = load(rows, row * width + column), load(rows, (row + 1) * width + column)
            for i in range(start, stop):
                place, amount = np.int64(list_[ID, i]) * width + column, (row - first) * LANES + i - start
                both = at(amounts, amount) * a + at(amounts, amount + LANES) * b
                store(sums, place, load(sums, place) + both)
            row += 2
        if row < end:
            a = load(rows, row * width + column)
            for i in range(start, stop):
                place, amount = np.int64(list_[ID, i]) * width + column, (row - first) * LANES + i - start
                store(sums, place, load(sums, place) + at(amounts, amount) * a)


@numba.njit(**PLAIN)
def _degree(bounds, node, clear2, square, nearness):  # type: ignore[no-untyped-def]
    """The lowest degree that is accurate enough at all the distances, given their squares."""
    degree = ORDER
    while degree > 1:
        distance = bounds[node, degree - 1] * nearness[degree - 1]
        if bits(square > max(distance * distance, clear2)) != ALL:
            break
        degree -= 1
    return degree


@numba.njit(**PLAIN)
def _expand_to(degree, x, y, z, basis):  # type: ignore[no-untyped-def]
    """`expand` to a degree that is not known when this is compiled."""
    if degree == 5:
        expand(x, y, z, 5, basis)  # type: ignore[call-arg]
    elif degree == 4:
        expand(x, y, z, 4, basis)  # type: ignore[call-arg]
    elif degree == 3:
        expand(x, y, z, 3, basis)  # type: ignore[call-arg]
    elif degree == 2:
        expand(x, y, z, 2, basis)  # type: ignore[call-arg]
    else:
        expand(x, y, z, 1, basis)  # type: ignore[call-arg]


@numba.njit(**PLAIN)
def _least_octave(list_, start):  # type: ignore[no-untyped-def]
    least = list_[OCTAVE, start]
    for i in range(start + 1, start + LANES):
        least = min(least, list_[OCTAVE, i])
    return np.int64(least)


@numba.njit(**PLAIN)
def _weigh_rows(x, y, z, leaves, leaf, tolerance, shares, weights, lane):  # type: ignore[no-untyped-def]
    """Weights of a leaf's rows for one point, in a lane of weights; returns what `weigh_leaf` does."""
    centres, corners, rows = leaves.centres, leaves.corners, leaves.rows
    x, y, z = x - centres[leaf, 0], y - centres[leaf, 1], z - centres[leaf, 2]
    count = leaves.counts[leaf]
    on = weigh_leaf(x, y, z, corners, leaf, count, tolerance, shares)
    for row in range(leaves.first_row[leaf + 1] - leaves.first_row[leaf]):
        weights[row, lane] = 0.0
    for corner in range(3):
        for face in range(count):
            weights[rows[leaf, corner, face], lane] += np.float32(shares[corner, face])
    return on


@numba.njit(**PLAIN)
def _add_near(points, list_, start, stop, leaves, values, leaf, tolerance, shares, weights, touching, sums):  # type: ignore[no-untyped-def]
    """A leaf's share of some points' sums, face by face."""
    first, end = leaves.first_row[leaf], leaves.first_row[leaf + 1]
    touched, rows, linear = touching
    for i in range(start, stop):
        point = np.int64(list_[ID, i])
        x, y, z = points[point, 0], points[point, 1], points[point, 2]
        on = _weigh_rows(x, y, z, leaves, leaf, tolerance, shares, weights, i - start)
        if on >= 0:
            touched[point] = 1
            for corner in range(3):
                rows[point, corner] = first + leaves.rows[leaf, corner, on]
                linear[point, corner] = shares[corner, on]
    _add_product(weights, values, first, end, list_, start, stop, sums)


@numba.njit(**PLAIN)
def _next(node, level):  # type: ignore[no-untyped-def]
    """The node after all below this one, and its level; node 0 after the last."""
    while node & 1:
        node, level = node >> 1, level - 1
    return node + 1 if node else 0, level


@numba.njit(**PLAIN)
def _descend(points, depth, nodes, factors, leaves, values, plan, room, touching, sums):  # type: ignore[no-untyped-def]
    """One chunk of points (c, 3) through the whole tree."""
    # Tuples are taken apart here, once: reading them inside of the loop costs more than the loop does.
    centres, radii, areas, bounds, first_factor, ranks = nodes
    shapes, profiles, rests = factors
    lists, held, counts, far, marks, packed, basis, amounts, shares, weights, stack = room
    tolerance, share, on_surface, nearness = plan
    _prepare(points, tolerance, depth, centres, radii, areas, packed, shares[0], stack, lists[0])
    held[0], counts[0] = 0, points.shape[0]
    width, fars = far.shape[1], 0
    node, level = 1, 0
    while node:
        x = np.float32(centres[node, 0] - points[0, 0])
        y = np.float32(centres[node, 1] - points[0, 1])
        z = np.float32(centres[node, 2] - points[0, 2])
        clear2, bound2 = np.float32((CLEARANCE * radii[node]) ** 2), bounds[node, ORDER] ** 2
        here, fars = lists[held[level]], 0
        held[level + 1], counts[level + 1] = held[level], counts[level]
        # Without factors a node is near to all.
        if ranks[node] and _mark_far(here, counts[level], x, y, z, bound2, clear2, marks):
            fars = _part(here, counts[level], marks, far, lists[level + 1])
            held[level + 1], counts[level + 1] = level + 1, counts[level] - fars
        for start in range(0, fars, LANES):
            rx, ry = x - load(far, start), y - load(far, width + start)
            rz = z - load(far, 2 * width + start)
            octave = _least_octave(far, start)
            square = rx * rx + ry * ry + rz * rz
            degree = _degree(bounds, node, clear2, square, nearness[octave])
            _expand_to(degree, rx, ry, rz, basis)
            first, end = first_factor[node], first_factor[node] + ranks[node]
            allowed = share * tolerance * LEAST_TOTAL * 2.0**octave
            while end > first + 1 and rests[end - 1] < allowed:
                end -= 1
            _amounts(shapes, first, end, COUNTS[degree], basis, amounts)
            _add_product(amounts, profiles, first, end, far, start, min(start + LANES, fars), sums)
        if counts[level + 1] and level < depth:
            node, level = 2 * node, level + 1
            continue
        leaf, rest = node - (1 << depth), lists[held[level + 1]]
        for start in range(0, counts[level + 1], LANES):
            stop = min(start + LANES, counts[level + 1])
            _add_near(
                points, rest, start, stop, leaves, values, leaf, on_surface, shares, weights, touching, sums
            )
        node, level = _next(node, level)


@numba.njit(parallel=True, cache=True, **OPTIONS)
def descend(  # type: ignore[no-untyped-def]
    points, chunks, depth, nodes, factors, leaves, values,
    tolerance, share, on_surface, nearness, room, touched, rows, linear, sums,
):  # fmt: skip
    """Sums of weights times values for many points, within a tolerance.

    Args:
        points: (p, 3), neighbours one after the other.
        chunks: (c + 1,) where each chunk of points begins.
        depth, nodes, factors, leaves, values: a `Tree`; compiled loops take no nested tuples.
        tolerance: error allowed to a node's share of a point, when weights add up to 1.
        share: of that error which left out profiles may cause.
        on_surface: how near the surface a point counts as lying on it.
        nearness: (OCTAVES, ORDER + 1) float32; see `nearness_of`.
        room: see `rooms`.
        touched: (p,) output, 1 for points on the surface; 0 at first.
        rows, linear: (p, 3) output, the rows and shares of their linear interpolation.
        sums: (p, k) float32 output, 0 at first.
    """
    workers = room.counts.shape[0]
    for worker in numba.prange(workers):
        own = Room(
            room.lists[worker],
            room.held[worker],
            room.counts[worker],
            room.far[worker],
            room.marks[worker],
            room.packed[worker],
            room.basis[worker],
            room.amounts[worker],
            room.shares[worker],
            room.weights[worker],
            room.stack[worker],
        )
        plan = tolerance, share, on_surface, nearness
        for chunk in range(worker, chunks.shape[0] - 1, workers):
            a, b = chunks[chunk], chunks[chunk + 1]
            touching = touched[a:b], rows[a:b], linear[a:b]
            _descend(points[a:b], depth, nodes, factors, leaves, values, plan, own, touching, sums[a:b])


def nearness_of(tolerance: float) -> Floats32:
    """How near nodes may be, in the unit of their bounds, by octave of a point's total and degree."""
    totals = LEAST_TOTAL * 2.0 ** np.arange(OCTAVES)
    degrees = np.arange(ORDER + 1)
    return ((tolerance * totals[:, None]) ** (-1.0 / (degrees + 3))).astype(np.float32)
