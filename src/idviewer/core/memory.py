"""Memory: amounts of it in words, and giving back what is free within the process."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from functools import cache


def bytes_in_words(count: float) -> str:
    """A number of bytes with its unit, to two digits.

    >>> bytes_in_words(1.93e11), bytes_in_words(4.21e9), bytes_in_words(17e6), bytes_in_words(4096)
    ('190 GB', '4.2 GB', '17 MB', '4.1 KB')
    """
    power = min(3, max(1, math.floor(math.log10(max(count, 1.0) * 1.005) / 3)))
    rounded = float(f"{count / 1e3**power:.2g}")
    name = ("KB", "MB", "GB")[power - 1]
    return f"{rounded:.0f} {name}" if rounded >= 10 else f"{rounded:g} {name}"


def release_free_memory() -> None:
    """Give back to the system what large results left behind, where the C library can (glibc).

    It takes some milliseconds. Threads have heaps of their own, which shrink only from their ends.
    """
    _trim()(0)


@cache
def _trim() -> Callable[[int], int]:
    try:
        return ctypes.CDLL(None).malloc_trim
    except (AttributeError, OSError, TypeError):
        return lambda _kept: 0
