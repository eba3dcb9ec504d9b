"""Threads of small problems: one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from functools import cache

from threadpoolctl import ThreadpoolController

from idviewer.core._kernels.parallel.threads import use_threads

SINGLE_THREAD_VERTICES = 2000
"""Vertices of a shape up to which BLAS had better use one thread."""

SINGLE_THREAD_FACETS = 500
"""Facets of a shape up to which kernels had better do so too."""


@contextmanager
def few_threads(vertices: int, facets: int) -> Iterator[None]:
    """Within it, what is computed in this thread uses one thread where the shape is small.

    Threads that share a small task wait for each other by turning in a loop. Wherever another program has a
    core, that lasts until the system gives it back: some milliseconds, ten times as long as the task.

    Args:
        vertices: how many the shape has.
        facets: how many triangles, or edges of a polygon.

    >>> with few_threads(vertices=3, facets=3):
    ...     before = use_threads(1)
    >>> before
    1
    """
    products = small_products() if vertices <= SINGLE_THREAD_VERTICES else nullcontext()
    kernels = _small_kernels() if facets <= SINGLE_THREAD_FACETS else nullcontext()
    with products, kernels:
        yield


@contextmanager
def small_products() -> Iterator[None]:
    """Within it BLAS uses one thread: products of the weights of some points with a basis are small tasks.

    >>> import numpy as np
    >>> with small_products():
    ...     product = np.ones((2, 3)) @ np.ones(3)
    >>> product.tolist()
    [3.0, 3.0]
    """
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@contextmanager
def _small_kernels() -> Iterator[None]:
    before = use_threads(1)
    try:
        yield
    finally:
        use_threads(before)


@cache
def _libraries() -> ThreadpoolController:
    return ThreadpoolController()
