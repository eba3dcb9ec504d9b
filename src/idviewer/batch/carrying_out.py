"""Carrying out one task, wherever that is: what is kept is not done again, and what fails is a reason."""

from __future__ import annotations

import threading
import time
from contextlib import suppress
from pathlib import Path

import numpy as np

from idviewer.batch.result_files import content_key, kept_content, write_failure, write_result
from idviewer.batch.task import Outcome, Reserve, Task, Work
from idviewer.core.threads import few_threads

LONGEST_REASON = 400
"""Characters of a reason."""

_ONE_AT_A_TIME = threading.Lock()
"""Kernels that run in parallel may be entered by one thread of a process only."""


def kept_outcome(task: Task, folder: Path) -> Outcome | None:
    """The outcome of a task whose result is there from an earlier run; None if it is to be computed."""
    try:
        content = kept_content(folder, task.name, content_key(task))
    except OSError:
        return None  # carrying it out will tell
    return None if content is None else Outcome(task, "kept", content=content)


def carry_out(work: Work, task: Task, folder: Path, reserve: Reserve, worker: str = "") -> Outcome:
    """Compute a task unless its result is there, and write its result file.

    Args:
        work: computes a result and writes all files but the result file.
        task: what to compute.
        folder: where results are written.
        reserve: gets memory.
        worker: who does it.

    Returns:
        An outcome, also of what fails; for each task it takes one thread, whatever the machine has.
    """
    began = time.perf_counter()
    try:
        # Before anything is read from it: a file that changes meanwhile is another one the next time.
        key = content_key(task)
        if (content := kept_content(folder, task.name, key)) is not None:
            return Outcome(task, "kept", content=content, worker=worker)
        with _ONE_AT_A_TIME, few_threads(vertices=0, facets=0):
            made = work(task, folder, reserve)
        content = write_result(folder, task, key, made, time.perf_counter() - began)
        return Outcome(task, "computed", "", content, time.perf_counter() - began, worker)
    except Exception as error:  # whatever it is, the others go on
        return failed_outcome(task, folder, reason_of(error), time.perf_counter() - began, worker)


def failed_outcome(task: Task, folder: Path, reason: str, seconds: float = 0.0, worker: str = "") -> Outcome:
    """Write down a failure, in place of the result of something else, and return it.

    Args:
        task: what failed.
        folder: of the results.
        reason: in one line.
        seconds: after which it failed.
        worker: who tried.
    """
    with suppress(OSError):
        write_failure(folder, task, reason)
    return Outcome(task, "failed", reason, {}, seconds, worker)


def reason_of(error: BaseException) -> str:
    """An error in one line, for those who own the shape; of an unforeseen one also its kind."""
    text = " ".join(str(error).split())
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    elif isinstance(error, MemoryError):
        text = text or "there is not enough memory for this"
    elif not isinstance(error, ValueError | OSError | np.linalg.LinAlgError) or not text:
        text = f"{type(error).__name__}: {text}"
    return text[:LONGEST_REASON]
