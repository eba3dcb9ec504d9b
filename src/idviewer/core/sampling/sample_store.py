"""Rows that were sampled, found again by the numbers of their points."""

from __future__ import annotations

import numpy as np

from idviewer.core.arrays import Bools, Floats, Ints


class SampleStore:
    """Rows sampled at points of a plane within one tolerance, by the points' keys.

    Args:
        rtol: the tolerance.
        columns: of a row.

    >>> kept = SampleStore(0.0, 1)
    >>> kept.add(np.array([7, 3]), np.array([[0.7], [0.3]]))
    >>> kept.rows(np.array([3, 7])).ravel().tolist(), kept.has(np.array([3, 4])).tolist()
    ([0.3, 0.7], [True, False])
    """

    def __init__(self, rtol: float, columns: int) -> None:
        self.rtol = rtol
        self._keys: Ints = np.empty(0, dtype=np.int64)
        self._order: Ints = np.empty(0, dtype=np.int64)
        self._rows: Floats = np.empty((0, columns))

    def has(self, keys: Ints) -> Bools:
        """Tell which of keys (p,) are known, (p,)."""
        return np.isin(keys, self._keys)

    def add(self, keys: Ints, rows: Floats) -> None:
        """Keep rows (p, k) of new keys (p,)."""
        order = np.concatenate([self._order, np.arange(len(self._rows), len(self._rows) + len(rows))])
        keys = np.concatenate([self._keys, keys])
        ascending = np.argsort(keys, kind="stable")
        self._keys, self._order = keys[ascending], order[ascending]
        self._rows = np.concatenate([self._rows, rows])

    def numbers(self, keys: Ints) -> Ints:
        """Numbers (p,) of the points with known keys (p,), in the order in which they were added."""
        return self._order[np.searchsorted(self._keys, keys)]

    def rows(self, keys: Ints) -> Floats:
        """The rows (p, k) of known keys (p,)."""
        return self._rows[self.numbers(keys)]
