"""Morton order: points along a space-filling curve, so that neighbours lie together in memory."""

from __future__ import annotations

import numpy as np

from idviewer.core.arrays import Floats, Ints

CURVE_BITS = 10
"""The curve runs through a cube of 2^10 cells a side."""


def morton_order(points: Floats) -> Ints:
    """Order of points (p, 3) along a Morton curve through their bounding cube, (p,).

    >>> morton_order(np.array([[1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]])).tolist()
    [1, 2, 0]
    """
    if len(points) == 0:
        return np.empty(0, dtype=np.int64)
    lowest = points.min(axis=0)
    size = max(float(np.ptp(points, axis=0).max()), float(np.finfo(np.float64).tiny))
    cells = ((points - lowest).T / size * (2**CURVE_BITS - 1)).astype(np.int64)
    x, y, z = _spread(cells)
    return stable_order(x | y << 1 | z << 2)


def stable_order(keys: Ints) -> Ints:
    """The stable order of keys (p,) in [0, 2^31): one plain sort, several times faster than an argsort.

    >>> stable_order(np.array([2, 0, 2, 1])).tolist()
    [1, 3, 0, 2]
    """
    return np.sort(keys << 32 | np.arange(len(keys))) & 0xFFFFFFFF


def _spread(numbers: Ints) -> Ints:
    """Numbers of CURVE_BITS bits, with two zeros put between neighbouring bits."""
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        numbers = (numbers | numbers << shift) & mask
    return numbers
