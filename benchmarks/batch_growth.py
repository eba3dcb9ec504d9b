"""Shapes of a collection a minute: by one process, by two, and by a thousand pretended workers."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from statistics import mean

import numpy as np
import pyvista as pv
from bodies import SEED, Body
from settings import Settings
from table import Row

from idviewer.batch import Outcome, RunSettings
from idviewer.batch.dask_cluster import passed_on
from idviewer.cli import batch_command
from idviewer.cli.collection_options import OutputOptions
from idviewer.cli.options import DistanceOptions, ReadingOptions

TITLE = "Collections: shapes a minute"
NOTE = (
    "Copies of a body, each of another size, with descriptors; from the first shape begun to the last one "
    "done, kernels and processes being there before. A thousand workers are pretended: a real Dask scheduler "
    "with threads that sleep as long as the shapes took and hand over the same results. So it is the "
    "scheduler and the client that are measured, on one machine together with the sleepers, and not the "
    "network. Shapes that take no time tell how many they can pass on at most."
)
SHAPES_A_TURN = 2
PROCESSES = (1, 2)
WORKERS, SLEEPING_PROCESSES = 1000, 2
ROUNDS = 4
"""Shapes that each pretended worker gets."""

ANSWER_SECONDS = 60


def rows(settings: Settings) -> Iterator[Row]:
    body = settings.bodies[0]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        paths = [
            str(_copy(body, folder, 1.0 + 0.01 * number)) for number in range(SHAPES_A_TURN * settings.turns)
        ]
        rates, outcomes = [], []
        for processes in PROCESSES:
            rate, outcomes = _run(paths, folder / f"results {processes}", processes)
            rates.append(rate)
            beside = ("one", rates[0]) if processes > 1 else None
            yield Row(f"shapes a minute, {processes} process(es)", body.label, rate, "", beside=beside)
    seconds = mean(outcome.seconds for outcome in outcomes)
    ideal = ("no overhead", 60.0 * WORKERS / seconds)
    slow = _pretended_rate(outcomes, [outcome.seconds for outcome in outcomes], ROUNDS * WORKERS)
    yield Row(f"shapes a minute, {WORKERS:,} workers pretended", body.label, slow, "", beside=ideal)
    fast = _pretended_rate(outcomes, [0.0], ROUNDS * WORKERS)
    yield Row("shapes a minute that the scheduler passes on", "shapes that take no time", fast, "")


def _copy(body: Body, folder: Path, scale: float) -> Path:
    path = folder / f"{body.mesh.name} {scale:.2f}.ply"
    pv.PolyData.from_regular_faces(scale * body.mesh.vertices, body.mesh.faces).save(path)
    return path


def _run(paths: list[str], folder: Path, processes: int) -> tuple[float, list[Outcome]]:
    """Shapes a minute, and the outcomes."""
    listed = batch_command.listed(paths, None, folder)
    given = OutputOptions(descriptors=True), ReadingOptions(no_cache=True), DistanceOptions()
    times: list[float] = []

    def note(event: str, _values: object) -> None:
        if event in ("started", "computed"):
            times.append(time.perf_counter())

    tasks, settings = batch_command.tasks_of(listed, *given), RunSettings(folder, processes=processes)
    summary = batch_command.carried_out(tasks, settings, listener=note)
    assert not summary.failures
    return 60.0 * len(tasks) / (times[-1] - times[0]), summary.outcomes


def _pretended_rate(outcomes: list[Outcome], seconds: list[float], count: int) -> float:
    """Results a minute that a scheduler passes on from workers that sleep."""
    from distributed import Client

    drawn = np.random.default_rng(SEED).choice(seconds, count).tolist()
    with _sleepers() as address, Client(address, timeout=ANSWER_SECONDS) as client:
        client.wait_for_workers(SLEEPING_PROCESSES, timeout=ANSWER_SECONDS)
        began = time.perf_counter()
        given = [(outcomes[number % len(outcomes)], wait) for number, wait in enumerate(drawn)]
        for _, outcome in passed_on(client, pretend, given):
            assert isinstance(outcome, Outcome)
        return 60.0 * count / (time.perf_counter() - began)


def pretend(given: tuple[Outcome, float]) -> Outcome:
    """Take as long as a shape did, and give its result."""
    outcome, seconds = given
    time.sleep(seconds)
    return outcome


@contextmanager
def _sleepers() -> Iterator[str]:
    """A scheduler, and processes whose threads are a thousand workers; its address."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port = str(one.getsockname()[1])
    address, threads = f"tcp://127.0.0.1:{port}", str(WORKERS // SLEEPING_PROCESSES)
    worker = ("dask_worker", address, "--no-nanny", "--nthreads", threads, "--host", "127.0.0.1")
    with ExitStack() as stack:
        stack.enter_context(_program("dask_scheduler", "--host", "127.0.0.1", "--port", port))
        folder = stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True))
        for _ in range(SLEEPING_PROCESSES):
            stack.enter_context(_program(*worker, "--local-directory", folder))
        yield address


@contextmanager
def _program(name: str, *arguments: str) -> Iterator[None]:
    own = {"PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])}
    command = [sys.executable, "-m", f"distributed.cli.{name}", *arguments, "--no-dashboard"]
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(command, env={**os.environ, **own}, stdout=quiet, stderr=quiet)
    try:
        yield
    finally:
        process.kill()
        process.wait()
