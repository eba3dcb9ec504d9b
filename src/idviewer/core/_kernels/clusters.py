"""A binary tree over the faces of a surface, each node with the moments that its far field needs.

Node 1 is the root and the children of node i are 2 i and 2 i + 1; the i-th node of a level holds the ordered
faces from (m i) >> level to (m (i + 1)) >> level. Source: docs/cluster_tree.md.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.expansion import COEFFICIENTS, ORDER, Tables, monomials
from idviewer.core._kernels.faces import OPTIONS, PLAIN
from idviewer.core._kernels.lanes import LANES, at, load, splat, store

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

RANK = 24
"""Most profiles that a node keeps."""

CLEARANCE = 1.2
"""The expansion of a node is never used nearer than so many of its radii."""

# A rule of degree 5 on the triangle: barycentric coordinates of its points, and their weights.
_NEAR, _FAR = (6.0 + math.sqrt(15.0)) / 21.0, (6.0 - math.sqrt(15.0)) / 21.0
_RULE = np.array(
    [[1.0 / 3.0] * 3]
    + [[1.0 - 2.0 * a if i == j else a for i in range(3)] for a in (_NEAR, _FAR) for j in range(3)]
)
_RULE_WEIGHTS = np.array(
    [0.225] + [(155.0 + math.sqrt(15.0)) / 1200.0] * 3 + [(155.0 - math.sqrt(15.0)) / 1200.0] * 3
)


class Source(NamedTuple):
    """A surface with what is given at its vertices, ordered for a tree.

    Attributes:
        positions: (n, 3).
        faces: (m, 3) in the order of the leaves.
        values: (n, k) at the vertices, k a multiple of LANES; column 0 is all ones.
        weights: (k,) what an error of each column counts.
        depth: level of the leaves.
    """

    positions: Floats
    faces: NDArray[np.int64]
    values: Floats
    weights: Floats
    depth: int


class Nodes(NamedTuple):
    """What the far field needs of each node; arrays of 2^(depth + 1).

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


class Factors(NamedTuple):
    """Moments of nodes, one behind the other: each a product of few shapes and profiles.

    Attributes:
        shapes: (f, COEFFICIENTS).
        profiles: (f, k).
        rests: (f,) the error left by the node's factors before each one.
    """

    shapes: Floats32
    profiles: Floats32
    rests: Floats32


class Plan(NamedTuple):
    """What to be accurate for.

    Attributes:
        tolerance: error allowed to a node, in the weights' unit.
        share: of that error which the factors may cause.
        tables: the multi-indices.
    """

    tolerance: float
    share: float
    tables: Tables


class Desk(NamedTuple):
    """Room for intermediate results, with one more axis in front for as many subtrees.

    Attributes:
        hats: (3, COEFFICIENTS) moments of a face's hat functions.
        powers: (COEFFICIENTS + 1,) monomials.
        scaled: (COEFFICIENTS, k) moments, with scales: (COEFFICIENTS,) and squares: (k,) of their columns.
        direction: (COEFFICIENTS,) of a shape.
        profile: (k,).
        joined: (COEFFICIENTS, k) moments of a node.
        waiting: (levels, COEFFICIENTS, k) moments of left children.
    """

    hats: Floats
    powers: Floats
    scaled: Floats
    scales: Floats
    squares: Floats
    direction: Floats
    profile: Floats
    joined: Floats
    waiting: Floats


def desks_for(width: int, levels: int, subtrees: int) -> Desk:
    """Room for so many subtrees of so many levels."""
    one = (subtrees, COEFFICIENTS)
    return Desk(
        np.empty((subtrees, 3, COEFFICIENTS)),
        np.empty((subtrees, COEFFICIENTS + 1)),
        np.empty((*one, width)),
        np.empty(one),
        np.empty((subtrees, width)),
        np.empty(one),
        np.empty((subtrees, width)),
        np.empty((*one, width)),
        np.empty((subtrees, levels, COEFFICIENTS, width)),
    )


@numba.njit(**PLAIN)
def desk_of(desks, i):  # type: ignore[no-untyped-def]
    """One subtree's."""
    return Desk(
        desks.hats[i],
        desks.powers[i],
        desks.scaled[i],
        desks.scales[i],
        desks.squares[i],
        desks.direction[i],
        desks.profile[i],
        desks.joined[i],
        desks.waiting[i],
    )


@numba.njit(**PLAIN)
def _select(order, keys, axis, low, high, middle):  # type: ignore[no-untyped-def]
    """Rearrange order[low:high] so that no key before middle exceeds one after it (Hoare's quickselect)."""
    left, right = low, high - 1
    while left < right:
        pivot = keys[order[(left + right) >> 1], axis]
        i, j = left, right
        while i <= j:
            while keys[order[i], axis] < pivot:
                i += 1
            while keys[order[j], axis] > pivot:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i, j = i + 1, j - 1
        if middle <= j:
            right = j
        elif middle >= i:
            left = i
        else:
            return


@numba.njit(**PLAIN)
def _longest_side(order, points, low, high):  # type: ignore[no-untyped-def]
    """The axis along which some points extend farthest."""
    best, longest = 0, -1.0
    for axis in range(3):
        lowest, highest = np.inf, -np.inf
        for i in range(low, high):
            lowest = min(lowest, points[order[i], axis])
            highest = max(highest, points[order[i], axis])
        if highest - lowest > longest:
            best, longest = axis, highest - lowest
    return best


@numba.njit(cache=True, **OPTIONS)
def halved(points, depth):  # type: ignore[no-untyped-def]
    """Order of (p, 3) points after depth halvings, each across the longest side of what is halved."""
    count = points.shape[0]
    order = np.arange(count)
    for level in range(depth):
        for i in range(1 << level):
            low, high = (count * i) >> level, (count * (i + 1)) >> level
            middle = (count * (2 * i + 1)) >> (level + 1)
            _select(order, points, _longest_side(order, points, low, high), low, high, middle)
    return order


@numba.njit(**PLAIN)
def _enclose(source, low, high, centre):  # type: ignore[no-untyped-def]
    """Centre and radius of a ball around some faces."""
    positions, faces = source.positions, source.faces
    for axis in range(3):
        lowest, highest = np.inf, -np.inf
        for f in range(low, high):
            for corner in range(3):
                value = positions[faces[f, corner], axis]
                lowest, highest = min(lowest, value), max(highest, value)
        centre[axis] = 0.5 * (lowest + highest)
    largest = 0.0
    for f in range(low, high):
        for corner in range(3):
            square = 0.0
            for axis in range(3):
                square += (positions[faces[f, corner], axis] - centre[axis]) ** 2
            largest = max(largest, square)
    return math.sqrt(largest)


@numba.njit(**PLAIN)
def _corner(source, vertex, centre):  # type: ignore[no-untyped-def]
    return (
        source.positions[vertex, 0] - centre[0],
        source.positions[vertex, 1] - centre[1],
        source.positions[vertex, 2] - centre[2],
    )


@numba.njit(**PLAIN)
def _face_moments(a, b, c, tables, powers, moments):  # type: ignore[no-untyped-def]
    """Moments (3, COEFFICIENTS) of a face's three hat functions; returns its area vector.

    The moment of f for beta is -1/2 sum_i beta_i integral f n_i y^(beta - e_i) dA.
    """
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    area = 0.5 * (uy * vz - uz * vy), 0.5 * (uz * vx - ux * vz), 0.5 * (ux * vy - uy * vx)
    for k in range(COEFFICIENTS):
        moments[0, k] = moments[1, k] = moments[2, k] = 0.0
    for q in range(_RULE.shape[0]):
        s, t, r = _RULE[q, 0], _RULE[q, 1], _RULE[q, 2]
        monomials(
            s * a[0] + t * b[0] + r * c[0],
            s * a[1] + t * b[1] + r * c[1],
            s * a[2] + t * b[2] + r * c[2],
            powers,
        )
        for k in range(COEFFICIENTS):
            sum_ = 0.0
            for axis in range(3):
                sum_ += tables.exponents[k, axis] * area[axis] * powers[tables.lowered[k, axis]]
            sum_ *= -0.5 * _RULE_WEIGHTS[q]
            moments[0, k] += s * sum_
            moments[1, k] += t * sum_
            moments[2, k] += r * sum_
    return area


@numba.njit(**PLAIN)
def _clear(moments):  # type: ignore[no-untyped-def]
    for place in range(0, moments.size, LANES):
        store(moments, place, splat(0.0))


@numba.njit(**PLAIN)
def _copy(moments, result):  # type: ignore[no-untyped-def]
    for place in range(0, moments.size, LANES):
        store(result, place, load(moments, place))


@numba.njit(**PLAIN)
def _leaf_moments(source, low, high, centre, tables, desk, moments, area):  # type: ignore[no-untyped-def]
    """Moments (COEFFICIENTS, k) of all columns over some faces, and their area vector (3,)."""
    width, hats, powers = source.values.shape[1], desk.hats, desk.powers
    _clear(moments)
    for axis in range(3):
        area[axis] = 0.0
    for f in range(low, high):
        i, j, k = source.faces[f, 0], source.faces[f, 1], source.faces[f, 2]
        a, b, c = _corner(source, i, centre), _corner(source, j, centre), _corner(source, k, centre)
        own = _face_moments(a, b, c, tables, powers, hats)
        for axis in range(3):
            area[axis] += own[axis]
        for column in range(0, width, LANES):
            at_i, at_j = load(source.values, i * width + column), load(source.values, j * width + column)
            at_k = load(source.values, k * width + column)
            for t in range(COEFFICIENTS):
                place = t * width + column
                share = at(hats, t) * at_i + at(hats, COEFFICIENTS + t) * at_j
                share = share + at(hats, 2 * COEFFICIENTS + t) * at_k
                store(moments, place, load(moments, place) + share)


@numba.njit(**PLAIN)
def _add_shifted(moments, child, parent, centres, tables, powers, result):  # type: ignore[no-untyped-def]
    """Add a child's moments to its parent's, whose centre is another."""
    width = result.shape[1]
    monomials(
        centres[child, 0] - centres[parent, 0],
        centres[child, 1] - centres[parent, 1],
        centres[child, 2] - centres[parent, 2],
        powers,
    )
    for s in range(tables.shifts.shape[0]):
        factor = tables.binomials[s] * powers[tables.shifts[s, 2]]
        to, out_of = tables.shifts[s, 0] * width, tables.shifts[s, 1] * width
        for column in range(0, width, LANES):
            store(result, to + column, load(result, to + column) + factor * load(moments, out_of + column))


@numba.njit(**PLAIN)
def _bound_errors(moments, weights, radius, tables, bounds):  # type: ignore[no-untyped-def]
    """From which distances each degree suffices, by the size of the first degree that is left out.

    Terms of degree n add up to no more than (n + 1) |moments of degree n| / distance^(n + 2).
    """
    t, size = 0, 0.0
    for degree in range(1, ORDER + 2):
        if degree <= ORDER:
            size = 0.0
            while t < COEFFICIENTS and tables.degrees[t] == degree:
                for column in range(moments.shape[1]):
                    size += (weights[column] * moments[t, column] * tables.norms[t]) ** 2
                t += 1
            size = math.sqrt(size)
        else:
            size *= radius
        if degree > 1:
            bounds[degree - 1] = ((degree + 1) * size) ** (1.0 / (degree + 2))


@numba.njit(**PLAIN)
def _project_out(direction, moments, profile):  # type: ignore[no-untyped-def]
    """Take the part along a unit direction (COEFFICIENTS,) from all columns; profile (k,) is that part."""
    width = moments.shape[1]
    for column in range(0, width, LANES):
        part = splat(0.0)
        for t in range(COEFFICIENTS):
            part = part + direction[t] * load(moments, t * width + column)
        for t in range(COEFFICIENTS):
            place = t * width + column
            store(moments, place, load(moments, place) - direction[t] * part)
        store(profile, column, part)


@numba.njit(**PLAIN)
def _scale(moments, weights, distance, tables, desk):  # type: ignore[no-untyped-def]
    """Moments by their errors as seen from a distance; leaves them and their columns' squares on the desk."""
    width, scaled, scales, squares = moments.shape[1], desk.scaled, desk.scales, desk.squares
    for column in range(width):
        squares[column] = 0.0
    for t in range(COEFFICIENTS):
        degree = tables.degrees[t]
        scales[t] = tables.norms[t] * (degree + 1) / distance ** (degree + 2)
        for column in range(width):
            scaled[t, column] = scales[t] * weights[column] * moments[t, column]
            squares[column] += scaled[t, column] ** 2


@numba.njit(**PLAIN)
def _turn_to_largest(scaled, squares, direction):  # type: ignore[no-untyped-def]
    """Unit direction of the largest column; returns the root of all squares."""
    largest, total, length = 0, 0.0, 0.0
    for column in range(squares.shape[0]):
        total += squares[column]
        if squares[column] > squares[largest]:
            largest = column
    for t in range(COEFFICIENTS):
        length += scaled[t, largest] ** 2
    over = 1.0 / math.sqrt(length) if length > 0.0 else 0.0
    for t in range(COEFFICIENTS):
        direction[t] = scaled[t, largest] * over
    return math.sqrt(total)


@numba.njit(**PLAIN)
def _factor(moments, weights, distance, plan, factors, first, desk):  # type: ignore[no-untyped-def]
    """Moments as a product of few shapes and profiles, by Gram-Schmidt with pivoting; returns how many.

    Errors are measured as seen from distance. Where the room for factors ends there are none.
    """
    shapes, profiles, rests = factors
    scaled, scales, squares, direction, profile = (
        desk.scaled,
        desk.scales,
        desk.squares,
        desk.direction,
        desk.profile,
    )
    _scale(moments, weights, distance, plan.tables, desk)
    row, end = first, min(first + RANK, rests.shape[0])
    while True:
        rest = _turn_to_largest(scaled, squares, direction)
        if rest <= plan.share * plan.tolerance:
            return row - first
        if row == end:
            return row - first if row == first + RANK else 0
        rests[row] = rest
        _project_out(direction, scaled, profile)
        for t in range(COEFFICIENTS):
            shapes[row, t] = direction[t] / scales[t]
        for column in range(moments.shape[1]):
            squares[column] = max(squares[column] - profile[column] ** 2, 0.0)
            divisor = weights[column] if weights[column] > 0.0 else 1.0
            profiles[row, column] = profile[column] / divisor
        row += 1


@numba.njit(**PLAIN)
def _finish(moments, node, source, plan, nodes, factors, first, desk):  # type: ignore[no-untyped-def]
    """Bounds and factors of a node whose moments are complete; returns where the next node's begin."""
    _bound_errors(moments, source.weights, nodes.radii[node], plan.tables, nodes.bounds[node])
    distance = nodes.bounds[node, ORDER] / plan.tolerance ** (1.0 / (ORDER + 3))
    distance = max(distance, CLEARANCE * nodes.radii[node])
    nodes.first[node], nodes.ranks[node] = first, 0
    # A body lies in a ball of diameter 1: no inner point is farther from a node than that.
    if distance < 1.0 + nodes.radii[node]:
        nodes.ranks[node] = _factor(moments, source.weights, distance, plan, factors, first, desk)
    return first + nodes.ranks[node]


@numba.njit(**PLAIN)
def _enclose_node(source, node, level, nodes):  # type: ignore[no-untyped-def]
    """The ball of a node; returns its range of faces."""
    count, place = source.faces.shape[0], node - (1 << level)
    low, high = (count * place) >> level, (count * (place + 1)) >> level
    nodes.radii[node] = _enclose(source, low, high, nodes.centres[node])
    return low, high


@numba.njit(**PLAIN)
def _join(left, right, node, tables, nodes, powers, result):  # type: ignore[no-untyped-def]
    """A node's moments from its children's."""
    centres, areas = nodes.centres, nodes.areas
    _clear(result)
    _add_shifted(left, 2 * node, node, centres, tables, powers, result)
    _add_shifted(right, 2 * node + 1, node, centres, tables, powers, result)
    for axis in range(3):
        areas[node, axis] = areas[2 * node, axis] + areas[2 * node + 1, axis]


@numba.njit(**PLAIN)
def _sum_subtree(source, top, level, plan, nodes, factors, desk, kept):  # type: ignore[no-untyped-def]
    """All nodes below and with node top at a level; its moments are left in kept (COEFFICIENTS, k).

    Leaf by leaf, so that no more moments exist at a time than the tree has levels. Returns the number of
    factors.
    """
    height, used = source.depth - level, 0
    waiting, joined = desk.waiting, desk.joined
    for leaf in range(top << height, (top + 1) << height):
        low, high = _enclose_node(source, leaf, source.depth, nodes)
        _leaf_moments(source, low, high, nodes.centres[leaf], plan.tables, desk, kept, nodes.areas[leaf])
        used = _finish(kept, leaf, source, plan, nodes, factors, used, desk)
        node, rise = leaf, 0
        while node & 1 and node != top:
            node >>= 1
            _enclose_node(source, node, source.depth - rise - 1, nodes)
            _join(waiting[rise], kept, node, plan.tables, nodes, desk.powers, joined)
            _copy(joined, kept)
            used = _finish(kept, node, source, plan, nodes, factors, used, desk)
            rise += 1
        _copy(kept, waiting[rise])
    return used


@numba.njit(parallel=True, cache=True, **OPTIONS)
def sum_subtrees(source, first, level, tolerance, share, tables, nodes, factors, desks, used, kept):  # type: ignore[no-untyped-def]
    """Some subtrees, in parallel.

    Args:
        source: a `Source`.
        first: the first of their topmost nodes.
        level: of these nodes.
        tolerance, share, tables: as in a `Plan`.
        nodes: a `Nodes`, written.
        factors: a `Factors` whose arrays have one more axis in front, of as many subtrees; written.
        desks: a `Desk`, likewise.
        used: number of factors of each subtree, written.
        kept: (2^level, COEFFICIENTS, k) moments of all topmost nodes, written.
    """
    for i in numba.prange(used.shape[0]):
        own = Factors(factors.shapes[i], factors.profiles[i], factors.rests[i])
        plan, top = Plan(tolerance, share, tables), first + i
        desk = desk_of(desks, i)
        used[i] = _sum_subtree(source, top, level, plan, nodes, own, desk, kept[top - (1 << level)])


@numba.njit(cache=True, **PLAIN)
def sum_level(source, level, tolerance, share, tables, nodes, factors, desks, kept, used):  # type: ignore[no-untyped-def]
    """The nodes of a level from kept, the moments of the level below, which they replace.

    Args:
        source, level, tolerance, share, tables, nodes, factors, desks: as for `sum_subtrees`; the first of
            the factors' and the desks' parts is used.
        kept: (2^(level + 1), COEFFICIENTS, k).
        used: number of factors so far.

    Returns:
        The new number of factors.
    """
    plan, desk = Plan(tolerance, share, tables), desk_of(desks, 0)
    own = Factors(factors.shapes[0], factors.profiles[0], factors.rests[0])
    for i in range(1 << level):
        node = (1 << level) + i
        _enclose_node(source, node, level, nodes)
        _join(kept[2 * i], kept[2 * i + 1], node, tables, nodes, desk.powers, desk.joined)
        _copy(desk.joined, kept[i])
        used = _finish(kept[i], node, source, plan, nodes, own, used, desk)
    return used
