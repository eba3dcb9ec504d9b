"""Which edges of a polygon cross or touch: exact signs, and no tolerance."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints

Signs = NDArray[np.int64]

ROUNDING = 3.4e-16
"""Largest relative error of the float determinant (Shewchuk 1997, ccwerrboundA, rounded up)."""

PAIRS = 2**19
"""Pairs of edges looked at together, at most about."""


def turns(first: Floats, second: Floats, third: Floats) -> Signs:
    """Where three points turn: 1 to the left, -1 to the right, 0 not at all; exact for any coordinates.

    Floats decide where their rounding cannot change the sign, rational numbers the few that are left.
    Source: the filter of Shewchuk 1997, "Adaptive Precision Floating-Point Arithmetic and Fast Robust
    Geometric Predicates".

    Args:
        first: (p, 2).
        second: (p, 2).
        third: (p, 2).

    >>> first, second = np.zeros((2, 2)), np.full((2, 2), 0.1)
    >>> turns(first, second, np.array([[0.3, 0.3], [0.3, 0.1 + 0.2]])).tolist()
    [0, 1]
    """
    left = (first[:, 0] - third[:, 0]) * (second[:, 1] - third[:, 1])
    right = (first[:, 1] - third[:, 1]) * (second[:, 0] - third[:, 0])
    difference = left - right
    signs = np.sign(difference).astype(np.int64)
    for i in np.flatnonzero(np.abs(difference) < ROUNDING * (np.abs(left) + np.abs(right))):
        (ax, ay), (bx, by), (cx, cy) = (
            map(Fraction, points[i].tolist()) for points in (first, second, third)
        )
        exact = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
        signs[i] = (exact > 0) - (exact < 0)
    return signs


def crossing(vertices: Floats, successors: Ints, moved: Ints | None = None) -> tuple[int, int] | None:
    """Two edges that have a point in common though they do not follow each other; None if there are none.

    Args:
        vertices: (n, 2); edge i goes from vertex i to its successor.
        successors: (n,).
        moved: only pairs with one of these edges are looked at; all by default.
    """
    starts, ends = vertices, vertices[successors]
    low, high = np.minimum(starts, ends), np.maximum(starts, ends)
    for i, j in _swept(low, high) if moved is None else _beside(low, high, moved):
        apart = (successors[i] != j) & (successors[j] != i) & (i != j)
        i, j = i[apart], j[apart]
        # Of two collinear edges the boxes overlap, so they do too.
        split = turns(starts[i], ends[i], starts[j]) * turns(starts[i], ends[i], ends[j]) <= 0
        i, j = i[split], j[split]
        split = turns(starts[j], ends[j], starts[i]) * turns(starts[j], ends[j], ends[i]) <= 0
        if split.any():
            pairs = np.sort(np.stack([i[split], j[split]], axis=1), axis=1)
            first, second = min(pairs.tolist())
            return first, second
    return None


def _swept(low: Floats, high: Floats) -> Iterator[tuple[Ints, Ints]]:
    """Pairs of boxes that overlap, in portions: swept along the axis with fewer neighbours."""
    sweeps = []
    for axis in (0, 1):
        order = np.argsort(low[:, axis], kind="stable")
        last = np.searchsorted(low[order, axis], high[order, axis], side="right")
        sweeps.append((last - np.arange(1, len(low) + 1), order, 1 - axis))
    counts, order, other = min(sweeps, key=lambda sweep: int(sweep[0].sum()))
    total = np.cumsum(counts)
    portions = np.searchsorted(total, np.arange(PAIRS, total[-1] + PAIRS, PAIRS), side="left") + 1
    first = 0
    for stop in np.unique(np.minimum(portions, len(low))):
        number = counts[first:stop]
        item = np.repeat(np.arange(first, stop), number)
        step = np.arange(len(item)) - np.repeat(np.cumsum(number) - number, number)
        i, j = order[item], order[item + 1 + step]
        overlap = (low[i, other] <= high[j, other]) & (low[j, other] <= high[i, other])
        yield i[overlap], j[overlap]
        first = int(stop)


def _beside(low: Floats, high: Floats, chosen: Ints) -> Iterator[tuple[Ints, Ints]]:
    """Pairs of a chosen box and any other that overlap, in portions."""
    portion = max(1, PAIRS // len(low))
    for first in range(0, len(chosen), portion):
        some = chosen[first : first + portion]
        overlap = (low[some, None] <= high).all(axis=2) & (low <= high[some, None]).all(axis=2)
        i, j = np.nonzero(overlap)
        yield some[i], j
