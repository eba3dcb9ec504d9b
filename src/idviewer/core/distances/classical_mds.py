"""Classical and landmark multidimensional scaling (MDS): from distances to an embedding of the vertices."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.errors import DistanceError
from idviewer.core.steps import beside

EIGENVALUE_ROUNDING = 1e-10
"""Eigenvalues smaller than this share of the largest are rounding; the input's own is a few eps n."""


@dataclass(frozen=True, eq=False)
class MDSEmbedding:
    """An embedding, and how far the distances are from having one.

    Attributes:
        embedding: (n, k), k the number of positive eigenvalues of the Gram matrix.
        discarded: sum of |negative eigenvalues| over the sum of |eigenvalues|; 0 where distances embed.
        most_negative: the most negative eigenvalue as a share of the largest, at most 0.
    """

    embedding: Floats
    discarded: float
    most_negative: float


def double_centred(squares: Floats) -> Floats:
    """The Gram matrix A = -J D J / 2 with J = I - 1 1^T / n; eq. 3 of the paper.

    Args:
        squares: D (n, n), squared distances.

    Returns:
        (n, n), symmetric.

    >>> double_centred(np.array([[0.0, 4.0], [4.0, 0.0]])).tolist()
    [[1.0, -1.0], [-1.0, 1.0]]
    """
    rows = squares.mean(axis=0)
    return -0.5 * (squares - rows - rows[:, None] + rows.mean())


def classical_mds_steps(squares: Floats) -> Generator[None, None, MDSEmbedding]:
    """Embed vertices by classical MDS: the positive part of the Gram matrix, decomposed.

    Source: Torgerson 1952; Rustamov et al. 2009, section 4, eq. 3.

    Args:
        squares: D (n, n), squared distances.

    Raises:
        DistanceError: all distances are 0.

    >>> from idviewer.core.steps import finish
    >>> line = np.array([[0.0, 1.0, 9.0], [1.0, 0.0, 4.0], [9.0, 4.0, 0.0]])
    >>> embedding = finish(classical_mds_steps(line)).embedding
    >>> np.abs(np.diff(embedding[:, 0])).round(9).tolist()
    [1.0, 2.0]
    """
    return (yield from landmark_mds_steps(squares, np.arange(len(squares))))


def landmark_mds_steps(
    squares: Floats, landmarks: Ints, negligible: float = EIGENVALUE_ROUNDING
) -> Generator[None, None, MDSEmbedding]:
    """Embed landmarks by classical MDS, and place the other vertices by their distances to them.

    A vertex with the squared distances delta to the landmarks gets the coordinates
    -v_i^T (delta - mean delta) / (2 sqrt(lambda_i)), (lambda_i, v_i) the eigenpairs of the landmarks' Gram
    matrix: for a landmark, its own. Source: de Silva and Tenenbaum 2004, "Sparse multidimensional scaling
    using landmark points", section 2.2.

    Args:
        squares: (n, l) squared distances of each vertex to each landmark.
        landmarks: (l,) their indices.
        negligible: eigenvalues up to such a share of the largest count as none.

    Raises:
        DistanceError: all distances between landmarks are 0.

    >>> from idviewer.core.steps import finish
    >>> squares = np.subtract.outer([0.0, 1.0, 3.0], [0.0, 1.0]) ** 2
    >>> placed = finish(landmark_mds_steps(squares, np.array([0, 1]))).embedding
    >>> np.abs(np.diff(placed[:, 0])).round(9).tolist()
    [1.0, 2.0]
    """
    between_landmarks = squares[landmarks]
    gram = double_centred(0.5 * (between_landmarks + between_landmarks.T))
    values, vectors = yield from beside(lambda: np.linalg.eigh(gram))
    largest = float(values[-1])
    if not largest > 0.0:
        raise DistanceError("all distances are 0: there is nothing to embed")
    kept = np.flatnonzero(values > negligible * largest)[::-1]
    projection = vectors[:, kept] * (-0.5 / np.sqrt(values[kept]))
    yield
    embedding = (squares - between_landmarks.mean(axis=0)) @ projection
    # What lies below rounding is neither kept nor counted as left out.
    negative = -values[values < -EIGENVALUE_ROUNDING * largest].sum()
    discarded = float(negative / np.abs(values).sum())
    return MDSEmbedding(embedding, discarded, min(0.0, float(values[0]) / largest))
