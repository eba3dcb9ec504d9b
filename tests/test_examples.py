"""Every example runs, prints something, and stays short; so does what the README shows of the library."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def output_of(*arguments: str) -> str:
    command = [sys.executable, "-W", "error", *arguments]
    run = subprocess.run(command, capture_output=True, text=True, env=os.environ, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs(path: Path) -> None:
    assert output_of(str(path)).strip()
    assert len(path.read_text().splitlines()) <= 40


def test_there_are_examples() -> None:
    assert EXAMPLES


@pytest.mark.slow
def test_the_library_works_as_the_readme_shows() -> None:
    (shown,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert len(output_of("-c", shown).splitlines()) >= shown.count("print(")
