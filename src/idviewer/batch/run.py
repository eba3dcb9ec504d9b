"""Run of a collection: what is kept is left, the rest is carried out, and a table is written."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from idviewer.batch.carrying_out import kept_outcome
from idviewer.batch.dask_cluster import DaskCluster
from idviewer.batch.events import Listener, Progress
from idviewer.batch.memory_budget import processes_for, usable_bytes
from idviewer.batch.result_files import remove_parts
from idviewer.batch.result_table import write_tables
from idviewer.batch.task import Outcome, Task, Work
from idviewer.batch.worker_pool import WorkerPool
from idviewer.core.memory import bytes_in_words


@dataclass(frozen=True)
class RunSettings:
    """How a collection is carried out; nothing here changes a result.

    Attributes:
        folder: of the results, absolute.
        table: name of the table's files, without a suffix.
        parquet: whether the table is written as Parquet, too.
        processes: how many on this machine; None for as many as it has cores and memory for.
        memory: bytes that they may take together; None for most of what there is.
        scheduler: address of a Dask scheduler whose workers do it instead; None for this machine.
    """

    folder: Path
    table: str = "results"
    parquet: bool = False
    processes: int | None = None
    memory: float | None = None
    scheduler: str | None = None


@dataclass(frozen=True)
class Summary:
    """What became of a collection.

    Attributes:
        outcomes: in the order of the tasks; those that were interrupted have none.
        tables: files that were written.
        interrupted: whether it was.
    """

    outcomes: list[Outcome]
    tables: list[Path]
    interrupted: bool

    @property
    def failures(self) -> int:
        """How many failed."""
        return sum(outcome.status == "failed" for outcome in self.outcomes)


def run_collection(
    tasks: list[Task],
    work: Work,
    prepare: Callable[[], None],
    settings: RunSettings,
    listener: Listener,
) -> Summary:
    """Carry out the tasks of a collection and write its table.

    Args:
        tasks: with different names.
        work: a function of a module that computes one, in other processes.
        prepare: likewise; compiles kernels, once a machine.
        settings: how.
        listener: gets to know what happens.

    Raises:
        ValueError, OSError: nothing could start: no scheduler answers, or the folder cannot be written to.
    """
    settings.folder.mkdir(parents=True, exist_ok=True)
    if not os.access(settings.folder, os.W_OK):
        raise PermissionError(13, "nothing may be written into this folder", str(settings.folder))
    remove_parts(settings.folder)
    done: dict[str, Outcome] = {}
    progress, interrupted = Progress(tasks), False

    def tell(event: str, **values: Any) -> None:
        listener(event, values)

    outcomes = _outcomes(tasks, work, prepare, settings, tell)
    try:
        with _terminated_as_interrupted():
            for outcome in outcomes:
                done[outcome.task.name] = outcome
                progress.add(outcome)
                tell(outcome.status, **_values(outcome, progress))
    except KeyboardInterrupt:
        interrupted = True
    finally:
        outcomes.close()
    ordered = [done[task.name] for task in tasks if task.name in done]
    tables = write_tables(settings.folder, settings.table, ordered, settings.parquet)
    tell(
        "interrupted" if interrupted else "finished",
        **progress.counts,
        seconds=round(progress.seconds, 3),
        tables=[str(path) for path in tables],
    )
    return Summary(ordered, tables, interrupted)


def _values(outcome: Outcome, progress: Progress) -> dict[str, Any]:
    left = progress.seconds_left
    values: dict[str, Any] = {"name": outcome.task.name}
    if outcome.status == "failed":
        values["reason"] = outcome.reason
    if outcome.status != "kept":
        values["seconds"] = round(outcome.seconds, 3)
    if outcome.worker:
        values["worker"] = outcome.worker
    counts = {"number": progress.number, "of": len(progress.tasks)}
    return {**values, **counts, "seconds_left": None if left is None else round(left, 1)}


def _outcomes(
    tasks: list[Task], work: Work, prepare: Callable[[], None], settings: RunSettings, tell: Any
) -> Generator[Outcome, None, None]:
    """Outcomes of all tasks, in the order in which they are there."""
    if settings.scheduler is not None:
        cluster = DaskCluster(settings.scheduler, work, settings.folder, prepare)
        tell("begun", shapes=len(tasks), workers=cluster.processes, scheduler=settings.scheduler)
        yield from cluster.outcomes(tasks)  # its workers look for what is kept
        return
    budget = usable_bytes() if settings.memory is None else settings.memory
    processes = settings.processes or min(_cores(), processes_for(budget), max(1, len(tasks)))
    tell("begun", shapes=len(tasks), processes=processes, memory=bytes_in_words(budget))
    kept: list[Outcome] = []
    pool = WorkerPool(work, settings.folder, processes, budget, prepare, tell)
    running = pool.outcomes(_left_to_do(tasks, settings.folder, kept))
    try:
        for outcome in running:
            yield from _taken(kept)
            yield outcome
    finally:
        running.close()
    yield from _taken(kept)


def _left_to_do(tasks: Iterable[Task], folder: Path, kept: list[Outcome]) -> Iterator[Task]:
    """Tasks whose results are not there; the outcomes of the others are appended to a list."""
    for task in tasks:
        outcome = kept_outcome(task, folder)
        if outcome is None:
            yield task
        else:
            kept.append(outcome)


def _taken(kept: list[Outcome]) -> Iterator[Outcome]:
    while kept:
        yield kept.pop(0)


def _cores() -> int:
    try:
        return len(os.sched_getaffinity(0))  # what SLURM or a container allows
    except AttributeError:
        return os.cpu_count() or 1


@contextmanager
def _terminated_as_interrupted() -> Iterator[None]:
    """Within it, SIGTERM, as SLURM sends at the end of the time, ends the work as Ctrl+C does."""

    def interrupt(*_: Any) -> None:
        raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
