"""Mouse state: which button is down, what it hit, and how the cursor shows that."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QPointF, Qt

from idviewer.view.handle_geometry import Drag, Part
from idviewer.view.vertex_geometry import VertexDrag

Hit = Part | int
"""Things that the mouse can hit and grab: a part of the plane's handle, or a polygon's vertex by number."""

CLICK_MAX_MOVE_PX, CLICK_MAX_MS = 4.0, 800
"""A click moves less than so many device-independent pixels and lasts less than so many milliseconds."""
_CURSORS = {
    Part.PUSH: Qt.CursorShape.SizeVerCursor,
    Part.TURN: Qt.CursorShape.PointingHandCursor,
    Part.MOVE: Qt.CursorShape.SizeAllCursor,
}


@dataclass
class MouseState:
    """State of the mouse while a button is down."""

    at: QPointF
    button: Qt.MouseButton
    modifiers: Qt.KeyboardModifier
    time: int
    drag: Drag | None = None
    vertex: VertexDrag | None = None
    panning: bool = False
    moved: bool = False
    cancelled: bool = False


def is_shift(modifiers: Qt.KeyboardModifier) -> bool:
    """Whether the shift key is held."""
    return bool(modifiers & Qt.KeyboardModifier.ShiftModifier)


def target_of(modifiers: Qt.KeyboardModifier) -> str:
    """The target of a click with these keys held."""
    if modifiers & Qt.KeyboardModifier.ControlModifier:
        return "chord"
    return "surface" if is_shift(modifiers) else "slice-or-body"


def cursor_for(hit: Hit | None) -> Qt.CursorShape:
    """The cursor over what can be grabbed."""
    if isinstance(hit, int):
        return Qt.CursorShape.SizeAllCursor
    return _CURSORS[hit] if hit is not None else Qt.CursorShape.ArrowCursor
