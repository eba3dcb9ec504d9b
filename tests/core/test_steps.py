"""Work in steps: kept when its driver is closed, begun anew when it ended, failed or is another's."""

from __future__ import annotations

from collections.abc import Generator

import pytest

from idviewer.core.steps import Resumable, Timed, finish, map_steps, without_shares

BEGUN: list[str] = []


def work(name: str, fails: bool = False) -> Generator[float, None, str]:
    BEGUN.append(name)
    yield 0.25
    if fails:
        raise RuntimeError("unexpected")
    yield 0.5
    return name


@pytest.fixture(autouse=True)
def _nothing_begun():
    BEGUN.clear()


def test_it_goes_on_where_a_closed_driver_left_it():
    kept = Resumable()
    driver = kept.run("a", lambda: work("a"))
    assert next(driver) == 0.25
    driver.close()
    assert finish(kept.run("a", lambda: work("a"))) == "a"
    assert BEGUN == ["a"]


def test_what_ended_is_begun_anew():
    kept = Resumable()
    assert [finish(kept.run("a", lambda: work("a"))) for _ in range(2)] == ["a", "a"]
    assert BEGUN == ["a", "a"]


def test_another_key_is_other_work():
    kept = Resumable()
    next(kept.run("a", lambda: work("a")))
    assert finish(kept.run("b", lambda: work("b"))) == "b"
    assert finish(kept.run("a", lambda: work("a"))) == "a"
    assert BEGUN == ["a", "b", "a"]


def test_what_failed_is_forgotten():
    kept = Resumable()
    with pytest.raises(RuntimeError, match="unexpected"):
        finish(kept.run("a", lambda: work("a", fails=True)))
    assert finish(kept.run("a", lambda: work("a"))) == "a"


def test_what_is_forgotten_is_begun_anew_and_closed():
    closed = []

    def closing():
        try:
            yield 1
        finally:
            closed.append(True)

    kept = Resumable()
    next(kept.run("a", closing))
    kept.forget()
    assert closed == [True]
    assert finish(kept.run("a", lambda: work("b"))) == "b"


@pytest.mark.parametrize("wrapped", [without_shares, Timed, lambda steps: map_steps(abs, steps)])
def test_what_wraps_steps_returns_their_result_and_closes_them(wrapped):
    assert finish(wrapped(work("a"))) == "a"
    steps = work("a")
    outer = wrapped(steps)
    next(outer)
    outer.close()
    assert steps.gi_frame is None, "it was left open"
