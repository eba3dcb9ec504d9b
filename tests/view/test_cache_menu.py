"""The menu line that clears the cache."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtWidgets import QMenu
from pytestqt.qtbot import QtBot
from tests.view.mouse import Mouse
from tests.view.windows import Gate, show_window, wait_until_done, write_ellipsoid

from idviewer.core.io.bundled_shapes import sample_path
from idviewer.session.pipeline import Pipeline
from idviewer.session.spectrum_cache import SpectrumCache
from idviewer.view.window import MainWindow

pytestmark = pytest.mark.slow


@pytest.fixture
def cache(tmp_path: Path) -> SpectrumCache:
    cache = SpectrumCache(tmp_path / "cache", worth=0.0)
    cache.folder.mkdir()
    cache._files.file("ab").write_bytes(bytes(25_600_000))
    return cache


def open_file_menu(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> QMenu:
    bar = window.menuBar()
    file = bar.actions()[0]
    place = bar.actionGeometry(file).center()
    mouse.click(bar, place.x(), place.y())
    menu = file.menu()
    qtbot.waitUntil(menu.isVisible)
    return menu


def test_it_tells_the_size_and_what_was_freed(qtbot: QtBot, mouse: Mouse, cache: SpectrumCache) -> None:
    window = show_window(qtbot, cache=cache)
    action = window.actions_by_name["clear_cache"]
    menu = open_file_menu(qtbot, mouse, window)
    assert action.text() == "&Clear cache (26 MB)"
    place = menu.actionGeometry(action).center()
    mouse.click(menu, place.x(), place.y())
    qtbot.waitUntil(lambda: window.status.currentMessage() == "The cache is empty; 26 MB freed")
    assert cache.size == 0
    open_file_menu(qtbot, mouse, window)
    assert action.text() == "&Clear cache (empty)"
    mouse.key("Escape")
    mouse.key("Escape")


def test_it_works_while_something_is_computed(qtbot: QtBot, cache: SpectrumCache, tmp_path: Path) -> None:
    gate = Gate()
    window = show_window(qtbot, gate.work, cache=cache)
    window.open(write_ellipsoid(tmp_path))
    qtbot.waitUntil(lambda: window.session.busy and window.session.state.shape is not None)
    window.actions_by_name["clear_cache"].trigger()
    assert window.status.currentMessage() == "The cache is empty; 26 MB freed"
    assert window.session.busy
    gate.let_through()
    wait_until_done(qtbot, window.session)


def test_without_a_cache_it_says_why_it_does_nothing(qtbot: QtBot) -> None:
    window = show_window(qtbot)
    action = window.actions_by_name["clear_cache"]
    assert not action.isEnabled()
    assert "without a cache" in action.toolTip()


def test_a_damaged_file_is_a_note_in_the_window(qtbot: QtBot, tmp_path: Path) -> None:
    path, cache = sample_path("hand_2k"), SpectrumCache(tmp_path / "cache", worth=0.0)

    def note() -> str:
        window = show_window(qtbot, Pipeline(cache).results)
        window.open(path)
        wait_until_done(qtbot, window.session)
        text = window.messages.text
        assert not text or window.messages.kind == "note"
        window.close()
        return text

    assert note() == ""
    (eigenpairs,) = (one for one in cache.folder.iterdir() if not one.stem.endswith("-view"))
    eigenpairs.write_text("damaged")
    assert "computed again" in note()
    assert note() == ""
