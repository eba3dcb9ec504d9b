"""Supernodes of a sparse factor: columns with the same entries, which a solve takes together."""

from __future__ import annotations

import numba
import numpy as np

LARGEST_SUPERNODE = 4
"""Columns."""


@numba.njit(cache=True)
def group_columns(starts, rows, part):  # type: ignore[no-untyped-def]
    """Count the columns that go together: with the same entries below them and in one part.

    Args:
        starts: (n + 1,) where the columns begin.
        rows: (z,) of the entries, in ascending order in each column, the diagonal first.
        part: (n,) of each column.

    Returns:
        (n,) 1, 2 or 4 for the first column of each group, 0 for the others.
    """
    count = len(starts) - 1
    widths = np.zeros(count, dtype=np.int8)
    first = 0
    while first < count:
        width = 1
        while (
            width < LARGEST_SUPERNODE and first + width < count and _joins(starts, rows, part, first + width)
        ):
            width += 1
        if width == 3:
            width = 2
        widths[first] = width
        first += width
    return widths


@numba.njit(cache=True)
def _joins(starts, rows, part, column):  # type: ignore[no-untyped-def]
    """Whether a column has the entries of the one before, but for that in its own row."""
    begin, end, before = starts[column], starts[column + 1], starts[column - 1]
    if part[column] != part[column - 1] or begin - before != end - begin + 1:
        return False
    return np.array_equal(rows[before + 1 : begin], rows[begin:end])


@numba.njit(cache=True)
def below_diagonal(starts, rows, values, part, number):  # type: ignore[no-untyped-def]
    """The entries below the diagonal as `Columns` numbers them.

    Args:
        starts, rows, values: the columns, the diagonal first in each.
        part: (n,) of each row and column; the last one is that of the rows that separate the others.
        number: (n,) of each row among those that separate.

    Returns:
        (z - n,) int32 rows, and values.
    """
    count = len(starts) - 1
    last = part.max()
    separating = number.max() + 1
    numbered = np.empty(len(rows) - count, dtype=np.int32)
    kept = np.empty(len(rows) - count)
    for column in range(count):
        shift = count + part[column] * separating
        for entry in range(starts[column] + 1, starts[column + 1]):
            row = rows[entry]
            crossing = part[row] == last and part[column] != last
            numbered[entry - column - 1] = shift + number[row] if crossing else row
            kept[entry - column - 1] = values[entry]
    return numbered, kept
