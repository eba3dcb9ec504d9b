"""The paper's equations 1 to 5 for rows of weights: what does not depend on how distances embed.

Rows that are NaN, of points outside, give NaN.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable
from typing import TYPE_CHECKING

import numpy as np

from idviewer.core.arrays import Floats

if TYPE_CHECKING:
    from idviewer.core.distances import QuadraticForm


ENOUGH = 5000
"""So many of a shape's vertices tell how far the farthest two are apart; a little less is the safe side."""


def by_gram(differences: Floats, columns: Floats) -> Floats:
    """Eq. 2: sqrt(z^T A z) of each row z = w(p) - w(q) of (p, n), with A = Y Y^T applied, never formed.

    Args:
        differences: (p, n).
        columns: Y (n, k), the embedding.
    """
    applied = (differences @ columns) @ columns.T
    return np.sqrt(np.maximum(np.einsum("pn,pn->p", differences, applied), 0.0))


def by_form_steps(differences: Iterable[Floats], form: QuadraticForm) -> Generator[float, None, Floats]:
    """Eq. 2 of portions of rows z (p, n), by a form that knows z^T A z; (all p,).

    Yields the share done of each portion, every few milliseconds.
    """
    squares = [np.empty(0)]
    for part in differences:
        squares.append((yield from form.squares_steps(part)))
    return _root(np.concatenate(squares))


def by_squares(differences: Floats, squares: Floats) -> Floats:
    """Eq. 4: sqrt(-z^T D z / 2) of each row z = w(p) - w(q) of (p, n).

    Args:
        differences: (p, n).
        squares: D (n, n), squared distances.

    >>> by_squares(np.array([[1.0, -1.0]]), np.array([[0.0, 4.0], [4.0, 0.0]])).tolist()
    [2.0]
    """
    return _root(-0.5 * np.einsum("pn,pn->p", differences @ squares, differences))


def by_expansion(first: Floats, second: Floats, squares: Floats) -> Floats:
    """Eq. 5: the mean squared distance between two points' weights, less what p = q would leave.

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


def squares_of(embedding: Floats) -> Floats:
    """D (n, n), the squared distances between the rows of an embedding (n, k).

    >>> squares_of(np.array([[0.0], [3.0]])).tolist()
    [[0.0, 9.0], [9.0, 0.0]]
    """
    centred = embedding - embedding.mean(axis=0)
    norms = np.einsum("nk,nk->n", centred, centred)
    result = np.maximum(norms[:, None] + norms - 2.0 * (centred @ centred.T), 0.0)
    np.fill_diagonal(result, 0.0)
    return result


def extent(points: Floats) -> float:
    """Nearly the largest distance between two of the points (p, k), never more.

    >>> extent(np.array([[0.0], [1.0], [3.0]]))
    3.0
    """
    farthest = points.mean(axis=0)
    for _ in range(3):
        distances = np.linalg.norm(points - farthest, axis=1)
        farthest = points[np.argmax(distances)]
    return float(distances.max())


def column_weights(basis: Floats, scales: Iterable[Floats]) -> Floats:
    """What an error of each column of a basis (n, k) counts, (k,), in largest distances between its points.

    Args:
        basis: before it is scaled.
        scales: (k,) for each of the distances; the one counts with which an error is largest.

    >>> column_weights(np.array([[0.0, 0.0], [4.0, 1.0]]), [np.array([1.0, 0.0])]).tolist()
    [0.25, 0.0]
    """
    some = basis[:: max(1, len(basis) // ENOUGH)]
    return np.max([np.abs(scale) / extent(some * scale) for scale in scales], axis=0)
