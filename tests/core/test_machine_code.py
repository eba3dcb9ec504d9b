"""Machine code is kept by the content of the kernels' sources, and nobody else's code is touched."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numba
import pytest

import idviewer
from idviewer.core._kernels import machine_code
from idviewer.core._kernels.geometry import collapses


def test_a_change_of_any_source_is_another_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kernels = tmp_path / "_kernels"
    shutil.copytree(Path(machine_code.__file__).parent, kernels)
    monkeypatch.setattr(machine_code, "__file__", str(kernels / "machine_code.py"))
    before = machine_code.cache_folder()
    assert before == machine_code.cache_folder()
    options = kernels / "simd" / "options.py"
    options.write_text(options.read_text() + "\n")
    assert machine_code.cache_folder() != before
    assert machine_code.cache_folder().parent == before.parent


def test_kernels_are_kept_there_and_others_where_they_were() -> None:
    assert Path(collapses.collapse_some._cache.cache_path).parent == machine_code.cache_folder()
    assert machine_code.cache_folder() != Path(numba.config.CACHE_DIR)  # type: ignore[attr-defined]


@pytest.mark.slow
def test_where_nothing_can_be_kept_kernels_work_all_the_same(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    source = str(Path(idviewer.__file__).parents[1])
    command = "from idviewer.core._kernels.geometry.collapses import _next; print(_next(5))"
    environment = {"PYTHONPATH": source, "NUMBA_CACHE_DIR": str(tmp_path / "file"), "HOME": str(tmp_path)}
    run = subprocess.run(
        [sys.executable, "-c", command], capture_output=True, text=True, env=environment, check=False
    )
    assert (run.returncode, run.stdout.strip()) == (0, "3"), run.stderr
