"""The worked examples of CONTRIBUTING.md hold: one file more, and everything knows the new kind."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[1] / "CONTRIBUTING.md"
EXAMPLE = re.compile(r"```python\n# (src/idviewer/core/(\w+)/(\w+)\.py)\n(.*?)```", re.DOTALL)

KINDS = ("distances", "coordinates")

ADDED = f"""
import os
from importlib import import_module
from pathlib import Path

for kind in {KINDS}:
    package = import_module(f"idviewer.core.{{kind}}")
    folder = Path(os.environ["EXAMPLES"]) / kind
    package.__path__.append(str(folder))
    for file in folder.glob("*.py"):
        import_module(f"idviewer.core.{{kind}}.{{file.stem}}")
"""

RUN = (
    ADDED
    + """
import sys

from idviewer.cli import main

sys.exit(main(sys.argv[1:]))
"""
)

GENERIC = (
    "tests/core/test_distances_all.py",
    "tests/core/test_coordinates.py",
    "tests/core/test_coordinates_properties.py",
    "tests/core/test_combinations.py",
    "tests/test_combinations.py",
)
"""The tests of all distances and of all coordinates."""

OF_THE_EXAMPLES = (
    "(killed or nearest or table) "
    "and not (run_and_agree and not (killed and mean_value) and not (diffusion and nearest))"
)
"""What is run of them; of the combinations on the command line, which are slow, one with each example."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The examples, as files, and a plugin for pytest that adds them."""
    for _, kind, name, text in EXAMPLE.findall(PAGE.read_text()):
        (tmp_path / kind).mkdir(exist_ok=True)
        (tmp_path / kind / f"{name}.py").write_text(text)
    (tmp_path / "examples_plugin.py").write_text(ADDED)
    return tmp_path


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Python in a process of its own, which finds the examples."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    paths = os.pathsep.join([str(folder), *filter(None, [kept.get("PYTHONPATH")])])
    return subprocess.run(
        [sys.executable, "-W", "error", *arguments],
        capture_output=True,
        text=True,
        cwd=PAGE.parent,
        env={**kept, "EXAMPLES": str(folder), "PYTHONPATH": paths},
        check=False,
    )


def told(folder: Path, *arguments: str) -> str:
    """What the command line says with the examples added."""
    done = run(folder, "-c", RUN, *arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_there_is_an_example_of_each() -> None:
    assert [kind for _, kind, *_ in EXAMPLE.findall(PAGE.read_text())] == [*KINDS]


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


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_the_tests_of_all_distances_and_coordinates_pass_with_the_examples_added(folder: Path) -> None:
    options = ("-p", "examples_plugin", "-p", "no:cacheprovider", "-v", "-k", OF_THE_EXAMPLES)
    done = run(folder, "-m", "pytest", *options, *GENERIC)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr
    for passed in (
        "test_values_that_mean_nothing_are_refused_in_one_line[killed-rate]",
        "test_numbers_that_mean_nothing_are_refused_in_one_line[killed-rate]",
        "test_it_is_a_metric[killed-random mesh]",
        "test_size_changes_it_by_a_factor[killed-random mesh]",
        "test_what_a_kind_does_not_state_it_lacks[star-nearest-SMOOTHNESS]",
        "test_all_go_together[nearest-killed-random mesh]",
        "test_coordinates.py::test_the_table_is_in_the_order_of_menus",
    ):
        assert f"{passed} PASSED" in done.stdout


def test_the_examples_import_from_faces_alone() -> None:
    """From packages, never from a module inside one."""
    source = PAGE.parent / "src"
    for *_, text in EXAMPLE.findall(PAGE.read_text()):
        found = re.findall(r"^from (idviewer\S*) import", text, re.MULTILINE)
        assert found
        assert all((source / name.replace(".", "/") / "__init__.py").is_file() for name in found)


def test_the_examples_are_written_as_the_code_is(folder: Path) -> None:
    if find_spec("ruff") is None:
        return  # it comes with the linters, and they have to pass as well
    settings = ("--config", str(PAGE.parent / "pyproject.toml"))
    for command in (("format", "--check"), ("check",)):
        done = run(folder, "-m", "ruff", *command, *settings, *(str(folder / kind) for kind in KINDS))
        assert done.returncode == 0, done.stdout + done.stderr
