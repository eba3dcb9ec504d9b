"""Edge collapses on a closed surface of half-edges.

Half-edge h = 3 f + i runs from corner i of face f to the next one; `tails` holds where it starts, -1 once
its face is gone, `twins` the half-edge that runs back, `out` some half-edge that starts at a vertex.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.simd.options import SCALAR
from idviewer.core.arrays import Floats

Int32s = NDArray[np.int32]

LARGEST_DEGREE = 12
"""A collapse that gives a vertex more neighbours is not done."""

BENT = 16.0
"""Weight of the squared distance from the surface, against that of the edge's squared length."""

TURNED = 0.4
"""Cosine of the angle up to which a collapse may turn a face."""

ROUNDEST = 0.25
"""Faces no worse than this (1 is equilateral) may come of a collapse; worse ones only of still worse ones."""


class HalfEdges(NamedTuple):
    """A closed surface under simplification.

    Attributes:
        points: (n, 3) positions.
        tails: (h,) int32 vertex at which each half-edge starts, or -1.
        twins: (h,) int32 the half-edge that runs back.
        out: (n,) int32 a half-edge that starts at each vertex.
        degrees: (n,) int32 neighbours of each vertex; 0 for those in which the surface touches itself.
        parents: (n,) int32 the vertex into which each was collapsed, or itself.
    """

    points: Floats
    tails: Int32s
    twins: Int32s
    out: Int32s
    degrees: Int32s
    parents: Int32s


def half_edges_of(points: Floats, faces: NDArray[np.int64]) -> HalfEdges:
    """Those of a closed, consistently wound surface: (n, 3) points and (m, 3) faces."""
    tails = faces.astype(np.int32).ravel()
    twins, out, degrees = _joined(tails, len(points))
    return HalfEdges(points, tails, twins, out, degrees, np.arange(len(points), dtype=np.int32))


@numba.njit(**SCALAR)
def _next(h):  # type: ignore[no-untyped-def]
    return h - 2 if h % 3 == 2 else h + 1


@numba.njit(**SCALAR)
def _last(h):  # type: ignore[no-untyped-def]
    return h + 2 if h % 3 == 0 else h - 1


@numba.njit(nogil=True, **SCALAR)
def _joined(tails, count):  # type: ignore[no-untyped-def]
    """Twins, an outgoing half-edge of each vertex, and degrees."""
    first = np.full(count, -1, np.int32)
    following = np.empty(len(tails), np.int32)
    twins = np.full(len(tails), -1, np.int32)
    corners = np.zeros(count, np.int32)
    for h in range(len(tails)):
        following[h] = first[tails[h]]
        first[tails[h]] = h
        corners[tails[h]] += 1
    for h in range(len(tails)):
        if twins[h] < 0:
            candidate = first[tails[_next(h)]]
            while candidate >= 0 and (tails[_next(candidate)] != tails[h] or twins[candidate] >= 0):
                candidate = following[candidate]
            twins[h] = candidate
            twins[candidate] = h
    degrees = np.zeros(count, np.int32)
    for v in range(count):
        if first[v] >= 0:
            h = first[v]
            while True:
                degrees[v] += 1
                h = twins[_last(h)]
                if h == first[v]:
                    break
            if degrees[v] < corners[v]:
                degrees[v] = 0
    return twins, first, degrees


@numba.njit(**SCALAR)
def _is_shorter(surface, h, limit):  # type: ignore[no-untyped-def]
    points, u, v = surface.points, surface.tails[h], surface.tails[_next(h)]
    x, y, z = points[v, 0] - points[u, 0], points[v, 1] - points[u, 1], points[v, 2] - points[u, 2]
    return x * x + y * y + z * z < limit


@numba.njit(**SCALAR)
def _worth(surface, h):  # type: ignore[no-untyped-def]
    """Cost of pulling the tail of h into its head: squares of length and of leaving the surface."""
    points, tails = surface.points, surface.tails
    u, v = tails[h], tails[_next(h)]
    x, y, z = points[v, 0] - points[u, 0], points[v, 1] - points[u, 1], points[v, 2] - points[u, 2]
    length, off = x * x + y * y + z * z, 0.0
    start = h
    while True:
        a, b = tails[_next(h)], tails[_last(h)]
        n_x, n_y, n_z, size = _normal(points, u, a, b)
        height = n_x * x + n_y * y + n_z * z
        if size > 0.0:
            off = max(off, height * height / size)
        h = surface.twins[_last(h)]
        if h == start:
            break
    return length + BENT * off


@numba.njit(**SCALAR)
def _normal(points, u, a, b):  # type: ignore[no-untyped-def]
    """Normal of the triangle u, a, b, as long as twice its area, and the square of that length."""
    a_x, a_y, a_z = points[a, 0] - points[u, 0], points[a, 1] - points[u, 1], points[a, 2] - points[u, 2]
    b_x, b_y, b_z = points[b, 0] - points[u, 0], points[b, 1] - points[u, 1], points[b, 2] - points[u, 2]
    x, y, z = a_y * b_z - a_z * b_y, a_z * b_x - a_x * b_z, a_x * b_y - a_y * b_x
    return x, y, z, x * x + y * y + z * z


@numba.njit(**SCALAR)
def _roundness(points, u, a, b, square):  # type: ignore[no-untyped-def]
    """Roundness of a triangle with such a square of twice its area: 1 if equilateral, 0 if flat."""
    sides = 0.0
    for axis in range(3):
        sides += (points[a, axis] - points[u, axis]) ** 2 + (points[b, axis] - points[u, axis]) ** 2
        sides += (points[b, axis] - points[a, axis]) ** 2
    return 2.0 * np.sqrt(3.0 * square) / sides


@numba.njit(**SCALAR)
def _keeps_shape(surface, h):  # type: ignore[no-untyped-def]
    """Whether pulling the tail of h into its head turns no face over and makes none much worse."""
    points, tails, twins = surface.points, surface.tails, surface.twins
    u, v = tails[h], tails[_next(h)]
    before, after = 1.0, 1.0
    start = h
    while True:
        a, b = tails[_next(h)], tails[_last(h)]
        x, y, z, size = _normal(points, u, a, b)
        before = min(before, _roundness(points, u, a, b, size))
        if a != v and b != v:
            p, q, r, new = _normal(points, v, a, b)
            along = x * p + y * q + z * r
            if not (along > 0.0 and along * along >= TURNED * TURNED * size * new):
                return False
            after = min(after, _roundness(points, v, a, b, new))
        h = twins[_last(h)]
        if h == start:
            return after > min(ROUNDEST, before)


@numba.njit(**SCALAR)
def _keeps_surface(surface, h):  # type: ignore[no-untyped-def]
    """Whether the ends of h have two neighbours in common: then the surface stays one (link condition)."""
    tails, twins, degrees = surface.tails, surface.twins, surface.degrees
    u, v = tails[h], tails[_next(h)]
    a, b = tails[_last(h)], tails[_last(twins[h])]
    if degrees[u] == 0 or degrees[v] == 0 or a == b:
        return False
    if degrees[a] == 3 or degrees[b] == 3 or degrees[u] + degrees[v] - 4 > LARGEST_DEGREE:
        return False
    common, start = 0, h
    while True:
        one, other = tails[_next(h)], surface.out[v]
        first = other
        while True:
            if tails[_next(other)] == one:
                common += 1
            other = twins[_last(other)]
            if other == first:
                break
        h = twins[_last(h)]
        if h == start:
            return common == 2


@numba.njit(**SCALAR)
def _collapse(surface, h):  # type: ignore[no-untyped-def]
    """Pull the tail of h into its head; two faces and a vertex go."""
    tails, twins, out, degrees = surface.tails, surface.twins, surface.out, surface.degrees
    u, v, back = tails[h], tails[_next(h)], twins[h]
    a, b = tails[_last(h)], tails[_last(back)]
    around = h
    while True:
        tails[around] = v
        around = twins[_last(around)]
        if around == h:
            break
    a_v, v_a = twins[_next(h)], twins[_last(h)]
    b_v, v_b = twins[_next(back)], twins[_last(back)]
    twins[a_v], twins[v_a], twins[b_v], twins[v_b] = v_a, a_v, v_b, b_v
    out[v], out[a], out[b] = v_a, a_v, b_v
    tails[h // 3 * 3 : h // 3 * 3 + 3] = -1
    tails[back // 3 * 3 : back // 3 * 3 + 3] = -1
    degrees[v] += degrees[u] - 4
    if degrees[a] > 0:
        degrees[a] -= 1
    if degrees[b] > 0:
        degrees[b] -= 1
    surface.parents[u] = v


@numba.njit(**SCALAR)
def collapse_some(surface, first, last, limit, most):  # type: ignore[no-untyped-def]
    """Collapse at most so many of the half-edges first to last - 1 that cost less than a limit; how many."""
    done = 0
    for h in range(first, last):
        if done == most:
            break
        if surface.tails[h] < 0 or not _is_shorter(surface, h, limit) or _worth(surface, h) >= limit:
            continue
        if _keeps_surface(surface, h) and _keeps_shape(surface, h):
            _collapse(surface, h)
            done += 1
    return done
