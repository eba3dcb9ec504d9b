"""The pool of processes: results, reasons, processes that are killed, memory, and the end."""

from __future__ import annotations

import os
import signal
import threading
from pathlib import Path

import pytest
from tests.batch.works import calls_of, run_in, task_in, wait_for

from idviewer.batch.memory_budget import BASE_BYTES, MemoryBudget, why_too_large

pytestmark = pytest.mark.slow


def test_each_shape_has_an_outcome(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """One process is killed once and the shape done again, another twice, and the others go on."""
    tasks = [
        task_in(tmp_path, "good", noisy=True),
        task_in(tmp_path, "unlucky", killed=1),
        task_in(tmp_path, "deadly", killed=9),
        task_in(tmp_path, "bad", fails=True),
        task_in(tmp_path, "buggy", bug=True),
        task_in(tmp_path, "large", needs=1e15),
        task_in(tmp_path, "fitting", needs=1e9),
    ]
    told: list[str] = []
    summary = run_in(tmp_path, tasks, lambda event, values: told.append(event), processes=1, memory=2e9)
    reasons = {outcome.task.name: outcome.reason for outcome in summary.outcomes}
    assert list(reasons) == [task.name for task in tasks]
    assert reasons["good"] == reasons["unlucky"] == reasons["fitting"] == ""
    assert reasons["bad"] == "bad: no shape"
    assert reasons["buggy"] == "KeyError: 'thing'"
    assert "would need about 1000000 GB" in reasons["large"]
    assert "killed, as the system does where memory runs out, in each of 2 tries" in reasons["deadly"]
    assert summary.failures == 4
    assert {task.name: calls_of(task) for task in tasks} == {
        **dict.fromkeys(["good", "bad", "buggy", "large", "fitting"], 1),
        **dict.fromkeys(["unlucky", "deadly"], 2),
    }
    assert told.count("lost") == 3
    assert capfd.readouterr().err == ""
    assert (tmp_path / "prepared").read_text() == "x"
    assert not list((tmp_path / "results").glob(".*"))


def test_an_interrupt_keeps_what_is_done(tmp_path: Path) -> None:
    """SIGTERM ends it as Ctrl+C does; later only the rest is done."""
    flag = tmp_path / "never"
    tasks = [task_in(tmp_path, "quick"), task_in(tmp_path, "endless", **{"waits for": str(flag)})]

    def interrupt() -> None:
        wait_for(tmp_path / "endless.calls")
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=interrupt, daemon=True).start()
    summary = run_in(tmp_path, tasks, processes=1)
    assert summary.interrupted
    assert [outcome.task.name for outcome in summary.outcomes] == ["quick"]
    assert (tmp_path / "results" / "results.csv").read_text().count("\n") == 2
    flag.touch()
    again = run_in(tmp_path, tasks, processes=1)
    assert [outcome.status for outcome in again.outcomes] == ["kept", "computed"]
    assert [calls_of(task) for task in tasks] == [1, 2]


class TestMemory:
    def test_who_asks_first_is_served_first(self) -> None:
        budget = MemoryBudget(10.0)
        assert budget.ask("a", 6.0) == ["a"]
        assert budget.ask("large", 9.0) == []
        assert budget.ask("small", 1.0) == []  # or the large one would wait for ever
        assert budget.give_back("a") == ["large", "small"]

    def test_who_is_alone_gets_what_there_is(self) -> None:
        budget = MemoryBudget(10.0)
        assert budget.ask("a", 30.0) == ["a"]
        assert budget.ask("b", 1.0) == []
        assert budget.give_back("a") == ["b"]

    def test_who_is_lost_waits_no_longer(self) -> None:
        budget = MemoryBudget(10.0)
        budget.ask("a", 8.0)
        budget.ask("lost", 8.0)
        assert budget.ask("c", 2.0) == []
        assert budget.give_back("lost") == ["c"]

    def test_what_never_fits_is_told(self) -> None:
        assert why_too_large(1e9, 1e9 + BASE_BYTES) == ""
        assert "simplify it to about" in why_too_large(1.1e9, 1e9 + BASE_BYTES)
        assert "allow for more" in why_too_large(1.0, BASE_BYTES)
