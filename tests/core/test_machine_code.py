"""Machine code is kept by the content of the kernels' sources, and nobody else's code is touched."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import pytest

import idviewer
from idviewer.core._kernels import machine_code
from idviewer.core._kernels.geometry import collapses

COMMAND = "from idviewer.core._kernels.geometry.collapses import _next; print(_next(5))"


@pytest.fixture(autouse=True)
def _nothing_remembered() -> None:
    machine_code.sources_digest.cache_clear()
    machine_code.cache_folder.cache_clear()


def run_with(**environment: str) -> subprocess.CompletedProcess[str]:
    """A process of its own that needs one kernel."""
    given = {"PYTHONPATH": str(Path(idviewer.__file__).parents[1]), **environment}
    return subprocess.run(
        [sys.executable, "-c", COMMAND], capture_output=True, text=True, env=given, check=False
    )


def test_a_change_of_any_source_is_another_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kernels = tmp_path / "_kernels"
    shutil.copytree(Path(machine_code.__file__).parent, kernels)
    monkeypatch.setattr(machine_code, "__file__", str(kernels / "machine_code.py"))
    before = machine_code.wanted_folder()
    assert before == machine_code.wanted_folder()
    options = kernels / "simd" / "options.py"
    options.write_text(options.read_text() + "\n")
    machine_code.sources_digest.cache_clear()
    assert machine_code.wanted_folder() != before
    assert machine_code.wanted_folder().parent == before.parent


def test_kernels_are_kept_there_and_others_where_they_were() -> None:
    assert Path(collapses.collapse_some._cache.cache_path) == machine_code.cache_folder()

    @numba.njit(cache=True)
    def other(x: float) -> float:
        return x

    assert machine_code.cache_folder() not in Path(other._cache.cache_path).parents
    assert Path(other._cache.cache_path) != machine_code.cache_folder()


def test_the_date_of_a_source_does_not_matter() -> None:
    stamp = collapses.collapse_some._cache._impl.locator.get_source_stamp()
    assert stamp == machine_code.sources_digest()


def test_a_folder_that_takes_no_files_is_replaced_by_a_private_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file"))
    monkeypatch.setattr(machine_code.tempfile, "gettempdir", lambda: str(tmp_path))
    folder = machine_code.cache_folder()
    assert folder.parent.parent == tmp_path
    assert folder.parent.stat().st_mode & 0o777 == 0o700
    assert f"nothing can be written to {tmp_path / 'file'}" in caplog.text


def test_what_an_installation_brought_along_is_copied(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    brought, digest = tmp_path / "brought", machine_code.sources_digest()
    (brought / digest).mkdir(parents=True)
    (brought / digest / "kernel.nbi").write_bytes(b"index")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(brought))
    monkeypatch.setattr(machine_code.tempfile, "gettempdir", lambda: str(tmp_path))
    monkeypatch.setattr(
        machine_code, "_takes_files", lambda folder: brought not in folder.parents and _made(folder)
    )
    assert (machine_code.cache_folder() / "kernel.nbi").read_bytes() == b"index"


def _made(folder: Path) -> bool:
    folder.mkdir(parents=True, exist_ok=True)
    return True


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="without owners")
@pytest.mark.parametrize("mode", [0o777, 0o750])
def test_a_folder_that_others_could_write_to_is_not_trusted(
    mode: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(machine_code.tempfile, "gettempdir", lambda: str(tmp_path))
    theirs = tmp_path / f"idviewer-{os.getuid()}"
    theirs.mkdir()
    theirs.chmod(mode)
    assert machine_code._private_folder() is None
    theirs.rmdir()
    theirs.symlink_to(tmp_path)
    assert machine_code._private_folder() is None


@pytest.mark.slow
def test_where_nothing_can_be_kept_kernels_work_all_the_same(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    nowhere = str(tmp_path / "file")
    run = run_with(NUMBA_CACHE_DIR=nowhere, HOME=nowhere, TMPDIR=str(tmp_path))
    assert (run.returncode, run.stdout.strip()) == (0, "3"), run.stderr
    assert run.stderr.startswith("idviewer: nothing can be written to")
    assert len(run.stderr.splitlines()) == 1


@pytest.mark.slow
def test_damaged_machine_code_is_compiled_again(tmp_path: Path) -> None:
    first = run_with(NUMBA_CACHE_DIR=str(tmp_path))
    files = [path for path in tmp_path.rglob("*.nb?") if path.is_file()]
    assert (first.returncode, len(files) > 0) == (0, True), first.stderr
    for path in files:
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    again = run_with(NUMBA_CACHE_DIR=str(tmp_path))
    assert (again.returncode, again.stdout, again.stderr) == (0, first.stdout, "")
