"""The program as a whole: started from the command line, and errors nobody expected."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot
from tests.view.windows import show_window, write_ellipsoid

from idviewer import app

pytestmark = pytest.mark.slow


def windows_named(title: str) -> list[str]:
    """The X server's visible windows with this title."""
    found = subprocess.run(
        ["xdotool", "search", "--onlyvisible", "--name", title], capture_output=True, text=True
    )
    return found.stdout.split()


def test_the_command_line_opens_a_mesh_and_ctrl_q_ends_it(qtbot: QtBot, tmp_path: Path) -> None:
    path = write_ellipsoid(tmp_path)
    with subprocess.Popen(
        [sys.executable, "-m", "idviewer", str(path)], stderr=subprocess.PIPE, text=True
    ) as it:
        qtbot.waitUntil(lambda: bool(windows_named(f"^{path.name}")))
        window = windows_named(f"^{path.name}")[0]
        subprocess.run(["xdotool", "windowfocus", "--sync", window, "key", "ctrl+q"], check=True)
        _, complaints = it.communicate()
    assert it.returncode == 0
    assert complaints == ""


def test_an_unexpected_error_is_a_line_in_the_window(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    window = show_window(qtbot)
    monkeypatch.setattr(sys, "excepthook", sys.excepthook)
    app._show_uncaught(window)
    error = ZeroDivisionError("a defect")
    sys.excepthook(ZeroDivisionError, error, None)
    assert window.messages.text == "a defect"
    assert window.messages.kind == "error"
    assert caplog.records[0].exc_info[1] is error
    assert window.isVisible()
