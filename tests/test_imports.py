"""What may be imported where: the library and the headless verbs do without window and renderer."""

from __future__ import annotations

import subprocess
import sys

import pytest

BLOCK = """
import importlib.abc, sys

class Wall(importlib.abc.MetaPathFinder):
    def __init__(self, names):
        self.names = set(names)
    def find_spec(self, fullname, path=None, target=None):
        if fullname.partition(".")[0] in self.names:
            raise ImportError(f"{fullname} is not there")

sys.meta_path.insert(0, Wall(sys.argv[1].split(",")))
"""

EVERYTHING_IN = """
import importlib, pkgutil
for name in ("idviewer.core", "idviewer.session"):
    package = importlib.import_module(name)
    for module in pkgutil.walk_packages(package.__path__, name + "."):
        importlib.import_module(module.name)
"""

HELP_LOADS = """
from idviewer.cli import main
try:
    main(["--help"])
finally:
    heavy = {"numpy", "scipy", "numba", "trimesh", "vtkmodules", "pyvista", "PySide6"} & set(sys.modules)
    assert not heavy, heavy
"""

QT = ("pyvistaqt", "PySide6", "qtpy", "shiboken6")
RENDERER = ("vtk", "vtkmodules", "pyvista", "matplotlib")
COMMAND_LINE = ("cyclopts",)


def run_without(modules: tuple[str, ...], code: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-W", "error", "-c", BLOCK + code, ",".join(modules)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_core_and_session_know_neither_window_nor_renderer() -> None:
    done = run_without(QT + RENDERER + COMMAND_LINE, EVERYTHING_IN)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_help_loads_nothing_heavy() -> None:
    done = run_without((), HELP_LOADS)
    assert done.returncode == 0, done.stderr


def test_the_wall_stands() -> None:
    done = run_without(("json",), "import json")
    assert done.returncode != 0
    assert "json is not there" in done.stderr


@pytest.mark.slow
def test_pictures_need_no_qt() -> None:
    pytest.importorskip("pyvista", reason="absent on purpose in `make test-core`")
    # VTK's and PyVista's own imports are theirs to warn about.
    code = BLOCK + "import warnings; warnings.simplefilter('default'); import idviewer.view.images"
    command = [sys.executable, "-c", code, ",".join(QT)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
