"""The window opened from the command line, and machines that can show none."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from tests.cli.commands import QUICK, Run, refused

from idviewer.cli import parsing


class TestWindow:
    @pytest.fixture
    def opened(self, monkeypatch: pytest.MonkeyPatch) -> list[Path | None]:
        """What the window was opened on."""
        opened: list[Path | None] = []
        self.caches = caches = []
        app = SimpleNamespace(run_window=lambda path, cache: opened.append(path) or caches.append(cache) or 7)
        monkeypatch.setitem(sys.modules, "idviewer.app", app)
        monkeypatch.setattr(parsing, "why_no_display", lambda: "")
        monkeypatch.setattr(parsing, "need_window_libraries", lambda: None)
        return opened

    def test_opens_on_a_file(self, run: Run, body: str, opened: list[Path | None]) -> None:
        assert run(body).status == 7
        assert opened == [Path(body)]

    def test_no_cache(self, run: Run, body: str, opened: list[Path | None]) -> None:
        assert (run(body).status, run(body, "--no-cache").status) == (7, 7)
        assert [cache is None for cache in self.caches] == [False, True]

    def test_opens_on_what_it_likes(self, run: Run, opened: list[Path | None]) -> None:
        assert run().status == 7
        assert opened == [None]

    def test_a_missing_library_is_named(self, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(parsing, "why_no_display", lambda: "")
        monkeypatch.setattr(parsing, "_loads", lambda library: library != "libEGL.so.1")
        told = refused(run())
        assert "libEGL.so.1" in told
        assert "apt-get install libegl1`" in told

    def test_a_machine_without_opengl(self, run: Run, body: str, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(parsing, "_loads", lambda library: False)
        told = refused(run("render", body, "out.png", *QUICK))
        assert "there is no OpenGL to draw with" in told
        assert "apt-get install libegl1" in told

    def test_a_machine_with_opengl_but_without_x11(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(parsing, "_loads", lambda library: library == "libEGL.so.1")
        monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", "")
        monkeypatch.delenv("VTK_DEFAULT_OPENGL_WINDOW")
        parsing.need_picture_libraries()
        assert os.environ["VTK_DEFAULT_OPENGL_WINDOW"] == "vtkEGLRenderWindow"

    def test_why_there_is_no_display(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
        monkeypatch.delenv("DISPLAY", raising=False)
        assert "neither DISPLAY nor WAYLAND_DISPLAY" in parsing.why_no_display()
        monkeypatch.setenv("DISPLAY", ":4711")
        assert parsing.why_no_display() == "no X server answers at DISPLAY=:4711"
        monkeypatch.setenv("WAYLAND_DISPLAY", "wayland-0")
        assert parsing.why_no_display() == ""
