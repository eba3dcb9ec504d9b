"""The controls beside the picture: each gets the state it shows and the calls it may make, not the window."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QFormLayout,
    QFrame,
    QGridLayout,
    QGroupBox,
    QLabel,
    QLineEdit,
    QPushButton,
    QScrollArea,
    QSlider,
    QSpinBox,
    QStyle,
    QVBoxLayout,
    QWidget,
)

from idviewer.session import MAX_ISOLINES, Frame, PlaneCommands, Point, State
from idviewer.view.colormaps import COLORMAPS
from idviewer.view.coordinate_text import format_coordinate
from idviewer.view.panel_distance import DistanceGroup
from idviewer.view.panel_planes import PlanesGroup
from idviewer.view.parameter_rows import choice
from idviewer.view.polygon_view import is_2d


@dataclass(frozen=True)
class Calls:
    """Calls that controls may make: change fields of the query or the display, say what cannot be done."""

    set: Callable[..., None]
    complain: Callable[[str], None]


class Panel(QScrollArea):
    """Source, slicing planes, the distance, and what is shown."""

    def __init__(self, calls: Calls, plane_commands: PlaneCommands, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.source, self.planes = SourceGroup(calls), PlanesGroup(calls, plane_commands)
        self.distance, self.show_group = DistanceGroup(calls), ShowGroup(calls)
        self._groups = (self.source, self.planes, self.distance, self.show_group)
        self._content = content = QWidget()
        layout = QVBoxLayout(content)
        layout.setContentsMargins(10, 8, 10, 8)
        layout.setSpacing(12)
        for group in self._groups:
            layout.addWidget(group)
        layout.addStretch(1)
        self.setWidget(content)
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        content.setEnabled(False)
        bar = self.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent)
        self.setMinimumWidth(content.minimumSizeHint().width() + bar)

    def show_state(self, state: State, frame: Frame | None) -> None:
        """Show the state; frame tells where the barycentroid is, and lambda_2."""
        self._content.setEnabled(state.shape is not None)
        self.planes.setVisible(not is_2d(state.shape))
        for group in self._groups:
            group.show_state(state, frame)


class SourceGroup(QGroupBox):
    """Controls of the source, from which distances are measured."""

    def __init__(self, calls: Calls) -> None:
        super().__init__("Source")
        self._calls = calls
        self._source: Point | None = None
        self._size = 1.0
        self._in_2d = False
        self.fields = tuple(_field(name) for name in "xyz")
        self.at_barycentroid = QPushButton("At the barycentroid")
        self.at_barycentroid.clicked.connect(lambda: calls.set(source=None))
        self._names = tuple(QLabel(name, alignment=Qt.AlignmentFlag.AlignHCenter) for name in "xyz")
        layout = QGridLayout(self)
        for column, (name, edit) in enumerate(zip(self._names, self.fields, strict=True)):
            layout.addWidget(name, 0, column)
            layout.addWidget(edit, 1, column)
            edit.editingFinished.connect(self._typed)
        layout.addWidget(self.at_barycentroid, 2, 0, 1, 3)

    def show_state(self, state: State, frame: Frame | None) -> None:
        """Show the coordinates, also those that were only computed."""
        source = state.query.source
        if source is None and frame is not None and frame.query.source is None:
            source = tuple(frame.source.tolist())
        self.at_barycentroid.setEnabled(state.query.source is not None)
        for widget in (self._names[2], self.fields[2]):
            widget.setVisible(not is_2d(state.shape))
        self._in_2d = is_2d(state.shape)
        if source != self._source:
            self._source, self._size = source, state.shape.diagonal if state.shape is not None else 1.0
            self._restore()

    def _restore(self) -> None:
        values = self._source if self._source is not None else (None, None, None)
        for edit, value in zip(self.fields, values, strict=True):
            edit.setText("" if value is None else format_coordinate(value, self._size))
            edit.setCursorPosition(0)

    def _typed(self) -> None:
        """Take what was typed alone: the other coordinates must not be rounded to what is shown."""
        edited = [edit for edit in self.fields if edit.isModified()]
        if not edited:
            return
        for edit in edited:
            edit.setModified(False)
        pasted = edited[0].text().replace(",", " ").split()
        try:
            if len(pasted) == 3 or (self._in_2d and len(pasted) == 2):
                x, y, z = (*map(float, pasted), 0.0)[:3]
            else:
                exact = self._source if self._source is not None else (None, None, None)
                x, y, z = (
                    float(edit.text()) if edit in edited or value is None else value
                    for edit, value in zip(self.fields, exact, strict=True)
                )
            if not all(map(math.isfinite, (x, y, z))):
                raise ValueError("infinitely far")
        except ValueError:
            self._calls.complain(f"“{edited[0].text()}” is not a coordinate.")
            self._restore()
            return
        self._calls.set(source=(x, y, z))


class ShowGroup(QGroupBox):
    """Controls of the quantity shown, and of its look."""

    def __init__(self, calls: Calls) -> None:
        super().__init__("Show")
        self.quantity = choice([("distance", "Distance from the source"), ("potential", "Potential U")])
        self.colormap = choice(COLORMAPS.items())
        self.isolines = QSpinBox()
        self.isolines.setRange(0, MAX_ISOLINES)
        self.isolines.setSpecialValueText("none")
        self.opacity = QSlider(Qt.Orientation.Horizontal)
        self.opacity.setRange(0, 100)
        self.vertices = QCheckBox("Vertices to drag")
        self.barycentroid = QCheckBox("Barycentroid")
        self.scale_bar = QCheckBox("Scale bar")
        self._lay_out()
        self._connect(calls)

    def _lay_out(self) -> None:
        self._form = layout = QFormLayout(self)
        layout.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.ExpandingFieldsGrow)
        rows = {
            "Quantity": self.quantity,
            "Isolines": self.isolines,
            "Colours": self.colormap,
            "Body opacity": self.opacity,
        }
        for label, widget in rows.items():
            layout.addRow(label, widget)
        ticks = QGridLayout()
        ticks.addWidget(self.barycentroid, 0, 0)
        ticks.addWidget(self.scale_bar, 0, 1)
        ticks.addWidget(self.vertices, 1, 0, 1, 2)
        layout.addRow(ticks)
        self.vertices.setToolTip(
            "Drag a vertex and the distances follow; with Shift its neighbours come along"
        )
        self.opacity.setToolTip("How opaque the body is")
        self.isolines.setToolTip("Number of equal steps between isolines")

    def _connect(self, calls: Calls) -> None:
        self.quantity.activated.connect(lambda: calls.set(quantity=self.quantity.currentData()))
        self.colormap.activated.connect(lambda: calls.set(colormap=self.colormap.currentData()))
        self.isolines.valueChanged.connect(lambda value: calls.set(isolines=value))
        self.opacity.valueChanged.connect(lambda value: calls.set(opacity=value / 100))
        self.barycentroid.clicked.connect(lambda on: calls.set(barycentroid=on))
        self.scale_bar.clicked.connect(lambda on: calls.set(scale_bar=on))
        self.vertices.clicked.connect(lambda on: calls.set(handle=on))

    def show_state(self, state: State, frame: Frame | None) -> None:
        """Show the state without calling anything."""
        query, display = state.query, state.display
        for box, value in (
            (self.quantity, query.quantity),
            (self.colormap, display.colormap),
        ):
            box.setCurrentIndex(box.findData(value))
        with QSignalBlocker(self.isolines):
            self.isolines.setValue(display.isolines)
        with QSignalBlocker(self.opacity):
            self.opacity.setValue(round(100 * display.opacity))
        self.barycentroid.setChecked(display.barycentroid)
        self.scale_bar.setChecked(display.scale_bar)
        self.vertices.setChecked(display.handle)
        in_2d = is_2d(state.shape)
        if in_2d == self._form.isRowVisible(self.opacity):
            self._form.setRowVisible(self.opacity, not in_2d)
        self.vertices.setVisible(in_2d)


def _field(name: str) -> QLineEdit:
    edit = QLineEdit()
    edit.setMinimumWidth(72)
    edit.setToolTip(f"{name} of the source, in the shape's unit; all coordinates may be pasted at once")
    return edit
