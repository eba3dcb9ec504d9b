"""Collections on a Dask scheduler with real workers, one of which is killed while it works."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import pytest
from tests.batch.works import calls_of, run_in, task_in

from idviewer.cli import main

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.slow


class Cluster(NamedTuple):
    address: str
    workers: list[int]
    """Their process ids."""


@contextmanager
def program(name: str, *arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """A process of Dask's command line, ended at the end."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT / "src"), str(ROOT)])}
    command = [sys.executable, "-m", f"distributed.cli.{name}", *arguments, "--no-dashboard"]
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(command, env=environment, stdout=quiet, stderr=quiet)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """A scheduler and two workers on the loopback address."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port = one.getsockname()[1]
    address, folder = f"tcp://127.0.0.1:{port}", str(tmp_path_factory.mktemp("dask"))
    of_worker = (address, "--no-nanny", "--nthreads", "1", "--host", "127.0.0.1", "--local-directory", folder)
    with (
        program("dask_scheduler", "--host", "127.0.0.1", "--port", str(port)),
        program("dask_worker", *of_worker) as first,
        program("dask_worker", *of_worker) as second,
    ):
        yield Cluster(address, [first.pid, second.pid])


def test_results_are_those_of_this_machine(cluster: Cluster, tmp_path: Path) -> None:
    texts = ("star", "blob", "--descriptors", "--grids", "9", "--quiet")
    assert main(["batch", *texts, "--out", str(tmp_path / "here")]) == 0
    assert main(["batch", *texts, "--out", str(tmp_path / "there"), "--scheduler", cluster.address]) == 0
    for name in ("star", "blob"):
        here, there = (
            json.loads((tmp_path / place / f"{name}.json").read_text()) for place in ("here", "there")
        )
        assert there["made_by"]["process"] in cluster.workers
        assert here["made_by"]["process"] not in cluster.workers
        assert (here["digest"], here["result"], here["files"]) == (
            there["digest"],
            there["result"],
            there["files"],
        )


def test_a_worker_that_is_killed_loses_nothing(cluster: Cluster, tmp_path: Path) -> None:
    """Each shape is done once, but for the one that the killed worker was at; nothing is done again later."""
    flag = tmp_path / "go on"
    tasks = [task_in(tmp_path, f"shape{number}", **{"waits for": str(flag)}) for number in range(6)]
    victim, killed = cluster.workers[0], []

    def kill_at_work() -> None:
        while not killed:
            for path in tmp_path.glob("*.calls"):
                if str(victim) in path.read_text().split():
                    os.kill(victim, signal.SIGKILL)
                    killed.append(path.stem)
        flag.touch()

    killer = threading.Thread(target=kill_at_work, daemon=True)
    killer.start()
    summary = run_in(tmp_path, tasks, scheduler=cluster.address)
    killer.join()
    assert [outcome.status for outcome in summary.outcomes] == ["computed"] * 6
    counts = {task.name: 2 if task.name in killed else 1 for task in tasks}
    assert {task.name: calls_of(task) for task in tasks} == counts
    again = run_in(tmp_path, tasks, scheduler=cluster.address)
    assert [outcome.status for outcome in again.outcomes] == ["kept"] * 6
    assert {task.name: calls_of(task) for task in tasks} == counts


def test_nobody_answers(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))  # nobody listens
        address = f"tcp://127.0.0.1:{one.getsockname()[1]}"
        assert main(["batch", "star", "--out", str(tmp_path / "out"), "--scheduler", address]) == 2
    assert "no Dask scheduler answers there" in capfd.readouterr().err
