"""Pool of processes on this machine that outlives each of them: one that is killed costs a second try.

`concurrent.futures` gives all work up where one process is lost, and cannot tell which shape it was at.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from idviewer.batch.carrying_out import failed_outcome
from idviewer.batch.memory_budget import BASE_BYTES, MemoryBudget, why_too_large
from idviewer.batch.result_files import remove_parts
from idviewer.batch.task import Outcome, Task, Work
from idviewer.batch.worker_process import ONE_THREAD, serve
from idviewer.core.memory import bytes_in_words

TRIES = 2
"""Of a shape whose process is killed."""

END_SECONDS = 2.0
"""That a process gets to end by itself."""

Tell = Callable[..., None]
"""Tells an event: its name, and values by name."""


@dataclass(eq=False)
class _Worker:
    process: BaseProcess
    channel: connection.Connection
    task: Task | None = None
    reserved: float = 0.0

    @property
    def name(self) -> str:
        return f"process {self.process.pid}"


class WorkerPool:
    """Carries tasks out in processes, each at one shape, whose memory together stays within a budget.

    Args:
        work: computes a task.
        folder: of the results.
        processes: how many at most.
        budget: bytes of memory for all.
        prepare: called in the first process before others are started; compiles kernels.
        tell: gets to know what happens.
    """

    def __init__(
        self,
        work: Work,
        folder: Path,
        processes: int,
        budget: float,
        prepare: Callable[[], None],
        tell: Tell,
    ) -> None:
        self._arguments = work, folder, prepare
        self._folder, self._processes, self._tell = folder, processes, tell
        self._budget = MemoryBudget(budget)
        self._workers: list[_Worker] = []
        self._tries: dict[str, int] = {}
        self._again: deque[Task] = deque()

    def outcomes(self, tasks: Iterable[Task]) -> Generator[Outcome, None, None]:
        """Carry out tasks in about their order; outcomes come as they are there.

        Closed before its end, it ends its processes, and leaves nothing half-written.
        """
        waiting = iter(tasks)
        try:
            yield from self._outcomes(waiting)
        finally:
            self._end_all()

    def _outcomes(self, waiting: Iterator[Task]) -> Iterator[Outcome]:
        task = self._next(waiting)
        if task is not None:
            self._tell("preparing", what="kernels, compiled once")
            self._start().channel.send(("prepare",))
        preparing = True
        while task is not None or any(worker.task for worker in self._workers):
            while task is not None and not preparing and (worker := self._idle()) is not None:
                self._give(worker, task)
                task = self._next(waiting)
            for worker in self._ready():
                try:
                    message = worker.channel.recv()
                except (EOFError, OSError):
                    if preparing:
                        raise OSError("the first process was ended while it compiled the kernels") from None
                    yield from self._lost(worker)
                    task = self._next(waiting) if task is None else task
                    continue
                preparing = False
                if message[0] == "outcome":
                    worker.task = None
                    self._serve(self._budget.give_back(worker))
                    yield message[1]
                elif message[0] == "reserve":
                    self._reserve(worker, message[1])

    def _next(self, waiting: Iterator[Task]) -> Task | None:
        return self._again.popleft() if self._again else next(waiting, None)

    def _idle(self) -> _Worker | None:
        """A worker without a task, or a new one while there may be more."""
        for worker in self._workers:
            if worker.task is None:
                return worker
        return self._start() if len(self._workers) < self._processes else None

    def _start(self) -> _Worker:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=serve, args=(theirs, *self._arguments), daemon=True)
        with _environment(ONE_THREAD), _deaf_to_interrupts():
            process.start()
        theirs.close()
        worker = _Worker(process, ours)
        self._workers.append(worker)
        return worker

    def _give(self, worker: _Worker, task: Task) -> None:
        worker.task, worker.reserved = task, 0.0
        self._tell("started", name=task.name, worker=worker.name)
        with suppress(OSError):  # that it is lost is found when it is looked at
            worker.channel.send(("task", task))

    def _ready(self) -> list[_Worker]:
        """Wait until there is something to hear from some worker, if only that it is lost."""
        by_channel: dict[Any, _Worker] = {worker.channel: worker for worker in self._workers}
        return [by_channel[channel] for channel in connection.wait(list(by_channel))]

    def _reserve(self, worker: _Worker, amount: float) -> None:
        if reason := why_too_large(amount, self._budget.budget):
            worker.channel.send(reason)
            return
        worker.reserved += amount
        assert worker.task is not None
        self._tell("memory", name=worker.task.name, foretold=bytes_in_words(amount))
        # What was killed before gets all there is: it runs alone.
        alone = worker.task.name in self._tries
        self._serve(self._budget.ask(worker, self._budget.budget if alone else amount + BASE_BYTES))

    def _serve(self, workers: Iterable[Any]) -> None:
        for worker in workers:
            with suppress(OSError):
                worker.channel.send("")

    def _lost(self, worker: _Worker) -> Iterator[Outcome]:
        """Take leave of a worker that was ended; its shape is tried again, or has failed."""
        self._workers.remove(worker)
        self._serve(self._budget.give_back(worker))
        worker.process.join(END_SECONDS)
        worker.channel.close()
        task = worker.task
        if task is None:
            return
        remove_parts(self._folder, task.name)
        tries = self._tries[task.name] = self._tries.get(task.name, 0) + 1
        reason = f"its process was {_manner_of_death(worker.process.exitcode)}"
        self._tell("lost", name=task.name, worker=worker.name, reason=reason, tries=tries)
        if tries < TRIES:
            self._again.append(task)
            return
        foretold = f"; it was foretold {bytes_in_words(worker.reserved)}" if worker.reserved else ""
        reason = f"{reason} in each of {TRIES} tries{foretold}"
        yield failed_outcome(task, self._folder, reason, worker=worker.name)

    def _end_all(self) -> None:
        for worker in self._workers:
            if worker.task is None:
                with suppress(OSError):
                    worker.channel.send(("end",))
            else:
                worker.process.terminate()
        for worker in self._workers:
            worker.process.join(END_SECONDS)
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()
            worker.channel.close()
            if worker.task is not None:
                remove_parts(self._folder, worker.task.name)
        self._workers.clear()


def _manner_of_death(exit_code: int | None) -> str:
    if exit_code == -9:
        return "killed, as the system does where memory runs out,"
    return (
        f"ended by signal {-exit_code}" if exit_code and exit_code < 0 else f"ended with status {exit_code}"
    )


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """What is started within ignores Ctrl+C from its first moment: the parent ends it in its own order."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Set variables of the environment for what is started within."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
