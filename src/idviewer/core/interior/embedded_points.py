"""Embedded points: squared distances between them, how far they reach, and what errors of columns count."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from idviewer.core.arrays import Floats

EXTENT_VERTICES = 5000
"""Vertices of a shape that its extent is taken from; a little less is the safe side."""


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
    """Weights (k,) of errors of a basis's columns (n, k), in largest distances between its points.

    Args:
        basis: before it is scaled.
        scales: (k,) for each of the distances; the one counts with which an error is largest.

    >>> column_weights(np.array([[0.0, 0.0], [4.0, 1.0]]), [np.array([1.0, 0.0])]).tolist()
    [0.25, 0.0]
    """
    some = basis[:: max(1, len(basis) // EXTENT_VERTICES)]
    return np.max([np.abs(scale) / extent(some * scale) for scale in scales], axis=0)
