"""Tasks carried out by the workers of a Dask scheduler, on other machines perhaps that share the folders.

Whatever a worker takes with it when it is lost is done again by others. What it had written stays: results
are known by their content, so the same task finds its result there.
"""

from __future__ import annotations

import math
import socket
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import closing, suppress
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import urlsplit
from uuid import uuid4

import idviewer
from idviewer.batch.carrying_out import carry_out, failed_outcome, reason_of
from idviewer.batch.memory_budget import usable_bytes, why_too_large
from idviewer.batch.task import Outcome, Task, Work

Given = TypeVar("Given")

ANSWER_SECONDS = 15.0
"""That a scheduler, and then its first worker, gets to answer."""

MISSING = "needs the package distributed: pip install 'idviewer[batch]'"


class DaskCluster:
    """Carries tasks out on the workers of a scheduler, each worker at one shape at a time.

    Args:
        address: of the scheduler, such as "tcp://10.0.0.1:8786".
        work: computes a task.
        folder: of the results, absolute; all workers see it and the shapes under the same names.
        prepare: called in one worker of each machine before there are tasks; compiles kernels.

    Raises:
        ValueError: there is no scheduler or no worker, they run another version, or Dask is not installed.
    """

    def __init__(self, address: str, work: Work, folder: Path, prepare: Callable[[], None]) -> None:
        self._where = f"--scheduler {address}"
        if find_spec("distributed") is None:
            raise ValueError(f"{self._where}: {MISSING}")
        from distributed import Client

        try:
            _knock(address)
            self._client: Any = Client(address, timeout=ANSWER_SECONDS)
        except (OSError, ValueError, TypeError) as error:
            raise ValueError(
                f"{self._where}: no Dask scheduler answers there; start one with `dask scheduler` and "
                f"workers with `dask worker {address}`"
            ) from error
        self._work, self._folder = work, folder
        try:
            self._check_workers()
            self._prepare(prepare)
        except BaseException:
            self._client.close()
            raise

    def _check_workers(self) -> None:
        """Refuse a cluster without workers, or whose workers compute with another version."""
        with suppress(TimeoutError, OSError):
            self._client.wait_for_workers(1, timeout=ANSWER_SECONDS)
        try:
            versions = self._client.run(_version)
        except ModuleNotFoundError as error:
            raise ValueError(
                f"{self._where}: its workers lack the package {error.name}; install it"
            ) from error
        if not versions:
            raise ValueError(f"{self._where}: it has no workers; start some with `dask worker ADDRESS`")
        others = sorted({version for version in versions.values() if version != idviewer.__version__})
        if others:
            raise ValueError(
                f"{self._where}: its workers have idviewer {', '.join(others)}, this is "
                f"{idviewer.__version__}; install the same version everywhere"
            )

    def _prepare(self, prepare: Callable[[], None]) -> None:
        """Compile kernels once a machine, whose processes share what is compiled."""
        workers = self._client.scheduler_info(n_workers=-1)["workers"]
        one_a_host = {info["host"]: address for address, info in workers.items()}
        started = [
            self._client.submit(_call, prepare, workers=[address], allow_other_workers=True, pure=False)
            for address in one_a_host.values()
        ]
        self._client.gather(started)

    @property
    def processes(self) -> int:
        """How many workers there are now."""
        return len(self._client.scheduler_info(n_workers=-1)["workers"])

    def outcomes(self, tasks: Iterable[Task]) -> Generator[Outcome, None, None]:
        """Carry out tasks; outcomes come as they are there. Closed early, it cancels what is left."""
        carry = partial(_carry_out_on_worker, self._work, str(self._folder))
        with closing(self._client), closing(passed_on(self._client, carry, list(tasks))) as results:
            for task, result in results:
                if isinstance(result, BaseException):
                    result = failed_outcome(task, self._folder, _reason_of_loss(result))
                yield result


def passed_on(
    client: Any, function: Callable[[Given], Any], given: Sequence[Given]
) -> Generator[tuple[Given, Any], None, None]:
    """Have workers call a function of many things; each thing with its result, or the error, as they come.

    They go and come in batches, since a scheduler passes on a few hundred messages a second. Closed before
    its end, it cancels what is left.

    Args:
        client: of the scheduler.
        function: called once a thing, unless a worker is lost.
        given: the things.
    """
    from distributed import as_completed

    futures = client.map(function, given, key=[uuid4().hex for _ in given], pure=False, retries=0)
    waiting = dict(zip(futures, given, strict=True))
    try:
        done = as_completed(futures, with_results=True, raise_errors=False)
        del futures  # so that results are let go of as they are taken
        for batch in done.batches():
            for future, result in batch:
                yield waiting.pop(future), future.exception() if future.status == "error" else result
    finally:
        client.cancel(list(waiting))


def _knock(address: str) -> None:
    """Find out at once where nobody listens, which Dask would try again and again."""
    place = urlsplit(address)
    if place.scheme == "tcp" and place.hostname and place.port:
        socket.create_connection((place.hostname, place.port), ANSWER_SECONDS).close()


def _version() -> str:
    return idviewer.__version__


def _call(function: Callable[[], None]) -> None:
    function()


def _carry_out_on_worker(work: Work, folder: str, task: Task) -> Outcome:
    """Carry out a task in a worker of Dask, within its memory."""
    from distributed import get_worker

    worker = get_worker()
    limit = min(float(worker.memory_manager.memory_limit or math.inf), usable_bytes())

    def reserve(amount: float) -> None:
        if reason := why_too_large(amount, limit):
            raise MemoryError(reason)

    return carry_out(work, task, Path(folder), reserve, worker.address)


def _reason_of_loss(error: BaseException) -> str:
    if type(error).__name__ == "KilledWorker":
        return "each worker that was at it was lost, as they are where memory runs out"
    return reason_of(error)
