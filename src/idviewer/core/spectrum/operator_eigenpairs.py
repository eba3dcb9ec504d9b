"""The k lowest eigenpairs of a given operator, L phi = lambda M phi, above its null space.

Sylvester's law of inertia says how many eigenvalues lie below a number that L - number M is factored at. So
the shift is put among the wanted ones, and none can be missed: neither copies of an eigenvalue, of which a
Krylov space holds no more than a block is wide, nor those of one component among many.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
from scipy import sparse
from scipy.sparse import csgraph

from idviewer.core.arrays import Floats
from idviewer.core.memory import bytes_in_words
from idviewer.core.spectrum.block_lanczos import BLOCK, BlockLanczos
from idviewer.core.spectrum.graph_positions import graph_positions
from idviewer.core.spectrum.krylov_eigenpairs import KRYLOV, LowPairs
from idviewer.core.spectrum.ldl_factorization import LDLFactorization
from idviewer.core.spectrum.memory_estimate import available_bytes
from idviewer.core.steps import finish


@dataclass(frozen=True)
class OperatorSettings:
    """Settings: the bound below which an eigenvalue is zero, and the choice of the solver.

    Attributes:
        dense_unknowns: up to so many, or where k is over a third of them, the solver is a dense one.
        dense_matrices: (n, n), that it holds at once.
        null_share: eigenvalues up to this share of the matrix's norm are zero, as far as floats can tell.
        indefinite_share: negative eigenvalues of this share are none that rounding makes.
        most_factors: factorizations until a shift is found.
        most_spaces: Krylov spaces until no pair is missing.
    """

    dense_unknowns: int = 700
    dense_matrices: int = 3
    null_share: float = 1e3 * float(np.finfo(float).eps)
    indefinite_share: float = 1e6 * float(np.finfo(float).eps)
    most_factors: int = 16
    most_spaces: int = 200


OPERATOR = OperatorSettings()


def check_operator(laplacian: sparse.sparray, masses: Any, k: int) -> tuple[sparse.csc_array, Floats]:
    """L as a csc_array and the diagonal of M (n,), if they can have eigenpairs.

    Args:
        laplacian: L (n, n), sparse.
        masses: M, diagonal and sparse, or its diagonal (n,).
        k: how many pairs are asked for.

    Raises:
        ValueError: L is not square, real, finite and symmetric; M is not diagonal, positive and as large; k
            is not between 1 and n.

    >>> check_operator(sparse.eye_array(2), [1.0, 2.0], 1)[1].tolist()
    [1.0, 2.0]
    """
    if len(laplacian.shape) != 2 or laplacian.shape[0] != laplacian.shape[1]:
        raise ValueError(f"L must be square, and has the shape {laplacian.shape}")
    if np.iscomplexobj(laplacian):
        raise ValueError("L must be real; split complex unknowns into their two parts")
    matrix = sparse.csc_array(laplacian, dtype=np.float64, copy=True)
    matrix.sum_duplicates()
    matrix.eliminate_zeros()
    count = matrix.shape[0]
    if not np.isfinite(matrix.data).all():
        raise ValueError("L has entries that are not finite")
    largest = np.abs(matrix.data).max(initial=0.0)
    if np.abs((matrix - matrix.T).data).max(initial=0.0) > OPERATOR.null_share * largest:
        raise ValueError("L must be symmetric; take (L + L.T) / 2 if it is so but for rounding")
    if not (isinstance(k, int | np.integer) and 1 <= k <= count):
        raise ValueError(f"k must be a whole number from 1 to the {count} unknowns, not {k!r}")
    return matrix, _diagonal(masses, count)


def _diagonal(masses: Any, count: int) -> Floats:
    if sparse.issparse(masses):
        if masses.shape != (count, count):
            raise ValueError(f"M must have the shape {(count, count)} of L, not {masses.shape}")
        entries = sparse.coo_array(masses)
        if np.any(entries.data[entries.row != entries.col]):
            raise ValueError("M must be diagonal: lump the masses, M.sum(axis=1)")
        masses = masses.diagonal()
    diagonal = np.asarray(masses, dtype=np.float64)
    if diagonal.shape != (count,):
        raise ValueError(f"masses must have the shape ({count},) of L, not {diagonal.shape}")
    if not (np.isfinite(diagonal).all() and (diagonal > 0.0).all()):
        raise ValueError("masses must be positive and finite")
    return diagonal


def operator_pairs(
    laplacian: sparse.csc_array, masses: Floats, k: int, points: Floats | None = None
) -> LowPairs:
    """The k pairs with the smallest positive eigenvalues.

    Args:
        laplacian: L (n, n), symmetric and positive semi-definite.
        masses: (n,) the diagonal of M.
        k: how many.
        points: (n, d) where the unknowns are, if they are anywhere.

    Raises:
        ValueError: L has negative eigenvalues, or fewer than k positive ones.

    >>> path = sparse.diags_array([[1.0, 2.0, 1.0], [-1.0, -1.0], [-1.0, -1.0]], offsets=[0, 1, -1])
    >>> operator_pairs(sparse.csc_array(path), np.ones(3), 2).values.round(12).tolist()
    [1.0, 3.0]
    """
    roots = np.sqrt(masses)
    inverse = sparse.diags_array(1.0 / roots)
    matrix = sparse.csc_array(inverse @ laplacian @ inverse)
    null = _constants(laplacian, roots)
    if len(masses) <= OPERATOR.dense_unknowns or 3 * (k + null.shape[1]) > len(masses):
        pairs = _dense_pairs(matrix, k)
    else:
        places = graph_positions(matrix) if points is None else points
        pairs = _LowestPairs(matrix, places, null).pairs(k)
    return pairs._replace(vectors=np.ascontiguousarray(pairs.vectors / roots[:, None]))


def _constants(laplacian: sparse.csc_array, roots: Floats) -> Floats:
    """Orthonormal (n, d): the constant of each component on which L maps it to 0, times the roots."""
    count, component = csgraph.connected_components(laplacian, directed=False)
    sums, sizes = laplacian.sum(axis=1), abs(laplacian).sum(axis=1)
    vanishing = np.bincount(component, np.abs(sums) > OPERATOR.null_share * sizes, count) == 0
    column = np.cumsum(vanishing) - 1
    rows = np.flatnonzero(vanishing[component])
    need = 8.0 * len(roots) * float(vanishing.sum())
    if need > available_bytes():
        raise ValueError(
            f"L falls into {count:,} components, whose constants take about {bytes_in_words(need)}; "
            "take the components one by one"
        )
    null = np.zeros((len(roots), int(vanishing.sum())))
    null[rows, column[component[rows]]] = roots[rows]
    return null / np.linalg.norm(null, axis=0)


def _dense_pairs(matrix: sparse.csc_array, k: int) -> LowPairs:
    count = matrix.shape[0]
    need = OPERATOR.dense_matrices * 8.0 * count**2
    if need > available_bytes():
        raise ValueError(
            f"{k} of {count:,} eigenpairs take a dense solver and about {bytes_in_words(need)}; "
            f"ask for fewer than {count // 3:,}"
        )
    values, vectors = scipy.linalg.eigh(matrix.toarray(), check_finite=False)
    size = float(np.abs(values).max(initial=0.0))
    if values[0] < -OPERATOR.indefinite_share * size:
        raise _indefinite()
    first = int(np.searchsorted(values, OPERATOR.null_share * size, side="right"))
    if first + k > count:
        raise _too_few(k, count - first)
    bound = math.inf if first + k == count else float(values[first + k - 1])
    return LowPairs(values[first : first + k], vectors[:, first : first + k], 0.0, bound)


def _indefinite() -> ValueError:
    return ValueError("L has negative eigenvalues, and must have none; is its sign the other way round?")


def _too_few(k: int, there: int) -> ValueError:
    return ValueError(f"k = {k} pairs are asked for, and L has {there} positive eigenvalues")


class _LowestPairs:
    """Searches for the lowest pairs of A = M^-1/2 L M^-1/2, by Krylov spaces about one shift.

    Args:
        matrix: A (n, n).
        points: (n, d) where the unknowns are.
        null: (n, d) orthonormal vectors of its null space, as far as they are known.
    """

    def __init__(self, matrix: sparse.csc_array, points: Floats, null: Floats) -> None:
        self._matrix, self._points, self._null = matrix, points, null
        self._size = float(abs(matrix).sum(axis=0).max())
        self._values, self._vectors = np.empty(0), np.empty((len(points), 0))
        self._residual = 0.0
        try:
            self._factored(-OPERATOR.indefinite_share * self._size, definite=True)
        except np.linalg.LinAlgError:
            raise _indefinite() from None

    def _factored(self, shift: float, definite: bool = False) -> LDLFactorization:
        moved = sparse.csc_array(self._matrix - shift * sparse.eye_array(len(self._points)))
        return LDLFactorization(moved, self._points, definite)

    def pairs(self, k: int) -> LowPairs:
        """The k lowest above the null space."""
        shift, factor = self._interior_shift(k)
        missing = k
        for seed in range(OPERATOR.most_spaces):
            before = len(self._values) + self._null.shape[1]
            known = np.concatenate([self._null, self._vectors], axis=1)
            self._take(BlockLanczos(factor, shift, known, seed, stops=True), missing)
            found = len(self._values) + self._null.shape[1]
            missing = k - len(self._values) if len(self._values) < k else self._missing_below(k)
            if missing <= 0:
                bound = float(self._values[k - 1])
                return LowPairs(self._values[:k], self._vectors[:, :k], self._residual, bound)
            if found == before:
                break
        raise ValueError(f"the {k} lowest eigenpairs of L were not found; ask for another number of them")

    def _interior_shift(self, k: int) -> tuple[float, LDLFactorization]:
        """A shift with a quarter of the wanted eigenvalues below it or more, but not all."""
        low, high, known = 0.0, math.inf, self._null.shape[1]
        shift = 0.5 * k / len(self._points) * float(self._matrix.diagonal().mean())
        made = None
        for _ in range(OPERATOR.most_factors):
            try:
                factor = self._factored(shift)
            except np.linalg.LinAlgError:
                shift *= 1.01
                continue
            made, below = (shift, factor), factor.negative - known
            if below > k:
                high = shift
                shift *= max(0.05, 0.6 * k / below)
            elif 4 * below < k and high > 1.2 * shift:
                low = shift
                shift *= min(20.0, 0.6 * k / max(below, 0.5))
            else:
                break
            if not low < shift < high:
                shift = math.sqrt(low * high) if low > 0.0 else 0.1 * high
        if made is None:
            raise ValueError("L cannot be factored; are its entries of very different size?")
        return made

    def _take(self, krylov: BlockLanczos, wanted: int) -> None:
        """Adds the lowest converged pairs of a space that is made as large as the wanted ones need."""
        null, blocks = OPERATOR.null_share * self._size, 4 + math.ceil(1.5 * wanted / BLOCK)
        while True:
            for _ in range(min(blocks, krylov.remaining_blocks)):
                finish(krylov.expand())
                if krylov.exhausted:
                    break
            values, coefficients, residuals = krylov.ritz_pairs(null)
            last = np.append(np.flatnonzero(residuals >= KRYLOV.residual), len(values))[0]
            if last > wanted or krylov.remaining_blocks == 0:
                break
            blocks = max(1, krylov.size // (8 * BLOCK))
        chosen = (
            np.flatnonzero(residuals < KRYLOV.residual)
            if krylov.exhausted
            else np.arange(min(last, wanted + 1))
        )
        vectors = krylov.vectors(coefficients[:, chosen])
        zero = values[chosen] <= null
        self._null = np.concatenate([self._null, vectors[:, zero]], axis=1)
        self._residual = max(self._residual, float(residuals[chosen[~zero]].max(initial=0.0)))
        all_values = np.concatenate([self._values, values[chosen[~zero]]])
        order = np.argsort(all_values, kind="stable")
        self._values = all_values[order]
        self._vectors = np.concatenate([self._vectors, vectors[:, ~zero]], axis=1)[:, order]

    def _missing_below(self, k: int) -> int:
        """Count the eigenvalues below the k-th found that have not been found, by the inertia."""
        for step in (1.0, 2.0, 3.0):
            bound = float(self._values[k - 1]) * (1.0 - step * 1e-6)
            try:
                factor = self._factored(bound)
            except np.linalg.LinAlgError:
                continue
            return factor.negative - self._null.shape[1] - int(np.searchsorted(self._values, bound))
        return 0
