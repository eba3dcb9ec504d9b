"""The paper's equations 2, 4 and 5: other routes to the interior distance than eq. 1, |p* - q*|.

Each is there for rows of weights, and for points inside the shape of an `InteriorDistance`. Rows that are
NaN, of points outside, give NaN. Source: Rustamov, Lipman and Funkhouser 2009, section 4.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Floats, as_pairs
from idviewer.core.interior.solver import InteriorDistance


def gram_distance(solver: InteriorDistance, p: ArrayLike, q: ArrayLike) -> Floats:
    """Interior distance by eq. 2, the quadratic form of w(p) - w(q) with the Gram matrix A = Y Y^T.

    The same number as `InteriorDistance.distance` by another route. A is applied, never formed.

    Args:
        solver: of the interior distance.
        p, q: (p, dimension) or (1, dimension).

    Returns:
        (p,), NaN where a point is outside the shape.

    Raises:
        ValueError: the points have another dimension, or there are not as many of both.

    >>> from idviewer.core import Euclidean, Polygon
    >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
    >>> gram_distance(solver, [[1, 1]], [[3, 1]]).round(12).tolist()
    [2.0]
    """
    first, second = map(solver.coordinates.weights, as_pairs(p, q, solver.shape.dimension))
    return by_gram(first - second, solver.boundary.embedding)


def pairwise_distance(
    solver: InteriorDistance,
    p: ArrayLike,
    q: ArrayLike,
    squares: Floats | None = None,
    expanded: bool = False,
) -> Floats:
    """Interior distance by eq. 4, or eq. 5, from the distances between the vertices and no embedding.

    Args:
        solver: of the interior distance.
        p, q: (p, dimension) or (1, dimension).
        squares: (n, n) squared distances between the vertices; those of the solver's boundary by default.
        expanded: eq. 5, the sums written out, instead of eq. 4.

    Returns:
        (p,), NaN where a point is outside the shape, 0 where squares of what does not embed are negative.

    Raises:
        ValueError: the points have another dimension, or there are not as many of both.

    >>> from idviewer.core import Euclidean, Polygon
    >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
    >>> pairwise_distance(solver, [[1, 1]], [[3, 1]]).round(12).tolist()
    [2.0]
    """
    squares = solver.boundary.squares() if squares is None else squares
    first, second = map(solver.coordinates.weights, as_pairs(p, q, solver.shape.dimension))
    if expanded:
        first, second = np.broadcast_arrays(first, second)
        return by_expansion(first, second, squares)
    return by_squares(first - second, squares)


def by_gram(differences: Floats, columns: Floats) -> Floats:
    """Eq. 2: sqrt(z^T A z) of each row z = w(p) - w(q) of (p, n), with A = Y Y^T applied, never formed.

    Source: Rustamov, Lipman and Funkhouser 2009, eq. 2.

    Args:
        differences: (p, n).
        columns: Y (n, k), the embedding.

    >>> by_gram(np.array([[1.0, -1.0]]), np.array([[0.0], [2.0]])).tolist()
    [2.0]
    """
    applied = (differences @ columns) @ columns.T
    return np.sqrt(np.maximum(np.einsum("pn,pn->p", differences, applied), 0.0))


def by_squares(differences: Floats, squares: Floats) -> Floats:
    """Eq. 4: sqrt(-z^T D z / 2) of each row z = w(p) - w(q) of (p, n).

    Source: Rustamov, Lipman and Funkhouser 2009, eq. 4.

    Args:
        differences: (p, n).
        squares: D (n, n), squared distances.

    >>> by_squares(np.array([[1.0, -1.0]]), np.array([[0.0, 4.0], [4.0, 0.0]])).tolist()
    [2.0]
    """
    return _root(-0.5 * np.einsum("pn,pn->p", differences @ squares, differences))


def by_expansion(first: Floats, second: Floats, squares: Floats) -> Floats:
    """Eq. 5: the mean squared distance between two points' weights, less what p = q would leave.

    Source: Rustamov, Lipman and Funkhouser 2009, eq. 5.

    Args:
        first, second: (p, n) weights of two points a row.
        squares: D (n, n), squared distances.

    >>> squares = np.array([[0.0, 4.0], [4.0, 0.0]])
    >>> by_expansion(np.array([[1.0, 0.0]]), np.array([[0.0, 1.0]]), squares).tolist()
    [2.0]
    """
    applied, beyond = first @ squares, second @ squares
    between = np.einsum("pn,pn->p", applied, second)
    within = np.einsum("pn,pn->p", applied, first) + np.einsum("pn,pn->p", beyond, second)
    return _root(between - 0.5 * within)


def _root(squares: Floats) -> Floats:
    # Below 0 by rounding, or because the distances do not embed.
    return np.sqrt(np.maximum(squares, 0.0))
