"""What the window tests share: a small shape, a window that is shown, and work that waits for a gate."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent, QImage
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot
from tests.core import shapes
from trimesh import Trimesh

from idviewer.app import make_window
from idviewer.session.pipeline import Pipeline
from idviewer.session.runner import Work
from idviewer.session.session import Session
from idviewer.session.spectrum_cache import SpectrumCache
from idviewer.session.state import Frame, FrameRequest, Progress, Request, Result
from idviewer.view.handle_geometry import Part
from idviewer.view.viewport import Viewport
from idviewer.view.window import MainWindow

SIZE = (1000, 640)
AXES = np.array([1.6, 0.6, 0.4])
"""Of the test shape: long in x, flat in z."""


def write_ellipsoid(folder: Path, name: str = "ellipsoid.ply") -> Path:
    """A file with an ellipsoid."""
    vertices, faces = shapes.icosphere(3)
    path = folder / name
    Trimesh(vertices * AXES, faces, process=False).export(path)
    return path


def show_window(
    qtbot: QtBot,
    work: Work | None = None,
    size: tuple[int, int] = SIZE,
    cache: SpectrumCache | None = None,
) -> MainWindow:
    """A window in the corner of the screen that has the keyboard; the test's end closes it."""
    window = make_window(work or FirstFrames().work, cache)
    qtbot.addWidget(window)
    window.move(0, 0)
    window.resize(*size)
    with qtbot.waitExposed(window):
        window.show()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)
    return window


def show_shape(qtbot: QtBot, path: Path, **how: object) -> MainWindow:
    """A window whose final frame of the file's shape is there."""
    window = show_window(qtbot, **how)  # type: ignore[arg-type]
    window.open(path)
    wait_until_done(qtbot, window.session)
    return window


def wait_until_done(qtbot: QtBot, session: Session) -> Frame:
    """The final frame of what the session's state asks for."""

    def done() -> bool:
        frame, state = session.frame, session.state
        return (
            not session.busy
            and frame is not None
            and (frame.shape, frame.query) == (state.shape, state.query)
        )

    errors: list[BaseException] = []
    session.failed.connect(errors.append)
    try:
        qtbot.waitUntil(lambda: bool(errors) or done())
    finally:
        session.failed.disconnect(errors.append)
    assert not errors, errors
    assert session.frame is not None
    return session.frame


class FirstFrames:
    """Work that is the pipeline's, but only the coarsest frame of each request: enough for a window."""

    def __init__(self) -> None:
        self._pipeline = Pipeline()

    def work(self, request: Request) -> Iterator[Result | None]:
        """As `Pipeline.results`."""
        for result in self._pipeline.results(request):
            yield result
            if isinstance(result, Frame):
                return


class Gate(FirstFrames):
    """The same, but frames wait, reporting progress, until they are let through."""

    def __init__(self) -> None:
        super().__init__()
        self._open = threading.Event()

    def work(self, request: Request) -> Iterator[Result | None]:
        """As `Pipeline.results`."""
        if isinstance(request, FrameRequest):
            while not self._open.wait(0.005):
                yield Progress("Waiting at the gate", 0.5)
        yield from super().work(request)

    def let_through(self) -> None:
        """From now on nothing waits."""
        self._open.set()


def pixels_of(window: MainWindow) -> np.ndarray:
    """(h, w, 3) what the screen shows of the picture, in device pixels."""
    image = window.viewport.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    raw = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine() // 4, 4)
    return raw[:, : image.width(), 2::-1].copy()


def focus(qtbot: QtBot, widget: QWidget) -> None:
    """Gives a dialog the keyboard, as a window manager would."""
    widget.activateWindow()
    qtbot.waitUntil(widget.isActiveWindow)


def told(qtbot: QtBot, window: MainWindow, *words: str) -> str:
    """The message bar's text, once it holds these words."""
    qtbot.waitUntil(lambda: all(word in window.messages.text for word in words))
    return window.messages.text


def place(viewport: Viewport, point: object) -> tuple[float, float]:
    """The whole pixel in which a position is shown."""
    scale = viewport.projection.scale
    x, y = np.round(viewport.projection.project([point])[0] * scale) / scale
    return float(x), float(y)


def grip(viewport: Viewport, part: Part) -> tuple[float, float]:
    """Where the handle's part can be grabbed."""
    handle = viewport.handle
    assert handle is not None
    if part is Part.PUSH:
        point = handle.origin + 0.8 * (handle.arrow[1] - handle.origin)
    elif part is Part.MOVE:
        point = handle.origin
    else:
        point = handle.ring[10]
    x, y = place(viewport, point)
    assert handle.part_at(x, y) is part
    return x, y


def drop(window: MainWindow, *paths: Path) -> None:
    """The events that a file manager's drag and drop sends."""
    mime = QMimeData()
    mime.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
    here, how = QPointF(300, 300), (mime, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier)
    with warnings.catch_warnings():
        # Qt changes what it takes from version to version.
        warnings.simplefilter("ignore", DeprecationWarning)
        enter = QDragEnterEvent(here.toPoint(), Qt.DropAction.CopyAction, *how)
    QApplication.sendEvent(window, enter)
    assert enter.isAccepted()
    QApplication.sendEvent(window, QDropEvent(here, Qt.DropAction.CopyAction, *how))


def vertices_of(window: MainWindow) -> np.ndarray:
    """Of the shape that is shown."""
    return window.session.state.shape.vertices


def place_of_vertex(window: MainWindow, vertex: int) -> tuple[float, float]:
    """The pixel of a polygon's vertex."""
    return place(window.viewport, [*vertices_of(window)[vertex], 0.0])
