"""Work for tests, which other processes import: it dies or fails where its options say so."""

from __future__ import annotations

import os
import signal
import time
from functools import partial
from pathlib import Path

from idviewer.batch import Made, Reserve, Task, nothing
from idviewer.batch.run import RunSettings, Summary, run_collection
from idviewer.core.io import atomic_path

PATIENCE = 60.0
"""Seconds after which whatever waits gives up."""


def prepare(folder: Path) -> None:
    """Leave a mark."""
    with (folder / "prepared").open("a") as file:
        file.write("x")


def work(task: Task, folder: Path, reserve: Reserve) -> Made:
    """Measure the file; count this call by a line in a file beside it."""
    options = task.options
    with (task.path.parent / f"{task.name}.calls").open("a") as file:
        file.write(f"{os.getpid()}\n")
    if "needs" in options:
        reserve(options["needs"])
    if options.get("noisy"):
        os.write(2, b"a library speaks")
    if options.get("fails"):
        raise ValueError(f"{task.name}: no\nshape")
    if options.get("bug"):
        raise KeyError("thing")
    calls = (task.path.parent / f"{task.name}.calls").read_text().count("\n")
    if calls <= options.get("killed", 0):
        (folder / f".{task.name}.json.half.part").write_text("{")
        os.kill(os.getpid(), signal.SIGKILL)
    if flag := options.get("waits for"):
        wait_for(Path(flag))
    with atomic_path(folder / f"{task.name}.copy") as part:
        part.write_bytes(task.path.read_bytes())
    return Made({"size": task.path.stat().st_size, "place": [0.5, 1.0]}, {"copy": f"{task.name}.copy"}, {})


def wait_for(path: Path) -> None:
    """Wait until there is such a file."""
    end = time.monotonic() + PATIENCE
    while not path.exists() and time.monotonic() < end:
        time.sleep(0.01)


def task_in(folder: Path, name: str, content: str = "shape", **options: object) -> Task:
    """A task whose file is made."""
    path = folder / f"{name}.txt"
    path.write_text(content)
    return Task(name, path, options)


def run_in(folder: Path, tasks: list[Task], listener=nothing, **settings: object) -> Summary:
    """Carry tasks out, with results in a folder beside their files."""
    results = folder / "results"
    results.mkdir(exist_ok=True)
    made = RunSettings(folder=results, **settings)  # type: ignore[arg-type]
    return run_collection(tasks, work, partial(prepare, folder), made, listener)


def calls_of(task: Task) -> int:
    """How often a task was begun."""
    path = task.path.parent / f"{task.name}.calls"
    return path.read_text().count("\n") if path.exists() else 0
