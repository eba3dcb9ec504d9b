"""While eigenpairs are computed, the window shows a preview and says so."""

from __future__ import annotations

import pytest
from pytestqt.qtbot import QtBot
from tests.view.windows import show_window

from idviewer.core.interior import preview
from idviewer.core.io.bundled_shapes import sample_path
from idviewer.session.pipeline import Pipeline
from idviewer.view.window import MainWindow

pytestmark = pytest.mark.slow

STAGES = ("Simplifying the mesh", "Computing coarse eigenpairs", "Refining eigenpairs")


@pytest.fixture(autouse=True)
def _small(monkeypatch):
    settings = preview.PreviewSettings(least_vertices=2000, vertices=1200, coarser_vertices=300)
    monkeypatch.setattr(preview, "PREVIEW_SETTINGS", settings)


def opened(qtbot: QtBot) -> MainWindow:
    window = show_window(qtbot, Pipeline(previews=True).results)
    window.open(sample_path("hand_2k"))
    return window


def test_a_preview_is_marked_until_the_final_picture_is_there(qtbot: QtBot) -> None:
    window = opened(qtbot)
    frames = []
    window.session.frame_ready.connect(
        lambda frame: frames.append((frame.preview, window.status.preview.text()))
    )
    qtbot.waitUntil(lambda: bool(frames) and window.session.frame.exact)
    assert frames[0][0] is not None
    for error, words in frames:
        assert words.startswith("Preview, error about") == (error is not None)
    assert not window.status.preview.isVisible()


@pytest.mark.parametrize("stage", STAGES)
def test_cancelled_in_a_stage_the_window_says_what_it_shows_and_goes_on_when_asked(
    qtbot: QtBot, stage: str
) -> None:
    window = opened(qtbot)
    stages: list[str] = []

    def cancel_there(progress: object) -> None:
        stages.append(getattr(progress, "stage", ""))
        if stages[-1] == stage and stages.count(stage) == 2:
            window.cancel()

    window.session.progressed.connect(cancel_there)
    qtbot.waitUntil(lambda: stage in stages and not window.session.busy)
    shown = window.session.frame
    assert window.status.stage.text() == "Cancelled"
    assert window.status.preview.isVisible() == (shown is not None)
    assert "refining" not in window.status.preview.text()
    window.status.button.click()
    qtbot.waitUntil(lambda: window.session.frame is not None and window.session.frame.exact)
    assert not window.status.preview.isVisible()


@pytest.mark.parametrize("stage", STAGES)
def test_it_closes_in_a_stage(qtbot: QtBot, stage: str) -> None:
    window = opened(qtbot)
    stages: list[str] = []
    window.session.progressed.connect(lambda progress: stages.append(getattr(progress, "stage", "")))
    qtbot.waitUntil(lambda: stage in stages)
    window.close()
