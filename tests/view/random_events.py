"""Random events on a window, which must keep still about them, and show at rest what it was asked for."""

from __future__ import annotations

import gc
import os
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QDialog,
    QFileDialog,
    QLineEdit,
    QSlider,
    QWidget,
)
from tests.core import meshfiles, shapes
from tests.view.heard import Heard
from tests.view.polygons import write_star
from tests.view.windows import pixels_of, write_ellipsoid

from idviewer.core.memory import release_free_memory
from idviewer.view.dialogs import PictureDialog
from idviewer.view.window import MainWindow

T = TypeVar("T")

NONSENSE = (
    *("", " ", "-1", "0", "nan", "inf", "1e400", "1e-300", "-0.0", "0.3", "0,3", "1 2 3", "0.1, 0, 0.1"),
    *(
        "∞",
        "½",
        "abc",
        "x" * 300,
        "1e",
        "--",
        "0x10",
        "\t",
        "1;2",
        "lambda**2",
        "exp(-t)",
        "(",
        "é\u0301",
        "𝟙",
    ),
)
KEYS = tuple(Qt.Key[f"Key_{name}"] for name in ("Return", "Escape", "Tab", "Up", "PageDown", "Delete"))
NOT_TRIGGERED = ("quit",)
PATIENCE_SECONDS = 300


def write_files(folder: Path) -> list[Path]:
    """Small shapes, whole and broken ones, and what is no shape at all."""
    made = [write_ellipsoid(folder), write_star(folder), folder / "missing.ply"]
    contents = {
        "cube.off": meshfiles.off(*shapes.cube()),
        "torn.off": meshfiles.off(*shapes.opened(shapes.icosphere(1), 2)),
        "two.off": meshfiles.off(*shapes.two_components()),
        "pinched.off": meshfiles.off(*shapes.pinched_cubes()),
        "sheet.off": meshfiles.off(*shapes.flat_sheet()),
        "cut.off": meshfiles.off(*shapes.icosphere(1))[:300],
        "noise.stl": bytes(range(256)),
        "crossed.csv": b"0,0\n1,1\n1,0\n0,1\n",
        "empty.csv": b"",
    }
    for name, content in contents.items():
        (folder / name).write_bytes(content)
        made.append(folder / name)
    return made


class RandomEvents:
    """Plays events on a window, the same ones for the same seed as far as time allows.

    Args:
        window: which is shown.
        files: that are opened.
        seed: of the random numbers.
        heard: where what is wrong is noted.
    """

    def __init__(self, window: MainWindow, files: list[Path], seed: int, heard: Heard) -> None:
        self.window, self.files, self.heard = window, files, heard
        self.rng = np.random.default_rng(seed)
        self.done: Counter[str] = Counter()
        self.last: list[str] = []
        self._kinds: dict[Callable[[], object], int] = {
            self.open_file: 2,
            self.click: 5,
            self.drag: 6,
            self.wheel: 3,
            self.use_control: 14,
            self.use_menu: 6,
            self.press_key: 3,
            self.resize: 1,
            self.cancel: 2,
            self.use_health: 3,
            self.wait_a_little: 2,
        }

    def play(self, count: int) -> None:
        """So many events, without coming to rest."""
        kinds, weights = list(self._kinds), np.array(list(self._kinds.values()), float)
        for _ in range(count):
            event = kinds[self.rng.choice(len(kinds), p=weights / weights.sum())]
            self.done[event.__name__] += 1
            known = len(self.heard.complaints)
            self.last = [*self.last[-14:], event.__name__]
            event()
            self._dismiss_dialogs()
            QApplication.processEvents()
            if len(self.heard.complaints) > known:
                self.heard.complaints[-1] += f"\n  after {', '.join(self.last)}"

    # The events

    def open_file(self) -> None:
        self.window.open(self._one(self.files))

    def click(self) -> None:
        button = Qt.MouseButton.LeftButton if self.rng.random() < 0.8 else Qt.MouseButton.RightButton
        QTest.mouseClick(self.window.viewport, button, self._modifier(), self._place())

    def drag(self) -> None:
        viewport, modifier = self.window.viewport, self._modifier()
        handle = viewport.handle
        start = self._place()
        if handle is not None and self.rng.random() < 0.6:
            x, y = viewport.projection.project([handle.origin])[0]
            if np.isfinite([x, y]).all():
                start = QPoint(int(np.clip(x, 0, 4000)), int(np.clip(y, 0, 4000)))
        QTest.mousePress(viewport, Qt.MouseButton.LeftButton, modifier, start)
        for _ in range(self.rng.integers(1, 8)):
            QTest.mouseMove(viewport, self._place(), 1)
            if self.rng.random() < 0.03:
                self.cancel()
        QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, modifier, self._place())

    def wheel(self) -> None:
        at, turn = QPointF(self._place()), QPoint(0, int(self.rng.integers(-5, 6)) * 120)
        buttons, phase = Qt.MouseButton.NoButton, Qt.ScrollPhase.NoScrollPhase
        viewport = self.window.viewport
        event = QWheelEvent(
            at, viewport.mapToGlobal(at), QPoint(), turn, buttons, self._modifier(), phase, False
        )
        QApplication.sendEvent(viewport, event)

    def use_control(self) -> None:
        self._use_one_of(self.window.panel)

    def use_menu(self) -> None:
        names = [name for name in self.window.actions_by_name if name not in NOT_TRIGGERED]
        self.last[-1] += f" {(name := self._one(names))}"
        self.window.actions_by_name[name].trigger()

    def press_key(self) -> None:
        QTest.keyClick(QApplication.focusWidget() or self.window, self._one(KEYS), self._modifier())

    def resize(self) -> None:
        self.window.resize(*(int(size) for size in self.rng.integers((300, 200), (1280, 800))))

    def cancel(self) -> None:
        QTest.keyClick(self.window, Qt.Key.Key_Escape)
        self.window.cancel()

    def use_health(self) -> None:
        button = self.window.messages.button
        if button.isVisible():
            button.click()
        elif self.window.health.dock.isVisible() and self.rng.random() < 0.1:
            self.window.health.dock.close()
        else:
            self._use_one_of(self.window.health.panel)

    def wait_a_little(self) -> None:
        QTest.qWait(int(self.rng.integers(1, 60)))

    # Rest

    def come_to_rest(self) -> None:
        """Wait until nothing is computed, and note where the picture is not that of the state."""
        session = self.window.session
        for _ in range(PATIENCE_SECONDS * 100):
            QTest.qWait(10)
            if not session.busy:
                break
        else:
            self.heard.complaints.append(f"still busy after {', '.join(self.last)}")
            return
        QTest.qWait(20)
        state, frame = session.state, session.frame
        if state.shape is None or session.busy:
            return
        answers = frame is not None and (frame.shape, frame.query) == (state.shape, state.query)
        stage = self.window.status.stage
        told = stage.isVisible() and stage.text() == "Cancelled"
        if not answers and not told:
            said = f"{self.window.status.stage.text()!r}, {self.window.messages.text!r}"
            self.heard.complaints.append(f"stale frame at rest ({said}) after {', '.join(self.last)}")
        if not self.window.health.is_refused_shown and (stale := self._stale_pixels()):
            self.heard.complaints.append(f"stale picture at rest ({stale}) after {', '.join(self.last)}")

    def open_and_rest(self, path: Path) -> int:
        """Open a file with what is asked of it by default, and return the memory used then, in bytes."""
        self.window.open(path)
        self.come_to_rest()
        self.window.session.resume()
        self.come_to_rest()
        gc.collect()
        release_free_memory()
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE")

    def _stale_pixels(self) -> str:
        """Which pixels change when all of the picture is shown anew, in words; empty where none do."""
        viewport, session = self.window.viewport, self.window.session
        before = pixels_of(self.window)
        viewport.show_frame(None)
        viewport.show_state(session.state)
        viewport.show_frame(session.frame)
        QTest.qWait(20)
        y, x = np.nonzero((before != pixels_of(self.window)).any(axis=2))
        return f"{len(x)} pixels, {x.min()}-{x.max()} x {y.min()}-{y.max()}" if len(x) else ""

    # What events share

    def _one(self, things: Sequence[T]) -> T:
        return things[int(self.rng.integers(len(things)))]

    def _modifier(self) -> Qt.KeyboardModifier:
        shift, none = Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.NoModifier
        return shift if self.rng.random() < 0.2 else none

    def _place(self) -> QPoint:
        size = self.window.viewport.size()
        return QPoint(*(int(self.rng.integers(max(1, one))) for one in (size.width(), size.height())))

    def _use_one_of(self, parent: QWidget) -> None:
        kinds = (QLineEdit, QAbstractButton, QComboBox, QSlider, QAbstractSpinBox)
        found = [one for one in parent.findChildren(QWidget) if isinstance(one, kinds)]
        usable = [one for one in found if one.isVisible() and one.isEnabled()]
        if usable:
            self._use(self._one(usable))

    def _use(self, widget: QWidget) -> None:
        name = type(widget).__name__
        if isinstance(widget, QAbstractButton):
            name += f" {widget.text()!r}"
            widget.click()
        elif isinstance(widget, QComboBox | QSlider):
            ways = Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_Home, Qt.Key.Key_End
            for _ in range(self.rng.integers(1, 6)):
                QTest.keyClick(widget, self._one(ways))
        elif isinstance(widget, QLineEdit | QAbstractSpinBox):
            text = self._one(NONSENSE)
            name += f" {text[:20]!r}"
            widget.setFocus()
            field = widget if isinstance(widget, QLineEdit) else widget.findChild(QLineEdit)
            field.selectAll()
            if text.isascii() and text.isprintable():
                QTest.keyClick(widget, Qt.Key.Key_Backspace)
                QTest.keyClicks(widget, text)
            else:
                field.insert(text)  # as from the clipboard; no key has such a character
            QTest.keyClick(widget, self._one((Qt.Key.Key_Return, Qt.Key.Key_Tab)))
        self.last[-1] += f" {name}"

    def _dismiss_dialogs(self) -> None:
        """Answer the dialogs that are open, now and then later than at once."""
        for dialog in self.window.findChildren(QDialog):
            if not dialog.isVisible() or self.rng.random() < 0.5:
                continue
            self.last[-1] += f" {type(dialog).__name__}"
            if self.rng.random() < 0.4:
                dialog.reject()
            elif isinstance(dialog, QFileDialog):
                # Beside what is read: a mesh that is saved there must not become one that is opened.
                is_saved = dialog.acceptMode() == QFileDialog.AcceptMode.AcceptSave
                path = self.files[0].parent / "saved.ply" if is_saved else self._one(self.files)
                if path.exists() and not is_saved:
                    dialog.fileSelected.emit(str(path))
                dialog.reject()
            elif isinstance(dialog, PictureDialog):
                dialog.width_box.setValue(64)
                dialog.height_box.setValue(48)
                name = self._one(("picture.png", "no folder/picture.png", "", "picture.xyz", "\0", "x" * 300))
                dialog.path.setText(name if name in ("", "\0") else str(self.files[0].parent / name))
                dialog.accept()
            else:
                dialog.accept()
