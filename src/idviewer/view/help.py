"""The sheet of keys and mouse moves."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLabel, QVBoxLayout, QWidget

SHORTCUTS: dict[str, tuple[tuple[str, str], ...]] = {
    "Source": (
        ("Click", "put the source there: on the slice, or on the body where there is no slice"),
        ("Shift + click", "on the body, also where a slice is in front"),
        ("Ctrl + click", "inside the body, in the middle of what the line of sight first goes through"),
        ("Shift + B", "put the source at the barycentroid"),
        ("B", "show or hide the barycentroid"),
    ),
    "Slicing plane": (
        ("Drag the arrow", "push the plane along its normal"),
        ("Drag the ring", "turn the plane; with Shift it snaps to axes and diagonals"),
        ("Drag the small ring", "move the handle within the plane"),
        ("X  Y  Z", "turn the normal to an axis"),
        ("Page up / Page down", "push the plane by a hundredth; with Shift by a tenth"),
        ("Ctrl + N / Ctrl + Backspace", "add a plane; remove the active one"),
        ("T", "put the plane through the source"),
        ("H", "show or hide the handle"),
    ),
    "Polygon": (
        ("Drag a vertex", "reshape the polygon: the distances follow"),
        ("Shift + drag a vertex", "softly: its neighbours along the outline come with it"),
        ("Click a vertex", "put the source on it"),
        ("Esc", "while dragging: back to where the vertex was"),
        ("Ctrl + Z / Ctrl + Shift + Z", "take a move of a vertex back; make it again"),
        ("Drag elsewhere", "shift the picture"),
        ("H", "show or hide the vertices"),
    ),
    "Camera": (
        ("Drag", "turn"),
        ("Shift + drag, middle or right drag", "shift"),
        ("Wheel", "zoom towards the mouse"),
        ("1  2  3  4  5  6", "from the front, back, left, right, top, bottom"),
        ("0", "face the plane"),
        ("A", "have another axis point upwards"),
        ("R", "reset the view"),
    ),
    "Program": (
        ("Ctrl + O", "open a mesh or a polygon; dropping a file on the window does the same"),
        ("Ctrl + S", "save a picture"),
        ("U", "distance or potential"),
        ("Esc", "cancel the computation"),
        ("F5", "compute again"),
        ("F8", "what is wrong with the mesh, and its repair"),
        ("F9", "show or hide the controls"),
        ("F1", "this sheet"),
        ("Ctrl + Q", "quit"),
    ),
}


SHEET_COLUMNS = (("Source", "Slicing plane", "Polygon"), ("Camera", "Program"))
"""The sheet is no higher than a small screen."""


def sheet_html() -> str:
    """The sheet as rich text."""
    columns = "".join(
        f"<td style='padding-right:36px'>{''.join(map(_part, titles))}</td>" for titles in SHEET_COLUMNS
    )
    return f"<table cellspacing=0 cellpadding=0><tr>{columns}</tr></table>"


def _part(title: str) -> str:
    rows = "".join(
        f"<tr><td style='padding-right:20px'>{k}</td><td>{what}</td></tr>" for k, what in SHORTCUTS[title]
    )
    return f"<p><b>{title}</b></p><table cellspacing=0 cellpadding=2>{rows}</table>"


class HelpSheet(QDialog):
    """Shows the sheet beside the window, which stays usable."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle("Keys and mouse")
        label = QLabel(sheet_html())
        label.setTextFormat(Qt.TextFormat.RichText)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(20, 10, 20, 14)
        layout.addWidget(label)
        layout.addWidget(buttons)
