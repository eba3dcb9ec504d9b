"""What is told of a collection: the time left, JSON lines, and the bar."""

from __future__ import annotations

import io
import json
from pathlib import Path

import pytest
from tests.batch.works import task_in

from idviewer.batch import Bar, Outcome, Task, json_lines
from idviewer.batch.events import BASE_WEIGHT, Progress


class Clock:
    """Seconds that a test lets pass."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def test_the_time_left_goes_by_sizes(tmp_path: Path) -> None:
    """A file three times as heavy counts three times; what is kept takes none."""
    tasks = [
        task_in(tmp_path, "a", ""),
        task_in(tmp_path, "b", "x" * 2 * BASE_WEIGHT),
        task_in(tmp_path, "c", ""),
    ]
    clock = Clock()
    progress = Progress(tasks, clock=clock)
    assert progress.seconds_left is None
    progress.add(Outcome(tasks[2], "kept"))
    assert progress.seconds_left is None
    clock.now += 4.0
    progress.add(Outcome(tasks[0], "computed"))
    assert progress.seconds_left == pytest.approx(12.0)
    clock.now += 12.0
    progress.add(Outcome(tasks[1], "failed", "why"))
    assert progress.seconds_left == 0.0
    assert (progress.number, progress.counts) == (3, {"computed": 1, "kept": 1, "failed": 1})


def test_a_file_that_is_not_there_weighs_something() -> None:
    progress = Progress([Task("a", Path("/nowhere/a.ply"))])
    progress.add(Outcome(progress.tasks[0], "computed"))
    assert progress.seconds_left == 0.0


def test_each_event_is_a_line() -> None:
    stream = io.StringIO()
    tell = json_lines(stream)
    tell("failed", {"name": "a", "reason": "two\nlines"})
    tell("finished", {})
    events = [json.loads(line) for line in stream.getvalue().splitlines()]
    assert events == [{"event": "failed", "name": "a", "reason": "two\nlines"}, {"event": "finished"}]


def test_a_reader_that_has_left_stops_nothing() -> None:
    stream = io.StringIO()
    stream.close()
    json_lines(stream)("finished", {})


def test_the_bar_tells_failures_and_the_time_left(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setenv("FORCE_COLOR", "1")  # as in a terminal
    stream = io.StringIO()
    bar = Bar(stream)
    bar("begun", {"shapes": 2})
    bar("preparing", {"what": "kernels"})
    bar("started", {"name": "[a]"})
    bar("failed", {"name": "[a]", "reason": "it is [open]", "number": 1, "seconds_left": 200.0})
    bar("computed", {"name": "b", "number": 2, "seconds_left": 0.0})
    bar("finished", {})
    shown = stream.getvalue()
    assert "[a]: it is [open]" in shown
    assert "1/2" in shown or "2/2" in shown
