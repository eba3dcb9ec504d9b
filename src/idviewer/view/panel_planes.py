"""The slicing planes' controls."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray
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
from idviewer.core.shapes.plane import AXES
from idviewer.session.state import Frame, State
from idviewer.view.flat import is_flat

STEPS = 1000
EDGE = 0.002
"""The share of the shape's extent that the handle leaves beyond the plane, for something to see."""


class _Calls(Protocol):
    def set(self, **fields: object) -> None: ...

    def complain(self, text: str) -> None: ...


def axis_of(plane: Plane) -> str | None:
    """The axis that the plane's normal lies on, None for a tilted plane."""
    aligned = (name for name, axis in AXES.items() if abs(np.dot(axis, plane.normal)) > 1 - 1e-9)
    return next(aligned, None)


def extent(shape: Shape, plane: Plane) -> tuple[float, float]:
    """The shape's lowest and highest point over the plane, measured along its normal."""
    heights = plane.height(shape.vertices)
    return float(heights.min()), float(heights.max())


def turned(shape: Shape, plane: Plane, normal: tuple[float, float, float]) -> Plane:
    """The plane with another normal through its origin, or through the middle if that misses the shape."""
    new = Plane(plane.origin, normal)
    low, high = extent(shape, new)
    return new if low < 0 < high else new.moved((low + high) / 2)


def another(shape: Shape, planes: tuple[Plane, ...]) -> Plane:
    """A plane through the middle, on the axis that the planes so far are least aligned with."""
    taken = np.sum([np.abs(plane.normal) for plane in planes], axis=0) if planes else np.zeros(3)
    return Plane.along("xyz"[int(np.argmin(taken))], 0.5, shape.bounds)


def tidy(value: float, size: float) -> str:
    """A coordinate in six digits, without the noise of a number that is zero against the shape's size.

    >>> tidy(1 / 3, 2.0), tidy(-1e-12, 2.0), tidy(1e6 + 1 / 3, 2.0)
    ('0.333333', '0', '1000000.333')
    """
    if abs(value) < 1e-7 * size:
        return "0"
    digits = max(6, int(np.ceil(np.log10(abs(value) / size))) + 4)
    return f"{value:.{digits}g}"


def written(plane: Plane, size: float) -> str:
    """The plane as `Plane.parse` reads it."""
    return "/".join(
        ",".join(tidy(value, scale) for value in part)
        for part, scale in ((plane.origin, size), (plane.normal, 1.0))
    )


class PlanesGroup(QGroupBox):
    """Which planes there are, and where the active one is."""

    def __init__(self, calls: _Calls) -> None:
        super().__init__("Slicing planes")
        self._calls = calls
        self._state = State()
        self._source: NDArray[np.float64] | None = None
        self._range = (0.0, 0.0)
        self._ranged: tuple[Shape | None, tuple[float, ...] | None] = (None, None)
        self.list, self.add, self.remove = QComboBox(), QPushButton("Add"), QPushButton("Remove")
        self.axes = {axis: QPushButton(axis.upper()) for axis in AXES}
        self.slider, self.fraction = QSlider(Qt.Orientation.Horizontal), QDoubleSpinBox()
        self.through_source = QPushButton("Through the source")
        self.pose = QLineEdit()
        self.handle = QCheckBox("Handle in the picture")
        self._lay_out()
        self._connect()

    def _lay_out(self) -> None:
        self.slider.setRange(0, STEPS)
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
        self._group = QButtonGroup(self)
        for axis, button in self.axes.items():
            self._group.addButton(button)
            button.clicked.connect(lambda _on, axis=axis: self.turn_to(axis))
        self.list.activated.connect(lambda index: self._calls.set(active_plane=index))
        self.add.clicked.connect(self.add_plane)
        self.remove.clicked.connect(self.remove_plane)
        self.slider.valueChanged.connect(lambda value: self.move_to(value / STEPS))
        self.fraction.valueChanged.connect(self.move_to)
        self.through_source.clicked.connect(self.go_through_source)
        self.pose.editingFinished.connect(self._typed)
        self.handle.clicked.connect(lambda on: self._calls.set(handle=on))

    # What it shows

    def show_state(self, state: State, frame: Frame | None) -> None:
        """Shows the state without calling anything."""
        self._source = frame.source if frame is not None and frame.shape is state.shape else None
        if state is self._state:
            return  # only another frame of it
        self._state = state
        planes, plane = state.query.planes, self.plane
        names = [f"Plane {n} ({axis_of(plane) or 'tilted'})" for n, plane in enumerate(planes, 1)]
        if names != [self.list.itemText(index) for index in range(self.list.count())]:
            self.list.clear()
            self.list.addItems(names)
        self.list.setCurrentIndex(state.display.active_plane if plane else -1)
        self.remove.setEnabled(plane is not None)
        self.handle.setChecked(state.display.handle)
        for widget in (*self.axes.values(), self.slider, self.fraction, self.pose, self.through_source):
            widget.setEnabled(plane is not None)
        if plane is not None:
            self._show_plane(plane)

    def _show_plane(self, plane: Plane) -> None:
        axis = axis_of(plane)
        self._group.setExclusive(False)
        for name, button in self.axes.items():
            button.setChecked(name == axis)
        self._group.setExclusive(True)
        low, high = self._extent(plane)
        share = min(1.0, max(0.0, -low / (high - low))) if high > low else 0.5
        with QSignalBlocker(self.slider):
            self.slider.setValue(round(share * STEPS))
        with QSignalBlocker(self.fraction):
            self.fraction.setValue(share)
        if not self.pose.isModified():
            assert self._state.shape is not None
            self.pose.setText(written(plane, self._state.shape.diagonal))
            self.pose.setCursorPosition(0)

    def _extent(self, plane: Plane) -> tuple[float, float]:
        """`extent`, computed once for each normal: a push asks for it at every move of the mouse."""
        shape = self._state.shape
        assert shape is not None
        if self._ranged[0] is not shape or self._ranged[1] != plane.normal:
            low, high = extent(shape, plane)
            height = float(np.dot(plane.origin, plane.normal))
            self._ranged, self._range = (shape, plane.normal), (low + height, high + height)
        height = float(np.dot(plane.origin, plane.normal))
        return self._range[0] - height, self._range[1] - height

    # What it does

    @property
    def plane(self) -> Plane | None:
        """The active one."""
        planes, active = self._state.query.planes, self._state.display.active_plane
        return planes[active] if active < len(planes) and not is_flat(self._state.shape) else None

    def replace(self, plane: Plane) -> None:
        """Puts the active plane somewhere else."""
        planes, active = self._state.query.planes, self._state.display.active_plane
        if active < len(planes):
            self._calls.set(planes=(*planes[:active], plane, *planes[active + 1 :]))

    def drag_to(self, plane: Plane) -> None:
        """Where the handle was dragged, but never so far that it loses the shape."""
        shape = self._state.shape
        if shape is None:
            return
        inside = np.clip(plane.origin, *shape.bounds)
        plane = Plane(tuple(inside - plane.height(inside) * np.array(plane.normal)), plane.normal)
        low, high = self._extent(plane)
        self.replace(plane.moved(float(np.clip(0.0, low + EDGE * (high - low), high - EDGE * (high - low)))))

    def move_to(self, fraction: float) -> None:
        """Along the normal: 0 is the shape's lowest point, 1 its highest."""
        if self.plane is not None:
            low, high = self._extent(self.plane)
            self.replace(self.plane.moved(low + fraction * (high - low)))

    def nudge(self, step: float) -> None:
        """Along the normal by a share of the shape's extent."""
        if self.plane is not None:
            low, high = self._extent(self.plane)
            self.move_to(min(1.0, max(0.0, -low / (high - low) + step)))

    def turn_to(self, axis: str) -> None:
        """The normal to an axis."""
        if self._state.shape is not None and self.plane is not None:
            self.replace(turned(self._state.shape, self.plane, AXES[axis]))

    def go_through_source(self) -> None:
        """The plane's origin to the source."""
        source = self._state.query.source if self._state.query.source is not None else self._source
        if source is not None and self.plane is not None:
            self.replace(Plane(tuple(source), self.plane.normal))

    def add_plane(self) -> None:
        """One more, which becomes the active one."""
        shape, planes = self._state.shape, self._state.query.planes
        if shape is not None and not is_flat(shape):
            self._calls.set(planes=(*planes, another(shape, planes)), active_plane=len(planes))

    def remove_plane(self) -> None:
        """Without the active one."""
        planes, active = self._state.query.planes, self._state.display.active_plane
        rest = (*planes[:active], *planes[active + 1 :])
        self._calls.set(planes=rest, active_plane=max(0, min(active, len(rest) - 1)))

    def _typed(self) -> None:
        if not self.pose.isModified() or self._state.shape is None:
            return
        self.pose.setModified(False)
        try:
            self.replace(Plane.parse(self.pose.text(), self._state.shape.bounds))
        except ValueError as error:
            self._calls.complain(str(error))
        if self.plane is not None:
            self._show_plane(self.plane)
