"""The worked examples of CONTRIBUTING.md hold: one file more, and everything knows the new kind."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[1] / "CONTRIBUTING.md"
EXAMPLE = re.compile(r"```python\n# (src/idviewer/core/(\w+)/(\w+)\.py)\n(.*?)```", re.DOTALL)

ADDED = """
import sys
from importlib import import_module
from pathlib import Path

for kind in ("distances", "coordinates"):
    package = import_module(f"idviewer.core.{kind}")
    folder = Path(sys.argv[1]) / kind
    package.__path__.append(str(folder))
    for file in folder.glob("*.py"):
        import_module(f"idviewer.core.{kind}.{file.stem}")
"""

RUN = (
    ADDED
    + """
from idviewer.cli import main

sys.exit(main(sys.argv[2:]))
"""
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The examples, as files."""
    for _, kind, name, text in EXAMPLE.findall(PAGE.read_text()):
        (tmp_path / kind).mkdir(exist_ok=True)
        (tmp_path / kind / f"{name}.py").write_text(text)
    return tmp_path


def told(folder: Path, *arguments: str) -> str:
    """What the command line says with the examples added."""
    command = [sys.executable, "-W", "error", "-c", RUN, str(folder), *arguments]
    run = subprocess.run(command, capture_output=True, text=True, env=os.environ, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout


def test_there_is_an_example_of_each() -> None:
    assert [kind for _, kind, *_ in EXAMPLE.findall(PAGE.read_text())] == ["distances", "coordinates"]


def measured(folder: Path, *options: str) -> float:
    """An interior distance of the hand."""
    ends = "--from", "0,0,0.05", "--to", "0,0,0.15"
    return float(json.loads(told(folder, "distance", "hand_2k", *ends, "--json", *options))["interior"])


@pytest.mark.slow
def test_the_command_line_knows_the_new_distance(folder: Path) -> None:
    """The faster the particle dies, the less it tells apart."""
    assert "Killed commute time" in told(folder, "distance", "--help")
    near, far = (measured(folder, "--distance", "killed", "--set", rate) for rate in ("rate=1", "rate=1e9"))
    assert 0.0 < far < near


@pytest.mark.slow
def test_the_command_line_knows_the_new_coordinates(folder: Path) -> None:
    """Points with the same nearest vertex are as far apart as it is from itself."""
    assert measured(folder, "--coordinates", "nearest") != measured(folder)
    close = "--from", "0,0,0.05", "--to", "0,0,0.0500001", "--coordinates", "nearest"
    assert json.loads(told(folder, "distance", "hand_2k", *close, "--json"))["interior"] == 0.0
