"""A worker process: carries out one task after another, as its parent tells, and ends when that ends."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import connection, parent_process
from pathlib import Path
from typing import Any

from idviewer.batch.carrying_out import carry_out
from idviewer.batch.task import Work
from idviewer.core.memory import release_free_memory

ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
}
"""The environment in which a worker is started: processes share the cores, not threads."""

STANDARD_ERROR = 2


def serve(channel: connection.Connection, work: Work, folder: Path, prepare: Callable[[], None]) -> None:
    """Answer messages: ("prepare",) with ("ready",), ("task", task) with ("outcome", outcome), until "end".

    Between a task and its outcome it may ask for memory with ("reserve", bytes) and waits for the reason why
    there is none, which is empty where there is.

    Args:
        channel: to the parent.
        work: computes a task.
        folder: of the results.
        prepare: called once where the parent asks for it; compiles kernels.
    """
    with suppress(OSError):
        # What libraries tell there in their own ways would stand between the parent's lines.
        os.dup2(os.open(os.devnull, os.O_WRONLY), STANDARD_ERROR)
    with suppress(ValueError, OSError):
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends its workers in its own order
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    worker = f"process {os.getpid()}"

    def reserve(amount: float) -> None:
        channel.send(("reserve", amount))
        if reason := channel.recv():
            raise MemoryError(reason)

    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        while True:
            message: Any = channel.recv()
            match message[0]:
                case "prepare":
                    prepare()
                    channel.send(("ready",))
                case "task":
                    outcome = carry_out(work, message[1], folder, reserve, worker)
                    release_free_memory()  # before others are told that there is some
                    channel.send(("outcome", outcome))
                case _:
                    return


def _end_with_parent() -> None:
    parent = parent_process()
    assert parent is not None
    connection.wait([parent.sentinel])
    os._exit(1)
