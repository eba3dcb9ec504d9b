"""Exports and caches whose writer is killed are the old file or the new one; `make soak` kills many more."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from idviewer.batch.inputs import entries_of
from idviewer.core.io import PART_SUFFIX, atomic_path
from idviewer.core.io.atomic_write import ABANDONED_PART_SECONDS

KILLS = 36
CAMPAIGN = [sys.executable, "-m", "tests.killed_writers", "--kills", str(KILLS), "--seed", "20090715"]


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="the writers are forked")
def test_a_killed_writer_leaves_the_old_file_or_the_new_one() -> None:
    done = subprocess.run(CAMPAIGN, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    told = json.loads(done.stdout)
    assert sum(told["versions"].values()) == KILLS
    assert min(told["versions"].values()) > 0, "both versions are met"
    assert told["cut_off"] > 0, "some were killed in the middle"


def _left(folder: Path, name: str, age: float) -> Path:
    path = folder / f".{name}.{age:032.0f}{PART_SUFFIX}"
    path.write_text("v 0 0 0")
    os.utime(path, (time.time() - age, time.time() - age))
    return path


def test_what_is_left_of_a_killed_writer_is_removed_after_a_day(tmp_path: Path) -> None:
    old, new = _left(tmp_path, "a.obj", ABANDONED_PART_SECONDS + 60), _left(tmp_path, "a.obj", 60)
    others = tmp_path / ".a.obj.part"
    others.write_text("not ours")
    os.utime(others, (0, 0))
    with atomic_path(tmp_path / "b.obj") as part:
        part.write_text("v 1 1 1")
    assert not old.exists()
    assert new.exists()
    assert others.exists()


def test_what_is_left_of_a_killed_writer_is_no_shape_of_a_folder(tmp_path: Path) -> None:
    _left(tmp_path, "a.obj", 60)
    (tmp_path / "b.obj").write_text("v 1 1 1")
    assert [one.path.name for one in entries_of([str(tmp_path)], Path, tmp_path / "out")] == ["b.obj"]
