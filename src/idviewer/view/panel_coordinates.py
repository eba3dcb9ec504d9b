"""Choice of the coordinates that carry distances inside: built from their registry."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from PySide6.QtCore import Qt
from PySide6.QtGui import QStandardItemModel
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QWidget

from idviewer.core.coordinates import COORDINATES, Coordinates, Property
from idviewer.session import State
from idviewer.view.parameter_rows import choice


class _Calls(Protocol):
    def set(self, **fields: object) -> None: ...


class _Kind(Protocol):
    dimensions: Any


class CoordinatesRow(QWidget):
    """A box with the kinds of coordinates; its tool tip tells what those chosen fulfil."""

    def __init__(self, calls: _Calls) -> None:
        super().__init__()
        self.box = choice((name, kind.title) for name, kind in COORDINATES.items())
        self.box.activated.connect(lambda: calls.set(coordinates=self.box.currentData()))
        self._dimension, self._shown = 0, ""
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(QLabel("Inside by"))
        layout.addWidget(self.box, 1)

    def show_state(self, state: State) -> None:
        """Show the state without calling anything."""
        if state.shape is not None and state.shape.dimension != self._dimension:
            self._dimension = state.shape.dimension
            fit(self.box, COORDINATES, self._dimension)
            for row, kind in enumerate(COORDINATES.values()):
                if self._dimension in kind.dimensions:
                    self.box.setItemData(row, properties_html(kind), Qt.ItemDataRole.ToolTipRole)
        if state.query.coordinates != self._shown:
            self._shown = state.query.coordinates
            self.box.setToolTip(properties_html(COORDINATES[state.query.coordinates]))
        # Also where nothing has changed but what was chosen and refused.
        self.box.setCurrentIndex(self.box.findData(state.query.coordinates))


def properties_html(kind: type[Coordinates]) -> str:
    """A list of the properties that a kind of coordinates has, and of those it has not."""
    lines = [
        f"{'✓' if one in kind.properties else '✗'} {one.name.replace('_', ' ').lower()}: {one.value}"
        for one in Property
    ]
    escaped = "<br>".join(line.replace(">", "&gt;") for line in lines)
    return f"<p style='white-space:pre'><b>{kind.title}</b> carry distances inside<br>{escaped}</p>"


def fit(box: QComboBox, kinds: Mapping[str, _Kind], dimension: int) -> None:
    """Disable those lines of a box whose kinds do not work in a dimension, and say why."""
    model = box.model()
    assert isinstance(model, QStandardItemModel)
    for row in range(box.count()):
        dimensions = kinds[box.itemData(row)].dimensions
        works = dimension in dimensions
        where = " and ".join(f"{one}D" for one in dimensions)
        model.item(row).setEnabled(works)
        model.item(row).setToolTip("" if works else f"Works in {where}, and this shape is {dimension}D")
