"""Memory that is free within the process goes back to the system."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache


def release_free_memory() -> None:
    """Returns what large results left behind, where the C library can (glibc); takes some milliseconds.

    Threads have heaps of their own, which shrink by themselves only from their ends.
    """
    _trim()(0)


@cache
def _trim() -> Callable[[int], int]:
    try:
        return ctypes.CDLL(None).malloc_trim
    except (AttributeError, OSError, TypeError):
        return lambda _kept: 0
