"""Loops of points as linked rings, and holes joined to what surrounds them by bridges."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from idviewer.core._kernels.simd.options import SCALAR
from idviewer.core.arrays import Floats, Ints


class Ring(NamedTuple):
    """Corners linked to closed rings, the region on the left.

    Attributes:
        x: (c,) coordinate of each corner.
        y: (c,) coordinate of each corner.
        point: (c,) which point it is; bridges to holes use points twice.
        before: (c,) the corner before, or -1 once it has been cut off.
        after: (c,) the corner after.
    """

    x: Floats
    y: Floats
    point: Ints
    before: Ints
    after: Ints


@numba.njit(**SCALAR)
def turn(ring, a, b, c):  # type: ignore[no-untyped-def]
    """Twice the signed area of the triangle a, b, c."""
    x, y = ring.x, ring.y
    return (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a])


def ring_of(points: Floats, first: Ints) -> Ring:
    """The loops of (p, 2) points, each from its place in first on, with room for two corners a bridge."""
    size = len(points) + 2 * (len(first) - 1)
    x, y = np.zeros((2, size))
    x[: len(points)], y[: len(points)] = points.T
    numbers = np.arange(size)
    before, after = numbers - 1, numbers + 1
    before[first[:-1]], after[first[1:] - 1] = first[1:] - 1, first[:-1]
    return Ring(x, y, numbers, before, after)


@numba.njit(**SCALAR)
def _leftmost(ring, start):  # type: ignore[no-untyped-def]
    """The leftmost corner of a ring, the lowest of equal ones, and twice the ring's signed area."""
    best, at, area = start, start, 0.0
    while True:
        area += turn(ring, start, at, ring.after[at])
        if ring.x[at] < ring.x[best] or (ring.x[at] == ring.x[best] and ring.y[at] < ring.y[best]):
            best = at
        at = ring.after[at]
        if at == start:
            return best, area


@numba.njit(**SCALAR)
def _opens_towards(ring, a, b):  # type: ignore[no-untyped-def]
    """Whether the way from corner a to b starts inside the region."""
    before, after = ring.before[a], ring.after[a]
    if turn(ring, before, a, after) > 0.0:
        return turn(ring, a, b, before) >= 0.0 and turn(ring, a, after, b) >= 0.0
    return turn(ring, a, b, before) > 0.0 or turn(ring, a, after, b) > 0.0


@numba.njit(**SCALAR)
def _first_side_to_the_left(ring, active, hole):  # type: ignore[no-untyped-def]
    """The nearest side left of a corner: its left end, and where the corner's level meets it; or -1."""
    x, y = ring.x, ring.y
    best, nearest = -1, -np.inf
    for p in range(len(active)):
        q = ring.after[p]
        if active[p] and y[p] >= y[hole] >= y[q] and y[p] != y[q]:
            met = x[p] + (y[hole] - y[p]) / (y[q] - y[p]) * (x[q] - x[p])
            if nearest < met <= x[hole]:
                best, nearest = (p if x[p] < x[q] else q), met
    return best, nearest


@numba.njit(**SCALAR)
def _bridgehead(ring, active, hole):  # type: ignore[no-untyped-def]
    """A corner left of a hole's leftmost one that sees it, or -1 (Eberly, Triangulation by Ear Clipping)."""
    x, y = ring.x, ring.y
    for p in range(len(active)):
        if active[p] and x[p] == x[hole] and y[p] == y[hole] and _opens_towards(ring, p, ring.after[hole]):
            return p
    best, met = _first_side_to_the_left(ring, active, hole)
    if best < 0:
        return -1
    # What hides the side's end lies in the triangle between the two and the point met; of the corners in
    # there, the one at the smallest angle to the level is seen.
    ex, ey, rising = x[best], y[best], (1.0 if y[best] >= y[hole] else -1.0)
    flattest, head = np.inf, -1
    for p in range(len(active)):
        if not active[p] or not ex <= x[p] < x[hole]:
            continue
        beyond = (ex - met) * (y[p] - y[hole]) - (ey - y[hole]) * (x[p] - met)
        ahead = (ex - x[hole]) * (y[p] - y[hole]) - (ey - y[hole]) * (x[p] - x[hole])
        if (y[p] - y[hole]) * rising < 0.0 or beyond * rising > 0.0 or ahead * rising < 0.0:
            continue
        angle = abs(y[p] - y[hole]) / (x[hole] - x[p])
        nearer = angle < flattest or (angle == flattest and x[p] > x[head])
        if nearer and _opens_towards(ring, p, hole):
            flattest, head = angle, p
    return head


@numba.njit(**SCALAR)
def _join(ring, a, b, spare):  # type: ignore[no-untyped-def]
    """Link two rings by a bridge from a to b and back, over two spare corners."""
    for new, old in ((spare, a), (spare + 1, b)):
        ring.x[new], ring.y[new], ring.point[new] = ring.x[old], ring.y[old], ring.point[old]
    after_a, before_b = ring.after[a], ring.before[b]
    ring.after[a], ring.before[b] = b, a
    ring.after[spare], ring.before[after_a] = after_a, spare
    ring.after[spare + 1], ring.before[spare] = spare, spare + 1
    ring.after[before_b], ring.before[spare + 1] = spare + 1, before_b


@numba.njit(**SCALAR)
def bridge(ring, first, active, roots):  # type: ignore[no-untyped-def]
    """Join each hole to what is left of it.

    Args:
        ring: the loops.
        first: (loops + 1,) where each begins.
        active: (c,) for which corners are used in the end.
        roots: (2, loops) for a corner of each outer loop or -1, and for scratch.

    Returns:
        How many corners are used, or -1 if a hole has nothing to its left.
    """
    for loop in range(roots.shape[1]):
        corner, area = _leftmost(ring, first[loop])
        roots[0, loop], roots[1, loop] = (corner, -1) if area > 0.0 else (-1, corner)
        active[first[loop] : first[loop + 1]] = area > 0.0
    spare = first[-1]
    active[spare:] = False
    while True:
        loop = _leftmost_hole(ring, roots[1])
        if loop < 0:
            return spare
        hole = roots[1, loop]
        head = _bridgehead(ring, active, hole)
        if head < 0:
            return -1
        _join(ring, head, hole, spare)
        active[first[loop] : first[loop + 1]] = True
        active[spare : spare + 2] = True
        roots[1, loop] = -1
        spare += 2


@numba.njit(**SCALAR)
def _leftmost_hole(ring, holes):  # type: ignore[no-untyped-def]
    """The hole that lies farthest left, of those that are left, or -1."""
    chosen = -1
    for loop in range(len(holes)):
        if holes[loop] >= 0 and (chosen < 0 or ring.x[holes[loop]] < ring.x[holes[chosen]]):
            chosen = loop
    return chosen
