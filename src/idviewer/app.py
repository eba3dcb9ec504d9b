"""The composition root: makes the application, the session and the window, and wires them."""

from __future__ import annotations

import logging
import sys
from pathlib import Path
from types import TracebackType

import pyvista as pv
from PySide6.QtWidgets import QApplication

from idviewer.core import sample_path
from idviewer.core.io import DEFAULT_SAMPLE
from idviewer.session import Pipeline, Session, SpectrumCache, Work
from idviewer.view.gui_thread import Post
from idviewer.view.vtk_files import register_vtk_reader
from idviewer.view.window import MainWindow


def make_window(work: Work | None = None, cache: SpectrumCache | None = None) -> MainWindow:
    """A window with a session of its own, whose requests work answers; a QApplication must exist."""
    register_vtk_reader()
    post = Post()
    answer = work or Pipeline(cache, previews=True, errors=True).results
    return MainWindow(Session(post, answer, cache), post)


def run_window(path: Path | None, cache: SpectrumCache | None = None) -> int:
    """Show the window on a mesh, or on a bundled shape, until it is closed; return the exit status."""
    logging.basicConfig(format="%(levelname)s: %(message)s")
    application = QApplication.instance() or QApplication(sys.argv[:1])
    application.setApplicationName("idviewer")
    pv.enable_smp_tools()
    window = make_window(cache=cache)
    _show_uncaught(window)
    window.show()
    window.open(path if path is not None else sample_path(DEFAULT_SAMPLE))
    return application.exec()


def _show_uncaught(window: MainWindow) -> None:
    """An error nobody expected becomes a line in the window and a trace in the log, not the program's end."""

    def hook(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if issubclass(kind, KeyboardInterrupt):
            sys.__excepthook__(kind, error, trace)
            window.close()
        else:
            window.on_failed(error)

    sys.excepthook = hook
