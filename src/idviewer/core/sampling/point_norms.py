"""Distances from the images of many points to one, quickly for one such point after another."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats

Singles = NDArray[np.float32]

CANCELLATION_SHARE = 1e-3
"""Squared distances below this share of the terms they are the difference of are computed directly."""

MEAN_STRIDE = 16
"""The mean of one row in so many is near enough to the mean of all."""

SINGLE_PRECISION_SHARE = 1e-5
"""Share of the largest term that rounding to single precision may cost; ten times what it does."""

PRODUCT_NUMBERS = 8192
"""So few that BLAS does not hand them to threads, which wait for each other wherever a core is taken."""

ROWS_PER_BLOCK = 2048
"""Small enough for the scaled rows to stay in the processor's cache."""


class PointNorms:
    """Rows of a basis whose images, rows * scale, are measured from one point after another.

    What does not depend on that point is kept, so that another one costs a single product.

    Args:
        rows: (p, k).

    >>> PointNorms(np.array([[3.0, 2.0]])).distances(np.array([1.0, 2.0])).tolist()
    [5.0]
    """

    def __init__(self, rows: Floats) -> None:
        self.rows = rows
        self._scale: Floats | None = None
        self._mean = self._squares = np.empty(0)

    def distances(self, scale: Floats, origin: Floats | float = 0.0) -> Floats:
        """|row * scale - origin| of each row, (p,), exact to rounding.

        Args:
            scale: (k,).
            origin: (k,).
        """
        if len(self.rows) == 0:
            return np.empty(0)
        if self._scale is None or not np.array_equal(self._scale, scale):
            self._scale, self._mean = scale.copy(), self.rows[::MEAN_STRIDE].mean(axis=0) * scale
            self._squares = squares_of(self.rows, scale, self._mean)
        off = origin - self._mean
        square = float(off @ off)
        # |x - m - off|^2 with the mean m taken out of the product.
        result = product(self.rows, -2.0 * scale * off)
        result += self._squares
        result += square + 2.0 * float(self._mean @ off)
        near = np.flatnonzero(result < CANCELLATION_SHARE * (square + self._squares.max()))
        result[near] = squares_of(self.rows[near], scale, origin)
        return np.sqrt(result)


class MaxNorm:
    """Rows of a basis of which only the one whose image is farthest is asked for.

    Candidates are found in single precision, their distances computed in double.

    Args:
        rows: (p, k).

    >>> MaxNorm(np.array([[3.0, 2.0], [1.0, 1.0]])).farthest(np.array([1.0, 2.0]))
    5.0
    """

    def __init__(self, rows: Floats) -> None:
        self._rows = rows
        self._singles: Singles = rows.astype(np.float32)
        self._scale: Floats | None = None
        self._squares: Singles = np.empty(0, dtype=np.float32)
        self._last: tuple[bytes, float] | None = None

    def farthest(self, scale: Floats, origin: Floats | float = 0.0) -> float:
        """The largest distance |row * scale - origin| of all rows.

        Args:
            scale: (k,).
            origin: (k,), or 0.
        """
        key = np.concatenate([scale, np.atleast_1d(origin)]).tobytes()
        if self._last is None or self._last[0] != key:
            squares = self._squared(scale)
            apart = squares - 2.0 * product(self._singles, scale * origin)
            candidates = np.flatnonzero(apart >= apart.max() - SINGLE_PRECISION_SHARE * squares.max())
            largest = squares_of(self._rows[candidates], scale, origin).max()
            self._last = key, float(np.sqrt(largest))
        return self._last[1]

    def _squared(self, scale: Floats) -> Singles:
        if self._scale is None or not np.array_equal(self._scale, scale):
            starts = range(0, len(self._singles), ROWS_PER_BLOCK)
            chunks = (self._singles[start : start + ROWS_PER_BLOCK] for start in starts)
            self._squares = np.concatenate([product(chunk**2, scale**2) for chunk in chunks])
            self._scale = scale.copy()
        return self._squares


def product(rows: NDArray[Any], vector: Floats) -> NDArray[Any]:
    """rows (p, k) @ vector (k,) or (1,), in the precision of the rows.

    >>> product(np.arange(6.0).reshape(2, 3), np.array([1.0, 0.0, 1.0])).tolist()
    [2.0, 8.0]
    """
    vector = np.broadcast_to(vector, rows.shape[1:]).astype(rows.dtype)
    step = max(1, PRODUCT_NUMBERS // rows.shape[1])
    whole = len(rows) // step * step
    result = np.empty(len(rows), dtype=rows.dtype)
    result[:whole] = (rows[:whole].reshape(-1, step, rows.shape[1]) @ vector).ravel()
    result[whole:] = rows[whole:] @ vector
    return result


def squares_of(rows: Floats, scale: Floats, origin: Floats | float) -> Floats:
    """Squared distances |row * scale - origin|^2 of each row, (p,).

    Args:
        rows: (p, k).
        scale: (k,).
        origin: (k,), or 0.

    >>> squares_of(np.array([[3.0, 2.0]]), np.array([1.0, 2.0]), 0.0).tolist()
    [25.0]
    """
    result = np.empty(len(rows))
    for start in range(0, len(rows), ROWS_PER_BLOCK):
        chunk = rows[start : start + ROWS_PER_BLOCK] * scale
        chunk -= origin
        result[start : start + ROWS_PER_BLOCK] = np.einsum("pk,pk->p", chunk, chunk)
    return result
