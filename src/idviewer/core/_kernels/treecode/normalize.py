"""Sums of a chunk of points, normalised into values where they are wanted, and the check of each point."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from idviewer.core._kernels.simd.options import ALLOCATION_FREE
from idviewer.core.arrays import Bools, Floats, Ints

POSITION = 1
"""Columns of a table: a one, the position's three, and then the values."""

FIRST_VALUE = 4


class Target(NamedTuple):
    """Destination of values.

    Attributes:
        rows: (p,) of values, one a point.
        columns: (k,) of values, one a column of the tree.
        values: (.., ..) output.
        doubtful: (p,) output, whether a point's error may be above the bound.
    """

    rows: Ints
    columns: Ints
    values: Floats
    doubtful: Bools


@numba.njit(**ALLOCATION_FREE)
def _interpolate_linearly(i, table, corners, linear, sums):  # type: ignore[no-untyped-def]
    """Replace the sums of a point on the surface by the linear interpolation, whose total is 1."""
    for column in range(table.shape[1]):
        value = 0.0
        for corner in range(3):
            value += linear[i, corner] * table[corners[i, corner], column]
        sums[i, column] = value


@numba.njit(**ALLOCATION_FREE)
def normalize(points, sums, hits, table, safety, bound, order, target):  # type: ignore[no-untyped-def]
    """Divide sums (c, width) by their totals and put them where the target wants them.

    A point is doubtful if `safety` times the largest error of its position is above the bound; one that is
    not doubtful and has a negative total is outside, and its values are NaN.

    Args:
        points: (c, 3).
        sums: (c, width) float32; overwritten.
        hits: (c,) which points are on the surface, (c, 3) corners and (c, 3) shares there.
        table: (r, width) float32 what was summed up.
        safety, bound: see above.
        order: (c,) the points' numbers in the target.
        target: a `Target`.
    """
    on_surface, corners, linear = hits
    target_rows, columns, values, doubtful = target
    for i in range(points.shape[0]):
        if on_surface[i]:
            _interpolate_linearly(i, table, corners, linear, sums)
        total, sure = np.float64(sums[i, 0]), True
        for axis in range(3):
            off = abs(sums[i, POSITION + axis] / total - points[i, axis])
            sure = sure and safety * off <= bound  # NaN is not sure
        doubtful[order[i]] = not sure
        row, share = target_rows[order[i]], 1.0 / total if total > 0.0 else np.nan
        for column in range(columns.shape[0]):
            values[row, columns[column]] = share * sums[i, FIRST_VALUE + column]
