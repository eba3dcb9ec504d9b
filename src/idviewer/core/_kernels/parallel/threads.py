"""The number of threads that parallel kernels use."""

from __future__ import annotations

import numba


def use_threads(count: int) -> int:
    """Have kernels that this thread calls use so many threads; returns how many they used before.

    >>> before = use_threads(1)
    >>> use_threads(before)
    1
    """
    before = int(numba.get_num_threads())
    numba.set_num_threads(count)
    return before
