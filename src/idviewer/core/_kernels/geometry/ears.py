"""Polygons with holes cut into triangles, ear by ear, the small and well-shaped ones first."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.geometry.rings import bridge, ring_of, turn
from idviewer.core._kernels.simd.options import SCALAR
from idviewer.core.arrays import Floats, Ints

SHAPELY = 0.2
"""An ear is well-shaped if it is at least so high, as a share of its base."""


class Buckets(NamedTuple):
    """Reflex corners by the cells of a square grid.

    Attributes:
        left: x of the grid's corner.
        bottom: y of the grid's corner.
        scale: cells in a unit.
        side: cells along a side.
        first: (side^2 + 1,) where each cell's corners begin.
        corners: (r,) the reflex corners, cell by cell.
    """

    left: float
    bottom: float
    scale: float
    side: int
    first: Ints
    corners: Ints


@numba.njit(**SCALAR)
def _cell(buckets, value, low):  # type: ignore[no-untyped-def]
    return min(max(int((value - low) * buckets.scale), 0), buckets.side - 1)


@numba.njit(**SCALAR)
def sort_into(buckets, ring, used):  # type: ignore[no-untyped-def]
    """Put the reflex ones of the corners used into their cells."""
    first = buckets.first
    first[:] = 0
    for p in range(used):
        if turn(ring, ring.before[p], p, ring.after[p]) <= 0.0:
            first[_cell_of(buckets, ring, p)] += 1
    for cell in range(1, len(first)):
        first[cell] += first[cell - 1]
    # Filled from the back, so that what was a cell's end becomes its beginning.
    for p in range(used):
        if turn(ring, ring.before[p], p, ring.after[p]) <= 0.0:
            cell = _cell_of(buckets, ring, p)
            first[cell] -= 1
            buckets.corners[first[cell]] = p


@numba.njit(**SCALAR)
def _cell_of(buckets, ring, p):  # type: ignore[no-untyped-def]
    return _cell(buckets, ring.x[p], buckets.left) * buckets.side + _cell(buckets, ring.y[p], buckets.bottom)


@numba.njit(**SCALAR)
def _is_in(ring, a, b, c, p):  # type: ignore[no-untyped-def]
    """Whether corner p lies in a triangle or on its sides, and not where one of its corners is."""
    if turn(ring, a, b, p) < 0.0 or turn(ring, b, c, p) < 0.0 or turn(ring, c, a, p) < 0.0:
        return False
    x, y = ring.x, ring.y
    at_a = x[p] == x[a] and y[p] == y[a]
    at_b = x[p] == x[b] and y[p] == y[b]
    at_c = x[p] == x[c] and y[p] == y[c]
    return not (at_a or at_b or at_c)


@numba.njit(**SCALAR)
def _is_free(ring, buckets, a, b, c):  # type: ignore[no-untyped-def]
    """Whether no reflex corner lies in a triangle."""
    x, y = ring.x, ring.y
    low_x, high_x = min(x[a], x[b], x[c]), max(x[a], x[b], x[c])
    low_y, high_y = min(y[a], y[b], y[c]), max(y[a], y[b], y[c])
    bottom, top = _cell(buckets, low_y, buckets.bottom), _cell(buckets, high_y, buckets.bottom)
    left, right = _cell(buckets, low_x, buckets.left), _cell(buckets, high_x, buckets.left)
    for i in range(left, right + 1):
        row = i * buckets.side
        for k in range(buckets.first[row + bottom], buckets.first[row + top + 1]):
            p = buckets.corners[k]
            near = ring.before[p] >= 0 and low_x <= x[p] <= high_x and low_y <= y[p] <= high_y
            if near and _is_in(ring, a, b, c, p):
                return False
    return True


@numba.njit(**SCALAR)
def _clip(ring, buckets, start, longest, flattest, triangles):  # type: ignore[no-untyped-def]
    """Once round a ring: cut the ears whose base and shape are within the limits.

    Returns:
        A corner still on the ring, and the number of triangles written.
    """
    at, stop, done = start, start, 0
    while True:
        a, c = ring.before[at], ring.after[at]
        if a == c:
            return at, done
        base = (ring.x[c] - ring.x[a]) ** 2 + (ring.y[c] - ring.y[a]) ** 2
        height = turn(ring, a, at, c)
        following = c
        if base <= longest and height >= flattest * base and _is_free(ring, buckets, a, at, c):
            triangles[done, 0] = ring.point[a]
            triangles[done, 1] = ring.point[at]
            triangles[done, 2] = ring.point[c]
            done += 1
            ring.after[a], ring.before[c], ring.before[at] = c, a, -1
            # The next corner waits for the next round, so that no fan of slivers grows.
            following = ring.after[c]
            stop = a
        elif c == stop:
            return at, done
        at = following


@numba.njit(**SCALAR)
def clip_all(ring, buckets, roots, size, triangles):  # type: ignore[no-untyped-def]
    """Cut rings into triangles, the longest base allowed growing from round to round.

    Args:
        ring: linked corners.
        buckets: the reflex ones.
        roots: (loops,) a corner of each ring; -1 for none.
        size: of the region.
        triangles: for the result.

    Returns:
        How many triangles there are; -1 if ears run out.
    """
    # Squares of lengths: at first about a dozen of the shortest possible steps, at last anything.
    done, shortest, limit = 0, min(1.0, 64.0 / len(ring.x) ** 2) * size**2, 4.0 * size**2
    for root in roots:
        if root < 0:
            continue
        at, longest = root, shortest
        while longest <= limit and ring.before[at] != ring.after[at]:
            cut = 0
            for flattest in (SHAPELY, 0.0):
                if cut == 0:
                    at, cut = _clip(ring, buckets, at, longest, flattest, triangles[done:])
                    done += cut
            if cut == 0:
                longest *= 2.0
        if ring.before[at] != ring.after[at]:
            return -1
    return done


def cut_ears(points: Floats, first: Ints) -> NDArray[np.int32] | None:
    """Triangulate a region bounded by loops, the region on their left.

    Args:
        points: (p, 2).
        first: (loops + 1,) where each loop begins among the points.

    Returns:
        (t, 3) triangles; None if the loops cross or touch in such a way that ears run out.
    """
    ring = ring_of(points, first)
    roots = np.empty((2, len(first) - 1), dtype=np.int64)
    used = bridge(ring, first, np.empty(len(ring.x), dtype=np.bool_), roots)
    if used < 0:
        return None
    low = points.min(axis=0)
    size = float((points.max(axis=0) - low).max())
    side = int(np.sqrt(used)) + 1
    cells = np.empty(side * side + 1, dtype=np.int64), np.empty(used, dtype=np.int64)
    buckets = Buckets(float(low[0]), float(low[1]), side / size, side, *cells)
    sort_into(buckets, ring, used)
    triangles = np.empty((len(ring.x), 3), dtype=np.int32)
    done = clip_all(ring, buckets, roots[0], size, triangles)
    return None if done < 0 else triangles[:done]
