"""How many threads small problems use: one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from threadpoolctl import ThreadpoolController

from idviewer.core._kernels.threads import use_threads
from idviewer.core.shape import Shape

FEW_OF_A_PRODUCT = 2000
"""Vertices of a shape up to which BLAS had better use one thread."""

FEW_OF_A_KERNEL = 500
"""Facets of a shape up to which kernels had better do so too."""


@contextmanager
def few_threads(shape: Shape) -> Iterator[None]:
    """Within it, what is computed in this thread uses one thread where the shape is small.

    Threads that share a small task wait for each other by turning in a loop. Wherever another program has a
    core, that lasts until the system gives it back: some milliseconds, ten times as long as the task.

    >>> from idviewer.core import Polygon
    >>> with few_threads(Polygon([[0, 0], [1, 0], [0, 1]])):
    ...     before = use_threads(1)
    >>> before
    1
    """
    if len(shape.vertices) > FEW_OF_A_PRODUCT:
        yield
        return
    small = len(shape.facets) <= FEW_OF_A_KERNEL
    with _libraries().limit(limits=1, user_api="blas"):
        before = use_threads(1) if small else 0
        try:
            yield
        finally:
            if small:
                use_threads(before)


@cache
def _libraries() -> ThreadpoolController:
    return ThreadpoolController()
