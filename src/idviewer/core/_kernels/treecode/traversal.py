"""Points traverse a tree of clusters: far nodes act through their moments, near leaves face by face.

A chunk of points goes down together. At every node it splits: the points that are far from the node are done
with it, the others go on to its children. So vectors are as full as they can be at every step.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.parallel.work_queue import take_work
from idviewer.core._kernels.simd.lanes import LANES, at, bits, load, prefetch, splat, store
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS
from idviewer.core._kernels.treecode.clusters import BOUND, CLEAR, FIRST, RANK_AT, RECORD
from idviewer.core._kernels.treecode.expansion import COUNTS, ORDER, expand
from idviewer.core._kernels.treecode.factor_products import add_product, amounts_of
from idviewer.core._kernels.treecode.leaf import Leaves, weigh_leaf
from idviewer.core._kernels.treecode.low_rank_factors import Factors
from idviewer.core._kernels.treecode.normalize import normalize
from idviewer.core._kernels.treecode.point_lists import (
    ALL,
    ID,
    LEAST_WEIGHT_SUM,
    OCTAVES,
    least_octave,
    list_all,
    pick,
    split,
)
from idviewer.core._kernels.treecode.workspace import workspace_of

Floats32 = NDArray[np.float32]


class Tree(NamedTuple):
    """All that a traversal needs to know of a surface.

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


class Accuracy(NamedTuple):
    """Accuracy of a traversal.

    Attributes:
        tolerance: error allowed to a node's share of a point, when weights add up to 1.
        factor_share: of that error which left out factors may cause.
        surface_distance: how near the surface a point counts as lying on it.
        opening: (OCTAVES, ORDER + 1) float32; see `opening_radii`.
        safety, bound: see `normalize`.
    """

    tolerance: float
    factor_share: float
    surface_distance: float
    opening: Floats32
    safety: float
    bound: float


@numba.njit(**ALLOCATION_FREE)
def _degree(records, record, square, opening, octave):  # type: ignore[no-untyped-def]
    """The lowest degree that is accurate enough at all the distances, given their squares."""
    degree, clear2 = ORDER, at(records, record + CLEAR)
    while degree > 1:
        distance = at(records, record + BOUND + degree - 1) * opening[octave, degree - 1]
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
def _add_far(x, y, z, record, records, factors, accuracy, count, workspace):  # type: ignore[no-untyped-def]
    """A node's share of the sums of count picked points, which are far from it, by its expansion."""
    left, right, residuals = factors
    picked, basis, amounts, sums = workspace.picked, workspace.basis, workspace.amounts, workspace.sums
    tolerance, factor_share, opening = accuracy.tolerance, accuracy.factor_share, accuracy.opening
    first, width = np.int64(at(records, record + FIRST)), picked.shape[1]
    end = first + np.int64(at(records, record + RANK_AT))
    for start in range(0, count, LANES):
        rx, ry = x - load(picked, start), y - load(picked, width + start)
        rz = z - load(picked, 2 * width + start)
        octave = least_octave(picked, start)
        square = rx * rx + ry * ry + rz * rz
        degree = _degree(records, record, square, opening, octave)
        _expand_to(degree, rx, ry, rz, basis)
        allowed, last = factor_share * tolerance * LEAST_WEIGHT_SUM * 2.0**octave, end
        while last > first + 1 and residuals[last - 1] < allowed:
            last -= 1
        amounts_of(left, first, last, COUNTS[degree], basis, amounts)
        add_product(amounts, right, first, last, picked, start, min(start + LANES, count), sums)


@numba.njit(**ALLOCATION_FREE)
def _weigh_rows(x, y, z, leaves, leaf, surface_distance, shares, weights, lane):  # type: ignore[no-untyped-def]
    """Weights of a leaf's rows for one point, in a lane of weights; returns what `weigh_leaf` does."""
    centres, corners, rows = leaves.centres, leaves.corners, leaves.rows
    x, y, z = x - centres[leaf, 0], y - centres[leaf, 1], z - centres[leaf, 2]
    count = leaves.counts[leaf]
    on = weigh_leaf(x, y, z, corners, leaf, count, surface_distance, shares)
    for row in range(leaves.first_row[leaf + 1] - leaves.first_row[leaf]):
        weights[row, lane] = 0.0
    for corner in range(3):
        for face in range(count):
            weights[rows[leaf, corner, face], lane] += np.float32(shares[corner, face])
    return on


@numba.njit(**ALLOCATION_FREE)
def _add_near(points, start, stop, leaves, values, leaf, surface_distance, workspace):  # type: ignore[no-untyped-def]
    """A leaf's share of the sums of picked points start to stop - 1, face by face."""
    first, end = leaves.first_row[leaf], leaves.first_row[leaf + 1]
    picked, shares, weights = workspace.picked, workspace.shares, workspace.weights
    on_surface, corners, linear = workspace.on_surface, workspace.corners, workspace.linear
    for i in range(start, stop):
        point = np.int64(picked[ID, i])
        x, y, z = points[point, 0], points[point, 1], points[point, 2]
        on = _weigh_rows(x, y, z, leaves, leaf, surface_distance, shares, weights, i - start)
        if on >= 0:
            on_surface[point] = 1
            for corner in range(3):
                corners[point, corner] = first + leaves.rows[leaf, corner, on]
                linear[point, corner] = shares[corner, on]
    add_product(weights, values, first, end, picked, start, stop, workspace.sums)


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
def _traverse_chunk(points, tree, accuracy, workspace):  # type: ignore[no-untyped-def]
    """Take one chunk of points (c, 3) through the whole tree; adds to the workspace's sums."""
    # Tuples are taken apart here, once: reading them inside of the loop costs more than the loop does.
    depth, records, factors, leaves, values = tree
    chunk, active, level_of, counts = workspace.chunk, workspace.active, workspace.level_of, workspace.counts
    picked, surface_distance = workspace.picked, accuracy.surface_distance
    totals, stack = workspace.amounts[0], workspace.stack
    list_all(points, accuracy.tolerance, depth, records, totals, stack, chunk, active[0])
    level_of[0], counts[0] = 0, -(-points.shape[0] // LANES)
    node, level = 1, 0
    while node:
        record, leaf = RECORD * node, node - (1 << depth)
        first, rank = np.int64(at(records, record + FIRST)), np.int64(at(records, record + RANK_AT))
        _fetch(factors.left, first, first + rank)
        _fetch(factors.right, first, first + rank)
        x = np.float32(at(records, record) - points[0, 0])
        y = np.float32(at(records, record + 1) - points[0, 1])
        z = np.float32(at(records, record + 2) - points[0, 2])
        clear2, bound = at(records, record + CLEAR), at(records, record + BOUND + ORDER)
        far_count, level_of[level + 1], counts[level + 1] = 0, level_of[level], counts[level]
        if rank > 0:
            here, rest, count = active[level_of[level]], active[level + 1], counts[level]
            far_count, left = split(chunk, here, count, x, y, z, bound * bound, clear2, picked, rest)
            level_of[level + 1], counts[level + 1] = level + 1, left
        if leaf >= 0 and counts[level + 1]:
            _fetch_leaf(leaves, values, leaf)
        _add_far(x, y, z, record, records, factors, accuracy, far_count, workspace)
        if counts[level + 1] and level < depth:
            node, level = 2 * node, level + 1
            continue
        near, count = active[level_of[level + 1]], 0
        for i in range(counts[level + 1]):
            count = pick(chunk, near[i, 0], near[i, 1], picked, count)
        for start in range(0, count, LANES):
            stop = min(start + LANES, count)
            _add_near(points, start, stop, leaves, values, leaf, surface_distance, workspace)
        node, level = _next(node, level)


@numba.njit(**ALLOCATION_FREE)
def _take_chunks(points, chunks, order, tree, accuracy, workspace, queue, target):  # type: ignore[no-untyped-def]
    """Take chunks from the queue, as one of the workers."""
    sums, on_surface = workspace.sums, workspace.on_surface
    hits = on_surface, workspace.corners, workspace.linear
    chunk = take_work(queue)
    while chunk < chunks.shape[0] - 1:
        a, b = chunks[chunk], chunks[chunk + 1]
        for place in range(0, (b - a) * sums.shape[1], LANES):
            store(sums, place, splat(np.float32(0.0)))
        for i in range(b - a):
            on_surface[i] = 0
        _traverse_chunk(points[a:b], tree, accuracy, workspace)
        normalize(points[a:b], sums, hits, tree.values, accuracy.safety, accuracy.bound, order[a:b], target)
        chunk = take_work(queue)


@numba.njit(parallel=True, cache=True, **OPTIONS)
def traverse(  # type: ignore[no-untyped-def]
    points, chunks, order, depth, records, factors, leaves, values, accuracy, workspaces, queue, target
):  # fmt: skip
    """Weights times values for many points, within a tolerance.

    Args:
        points: (p, 3), neighbours one after the other.
        chunks: (c + 1,) where each chunk of points begins.
        order: (p,) the points' numbers in the target.
        depth, records, factors, leaves, values: a `Tree`; parallel loops take no nested tuples.
        accuracy: an `Accuracy`.
        workspaces: see there.
        queue: (1,) 0, counts the chunks that were begun.
        target: a `Target`.
    """
    for worker in numba.prange(workspaces.counts.shape[0]):
        tree = Tree(depth, records, factors, leaves, values)
        _take_chunks(points, chunks, order, tree, accuracy, workspace_of(workspaces, worker), queue, target)


def opening_radii(tolerance: float) -> Floats32:
    """Opening radii (OCTAVES, ORDER + 1) in units of nodes' bounds, by weight sum's octave and by degree."""
    sums = LEAST_WEIGHT_SUM * 2.0 ** np.arange(OCTAVES)
    degrees = np.arange(ORDER + 1)
    return ((tolerance * sums[:, None]) ** (-1.0 / (degrees + 3))).astype(np.float32)
