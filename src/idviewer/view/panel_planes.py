"""The slicing planes' controls."""

from __future__ import annotations

from typing import Protocol

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtWidgets import (
    QButtonGroup,
    QCheckBox,
    QComboBox,
    QDoubleSpinBox,
    QGridLayout,
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QSlider,
)

from idviewer.core import Plane, Shape
from idviewer.core.shapes import AXES
from idviewer.session import Frame, PlaneCommands, State, active_plane, axis_of
from idviewer.view.coordinate_text import format_plane

SLIDER_STEPS = 1000


class _Calls(Protocol):
    def set(self, **fields: object) -> None: ...

    def complain(self, text: str) -> None: ...


class PlanesGroup(QGroupBox):
    """Controls of the planes, and of the active one's position."""

    def __init__(self, calls: _Calls, commands: PlaneCommands) -> None:
        super().__init__("Slicing planes")
        self._calls, self._commands = calls, commands
        self._state = State()
        self.list, self.add, self.remove = QComboBox(), QPushButton("Add"), QPushButton("Remove")
        self.axes = {axis: QPushButton(axis.upper()) for axis in AXES}
        self.slider, self.fraction = QSlider(Qt.Orientation.Horizontal), QDoubleSpinBox()
        self.through_source = QPushButton("Through the source")
        self.pose = QLineEdit()
        self.handle = QCheckBox("Handle in the picture")
        self._lay_out()
        self._connect()

    def _lay_out(self) -> None:
        self.slider.setRange(0, SLIDER_STEPS)
        self.fraction.setRange(0.0, 1.0)
        self.fraction.setDecimals(3)
        self.fraction.setSingleStep(0.01)
        grid = QGridLayout(self)
        top, axes, place = QHBoxLayout(), QHBoxLayout(), QHBoxLayout()
        top.addWidget(self.list, 1)
        for button in (self.add, self.remove):
            top.addWidget(button)
        for axis, button in self.axes.items():
            button.setCheckable(True)
            button.setToolTip(f"Turn the plane's normal to the {axis} axis; its origin stays")
            axes.addWidget(button)
        place.addWidget(self.slider, 1)
        place.addWidget(self.fraction)
        grid.addLayout(top, 0, 0, 1, 2)
        for row, (label, content) in enumerate((("Normal", axes), ("Position", place)), 1):
            grid.addWidget(QLabel(label), row, 0)
            grid.addLayout(content, row, 1)
        grid.addWidget(QLabel("Pose"), 3, 0)
        grid.addWidget(self.pose, 3, 1)
        grid.addWidget(self.through_source, 4, 0, 1, 2)
        grid.addWidget(self.handle, 5, 0, 1, 2)
        grid.setColumnStretch(1, 1)
        self.list.setToolTip("The plane that the handle and these controls move")
        self.fraction.setToolTip("0 is the shape's lowest point along the normal, 1 its highest")
        self.pose.setToolTip("ox,oy,oz/nx,ny,nz (origin/normal) or x=0.5; can be copied and typed")

    def _connect(self) -> None:
        commands = self._commands
        self._group = QButtonGroup(self)
        for axis, button in self.axes.items():
            self._group.addButton(button)
            button.clicked.connect(lambda _on, axis=axis: commands.turn_to(axis))
        self.list.activated.connect(lambda index: self._calls.set(active_plane=index))
        self.add.clicked.connect(commands.add)
        self.remove.clicked.connect(commands.remove)
        self.slider.valueChanged.connect(lambda value: commands.move_to(value / SLIDER_STEPS))
        self.fraction.valueChanged.connect(commands.move_to)
        self.through_source.clicked.connect(commands.move_through_source)
        self.pose.editingFinished.connect(self._typed)
        self.handle.clicked.connect(lambda on: self._calls.set(handle=on))

    def show_state(self, state: State, frame: Frame | None) -> None:
        """Show the state without calling anything."""
        if state is self._state:
            return  # only another frame of it
        self._state = state
        planes, plane = state.query.planes, active_plane(state)
        names = [f"Plane {n} ({axis_of(plane) or 'tilted'})" for n, plane in enumerate(planes, 1)]
        if names != [self.list.itemText(index) for index in range(self.list.count())]:
            self.list.clear()
            self.list.addItems(names)
        self.list.setCurrentIndex(state.display.active_plane if plane else -1)
        self.remove.setEnabled(plane is not None)
        self.handle.setChecked(state.display.handle)
        for widget in (*self.axes.values(), self.slider, self.fraction, self.pose, self.through_source):
            widget.setEnabled(plane is not None)
        if state.shape is not None and plane is not None:
            self._show_plane(state.shape, plane)

    def _show_plane(self, shape: Shape, plane: Plane) -> None:
        axis = axis_of(plane)
        self._group.setExclusive(False)
        for name, button in self.axes.items():
            button.setChecked(name == axis)
        self._group.setExclusive(True)
        share = min(1.0, max(0.0, self._commands.fraction_of(shape, plane)))
        with QSignalBlocker(self.slider):
            self.slider.setValue(round(share * SLIDER_STEPS))
        with QSignalBlocker(self.fraction):
            self.fraction.setValue(share)
        if not self.pose.isModified():
            self.pose.setText(format_plane(plane, shape.diagonal))
            self.pose.setCursorPosition(0)

    def _typed(self) -> None:
        if not self.pose.isModified() or self._state.shape is None:
            return
        self.pose.setModified(False)
        try:
            self._commands.replace(Plane.parse(self.pose.text(), self._state.shape.bounds))
        except ValueError as error:
            self._calls.complain(str(error))
        plane = active_plane(self._state)
        if plane is not None:
            self._show_plane(self._state.shape, plane)
