"""A binary tree over the faces of a surface, each node with the moments that its far field needs.

Node 1 is the root and the children of node i are 2 i and 2 i + 1; the i-th node of a level holds the ordered
faces from (m i) >> level to (m (i + 1)) >> level. Source: docs/treecode.md.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.simd.lanes import LANES
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS
from idviewer.core._kernels.treecode.expansion import ORDER
from idviewer.core._kernels.treecode.low_rank_factors import (
    Factors,
    Plan,
    bound_errors,
    factor,
    factor_workspace_of,
)
from idviewer.core._kernels.treecode.moments import add_shifted, clear_moments, copy_moments, leaf_moments
from idviewer.core.arrays import Floats

Floats32 = NDArray[np.float32]

LEAST_RADII = 1.2
"""The expansion of a node is never used nearer than so many of its radii."""


class Nodes(NamedTuple):
    """Nodes as the far field needs them; arrays of 2^(depth + 1).

    Attributes:
        centres: (.., 3) of a ball around the node.
        radii: of that ball.
        areas: (.., 3) area vectors.
        bounds: (.., ORDER + 1); degree p suffices at distances beyond bounds[p] / tolerance^(1 / (p + 3)).
        first: where the node's factors begin.
        ranks: how many it has; 0 where it is never far from anything.
    """

    centres: Floats
    radii: Floats
    areas: Floats
    bounds: Floats32
    first: NDArray[np.int64]
    ranks: NDArray[np.int64]


@numba.njit(**ALLOCATION_FREE)
def _enclose(source, node, level, nodes):  # type: ignore[no-untyped-def]
    """Fill in the ball of a node: its centre and radius."""
    corners, middles, centre = source.corners, source.centres, nodes.centres[node]
    rise = source.depth - level
    first = (node - (1 << level)) << rise
    end = first + (1 << rise)
    for axis in range(3):
        lowest, highest = np.inf, -np.inf
        for leaf in range(first, end):
            for corner in range(3):
                for face in range(LANES):  # the last is repeated where there are fewer
                    value = middles[leaf, axis] + corners[leaf, corner, axis, face]
                    lowest, highest = min(lowest, value), max(highest, value)
        # In single precision, as traversals will read it.
        centre[axis] = np.float32(0.5 * (lowest + highest))
    largest = 0.0
    for leaf in range(first, end):
        x, y, z = middles[leaf, 0] - centre[0], middles[leaf, 1] - centre[1], middles[leaf, 2] - centre[2]
        for corner in range(3):
            for face in range(LANES):
                a, b = x + corners[leaf, corner, 0, face], y + corners[leaf, corner, 1, face]
                c = z + corners[leaf, corner, 2, face]
                largest = max(largest, a * a + b * b + c * c)
    nodes.radii[node] = math.sqrt(largest)


@numba.njit(**ALLOCATION_FREE)
def _finish(moments, node, source, plan, nodes, factors, first, workspace):  # type: ignore[no-untyped-def]
    """Fill in a node whose moments are complete; returns where the next node's factors begin."""
    for axis in range(3):
        nodes.areas[node, axis] = -2.0 * moments[axis, 0]  # column 0 is all ones: -1/2 integral n dA
    bound_errors(moments, source.weights, nodes.radii[node], plan.tables, nodes.bounds[node])
    distance = nodes.bounds[node, ORDER] / plan.tolerance ** (1.0 / (ORDER + 3))
    distance = max(distance, LEAST_RADII * nodes.radii[node])
    nodes.first[node], nodes.ranks[node] = first, 0
    # A body lies in a ball of diameter 1: no inner point is farther from a node than that.
    if distance < 1.0 + nodes.radii[node]:
        nodes.ranks[node] = factor(moments, source.weights, distance, plan, factors, first, workspace)
    return first + nodes.ranks[node]


@numba.njit(**ALLOCATION_FREE)
def _join(left, right, node, tables, nodes, workspace, result):  # type: ignore[no-untyped-def]
    """Sum up a node's moments from its children's."""
    clear_moments(result)
    add_shifted(left, 2 * node, node, nodes.centres, tables, workspace, result)
    add_shifted(right, 2 * node + 1, node, nodes.centres, tables, workspace, result)


@numba.njit(**ALLOCATION_FREE)
def _sum_subtree(source, top, level, plan, nodes, factors, workspace, kept):  # type: ignore[no-untyped-def]
    """Fill in all nodes below and with node top at a level; its moments are left in kept (COEFFICIENTS, k).

    Leaf by leaf, so that no more moments exist at a time than the tree has levels. Returns the number of
    factors.
    """
    height, used = source.depth - level, 0
    waiting, joined = workspace.waiting, workspace.joined
    for leaf in range(top << height, (top + 1) << height):
        _enclose(source, leaf, source.depth, nodes)
        leaf_moments(source, leaf - (1 << source.depth), nodes.centres[leaf], plan.tables, workspace, kept)
        used = _finish(kept, leaf, source, plan, nodes, factors, used, workspace)
        node, rise = leaf, 0
        while node & 1 and node != top:
            node >>= 1
            _enclose(source, node, source.depth - rise - 1, nodes)
            _join(waiting[rise], kept, node, plan.tables, nodes, workspace, joined)
            copy_moments(joined, kept)
            used = _finish(kept, node, source, plan, nodes, factors, used, workspace)
            rise += 1
        copy_moments(kept, waiting[rise])
    return used


@numba.njit(parallel=True, cache=True, **OPTIONS)
def sum_subtrees(  # type: ignore[no-untyped-def]
    source, first, level, tolerance, share, tables, nodes, factors, workspaces, used, kept
):  # fmt: skip
    """Fill in some subtrees, in parallel.

    Args:
        source: a `Source`.
        first: the first of their topmost nodes.
        level: of these nodes.
        tolerance, share, tables: as in a `Plan`.
        nodes: a `Nodes`, written.
        factors: a `Factors` whose arrays have one more axis in front, of as many subtrees; written.
        workspaces: a `FactorWorkspace`, likewise.
        used: number of factors of each subtree, written.
        kept: (2^level, COEFFICIENTS, k) moments of all topmost nodes, written.
    """
    for i in numba.prange(used.shape[0]):
        own = Factors(factors.left[i], factors.right[i], factors.residuals[i])
        plan, top = Plan(tolerance, share, tables), first + i
        workspace = factor_workspace_of(workspaces, i)
        used[i] = _sum_subtree(source, top, level, plan, nodes, own, workspace, kept[top - (1 << level)])


@numba.njit(cache=True, **ALLOCATION_FREE)
def sum_level(  # type: ignore[no-untyped-def]
    source, level, tolerance, share, tables, nodes, factors, workspaces, kept, used
):  # fmt: skip
    """Fill in the nodes of a level from kept, the moments of the level below, which theirs replace.

    Args:
        source, level, tolerance, share, tables, nodes, factors, workspaces: as for `sum_subtrees`; of the
            factors' and the workspaces' parts the first is used.
        kept: (2^(level + 1), COEFFICIENTS, k).
        used: number of factors so far.

    Returns:
        The new number of factors.
    """
    plan, workspace = Plan(tolerance, share, tables), factor_workspace_of(workspaces, 0)
    own = Factors(factors.left[0], factors.right[0], factors.residuals[0])
    for i in range(1 << level):
        node = (1 << level) + i
        _enclose(source, node, level, nodes)
        _join(kept[2 * i], kept[2 * i + 1], node, tables, nodes, workspace, workspace.joined)
        copy_moments(workspace.joined, kept[i])
        used = _finish(kept[i], node, source, plan, nodes, own, used, workspace)
    return used


CENTRE, CLEAR, AREA, RADIUS, BOUND, FIRST, RANK_AT, RECORD = 0, 3, 4, 7, 7, 13, 14, 16
"""Where a record of a node holds its centre (3), the square of the distance at which it may be far (infinite
without factors), its area vector (3), the square of its radius, the bounds of each degree (from BOUND + 1),
its first factor and how many there are: one line of memory for all that a visit needs."""


def records_of(nodes: Nodes) -> Floats32:
    """(nodes, RECORD) float32."""
    records = np.zeros((len(nodes.radii), RECORD), dtype=np.float32)
    records[:, CENTRE : CENTRE + 3] = nodes.centres
    records[:, CLEAR] = np.where(nodes.ranks > 0, (LEAST_RADII * nodes.radii) ** 2, np.inf)
    records[:, AREA : AREA + 3] = nodes.areas
    records[:, RADIUS] = nodes.radii**2
    records[:, BOUND + 1 : BOUND + 1 + ORDER] = nodes.bounds[:, 1:]
    records[:, FIRST], records[:, RANK_AT] = nodes.first, nodes.ranks
    return records
