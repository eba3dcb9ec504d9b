"""What the tests of the command line share: how it is run, a body, and tables of points."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from tests.cli.commands import Answer, Run

from idviewer.cli import main


@pytest.fixture
def run(capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Runs a command line in this process, in a folder of its own."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> Answer:
        status = main(arguments)
        return Answer(status, *capfd.readouterr())

    return run


@pytest.fixture(scope="session")
def body(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A spindle, long enough to need few modes."""
    angles = np.linspace(np.pi, 0.0, 35)
    outline = np.column_stack([np.sin(angles).clip(0.0), 6.0 * np.cos(angles)])
    outline[[0, -1], 0] = 0.0
    shape = trimesh.creation.revolve(outline, sections=20)
    path = tmp_path_factory.mktemp("bodies") / "spindle.off"
    shape.export(path)
    return str(path)


@pytest.fixture
def table(tmp_path: Path) -> Callable[[str], str]:
    def write(text: str) -> str:
        path = tmp_path / "points.csv"
        path.write_text(text)
        return str(path)

    return write
