"""A sparse symmetric positive definite matrix, factored once and solved for many right-hand sides."""

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

    The factor is SuperLU's; the solves are ours, as SuperLU takes one right-hand side after another.

    Args:
        matrix: (n, n) symmetric positive definite.
        points: (n, d) where the unknowns are.

    Attributes:
        order: (n,) the unknowns in the order of the factor's rows.

    Raises:
        numpy.linalg.LinAlgError: the matrix is not positive definite in floating point.
    """

    def __init__(self, matrix: sparse.csc_array, points: Floats) -> None:
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
        if not (np.array_equal(factor.perm_r, factor.perm_c) and np.all(over > 0.0)):
            raise np.linalg.LinAlgError("the matrix is not positive definite in floating point")
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

    def solve_ordered(self, sides: Floats) -> Floats:
        """The same of up to LANES right-hand sides whose rows, like those of the result, are in `order`."""
        count, width = sides.shape
        copies = (len(self._columns.first_column) - 1) * len(self._columns.separating)
        room = np.zeros((count + copies, LANES))
        room[:count, :width] = sides
        solve(*self._columns, room)
        return np.asfortranarray(room[:count, :width])


def _cut(lower: sparse.csc_array, over: Floats, path: NDArray[np.int8]) -> Columns:
    """The factor's columns in parts, from the halves (n, levels) that its rows are in."""
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
    crossing = separates[rows] & ~separates[column]
    rows[crossing] = count + part[column[crossing]] * len(separating) + number[rows[crossing]]
    return Columns(
        np.argsort(part, kind="stable"),
        np.searchsorted(np.sort(part), np.arange(parts + 1)),
        np.concatenate([[0], np.cumsum(np.bincount(column, minlength=count))]),
        rows.astype(np.int32),
        values,
        over,
        separating,
    )
