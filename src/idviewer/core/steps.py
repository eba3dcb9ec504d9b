"""Long work as generators: they yield every few milliseconds and return their result at the end."""

from __future__ import annotations

from collections.abc import Generator
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
