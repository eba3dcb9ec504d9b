"""Nested dissection: an order of unknowns in which a sparse matrix has a factor with few entries."""

from __future__ import annotations

import math
from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints
from idviewer.core.steps import finish

LEAST_PART_SIZE = 24
"""Parts of about so many vertices are not cut any more."""

MOST_OFF_CENTRE = 0.15
"""Largest distance of a cut from the middle of a part, as a share of its vertices."""

SEPARATOR = 2


def dissect(points: Floats, edges: Ints) -> tuple[Ints, NDArray[np.int8]]:
    """An order of the vertices of a graph drawn in space, separators after what they separate.

    Every part is cut in half across its longest principal axis; the vertices on one side of the cut with
    neighbours on the other, whichever side has fewer, are the separator. Source: George 1973, "Nested
    dissection of a regular finite element mesh"; the geometric cut is that of inertial bisection.

    Args:
        points: (n, d).
        edges: (e, 2) pairs of neighbours.

    Returns:
        (n,) the vertices in order, and (n, levels) of each vertex and level 0 or 1 for the half it is in,
        SEPARATOR for the level at which it separates, and 0 from then on.

    >>> line = np.column_stack([np.arange(100.0), np.zeros((100, 2))])
    >>> order, halves = dissect(line, np.column_stack([np.arange(99), np.arange(1, 100)]))
    >>> int(order[-1]), halves.shape
    (49, (100, 3))
    """
    return finish(dissection_steps(points, edges))


def dissection_steps(points: Floats, edges: Ints) -> Generator[None, None, tuple[Ints, NDArray[np.int8]]]:
    """`dissect` as a generator.

    Args:
        points: (n, d).
        edges: (e, 2) pairs of neighbours.
    """
    count = len(points)
    levels = max(1, math.ceil(math.log2(max(count, 2) / LEAST_PART_SIZE)))
    halves = np.zeros((count, levels), dtype=np.int8)
    left, part, place = np.arange(count), np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
    for level in range(levels):
        half = np.zeros(count, dtype=np.int8)
        edges = edges[part[edges[:, 0]] == part[edges[:, 1]]]
        place[left] = np.arange(len(left))
        half[left] = _halves(points[left], part[left], 1 << level, place[edges])
        separator = _separator(edges, half, part, 1 << level)
        halves[left, level] = half[left]
        halves[separator, level] = SEPARATOR
        part[left] = 2 * part[left] + half[left]
        part[separator] = -1 - separator  # in no part with any other
        left = left[part[left] >= 0]
        yield
    return np.lexsort(halves.T[::-1]), halves


def _halves(points: Floats, part: Ints, parts: int, edges: Ints) -> NDArray[np.bool_]:
    """Tell which half of its part each point (p, d) is in, cut across the part's longest principal axis."""
    counts = np.bincount(part, minlength=parts)
    order = np.lexsort((_along(points, part, counts), part))
    firsts = np.cumsum(counts) - counts
    place = np.empty(len(points), dtype=np.int64)
    place[order] = np.arange(len(points))
    cut = _thinnest(place[edges], part[order], counts, firsts)
    return place >= cut[part]


def _along(points: Floats, part: Ints, counts: Ints) -> Floats:
    """Positions of points (p, d) along the longest principal axis of their part."""
    share = 1.0 / np.maximum(counts, 1)
    parts, dimension = len(counts), points.shape[1]
    middle = np.stack(
        [np.bincount(part, points[:, axis], parts) * share for axis in range(dimension)], axis=1
    )
    off = points - middle[part]
    spread = np.empty((parts, dimension, dimension))
    for i in range(dimension):
        for j in range(dimension):
            spread[:, i, j] = np.bincount(part, off[:, i] * off[:, j], parts)
    longest = np.linalg.eigh(spread)[1][:, :, -1]
    return np.einsum("pd,pd->p", off, longest[part])


def _thinnest(edges: Ints, part: Ints, counts: Ints, firsts: Ints) -> Ints:
    """Place of the cut of each part: near its middle, where the fewest edges go across.

    Args:
        edges: (e, 2) places of neighbours in one part.
        part: of each place, ascending.
        counts, firsts: of each part's places.
    """
    size = len(part)
    # A cut before place c crosses the edges that begin before c and end at c or behind it.
    begins = np.bincount(np.minimum(edges[:, 0], edges[:, 1]) + 1, minlength=size + 1)
    changes = begins - np.bincount(np.maximum(edges[:, 0], edges[:, 1]) + 1, minlength=size + 1)
    crossing = np.cumsum(changes)[:size]
    off = np.abs(np.arange(size) - (firsts + 0.5 * counts)[part]) / np.maximum(counts, 1)[part]
    cost = np.where(off <= MOST_OFF_CENTRE, crossing + off, np.inf)
    cut = firsts + counts // 2
    some = np.flatnonzero(counts)
    least = np.full(len(counts), np.inf)
    least[some] = np.minimum.reduceat(cost, firsts[some])
    best = np.flatnonzero((cost == least[part]) & np.isfinite(cost))
    found, at = np.unique(part[best], return_index=True)
    cut[found] = best[at]
    return cut


def _separator(edges: Ints, half: NDArray[np.int8], part: Ints, parts: int) -> Ints:
    """The ends of each part's cut edges on the side that has fewer of them."""
    cut = edges[half[edges[:, 0]] != half[edges[:, 1]]]
    turned = half[cut[:, 0]] == 1
    sides = [np.unique(np.where(turned, cut[:, 1 - k], cut[:, k])) for k in range(2)]
    counts = [np.bincount(part[side], minlength=parts) for side in sides]
    fewer = counts[0] <= counts[1]
    return np.concatenate([sides[0][fewer[part[sides[0]]]], sides[1][~fewer[part[sides[1]]]]])
