"""How many threads small problems use: one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from functools import cache

from threadpoolctl import ThreadpoolController

from idviewer.core._kernels.simd.threads import use_threads

FEW_OF_A_PRODUCT = 2000
"""Vertices of a shape up to which BLAS had better use one thread."""

FEW_OF_A_KERNEL = 500
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
    products = small_products() if vertices <= FEW_OF_A_PRODUCT else nullcontext()
    kernels = _small_kernels() if facets <= FEW_OF_A_KERNEL else nullcontext()
    with products, kernels:
        yield


@contextmanager
def small_products() -> Iterator[None]:
    """Within it BLAS uses one thread: products of the weights of some points with a basis are small tasks."""
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
