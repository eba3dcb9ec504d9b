"""How many threads multiply matrices."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from threadpoolctl import ThreadpoolController

from idviewer.core import Shape

FEW = 2000
"""Vertices of a shape whose matrices are so small that threads cost more than they save."""


@contextmanager
def one_thread(shape: Shape) -> Iterator[None]:
    """Has BLAS use one thread where a shape is small.

    Its threads wait for each other by turning in a loop: wherever a core is taken, by numba's threads or by
    another program, products of some hundred numbers take ten times as long with two threads as with one.
    """
    if len(shape.vertices) > FEW:
        yield
        return
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@cache
def _libraries() -> ThreadpoolController:
    return ThreadpoolController()
