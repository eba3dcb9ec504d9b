"""Recursive coordinate bisection: points in the order of a balanced binary tree."""

from __future__ import annotations

import numba
import numpy as np

from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS


@numba.njit(**ALLOCATION_FREE)
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


@numba.njit(**ALLOCATION_FREE)
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
def bisection_order(points, depth):  # type: ignore[no-untyped-def]
    """Order of (p, 3) points after depth halvings, each across the longest side of what is halved."""
    count = points.shape[0]
    order = np.arange(count)
    for level in range(depth):
        for i in range(1 << level):
            low, high = (count * i) >> level, (count * (i + 1)) >> level
            middle = (count * (2 * i + 1)) >> (level + 1)
            _select(order, points, _longest_side(order, points, low, high), low, high, middle)
    return order
