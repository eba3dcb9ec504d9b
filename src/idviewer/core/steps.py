"""Long work as generators: they yield every few milliseconds and return their result at the end."""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator, Hashable
from concurrent.futures import Future, wait
from contextlib import closing
from time import perf_counter
from typing import Any, Generic, TypeVar

Result = TypeVar("Result")
Item = TypeVar("Item")
Other = TypeVar("Other")


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


def map_steps(
    change: Callable[[Item], Other], steps: Generator[Item, None, Result]
) -> Generator[Other, None, Result]:
    """Run steps as `yield from` does, but yield what a function makes of each item.

    Args:
        change: applied to each item.
        steps: the generator to run; closed at the end, and returned from.

    >>> list(map_steps(lambda share: f"{share:.0%}", (share for share in (0.5, 1.0))))
    ['50%', '100%']
    """
    with closing(steps):
        while True:
            try:
                item = next(steps)
            except StopIteration as stop:
                return stop.value
            yield change(item)


def without_shares(steps: Generator[Any, None, Result]) -> Generator[None, None, Result]:
    """Run steps that are a small part of something else: their checkpoints, but not the share that is done.

    >>> list(without_shares(share for share in (0.5, 1.0)))
    [None, None]
    """
    return map_steps(lambda _: None, steps)


class Resumable(Generic[Item, Result]):
    """Work as a generator that outlives the requests that drive it.

    One that closes `run` half-way leaves the work where it is, and the next that runs the same work goes on
    there. Work that ended, failed, or has another key is begun anew.

    >>> def count():
    ...     yield 1
    ...     yield 2
    ...     return "done"
    >>> counting = Resumable()
    >>> first = counting.run("a key", count)
    >>> next(first)
    1
    >>> first.close()
    >>> list(counting.run("a key", count))
    [2]
    """

    def __init__(self) -> None:
        self._key: Hashable = None
        self._work: Generator[Item, None, Result] | None = None

    def run(
        self, key: Hashable, begin: Callable[[], Generator[Item, None, Result]]
    ) -> Generator[Item, None, Result]:
        """Go on with the work that has this key, or begin it; return its result.

        Args:
            key: tells this work from other work; compared by `==`.
            begin: makes the generator, where there is none with this key.
        """
        if self._work is None or self._key != key:
            self._key, self._work = key, begin()
        work = self._work
        # Not `yield from`: that would close the work together with whoever drives it.
        while True:
            try:
                item = next(work)
            except StopIteration as stop:
                self.forget()
                return stop.value
            except BaseException:
                self.forget()
                raise
            yield item

    def forget(self) -> None:
        """Drop what is half done."""
        self._key = self._work = None


class Timed(Generator[Item, None, Result]):
    """Steps that know how long they took.

    Attributes:
        seconds: spent in the steps so far, and not between them.

    >>> steps = Timed(share for share in (0.5, 1.0))
    >>> list(steps), steps.seconds > 0.0
    ([0.5, 1.0], True)
    """

    def __init__(self, steps: Generator[Item, None, Result]) -> None:
        self._steps = steps
        self.seconds = 0.0

    def send(self, _value: None) -> Item:
        """Take a step."""
        began = perf_counter()
        try:
            return next(self._steps)
        finally:
            self.seconds += perf_counter() - began

    def throw(self, error: Any, *_: Any) -> Item:
        """Raise an error where the steps are, as `close` does."""
        return self._steps.throw(error)


CHECKPOINT_SECONDS = 0.005
"""Between two checkpoints while something works in another thread."""


def beside(call: Callable[[], Result]) -> Generator[None, None, Result]:
    """Make one long call of a routine that lets go of Python's lock (LAPACK's), with checkpoints meanwhile.

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

    threading.Thread(target=work, daemon=True, name="idviewer-beside").start()
    while not wait([outcome], CHECKPOINT_SECONDS).done:
        yield
    return outcome.result()
