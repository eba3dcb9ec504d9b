"""Kernels are compiled before they are used, those of trees in another process meanwhile."""

from __future__ import annotations

import subprocess
import sys
import time

import pytest

from idviewer.core import compilation
from idviewer.core.steps import finish


class Helper:
    """Another process that ends after having been looked at some times."""

    def __init__(self, looks: int) -> None:
        self.looks, self.ended = looks, False

    def poll(self) -> int | None:
        self.looks -= 1
        return None if self.looks >= 0 else 1

    def kill(self) -> None:
        self.ended = True

    def communicate(self) -> None:
        assert self.ended


@pytest.fixture
def helper(monkeypatch):
    """As on a machine where nothing was compiled yet."""
    helper = Helper(looks=3)
    monkeypatch.setattr(compilation, "COMPILATION", compilation.CompilationSettings(0.0, 1e-3))
    monkeypatch.setattr(compilation, "_compiling_trees", lambda: helper)
    return helper


@pytest.mark.parametrize(("dimension", "coordinates"), [(2, "mean_value"), (3, "mean_value"), (3, "shepard")])
def test_the_share_done_grows_until_all_is_done(dimension, coordinates):
    shares = list(compilation.compile_steps(dimension, coordinates))
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_what_another_process_compiles_is_waited_for(helper):
    shares = list(compilation.compile_steps(3))
    assert helper.looks < 0
    assert shares.count(7 / 10) == 1 + 3, "it is told that the work goes on"
    assert helper.ended


def test_the_other_process_ends_with_the_work(helper):
    steps = compilation.compile_steps(3)
    next(steps)
    steps.close()
    assert helper.ended


def test_where_no_process_can_be_started_all_is_compiled_here(monkeypatch):
    monkeypatch.setattr(compilation, "COMPILATION", compilation.CompilationSettings(0.0))
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    assert compilation._compiling_trees() is None
    finish(compilation.compile_steps(3))


@pytest.mark.slow
def test_the_other_process_compiles_the_trees():
    helper = compilation._compiling_trees()
    assert isinstance(helper, subprocess.Popen)
    assert helper.wait() == 0
    helper.communicate()


@pytest.mark.slow
def test_the_other_process_ends_with_this_one(monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))  # where there is plenty to do
    helper = compilation._compiling_trees()
    assert isinstance(helper, subprocess.Popen)
    while not any(tmp_path.rglob("*.nbi")):  # it is in the midst of it
        assert helper.poll() is None
        time.sleep(0.01)
    assert helper.stdin is not None
    helper.stdin.close()  # as when a process ends
    assert helper.wait() == 1


def test_nothing_is_started_where_the_kernels_are_there(monkeypatch):
    finish(compilation.compile_steps(3))
    monkeypatch.setattr(compilation, "_compiling_trees", lambda: pytest.fail("another process was started"))
    finish(compilation.compile_steps(3))
