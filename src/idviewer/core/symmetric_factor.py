"""A sparse symmetric matrix, factored once and solved for many right-hand sides."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from idviewer.core._kernels import LANES, thread_count
from idviewer.core._kernels.triangular import Columns, solve
from idviewer.core.dissection import SEPARATOR, dissect

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class SymmetricFactor:
    """A = L D L^T in an order from nested dissection: few entries, and halves for threads side by side.

    The factor is SuperLU's; the solves are ours, as SuperLU takes one right-hand side after another. There
    is no pivoting: by bad luck, an indefinite matrix loses digits. `residual` tells.

    Args:
        matrix: (n, n) symmetric.
        points: (n, d) where the unknowns are.
        definite: the matrix has to be positive definite.

    Attributes:
        order: (n,) the unknowns in the order of the factor's rows.
        negative: how many eigenvalues of the matrix are negative (Sylvester's law of inertia).

    Raises:
        numpy.linalg.LinAlgError: the matrix is singular, or not definite, in floating point.
    """

    def __init__(self, matrix: sparse.csc_array, points: Floats, definite: bool = True) -> None:
        upper = sparse.coo_array(sparse.triu(matrix, 1))
        order, path = dissect(points, np.stack([upper.row, upper.col], axis=1))
        permuted = sparse.csc_array(matrix[order][:, order])
        try:
            factor = splu(
                permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )
        except RuntimeError as error:
            raise np.linalg.LinAlgError(f"the matrix cannot be factored: {error}") from error
        over = 1.0 / factor.U.diagonal()
        self.negative = int(np.count_nonzero(over < 0.0))
        if definite and not np.all(over > 0.0):
            raise np.linalg.LinAlgError("the matrix is not positive definite in floating point")
        if not (np.array_equal(factor.perm_r, factor.perm_c) and np.isfinite(over).all()):
            raise np.linalg.LinAlgError("the matrix cannot be factored without pivoting")
        # SuperLU reorders columns within the order it was given, by the elimination tree.
        self.order: Ints = order[np.argsort(factor.perm_c)]
        levels = min(path.shape[1], math.ceil(math.log2(max(thread_count(), 2))))
        self._columns = _cut(factor.L, over, path[self.order, :levels])

    def solve(self, sides: Floats) -> Floats:
        """A^-1 b of right-hand sides (n, b)."""
        result = np.empty(sides.shape)
        for start in range(0, sides.shape[1], LANES):
            some = slice(start, start + LANES)
            result[self.order, some] = self.solve_ordered(sides[self.order, some])
        return result

    def residual(self, matrix: sparse.csc_array) -> float:
        """|A x - b| / |b| for a random b."""
        side = np.random.default_rng(0).standard_normal((len(self.order), 1))
        return float(np.linalg.norm(matrix @ self.solve(side) - side) / np.linalg.norm(side))

    def solve_ordered(self, sides: Floats) -> Floats:
        """The same of up to LANES right-hand sides whose rows, like those of the result, are in `order`."""
        count, width = sides.shape
        copies = (len(self._columns.first_group) - 1) * len(self._columns.separating)
        room = np.zeros((count + copies, LANES))
        room[:count, :width] = sides
        solve(*self._columns, room)
        return np.asfortranarray(room[:count, :width])


def _cut(lower: sparse.csc_array, over: Floats, path: NDArray[np.int8]) -> Columns:
    """The factor's columns in parts, from the halves (n, levels) that its rows are in."""
    lower.sort_indices()
    levels, count = path.shape[1], len(over)
    parts = 1 << levels
    separates = (path == SEPARATOR).any(axis=1)
    part = np.where(separates, parts, path.astype(np.int64) @ (1 << np.arange(levels)[::-1]))
    separating = np.flatnonzero(separates)
    number = np.zeros(count, dtype=np.int64)
    number[separating] = np.arange(len(separating))
    column = np.repeat(np.arange(count), np.diff(lower.indptr))
    below = lower.indices != column
    column, rows, values = column[below], lower.indices[below].astype(np.int64), lower.data[below]
    starts = np.concatenate([[0], np.cumsum(np.bincount(column, minlength=count))])
    groups, widths = _grouped(starts, column, rows, part)
    by_part = np.argsort(part[groups], kind="stable")
    crossing = separates[rows] & ~separates[column]
    rows[crossing] = count + part[column[crossing]] * len(separating) + number[rows[crossing]]
    return Columns(
        groups[by_part],
        widths[by_part],
        np.searchsorted(part[groups[by_part]], np.arange(parts + 1)),
        starts,
        rows.astype(np.int32),
        values,
        over,
        separating,
    )


def _grouped(starts: Ints, column: Ints, rows: Ints, part: Ints) -> tuple[Ints, Ints]:
    """First columns and widths of groups of columns with the same entries below them, in one part each.

    Args:
        starts: (n + 1,) where the entries of each column begin.
        column, rows: (z,) of each entry, in ascending order.
        part: (n,) of each column.
    """
    sizes = np.diff(starts)
    joins = np.zeros(len(sizes) + 1, dtype=bool)  # each column with the one before
    candidate = np.flatnonzero((sizes[:-1] == sizes[1:] + 1) & (part[:-1] == part[1:])) + 1
    joins[candidate] = rows[starts[candidate - 1]] == candidate
    # An entry of such a column has its like in the column before, as many places ahead as it has entries.
    entries = np.flatnonzero(joins[column])
    other = rows[entries] != rows[entries - sizes[column[entries]]]
    joins[column[entries[other]]] = False
    run_starts = np.flatnonzero(~joins[:-1])
    run = np.cumsum(~joins[:-1]) - 1
    lengths = np.diff(np.append(run_starts, len(sizes)))[run]
    place = np.arange(len(sizes)) - run_starts[run]
    four = place // 4 * 4
    left = lengths - four
    widths = np.where(left >= 4, 4, np.where((left >= 2) & (place - four < 2), 2, 1))
    first = np.where(widths == 1, True, (place - four) % widths == 0)
    return np.flatnonzero(first), widths[first]
