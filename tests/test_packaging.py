"""What `pip install .` gives: everything that runs, the bundled shapes, and nothing of the workshop."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
import venv
import zipfile
from email.parser import HeaderParser
from pathlib import Path

import pytest

import idviewer

ROOT = Path(__file__).parents[1]


def call(*command: object, **more: object) -> subprocess.CompletedProcess[str]:
    words = [str(word) for word in command]
    return subprocess.run(words, capture_output=True, text=True, check=False, **more)  # type: ignore[call-overload]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of this tree."""
    folder = tmp_path_factory.mktemp("wheel")
    pip = [
        sys.executable,
        "-m",
        "pip",
        "--disable-pip-version-check",
        "wheel",
        "--no-deps",
        "--wheel-dir",
        folder,
    ]
    done = call(*pip, ROOT)
    if done.returncode != 0 and ("hatchling" in done.stderr or "onnection" in done.stderr):
        # Its own environment for the build has to be fetched; offline, the one that is here must do.
        done = call(*pip, "--no-build-isolation", ROOT)
        if "hatchling" in done.stderr:
            pytest.skip("the build backend is not installed and cannot be fetched")
    assert done.returncode == 0, done.stderr
    return next(folder.glob("*.whl"))


def bundled() -> list[Path]:
    return [path for suffix in ("ply", "csv") for path in (ROOT / "assets").glob(f"*.{suffix}")]


@pytest.mark.slow
def test_the_wheel_holds_what_runs(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    packed = {name for name in names if name.endswith(".py")}
    source = {str(path.relative_to(ROOT / "src")) for path in (ROOT / "src").rglob("*.py")}
    shapes = {f"idviewer/assets/{path.name}" for path in bundled()}
    assert packed == source
    assert shapes
    assert shapes <= set(names)
    assert "idviewer/py.typed" in names
    assert any(name.endswith("licenses/LICENSE") for name in names)


@pytest.mark.slow
def test_the_wheel_tells_what_it_is(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        name = next(name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        told = HeaderParser().parsestr(archive.read(name).decode())
    assert (told["Name"], told["Version"]) == ("idviewer", idviewer.__version__)
    assert told["License-Expression"] == "MIT"
    assert wheel.stat().st_size < 5_000_000


@pytest.mark.slow
def test_the_wheel_works_where_the_tree_is_not(wheel: Path, tmp_path: Path) -> None:
    """Installed beside the dependencies of this environment, it finds its own shapes and reads one."""
    venv.create(tmp_path / "env", with_pip=False)
    python = tmp_path / "env" / "bin" / "python"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "site")
    here = call(sys.executable, "-c", "import numpy, pathlib; print(pathlib.Path(numpy.__file__).parents[1])")
    # Entries of PYTHONPATH are not searched for .pth files, so an editable install of this tree stays out.
    paths = os.pathsep.join([str(tmp_path / "site"), here.stdout.strip()])
    environment = {**os.environ, "PYTHONPATH": paths}
    listed = call(python, "-m", "idviewer", "samples", cwd=tmp_path, env=environment)
    assert listed.returncode == 0, listed.stderr
    assert set(listed.stdout.split()) >= {path.stem for path in bundled()}
    done = call(python, "-m", "idviewer", "info", listed.stdout.split()[0], cwd=tmp_path, env=environment)
    assert done.returncode == 0, done.stderr
    assert "usable          yes" in done.stdout


def test_no_registry_is_named() -> None:
    """Where packages come from is the user's business."""
    known = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert "uv" not in known["tool"]
    assert not [path.name for path in ROOT.iterdir() if path.name.endswith((".lock", "requirements.txt"))]
    for name in ("pyproject.toml", "Makefile", ".ci/run", ".github/workflows/ci.yml"):
        text = (ROOT / name).read_text()
        assert "index-url" not in text
        assert "://" not in text
