"""Events of a collection: JSON lines, a bar where somebody looks on, or nothing; with the time left."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TextIO

from idviewer.batch.task import Outcome, Task

BASE_WEIGHT = 20_000
"""Bytes of a shape's file that stand for what any shape takes, in estimates of the time left."""


@dataclass
class Progress:
    """How far a collection is.

    Attributes:
        tasks: all of them.
        counts: of outcomes by their status.
        clock: in seconds; another one for tests.
    """

    tasks: list[Task]
    counts: dict[str, int] = field(default_factory=lambda: {"computed": 0, "kept": 0, "failed": 0})
    clock: Callable[[], float] = time.monotonic

    def __post_init__(self) -> None:
        self._began = self.clock()
        self._weights = {task.name: weight_of(task.path) for task in self.tasks}
        self._left = sum(self._weights.values())
        self._done = 0

    @property
    def number(self) -> int:
        """How many tasks have an outcome."""
        return sum(self.counts.values())

    def add(self, outcome: Outcome) -> None:
        """Count an outcome."""
        self.counts[outcome.status] += 1
        weight = self._weights.get(outcome.task.name, 0)
        self._left -= weight
        self._done += weight if outcome.status == "computed" else 0

    @property
    def seconds(self) -> float:
        """Since the beginning."""
        return self.clock() - self._began

    @property
    def seconds_left(self) -> float | None:
        """About how long the rest takes, by the sizes of files; None while nothing is computed."""
        return self.seconds * self._left / self._done if self._done else None


def weight_of(path: Path) -> int:
    """About how much work a shape is, in bytes of its file."""
    with suppress(OSError):
        return BASE_WEIGHT + path.stat().st_size
    return BASE_WEIGHT


Listener = Callable[[str, Mapping[str, Any]], None]
"""Gets an event's name and its values."""


def json_lines(stream: TextIO) -> Listener:
    """A listener that writes each event as a line of JSON, at once.

    >>> import sys
    >>> json_lines(sys.stdout)("failed", {"name": "cup", "reason": "it is empty"})
    {"event": "failed", "name": "cup", "reason": "it is empty"}
    """

    def write(event: str, values: Mapping[str, Any]) -> None:
        with suppress(OSError, ValueError):  # whoever read them has left; the work goes on
            stream.write(json.dumps({"event": event, **values}, ensure_ascii=False) + "\n")
            stream.flush()

    return write


def nothing(event: str, values: Mapping[str, Any]) -> None:
    """A listener that tells nothing."""


class Bar:
    """A bar in a terminal with the time left; what fails is a line above it.

    Args:
        stream: the terminal.
    """

    def __init__(self, stream: TextIO) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn
        from rich.progress import Progress as RichProgress

        columns = (BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}"))
        self._console = Console(file=stream)
        self._bar = RichProgress(*columns, console=self._console)
        self._line: Any = None
        self._has_begun = False

    def __call__(self, event: str, values: Mapping[str, Any]) -> None:
        """Show an event."""
        if event == "begun":
            self._bar.start()
            self._line = self._bar.add_task("", total=values["shapes"])
        elif event == "preparing":
            self._bar.update(self._line, description=f"preparing {values['what']}")
        elif event == "started" and not self._has_begun:
            self._has_begun = True
            self._bar.update(self._line, description="")
        elif event in ("computed", "kept", "failed"):
            if event == "failed":
                self._console.print(f"{values['name']}: {values['reason']}", markup=False, highlight=False)
            left = values["seconds_left"]
            words = "" if left is None else f"about {in_words(left)} left"
            self._bar.update(self._line, completed=values["number"], description=words)
        elif event == "lost":
            self._console.print(f"{values['name']}: {values['reason']}", markup=False, highlight=False)
        elif event in ("finished", "interrupted"):
            self._bar.stop()


def in_words(seconds: float) -> str:
    """A length of time.

    >>> in_words(42.0), in_words(200.0), in_words(86000.0)
    ('42 s', '3 min', '23 h 53 min')
    """
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60.0)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60} min"
