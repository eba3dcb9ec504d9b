"""Sparse LDL^T factorization of a symmetric matrix, and solves for many right-hand sides."""

from __future__ import annotations

import math
from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from idviewer.core._kernels import LANES, thread_count
from idviewer.core._kernels.linear_algebra.supernodes import below_diagonal, group_columns
from idviewer.core._kernels.linear_algebra.triangular import Columns, solve
from idviewer.core.arrays import Floats, Ints
from idviewer.core.spectrum.nested_dissection import SEPARATOR, dissection_steps
from idviewer.core.steps import finish

LARGEST_RESIDUAL = 2e-10
"""Largest residual of a solution; eigenvalues lose ten times as much. Without refinement those seen are 1e-13
to 2e-9, another one for each shift."""


class LDLFactorization:
    """A = L D L^T in an order from nested dissection: few entries, and halves for threads side by side.

    The factor is SuperLU's; the solves are ours, as SuperLU takes one right-hand side after another. There
    is no pivoting: by bad luck, an indefinite matrix loses digits. Solutions are then refined once.

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
        finish(self._make(matrix, points, definite))

    @classmethod
    def steps(
        cls, matrix: sparse.csc_array, points: Floats, definite: bool = True
    ) -> Generator[None, None, LDLFactorization]:
        """The constructor as a generator; SuperLU's factorisation is a single step of it.

        Args:
            matrix: (n, n) symmetric.
            points: (n, d) where the unknowns are.
            definite: the matrix has to be positive definite.

        Raises:
            numpy.linalg.LinAlgError: the matrix is singular, or not definite, in floating point.
        """
        made = cls.__new__(cls)
        yield from made._make(matrix, points, definite)
        return made

    def _make(self, matrix: sparse.csc_array, points: Floats, definite: bool) -> Generator[None, None, None]:
        upper = sparse.coo_array(sparse.triu(matrix, 1))
        order, halves = yield from dissection_steps(points, np.stack([upper.row, upper.col], axis=1))
        permuted = sparse.csc_array(matrix[order][:, order])
        yield
        try:
            factor = splu(
                permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )
        except RuntimeError as error:
            raise np.linalg.LinAlgError(f"the matrix cannot be factored: {error}") from error
        yield
        inverse_pivots = 1.0 / factor.U.diagonal()
        self.negative = int(np.count_nonzero(inverse_pivots < 0.0))
        if definite and not np.all(inverse_pivots > 0.0):
            raise np.linalg.LinAlgError("the matrix is not positive definite in floating point")
        if not (np.array_equal(factor.perm_r, factor.perm_c) and np.isfinite(inverse_pivots).all()):
            raise np.linalg.LinAlgError("the matrix cannot be factored without pivoting")
        yield
        # SuperLU reorders columns within the order it was given, by the elimination tree.
        moved = np.argsort(factor.perm_c)
        self.order: Ints = order[moved]
        levels = min(halves.shape[1], math.ceil(math.log2(max(thread_count(), 2))))
        self._columns = _supernodes(factor.L, inverse_pivots, halves[self.order, :levels])
        copies = (len(self._columns.first_group) - 1) * len(self._columns.separating)
        self._workspace = np.zeros((len(order) + copies, LANES))
        self._refining: sparse.csr_array | None = None
        if not definite:
            yield
            self._refine(sparse.csr_array(permuted[moved][:, moved]))

    def _refine(self, matrix: sparse.csr_array) -> None:
        """Have solutions refined where digits were lost."""
        if self._residual(matrix) > LARGEST_RESIDUAL:
            self._refining = matrix
            if self._residual(matrix) > LARGEST_RESIDUAL:
                raise np.linalg.LinAlgError("the matrix cannot be factored without pivoting")

    def _residual(self, matrix: sparse.csr_array) -> float:
        """|A x - b| / |b| for random sides b, rows in `order`."""
        sides = np.random.default_rng(0).standard_normal((len(self.order), LANES))
        return float(np.linalg.norm(matrix @ self.solve_ordered(sides) - sides) / np.linalg.norm(sides))

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
        self._solve_in_workspace(sides)
        result = self._workspace[:count, :width].copy()
        if self._refining is not None:
            left = self._refining @ result
            self._solve_in_workspace(np.subtract(sides, left, out=left))
            result += self._workspace[:count, :width]
        return result

    def _solve_in_workspace(self, sides: Floats) -> None:
        count, width = sides.shape
        self._workspace[:count, :width] = sides
        self._workspace[:count, width:] = 0.0
        self._workspace[count:] = 0.0
        solve(*self._columns, self._workspace)


def _supernodes(lower: sparse.csc_array, inverse_pivots: Floats, halves: NDArray[np.int8]) -> Columns:
    """Group the factor's columns in supernodes, by the halves (n, levels) that its rows are in."""
    lower.sort_indices()
    levels, count = halves.shape[1], len(inverse_pivots)
    parts = 1 << levels
    separates = (halves == SEPARATOR).any(axis=1)
    part = np.where(separates, parts, halves.astype(np.int64) @ (1 << np.arange(levels)[::-1]))
    separating = np.flatnonzero(separates)
    number = np.zeros(count, dtype=np.int64)
    number[separating] = np.arange(len(separating))
    widths = group_columns(lower.indptr, lower.indices, part)
    groups = np.flatnonzero(widths)
    groups = groups[np.argsort(part[groups], kind="stable")]
    first_group = np.searchsorted(part[groups], np.arange(parts + 1))
    starts = lower.indptr - np.arange(count + 1)
    rows, values = below_diagonal(lower.indptr, lower.indices, lower.data, part, number)
    return Columns(groups, widths[groups], first_group, starts, rows, values, inverse_pivots, separating)
