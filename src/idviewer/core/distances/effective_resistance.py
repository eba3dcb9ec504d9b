"""Effective resistances z^T L^+ z of a boundary's Laplacian: by sparse solves, or as a dense embedding.

For z with the sum 0, z^T L^+ z = z'^T G^-1 z', where ' drops one vertex and the grounded Laplacian G is L
without its row and column: G is positive definite, and any solution of L x = z gives the same z^T x. See
docs/distances.md. Source: Klein and Randic 1993, "Resistance distance".
"""

from __future__ import annotations

from collections.abc import Generator
from functools import cached_property

import numpy as np
import scipy.linalg
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

from idviewer.core.arrays import Floats
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.laplacian import laplacian_of
from idviewer.core.steps import beside

SIDES_PER_SOLVE = 4
"""Right-hand sides between two checkpoints; SuperLU takes longer for each of them from eight on."""

COLUMNS_PER_STEP = 96
"""Columns of the inverse factor between two checkpoints."""


class EffectiveResistance:
    """z^T L^+ z by one sparse factorisation of the grounded Laplacian and a solve for each z.

    Args:
        shape: n vertices.

    >>> import numpy as np
    >>> from idviewer.core import Mesh
    >>> from idviewer.core.steps import finish
    >>> tetrahedron = Mesh([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]],
    ...                    [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    >>> between_vertices = EffectiveResistance(tetrahedron).squares_steps(np.array([[1.0, -1.0, 0.0, 0.0]]))
    >>> finish(between_vertices).round(12).tolist()
    [0.866025403784]
    """

    def __init__(self, shape: Shape) -> None:
        self._shape = shape

    @cached_property
    def _factor(self) -> SuperLU:
        grounded = sparse.csc_array(laplacian_of(self._shape)[1:, 1:])
        options = {"SymmetricMode": True}
        return splu(grounded, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)

    def squares_steps(self, differences: Floats) -> Generator[float, None, Floats]:
        """z^T L^+ z of each row z.

        Args:
            differences: (p, n) rows whose sum is 0; a row with NaN gives NaN.

        Returns:
            (p,), without unit: neither depends on the shape's size.
        """
        result = np.full(len(differences), np.nan)
        known = np.flatnonzero(np.isfinite(differences).all(axis=1))
        for start in range(0, len(known), SIDES_PER_SOLVE):
            some = known[start : start + SIDES_PER_SOLVE]
            sides = np.ascontiguousarray(differences[some, 1:].T)
            result[some] = np.einsum("np,np->p", sides, self._factor.solve(sides))
            yield (start + len(some)) / len(known)
        return result


def commute_embedding_steps(shape: Shape) -> Generator[float | None, None, Floats]:
    """Embed vertices so that squared distances are effective resistances; yields the share done, or None.

    With G = C C^T (Cholesky) the rows are the columns of C^-1, and 0 for the vertex that is left out.

    Args:
        shape: n vertices; it takes 8 n^2 bytes.

    Returns:
        (n, n - 1) one row a vertex.

    >>> from idviewer.core import Polygon
    >>> from idviewer.core.steps import finish
    >>> rows = finish(commute_embedding_steps(Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])))
    >>> (np.linalg.norm(rows - rows[0], axis=1) ** 2).round(12).tolist()
    [0.0, 0.75, 1.0, 0.75]
    """
    grounded = laplacian_of(shape)[1:, 1:].toarray()
    lower = yield from beside(lambda: np.linalg.cholesky(grounded))
    count = len(lower)
    rows = np.zeros((count + 1, count))
    for start in range(0, count, COLUMNS_PER_STEP):
        width = min(COLUMNS_PER_STEP, count - start)
        sides = np.eye(count - start, width)
        below = lower[start:, start:]
        rows[1 + start : 1 + start + width, start:] = scipy.linalg.solve_triangular(
            below, sides, lower=True
        ).T
        yield 0.3 + 0.7 * (start + width) / count
    return rows
