"""Points against the edges of a polygon: their classification, and their mean value coordinates.

Notation as in docs/coordinates.md: x a query point, for an edge from a to b the distances r_a, r_b from x,
the cross product A and the dot product D of a - x and b - x. Everything is in units of the bounding box's
diagonal.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from idviewer.core._kernels.simd.options import OPTIONS


@numba.njit(**OPTIONS)
def _on_edge(p_0, p_1, e_0, e_1, tolerance):  # type: ignore[no-untyped-def]
    """Share of an edge's second end if x lies on it, 0 or 1 on an end; else -1.

    p and e lead from the first end to x and to the second end.
    """
    q_0, q_1, limit = p_0 - e_0, p_1 - e_1, tolerance * tolerance
    if p_0 * p_0 + p_1 * p_1 <= limit:
        return 0.0
    if q_0 * q_0 + q_1 * q_1 <= limit:
        return 1.0
    square = e_0 * e_0 + e_1 * e_1
    across, along = e_0 * p_1 - e_1 * p_0, e_0 * p_0 + e_1 * p_1
    if across * across > limit * square or along < 0.0 or along > square:
        return -1.0
    return along / square


@numba.njit(**OPTIONS)
def _winding_number(x, y, ends, tolerance):  # type: ignore[no-untyped-def]
    """Winding number of edges around x, and whether x may lie on one; a loop without branches."""
    winding, near = 0, 0
    for e in range(ends.shape[1]):
        a_0, a_1, b_0, b_1 = ends[0, e], ends[1, e], ends[2, e], ends[3, e]
        e_0, e_1 = b_0 - a_0, b_1 - a_1
        left = e_0 * (y - a_1) - (x - a_0) * e_1
        # Crossings with the ray towards lower x, by a rule that counts a vertex for one of its edges alone.
        below, beyond = a_1 <= y, b_1 <= y
        winding += int(beyond & ~below & (left > 0.0)) - int(below & ~beyond & (left < 0.0))
        close = abs(left) <= 2.0 * tolerance * (abs(e_0) + abs(e_1))
        near |= int(
            close
            & (min(a_0, b_0) - tolerance <= x)
            & (max(a_0, b_0) + tolerance >= x)
            & (min(a_1, b_1) - tolerance <= y)
            & (max(a_1, b_1) + tolerance >= y)
        )
    return winding, near


@numba.njit(parallel=True, cache=True, **OPTIONS)
def classify(points, ends, tolerance):  # type: ignore[no-untyped-def]
    """Classify points: which edge they lie on, and how often the edges wind around them.

    Args:
        points: (p, 2).
        ends: (4, e) coordinates of the two ends of each edge, the interior on the left.
        tolerance: how near an edge a point counts as lying on it.

    Returns:
        (p,) the edge or -1, one that ends in the point first; (p,) the share of its second vertex; and
        (p,) winding numbers, which hold off the boundary.
    """
    edge, share = np.full(len(points), -1), np.zeros(len(points))
    winding = np.zeros(len(points), dtype=np.int64)
    for p in numba.prange(len(points)):
        x, y = points[p, 0], points[p, 1]
        winding[p], near = _winding_number(x, y, ends, tolerance)
        if near:
            for e in range(ends.shape[1]):
                a_0, a_1 = ends[0, e], ends[1, e]
                on = _on_edge(x - a_0, y - a_1, ends[2, e] - a_0, ends[3, e] - a_1, tolerance)
                if on == 0.0 or on == 1.0 or (on > 0.0 and edge[p] < 0):
                    edge[p], share[p] = e, on
    return edge, share, winding


@numba.njit(**OPTIONS)
def _tangents(x, y, ends, tangents):  # type: ignore[no-untyped-def]
    """tan(alpha / 2) of the signed angles under which edges are seen; a loop without branches.

    = A / (r_a r_b + D) = (r_a r_b - D) / A, whichever has nothing that cancels: the first for acute angles,
    the second for obtuse ones, where A is far from 0 off the edge.
    """
    for e in range(ends.shape[1]):
        a_0, a_1, b_0, b_1 = ends[0, e] - x, ends[1, e] - y, ends[2, e] - x, ends[3, e] - y
        product = math.sqrt((a_0 * a_0 + a_1 * a_1) * (b_0 * b_0 + b_1 * b_1))
        cross, dot = a_0 * b_1 - a_1 * b_0, a_0 * b_0 + a_1 * b_1
        acute = dot >= 0.0
        tangents[e] = (cross if acute else product - dot) / (product + dot if acute else cross)


@numba.njit(parallel=True, cache=True, **OPTIONS)
def mean_value(points, inside, vertices, edges, ends, result):  # type: ignore[no-untyped-def]
    """Mean value coordinates of points inside; Hormann and Floater 2006, for any set of edges.

    Args:
        points: (p, 2).
        inside: (q,) indices of those that are inside and on no edge.
        vertices: (2, n).
        edges: (e, 2) from a vertex to the next, the interior on the left.
        ends: (4, e) coordinates of the two ends of each edge.
        result: (p, n) output; the rows of the points inside.
    """
    for place in numba.prange(len(inside)):
        p = inside[place]
        x, y = points[p, 0], points[p, 1]
        row, tangents = result[p], np.empty(len(edges))
        _tangents(x, y, ends, tangents)
        row[:] = 0.0
        for e in range(len(edges)):
            row[edges[e, 0]] += tangents[e]
            row[edges[e, 1]] += tangents[e]
        for i in range(len(row)):
            d_0, d_1 = vertices[0, i] - x, vertices[1, i] - y
            row[i] /= math.sqrt(d_0 * d_0 + d_1 * d_1)
        total = 0.0
        for i in range(len(row)):
            total += row[i]
        scale = 1.0 / total
        for i in range(len(row)):
            row[i] *= scale
