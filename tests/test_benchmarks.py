"""The benchmarks run, and their table says what was reached and what was missed."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from tests.core import shapes
from trimesh import Trimesh

FOLDER = Path(__file__).parents[1] / "benchmarks"
SUBJECTS = (
    "weights",
    "tree",
    "drag",
    "sliders",
    "growth",
    "gui",
    "event_loop",
    "preparation",
    "spectrum",
    "opening",
)
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
    vertices, faces = shapes.icosphere(3)
    Trimesh(vertices * [1.0, 1.4, 2.2], faces, process=False).export(tmp_path / "egg.ply")
    small = ["--shapes", "--turns", "1", "--poses", "2", "--sizes", "700", "--doublings", "0"]
    out = tmp_path / "out.json"
    command = [
        sys.executable,
        FOLDER / "run.py",
        tmp_path / "egg.ply",
        *small,
        "--out",
        out,
        "--only",
        *SUBJECTS,
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    tables = json.loads(out.read_text())["tables"]
    assert set(tables) == set(SUBJECTS)
    assert all(tables.values())
    within = [row for row in tables["tree"] if row["what"] == "embedding within 1e-05"]
    assert within[0]["error"] < 1e-4
