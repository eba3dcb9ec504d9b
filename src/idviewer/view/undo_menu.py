"""Undo and redo in the menu: repairs of a mesh, or moves of a polygon's vertices."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtGui import QAction

from idviewer.session import RepairDesk
from idviewer.view.polygon_edits import PolygonEdits

NOTHING_TIP = "No vertex has been moved, and no mesh repaired"


class UndoMenu:
    """Takes back what was done last: of a polygon a move, of a mesh its repairs."""

    def __init__(self, edits: PolygonEdits, desk: RepairDesk) -> None:
        self._edits, self._desk = edits, desk

    def undo(self) -> None:
        """Take back what was done last."""
        (self._edits.undo if self._edits.can_undo else self._desk.undo)()

    def redo(self) -> None:
        """Do again what was taken back last."""
        (self._edits.redo if self._edits.can_redo else self._desk.redo)()

    def show(self, actions: Mapping[str, QAction]) -> None:
        """Name in the menu what would be taken back or done again."""
        for name, moved, repair in (
            ("undo", self._edits.can_undo, self._desk.undo_title),
            ("redo", self._edits.can_redo, self._desk.redo_title),
        ):
            what = repair.lower() if repair and not moved else "moving a vertex"
            actions[name].setText(f"&{name.capitalize()} {what}")
            actions[name].setEnabled(moved or bool(repair))
            actions[name].setToolTip("" if moved or repair else NOTHING_TIP)
