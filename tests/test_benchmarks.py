"""The benchmarks run, and their table says what was reached and what was missed."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

FOLDER = Path(__file__).parents[1] / "benchmarks"
SUBJECTS = ("weights", "drag", "sliders", "gui", "opening")
"""Those that are quick on a small shape."""


@pytest.fixture
def table(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(FOLDER)
    import table

    return table


@pytest.mark.parametrize(
    ("value", "error", "bar", "reached"),
    [
        (4.0, None, (5.0,), True),
        (6.0, None, (5.0,), False),
        (4.0, 1e-2, (5.0, 1e-3), False),
        (math.inf, None, (5.0,), False),
        (4.0, 1e-4, (2.0, 1e-3, True), True),
        (4.0, 1e-4, (3.0, 1e-3, True), False),
    ],
)
def test_a_row_reaches_its_bar(
    table: ModuleType, value: float, error: float | None, bar: tuple, reached: bool
) -> None:
    row = table.Row("what", "on", value, "ms", beside=("peer", 8.0), error=error, bar=table.Bar(*bar))
    assert row.reached is reached
    assert row.cells[-1] == ("yes" if reached else "**no**")


def test_the_readme_takes_the_table(table: ModuleType, tmp_path: Path) -> None:
    readme = tmp_path / "README.md"
    readme.write_text(f"before\n{table.START}\nold\n{table.END}\nafter\n")
    for text in ("new", "newer"):
        table.put_into(readme, text)
        assert readme.read_text() == f"before\n{table.START}\n\n{text}\n\n{table.END}\nafter\n"


def test_the_readme_has_the_place_for_it(table: ModuleType) -> None:
    readme = (FOLDER.parent / "README.md").read_text()
    assert readme.index(table.START) < readme.index(table.END)


@pytest.mark.slow
def test_small_runs_measure(tmp_path: Path) -> None:
    small = [
        "--shapes",
        "hand_2k",
        "--turns",
        "1",
        "--poses",
        "2",
        "--sizes",
        "1200",
        "--out",
        tmp_path / "out.json",
    ]
    command = [sys.executable, FOLDER / "run.py", *small, "--only", *SUBJECTS]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = [
        row for rows in json.loads((tmp_path / "out.json").read_text())["tables"].values() for row in rows
    ]
    kinds = {"weights", "first frame", "frame accepted", "first colours", "seen before"}
    assert {row["what"].split(",")[0] for row in rows} >= kinds
    within = [row for row in rows if row["what"] == "embedding within 1e-05"]
    assert within[0]["error"] < 1e-4
