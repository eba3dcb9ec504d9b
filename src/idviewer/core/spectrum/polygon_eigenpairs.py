"""Eigenpairs of a polygon's boundary from its resistances, accurate however unequal the edges are."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import scipy.linalg

from idviewer.core.arrays import Floats
from idviewer.core.shapes.polygon import Polygon

FIRST_PAIRS = 32
"""Eigenpairs computed at first; the paper's cut-off keeps some 20 of a loop, however fine it is."""

RESOLVED_SHARE = 1e-13
"""Eigenvalues above the lowest one over this are lost in rounding, and left out."""


def low_pairs(
    polygon: Polygon, masses: Floats, cutoff: Callable[[float], float]
) -> tuple[Floats, Floats, float]:
    """All eigenpairs L phi = lambda M phi with 0 < lambda < cutoff(lambda_2), by a dense solver.

    L phi = lambda M phi is solved as G M phi = phi / lambda with Green's function G, which has a closed form:
    -1/2 times the resistances, freed of constants. The low eigenvalues are then the large ones, and exact to
    rounding also where two vertices almost meet; in L itself they would drown in 1 / d.

    Args:
        polygon: n vertices.
        masses: (n,) diagonal of M, lengths.
        cutoff: from lambda_2, the first non-zero eigenvalue, to the largest that counts.

    Returns:
        values (k,) ascending, vectors (n, k) with vectors^T M vectors = 1, and the bound below which none
        is missing, infinite if there are no others.
    """
    roots, green = np.sqrt(masses), _green(polygon.resistances(), masses / masses.sum())
    matrix, most = roots[:, None] * green * roots, len(masses) - 1
    wanted = min(FIRST_PAIRS, most)
    while True:
        inverses, vectors = _largest(matrix, wanted)
        inverses, vectors = inverses[::-1], vectors[:, ::-1]
        resolved = int(np.count_nonzero(inverses > RESOLVED_SHARE * inverses[0]))
        values = 1.0 / inverses[:resolved]
        bound = cutoff(float(values[0]))
        kept = int(np.searchsorted(values, bound))
        if kept < wanted or wanted == most:
            break
        wanted = min(4 * wanted, most)
    if kept == most:
        bound = math.inf
    elif kept == resolved:
        bound = float(values[-1])
    return values[:kept], np.ascontiguousarray(vectors[:, :kept] / roots[:, None]), bound


def _green(resistances: Floats, shares: Floats) -> Floats:
    """-1/2 (I - 1 s^T) R (I - s 1^T): the inverse of L on what has no mean, with masses' shares s (n,)."""
    means = resistances @ shares
    return -0.5 * (resistances - means[:, None] - means + shares @ means)


def _largest(matrix: Floats, count: int) -> tuple[Floats, Floats]:
    """The largest eigenvalues, ascending, and their vectors."""
    size = len(matrix)
    if 3 * count > size:
        values, vectors = scipy.linalg.eigh(matrix, driver="evd", check_finite=False)
        return values[size - count :], vectors[:, size - count :]
    values, vectors = scipy.linalg.eigh(matrix, subset_by_index=(size - count, size - 1), check_finite=False)
    return values, vectors
