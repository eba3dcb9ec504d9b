"""Seconds: medians over turns, percentiles, and the time until results of a generator come."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Generator, Iterator
from statistics import median
from typing import TypeVar

Result = TypeVar("Result")


def take_turns(turns: int, *calls: Callable[[], object]) -> list[float]:
    """Median seconds of each call. They are called alternately, so that a busy machine disturbs all alike."""
    spent: list[list[float]] = [[] for _ in calls]
    for _ in range(turns):
        for seconds, call in zip(spent, calls, strict=True):
            seconds.append(seconds_of(call))
    return [median(seconds) for seconds in spent]


def seconds_of(call: Callable[[], object]) -> float:
    """Seconds that a call takes."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def arrivals(
    results: Iterator[Result], patience: float = math.inf
) -> Generator[tuple[float, Result], None, None]:
    """Each result and the seconds spent on getting so far; ends when they exceed the patience.

    The clock stands still while the caller looks at a result.
    """
    spent = 0.0
    while spent <= patience:
        start = time.perf_counter()
        try:
            result = next(results)
        except StopIteration:
            return
        spent += time.perf_counter() - start
        yield spent, result


def percentile(values: list[float], percent: float) -> float:
    """The smallest of the values that so many percent of them do not exceed."""
    return sorted(values)[max(0, math.ceil(percent / 100.0 * len(values)) - 1)]
