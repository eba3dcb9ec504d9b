"""Drives a window as its user does: real events of the X server, sent with xdotool.

No window manager runs under Xvfb, so windows are shown at 0, 0 and ask for the keyboard themselves.
"""

from __future__ import annotations

import shutil
import subprocess
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from PySide6.QtCore import QEvent, QObject, QPoint, QPointF
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

MISSING = (
    "the window tests need xdotool, and there is none: `make test` installs it, or `apt-get install xdotool`"
)


class _Watch(QObject):
    """Counts the events that Qt delivers, so that a test goes on when they have arrived and not earlier."""

    def __init__(self) -> None:
        super().__init__()
        self.seen: Counter[QEvent.Type] = Counter()
        self.at = QPointF(-1, -1)
        QApplication.instance().installEventFilter(self)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:  # noqa: N802
        if isinstance(event, QMouseEvent):
            self.at = event.globalPosition()
        self.seen[event.type()] += 1
        return False


class Mouse:
    """The mouse and the keyboard. Positions are a widget's, in device-independent pixels."""

    def __init__(self, qtbot: QtBot) -> None:
        if shutil.which("xdotool") is None:
            pytest.fail(MISSING, pytrace=False)
        self._qtbot = qtbot
        self._watch = _Watch()

    def close(self) -> None:
        """Stops watching."""
        QApplication.instance().removeEventFilter(self._watch)

    def move(self, widget: QWidget, x: float, y: float) -> None:
        """To a position, and waits until the window knows."""
        to_x, to_y = _device(widget, x, y)
        _xdotool("mousemove", to_x, to_y)
        scale = widget.devicePixelRatioF()
        self._wait(lambda: (self._watch.at * scale - QPointF(to_x, to_y)).manhattanLength() < 1)

    def press(self, widget: QWidget, x: float, y: float, button: int = 1, keys: tuple[str, ...] = ()) -> None:
        """A button down, with keys like "shift" or "ctrl" held."""
        self._come(widget, x, y)
        for key in keys:
            _xdotool("keydown", key)
        with self._arrives(QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonDblClick):
            _xdotool("mousedown", button)

    def release(self, button: int = 1, keys: tuple[str, ...] = ()) -> None:
        """The button and the keys up."""
        with self._arrives(QEvent.Type.MouseButtonRelease):
            _xdotool("mouseup", button)
        for key in keys:
            _xdotool("keyup", key)

    def release_anywhere(self, button: int = 1) -> None:
        """The button up, when no window is there any more to be told."""
        _xdotool("mouseup", button)

    def click(
        self, widget: QWidget, x: float = -1, y: float = -1, button: int = 1, keys: tuple[str, ...] = ()
    ) -> None:
        """On a position, or on the widget's middle."""
        if x < 0:
            x, y = widget.width() // 2, widget.height() // 2
        self.press(widget, x, y, button, keys)
        self.release(button, keys)

    def drag(
        self,
        widget: QWidget,
        start: tuple[float, float],
        end: tuple[float, float],
        steps: int = 8,
        **how: object,
    ) -> None:
        """From start to end in steps; `how` as for `press`."""
        self.press(widget, *start, **how)  # type: ignore[arg-type]
        for step in range(1, steps + 1):
            self.move(widget, *(a + (b - a) * step / steps for a, b in zip(start, end, strict=True)))
        self.release(**how)  # type: ignore[arg-type]

    def swing(self, widget: QWidget, way: list[tuple[float, float]]) -> None:
        """Along the way with the button down, as fast as a hand: nothing waits for the window but the end."""
        self._come(widget, *way[0])
        moves = [("mousemove", *_device(widget, x, y), "sleep", 0.008) for x, y in way[1:]]
        with self._arrives(QEvent.Type.MouseButtonRelease):
            _xdotool("mousedown", 1, *(word for move in moves for word in move), "mouseup", 1)

    def drag_from_elsewhere(self, start: tuple[int, int], widget: QWidget, x: float, y: float) -> None:
        """From another program's window at `start`, in the X server's pixels, to a position of ours."""
        end = _device(widget, x, y)
        _xdotool("mousemove", *start, "mousedown", 1)
        for step in range(1, 11):
            _xdotool("mousemove", *(round(a + (b - a) * step / 10) for a, b in zip(start, end, strict=True)))
            self._qtbot.wait(20)  # the other program has to follow
        _xdotool("mousemove", end[0] + 1, end[1], "mouseup", 1)

    def wheel(self, widget: QWidget, x: float, y: float, notches: int) -> None:
        """Upwards for a positive number."""
        self._come(widget, x, y)
        for _ in range(abs(notches)):
            with self._arrives(QEvent.Type.Wheel):
                _xdotool("click", 4 if notches > 0 else 5)

    def press_key(self, key: str) -> None:
        """Down, until a `release` with this key."""
        with self._arrives(QEvent.Type.KeyPress):
            _xdotool("keydown", key)

    def key(self, *keys: str) -> None:
        """Keys or combinations, as "ctrl+o"."""
        for key in keys:
            with self._arrives(QEvent.Type.KeyRelease):
                _xdotool("key", key)

    def type(self, text: str) -> None:
        """Characters into whatever has the keyboard."""
        goal = self._watch.seen[QEvent.Type.KeyRelease] + len(text)
        _xdotool("type", "--delay", 1, text)
        self._wait(lambda: self._watch.seen[QEvent.Type.KeyRelease] >= goal)

    def _come(self, widget: QWidget, x: float, y: float) -> None:
        # A mouse that is there already would not be told to have moved.
        self.move(widget, x + 1, y)
        self.move(widget, x, y)

    @contextmanager
    def _arrives(self, *kinds: QEvent.Type) -> Iterator[None]:
        before = sum(self._watch.seen[kind] for kind in kinds)
        yield
        self._wait(lambda: sum(self._watch.seen[kind] for kind in kinds) > before)

    def _wait(self, condition: object) -> None:
        self._qtbot.waitUntil(condition)


def _device(widget: QWidget, x: float, y: float) -> tuple[int, int]:
    """A widget's position in the X server's pixels."""
    corner, scale = widget.mapToGlobal(QPoint(0, 0)), widget.devicePixelRatioF()
    return round((corner.x() + x) * scale), round((corner.y() + y) * scale)


def _xdotool(*arguments: object) -> None:
    subprocess.run(["xdotool", *map(str, arguments)], check=True)
