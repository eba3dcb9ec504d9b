"""A few random events on a window, and closes in every phase of its work; `make soak` does it for a night."""

from __future__ import annotations

from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot
from tests.core import meshfiles, shapes
from tests.view import closes
from tests.view.heard import Heard
from tests.view.random_events import RandomEvents, write_files
from tests.view.windows import FirstFrames, show_shape, told

EVENTS, SEED = 120, 20090715


@pytest.mark.slow
def test_random_events_do_no_harm(qtbot: QtBot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    files, heard = write_files(tmp_path), Heard()
    with heard.listen():
        events = RandomEvents(show_shape(qtbot, files[0], size=(700, 500)), files, SEED, heard)
        for _ in range(4):
            events.play(EVENTS // 4)
            events.come_to_rest()
    assert not heard.complaints, "\n".join(heard.complaints)
    assert sum(events.done.values()) == EVENTS


@pytest.mark.slow
def test_a_picture_that_is_not_that_of_the_state_is_noticed(qtbot: QtBot, tmp_path: Path) -> None:
    files, heard = write_files(tmp_path), Heard()
    window = show_shape(qtbot, files[0], size=(500, 400))
    events = RandomEvents(window, files, SEED, heard)
    events.come_to_rest()
    assert not heard.complaints
    window.viewport.show_frame(None)
    events.come_to_rest()
    assert "stale picture" in heard.complaints.pop()
    window.session.stopped = True
    window.session.set(source=(0.1, 0.0, 0.0))
    events.come_to_rest()
    assert "stale frame" in heard.complaints[0]


@pytest.mark.slow
@pytest.mark.parametrize("phase", ["simplifying", "first frame", "discretisation", "repairing", "dialog"])
def test_a_window_is_closed_in_a_phase(qtbot: QtBot, tmp_path: Path, phase: str) -> None:
    heard = Heard()
    with heard.listen(), closes.small_previews():
        assert closes.close_in(closes.phases(tmp_path)[phase], 0)
    assert not heard.complaints


@pytest.mark.slow
def test_work_that_was_cancelled_is_so_still_when_another_file_is_refused(
    qtbot: QtBot, tmp_path: Path
) -> None:
    window = show_shape(qtbot, write_files(tmp_path)[0], work=FirstFrames().work)
    window.session.set(source=(0.1, 0.0, 0.0))
    window.cancel()
    assert window.status.stage.text() == "Cancelled"
    broken = tmp_path / "broken.off"
    broken.write_bytes(meshfiles.off(*shapes.icosphere(1))[:300])
    window.open(broken)
    told(qtbot, window, "broken.off")
    qtbot.waitUntil(lambda: not window.session.busy)
    assert window.session.frame.query != window.session.state.query
    assert window.status.stage.isVisible()
    assert window.status.stage.text() == "Cancelled"
    window.status.button.click()
    qtbot.waitUntil(lambda: window.session.frame.query == window.session.state.query)
