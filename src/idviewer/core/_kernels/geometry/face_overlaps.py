"""Pairs of triangles that cross or lie on each other: a tree of boxes, then separating axes."""

from __future__ import annotations

import math

import numba
import numpy as np

from idviewer.core._kernels.simd.options import SCALAR

FACES_PER_LEAF = 4

PARALLEL_SINE = 1e-9
"""Sine of the angle between two edges below which their cross product tells no direction."""


@numba.njit(**SCALAR)
def _minus(a, b):  # type: ignore[no-untyped-def]
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@numba.njit(**SCALAR)
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@numba.njit(**SCALAR)
def _cross(a, b):  # type: ignore[no-untyped-def]
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@numba.njit(**SCALAR)
def _corners_of(corners, face, x, y, z):  # type: ignore[no-untyped-def]
    """The corners of a face, relative to a point."""
    return (
        (corners[face, 0, 0] - x, corners[face, 0, 1] - y, corners[face, 0, 2] - z),
        (corners[face, 1, 0] - x, corners[face, 1, 1] - y, corners[face, 1, 2] - z),
        (corners[face, 2, 0] - x, corners[face, 2, 1] - y, corners[face, 2, 2] - z),
    )


@numba.njit(**SCALAR)
def _apart(axis, p, q, tolerance):  # type: ignore[no-untyped-def]
    """Whether a shift by no more than a tolerance along an axis of any length parts two triangles."""
    length = math.sqrt(_dot(axis, axis))
    if length == 0.0:
        return False
    p_0, p_1, p_2 = _dot(axis, p[0]), _dot(axis, p[1]), _dot(axis, p[2])
    q_0, q_1, q_2 = _dot(axis, q[0]), _dot(axis, q[1]), _dot(axis, q[2])
    forward = max(p_0, p_1, p_2) - min(q_0, q_1, q_2)
    backward = max(q_0, q_1, q_2) - min(p_0, p_1, p_2)
    return min(forward, backward) <= tolerance * length


@numba.njit(**SCALAR)
def _apart_in_planes(n_p, n_q, p, q, tolerance):  # type: ignore[no-untyped-def]
    """Whether one of the triangles' sides parts them, as seen in the planes with these normals."""
    return (
        _apart(_cross(n_p, _minus(p[1], p[0])), p, q, tolerance)
        or _apart(_cross(n_p, _minus(p[2], p[1])), p, q, tolerance)
        or _apart(_cross(n_p, _minus(p[0], p[2])), p, q, tolerance)
        or _apart(_cross(n_q, _minus(q[1], q[0])), p, q, tolerance)
        or _apart(_cross(n_q, _minus(q[2], q[1])), p, q, tolerance)
        or _apart(_cross(n_q, _minus(q[0], q[2])), p, q, tolerance)
    )


@numba.njit(**SCALAR)
def _edges_part(p, q, tolerance):  # type: ignore[no-untyped-def]
    """Whether the triangles are apart as seen along some edge of one and some edge of the other."""
    for i in range(3):
        e = _minus(p[(i + 1) % 3], p[i])
        for j in range(3):
            f = _minus(q[(j + 1) % 3], q[j])
            axis = _cross(e, f)
            if _dot(axis, axis) <= PARALLEL_SINE**2 * _dot(e, e) * _dot(f, f):
                continue
            if _apart(axis, p, q, tolerance):
                return True
    return False


@numba.njit(**SCALAR)
def _heights(normal, origin, p):  # type: ignore[no-untyped-def]
    """Lowest and highest of a triangle's corners over a plane, in lengths of its normal."""
    a, b, c = (
        _dot(normal, _minus(p[0], origin)),
        _dot(normal, _minus(p[1], origin)),
        _dot(normal, _minus(p[2], origin)),
    )
    return min(a, b, c), max(a, b, c)


@numba.njit(**SCALAR)
def faces_overlap(corners, first, second, tolerance):  # type: ignore[no-untyped-def]
    """Whether two triangles of (m, 3, 3) corners cross, or lie on each other, by more than a tolerance.

    By the separating axis theorem: two triangles that no shift by the tolerance parts overlap along the
    normals of both, along the products of their edges and along the normals of their sides in both planes.
    Those whose corners are within the tolerance of the other's plane are compared in the plane alone.
    """
    x, y, z = corners[first, 0, 0], corners[first, 0, 1], corners[first, 0, 2]
    p, q = _corners_of(corners, first, x, y, z), _corners_of(corners, second, x, y, z)
    n_p = _cross(_minus(p[1], p[0]), _minus(p[2], p[0]))
    n_q = _cross(_minus(q[1], q[0]), _minus(q[2], q[0]))
    slack_p, slack_q = tolerance * math.sqrt(_dot(n_p, n_p)), tolerance * math.sqrt(_dot(n_q, n_q))
    if slack_p == 0.0 or slack_q == 0.0:  # without area
        return False
    low_q, high_q = _heights(n_p, p[0], q)
    if low_q > slack_p or high_q < -slack_p:
        return False
    low_p, high_p = _heights(n_q, q[0], p)
    if low_p > slack_q or high_p < -slack_q:
        return False
    if low_q >= -slack_p and high_q <= slack_p:
        return not _apart_in_planes(n_p, n_p, p, q, tolerance)
    if low_p >= -slack_q and high_p <= slack_q:
        return not _apart_in_planes(n_q, n_q, p, q, tolerance)
    if low_q >= -slack_p or high_q <= slack_p or low_p >= -slack_q or high_p <= slack_q:
        return False
    return not (_apart_in_planes(n_p, n_q, p, q, tolerance) or _edges_part(p, q, tolerance))


@numba.njit(**SCALAR)
def _boxes_of(corners, margin, boxes):  # type: ignore[no-untyped-def]
    """Fill in lowest and highest coordinates (m, 6) of triangles, with a margin."""
    for face in range(corners.shape[0]):
        for axis in range(3):
            a, b, c = corners[face, 0, axis], corners[face, 1, axis], corners[face, 2, axis]
            boxes[face, axis] = min(a, b, c) - margin
            boxes[face, 3 + axis] = max(a, b, c) + margin


@numba.njit(**SCALAR)
def _tree_of(boxes, depth):  # type: ignore[no-untyped-def]
    """Boxes (2^(depth + 1), 6) of a binary tree over runs of triangles; the i-th node's children are 2 i and
    2 i + 1, and leaf i is node 2^depth + i."""
    nodes = np.empty((2 << depth, 6))
    nodes[:, :3], nodes[:, 3:] = np.inf, -np.inf
    for face in range(boxes.shape[0]):
        node = (1 << depth) + face // FACES_PER_LEAF
        for axis in range(3):
            nodes[node, axis] = min(nodes[node, axis], boxes[face, axis])
            nodes[node, 3 + axis] = max(nodes[node, 3 + axis], boxes[face, 3 + axis])
    for node in range((1 << depth) - 1, 0, -1):
        for axis in range(3):
            nodes[node, axis] = min(nodes[2 * node, axis], nodes[2 * node + 1, axis])
            nodes[node, 3 + axis] = max(nodes[2 * node, 3 + axis], nodes[2 * node + 1, 3 + axis])
    return nodes


@numba.njit(**SCALAR)
def _meet(a, i, b, j):  # type: ignore[no-untyped-def]
    """Whether two boxes meet."""
    return (
        a[i, 0] <= b[j, 3]
        and b[j, 0] <= a[i, 3]
        and a[i, 1] <= b[j, 4]
        and b[j, 1] <= a[i, 4]
        and a[i, 2] <= b[j, 5]
        and b[j, 2] <= a[i, 5]
    )


@numba.njit(**SCALAR)
def _grown(pairs, count):  # type: ignore[no-untyped-def]
    """The pairs, with room for at least one more than count."""
    if count < len(pairs):
        return pairs
    result = np.empty((2 * count, 2), dtype=np.int64)
    result[:count] = pairs
    return result


@numba.njit(**SCALAR)
def _compare_leaves(corners, boxes, nodes, leaf, other, base, tolerance, pairs, found):  # type: ignore[no-untyped-def]
    """Append the pairs between two leaves, or within one; the pairs, and how many there are now."""
    count = len(boxes)
    end, stop = min(count, (leaf + 1) * FACES_PER_LEAF), min(count, (other + 1) * FACES_PER_LEAF)
    for first in range(leaf * FACES_PER_LEAF, end):
        if not _meet(boxes, first, nodes, base + other):
            continue
        for second in range(max(first + 1, other * FACES_PER_LEAF), stop):
            if _meet(boxes, first, boxes, second) and faces_overlap(corners, first, second, tolerance):
                pairs = _grown(pairs, found)
                pairs[found, 0], pairs[found, 1] = first, second
                found += 1
    return pairs, found


@numba.njit(**SCALAR)
def find_overlaps(corners, tolerance, most_tests):  # type: ignore[no-untyped-def]
    """Find all pairs of triangles that cross or lie on each other.

    Args:
        corners: (m, 3, 3), neighbours one after the other.
        tolerance: see `faces_overlap`.
        most_tests: pairs of nodes that are compared at most; then it ends.

    Returns:
        (k, 2) pairs, the smaller number first, and how many faces were compared with all others.
    """
    boxes = np.empty((corners.shape[0], 6))
    _boxes_of(corners, tolerance, boxes)
    leaves, depth = -(-len(boxes) // FACES_PER_LEAF), 0
    while (1 << depth) < leaves:
        depth += 1
    base, nodes = 1 << depth, _tree_of(boxes, depth)
    found, pairs, tests = 0, np.empty((64, 2), dtype=np.int64), 0
    stack, levels = np.empty(2 * depth + 2, dtype=np.int64), np.empty(2 * depth + 2, dtype=np.int64)
    for leaf in range(leaves):
        if tests > most_tests:
            return pairs[:found], leaf * FACES_PER_LEAF
        stack[0], levels[0], top = 1, depth, 1
        while top:
            top -= 1
            node, height = stack[top], levels[top]
            tests += 1
            # Leaves before one's own have been compared with it.
            if ((node + 1) << height) <= base + leaf or not _meet(nodes, node, nodes, base + leaf):
                continue
            if height:
                stack[top], stack[top + 1] = 2 * node, 2 * node + 1
                levels[top] = levels[top + 1] = height - 1
                top += 2
                continue
            pairs, found = _compare_leaves(
                corners, boxes, nodes, leaf, node - base, base, tolerance, pairs, found
            )
            tests += FACES_PER_LEAF
    return pairs[:found], len(boxes)
