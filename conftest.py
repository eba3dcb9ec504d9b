"""What tests and the examples in docstrings share: where two processes run them, some have to be alone."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def locks(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of files that processes lock; it is the same for all that share out the tests."""
    folder = tmp_path_factory.getbasetemp().parent / "locks"
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(autouse=True)
def turn(request: pytest.FixtureRequest, locks: Path) -> Iterator[None]:
    """Has a test that is marked so run while no other process runs any."""
    if "PYTEST_XDIST_WORKER" not in os.environ:
        yield
        return
    alone = request.node.get_closest_marker("alone") is not None
    with (locks / "room").open("w") as room:
        with (locks / "queue").open("w") as queue:  # so that nobody who waits is overtaken for ever
            fcntl.flock(queue, fcntl.LOCK_EX)
            fcntl.flock(room, fcntl.LOCK_EX if alone else fcntl.LOCK_SH)
        yield
