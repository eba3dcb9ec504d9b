"""Points descend a tree of clusters: far nodes act through their moments, near leaves face by face.

A chunk of points goes down together. At every node it splits: the points that are far from the node are done
with it, the others go on to its children. So vectors are as full as they can be at every step.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.simd.lanes import LANES, at, bits, load, prefetch, splat, store
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS
from idviewer.core._kernels.simd.work_queue import take_work
from idviewer.core._kernels.treecode.clusters import BOUND, CLEAR, FIRST, RANK_AT, RECORD
from idviewer.core._kernels.treecode.expansion import COUNTS, ORDER, expand
from idviewer.core._kernels.treecode.factors import Factors
from idviewer.core._kernels.treecode.leaf import Leaves, weigh_leaf
from idviewer.core._kernels.treecode.normalize import normalize
from idviewer.core._kernels.treecode.point_lists import (
    ALL,
    ID,
    LEAST_TOTAL,
    OCTAVES,
    least_octave,
    list_all,
    pick,
    split,
)
from idviewer.core._kernels.treecode.products import add_product, amounts_of
from idviewer.core._kernels.treecode.workspace import Room

Floats32 = NDArray[np.float32]


class Tree(NamedTuple):
    """All that `descend` needs to know of a surface.

    Attributes:
        depth: level of the leaves.
        records: of the nodes; see `records_of`.
        factors: of all nodes.
        leaves: a `Leaves`.
        values: (rows of the leaves, k) float32.
    """

    depth: int
    records: Floats32
    factors: Factors
    leaves: Leaves
    values: Floats32


@numba.njit(**ALLOCATION_FREE)
def _degree(records, record, square, nearness, octave):  # type: ignore[no-untyped-def]
    """The lowest degree that is accurate enough at all the distances, given their squares."""
    degree, clear2 = ORDER, at(records, record + CLEAR)
    while degree > 1:
        distance = at(records, record + BOUND + degree - 1) * nearness[octave, degree - 1]
        if bits(square > max(distance * distance, clear2)) != ALL:
            break
        degree -= 1
    return degree


@numba.njit(**ALLOCATION_FREE)
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


@numba.njit(**ALLOCATION_FREE)
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


@numba.njit(**ALLOCATION_FREE)
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
    add_product(weights, values, first, end, list_, start, stop, sums)


@numba.njit(**ALLOCATION_FREE)
def _next(node, level):  # type: ignore[no-untyped-def]
    """The node after all below this one, and its level; node 0 after the last."""
    while node & 1:
        node, level = node >> 1, level - 1
    return node + 1 if node else 0, level


@numba.njit(**ALLOCATION_FREE)
def _fetch(array, first, end):  # type: ignore[no-untyped-def]
    """Ask for some rows of an array of float32."""
    for place in range(first * array.shape[1], end * array.shape[1], LANES):
        prefetch(array, place)


@numba.njit(**ALLOCATION_FREE)
def _fetch_leaf(leaves, values, leaf):  # type: ignore[no-untyped-def]
    """Ask for all that `_add_near` reads of a leaf."""
    for place in range(leaf * 9 * LANES, (leaf + 1) * 9 * LANES, LANES // 2):
        prefetch(leaves.corners, place)
    _fetch(values, leaves.first_row[leaf], leaves.first_row[leaf + 1])


@numba.njit(**ALLOCATION_FREE)
def _descend(points, depth, records, factors, leaves, values, plan, room):  # type: ignore[no-untyped-def]
    """One chunk of points (c, 3) through the whole tree."""
    # Tuples are taken apart here, once: reading them inside of the loop costs more than the loop does.
    shapes, profiles, rests = factors
    (
        list_,
        active,
        held,
        counts,
        picked,
        basis,
        amounts,
        shares,
        weights,
        stack,
        sums,
        touched,
        rows,
        linear,
    ) = room
    touching = touched, rows, linear
    tolerance, share, on_surface, nearness = plan
    list_all(points, tolerance, depth, records, amounts[0], stack, list_, active[0])
    held[0], counts[0] = 0, -(-points.shape[0] // LANES)
    width, fars = picked.shape[1], 0
    node, level = 1, 0
    while node:
        record = RECORD * node
        first = np.int64(at(records, record + FIRST))
        end = first + np.int64(at(records, record + RANK_AT))
        _fetch(shapes, first, end)
        _fetch(profiles, first, end)
        x = np.float32(at(records, record) - points[0, 0])
        y = np.float32(at(records, record + 1) - points[0, 1])
        z = np.float32(at(records, record + 2) - points[0, 2])
        clear2, bound = at(records, record + CLEAR), at(records, record + BOUND + ORDER)
        fars, held[level + 1], counts[level + 1] = 0, held[level], counts[level]
        if end > first:
            here, rest = active[held[level]], active[level + 1]
            fars, left = split(list_, here, counts[level], x, y, z, bound * bound, clear2, picked, rest)
            held[level + 1], counts[level + 1] = level + 1, left
        leaf = node - (1 << depth)
        if leaf >= 0 and counts[level + 1]:
            _fetch_leaf(leaves, values, leaf)
        for start in range(0, fars, LANES):
            rx, ry = x - load(picked, start), y - load(picked, width + start)
            rz = z - load(picked, 2 * width + start)
            octave = least_octave(picked, start)
            square = rx * rx + ry * ry + rz * rz
            degree = _degree(records, record, square, nearness, octave)
            _expand_to(degree, rx, ry, rz, basis)
            allowed, last = share * tolerance * LEAST_TOTAL * 2.0**octave, end
            while last > first + 1 and rests[last - 1] < allowed:
                last -= 1
            amounts_of(shapes, first, last, COUNTS[degree], basis, amounts)
            add_product(amounts, profiles, first, last, picked, start, min(start + LANES, fars), sums)
        if counts[level + 1] and level < depth:
            node, level = 2 * node, level + 1
            continue
        near, count = active[held[level + 1]], 0
        for i in range(counts[level + 1]):
            count = pick(list_, near[i, 0], near[i, 1], picked, count)
        for start in range(0, count, LANES):
            stop = min(start + LANES, count)
            _add_near(
                points, picked, start, stop, leaves, values, leaf, on_surface, shares, weights, touching, sums
            )
        node, level = _next(node, level)


@numba.njit(**ALLOCATION_FREE)
def _take_chunks(  # type: ignore[no-untyped-def]
    points, chunks, depth, records, factors, leaves, values, plan, checks, room, turn, order, target
):  # fmt: skip
    """One worker's share of the chunks."""
    doubt, bound = checks
    chunk = take_work(turn)
    while chunk < chunks.shape[0] - 1:
        a, b = chunks[chunk], chunks[chunk + 1]
        for place in range(0, (b - a) * values.shape[1], LANES):
            store(room.sums, place, splat(np.float32(0.0)))
        for i in range(b - a):
            room.touched[i] = 0
        _descend(points[a:b], depth, records, factors, leaves, values, plan, room)
        touching = room.touched, room.rows, room.linear
        normalize(points[a:b], room.sums, touching, values, doubt, bound, order[a:b], target)
        chunk = take_work(turn)


@numba.njit(parallel=True, cache=True, **OPTIONS)
def descend(  # type: ignore[no-untyped-def]
    points, chunks, depth, records, factors, leaves, values,
    tolerance, share, on_surface, nearness, doubt, bound, room, turn, order, target,
):  # fmt: skip
    """Weights times values for many points, within a tolerance.

    Args:
        points: (p, 3), neighbours one after the other.
        chunks: (c + 1,) where each chunk of points begins.
        depth, records, factors, leaves, values: a `Tree`; compiled loops take no nested tuples.
        tolerance: error allowed to a node's share of a point, when weights add up to 1.
        share: of that error which left out profiles may cause.
        on_surface: how near the surface a point counts as lying on it.
        nearness: (OCTAVES, ORDER + 1) float32; see `opening_radii`.
        doubt, bound, order, target: see `normalize`.
        room: see `rooms`.
        turn: (1,) 0, counts the chunks that were begun.
    """
    workers = room.counts.shape[0]
    for worker in numba.prange(workers):
        own = Room(
            room.list_[worker],
            room.active[worker],
            room.held[worker],
            room.counts[worker],
            room.picked[worker],
            room.basis[worker],
            room.amounts[worker],
            room.shares[worker],
            room.weights[worker],
            room.stack[worker],
            room.sums[worker],
            room.touched[worker],
            room.rows[worker],
            room.linear[worker],
        )
        plan = tolerance, share, on_surface, nearness
        checks = doubt, bound
        _take_chunks(
            points, chunks, depth, records, factors, leaves, values, plan, checks, own, turn, order, target
        )


def opening_radii(tolerance: float) -> Floats32:
    """How near nodes may be, in the unit of their bounds, by octave of a point's total and degree."""
    totals = LEAST_TOTAL * 2.0 ** np.arange(OCTAVES)
    degrees = np.arange(ORDER + 1)
    return ((tolerance * totals[:, None]) ** (-1.0 / (degrees + 3))).astype(np.float32)
