"""Long work as generators: they yield every few milliseconds and return their result at the end."""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator
from concurrent.futures import Future, wait
from typing import Any, TypeVar

Result = TypeVar("Result")


def finish(steps: Generator[Any, None, Result]) -> Result:
    """Run a generator to its end without interruption and return its result.

    >>> def count():
    ...     yield 0.5
    ...     return 42
    >>> finish(count())
    42
    """
    while True:
        try:
            next(steps)
        except StopIteration as stop:
            return stop.value


def without_shares(steps: Generator[Any, None, Result]) -> Generator[None, None, Result]:
    """Work that is a small part of something else: its checkpoints, but not the share of it that is done.

    >>> list(without_shares(share for share in (0.5, 1.0)))
    [None, None]
    """
    while True:
        try:
            next(steps)
        except StopIteration as stop:
            return stop.value
        yield


CHECKPOINT = 0.005
"""Seconds between two checkpoints while something works beside."""


def beside(call: Callable[[], Result]) -> Generator[None, None, Result]:
    """One long call of a routine that lets go of Python's lock (LAPACK's), with checkpoints while it works.

    Closed before its end, it leaves the routine to itself: there is no stopping it, and nobody takes what it
    returns.

    >>> finish(beside(lambda: 6 * 7))
    42
    """
    outcome: Future[Result] = Future()

    def work() -> None:
        try:
            outcome.set_result(call())
        except BaseException as error:
            outcome.set_exception(error)

    threading.Thread(target=work, daemon=True, name="idviewer-lapack").start()
    while not wait([outcome], CHECKPOINT).done:
        yield
    return outcome.result()
