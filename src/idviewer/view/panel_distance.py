"""Which distance, and its parameters: built from the registry of distances."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from typing import Protocol

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtWidgets import (
    QComboBox,
    QGridLayout,
    QGroupBox,
    QLabel,
    QLineEdit,
    QPushButton,
    QSizePolicy,
    QSlider,
    QVBoxLayout,
    QWidget,
)

from idviewer.core import DISTANCES, Distance, Mesh, parameters_of
from idviewer.core.distances import Number
from idviewer.session.state import Frame, State

STEPS = 24
"""Of a slider, to double the value."""

FIELD = 92
"""Width in pixels: six digits and an exponent."""


class _Calls(Protocol):
    def set(self, **fields: object) -> None: ...

    def complain(self, text: str) -> None: ...


class DistanceGroup(QGroupBox):
    """The kind of distance, and under it what may be set of the kind chosen."""

    def __init__(self, calls: _Calls) -> None:
        super().__init__("Distance")
        self._calls = calls
        self._distance: Distance = State().query.distance
        self._mesh: Mesh | None = None
        self._last: dict[str, Distance] = {}
        self.kind = choice((name, kind.title) for name, kind in DISTANCES.items())
        self.kind.activated.connect(self._choose)
        self.rows = {
            (name, parameter): ParameterRow(one, partial(self._change, parameter), calls)
            for name, kind in DISTANCES.items()
            for parameter, one in parameters_of(kind).items()
            if isinstance(one, Number)
        }
        layout = QVBoxLayout(self)
        layout.addWidget(self.kind)
        for row in self.rows.values():
            layout.addWidget(row)

    def show_state(self, state: State, frame: Frame | None) -> None:
        """Shows the state; frame tells the first eigenvalue, by which parameters are measured."""
        if state.mesh is not self._mesh:
            self._mesh = state.mesh
            self._last.clear()
        self._distance = distance = state.query.distance
        self._last[distance.name] = distance
        self.kind.setCurrentIndex(self.kind.findData(distance.name))
        lambda_2 = frame.lambda_2 if frame is not None and frame.mesh is state.mesh else None
        for (name, parameter), row in self.rows.items():
            row.setVisible(name == distance.name)
            if name == distance.name:
                row.show_value(getattr(distance, parameter), lambda_2)

    def _choose(self) -> None:
        """A kind with the parameters that it had last on this mesh."""
        name = self.kind.currentData()
        self._calls.set(distance=self._last.get(name) or DISTANCES[name]())

    def _change(self, parameter: str, value: float | None) -> None:
        try:
            distance = replace(self._distance, **{parameter: value})
        except ValueError as error:
            self._calls.complain(str(error))
        else:
            self._calls.set(distance=distance)


class ParameterRow(QWidget):
    """A parameter's slider, logarithmic about its default, its value to read and type, and a way back.

    Args:
        parameter: what it is.
        change: what to do with a new value, None for the default.
        calls: whom to tell what cannot be understood.
    """

    def __init__(self, parameter: Number, change: Callable[[float | None], None], calls: _Calls) -> None:
        super().__init__()
        self._parameter, self._change, self._calls = parameter, change, calls
        self._default: float | None = None
        self._shown = ""
        self.slider, self.field = QSlider(Qt.Orientation.Horizontal), QLineEdit()
        self.multiple, self.reset = QLabel(), QPushButton("Default")
        self._lay_out()
        self.slider.valueChanged.connect(self._slid)
        self.field.editingFinished.connect(self._typed)
        self.reset.clicked.connect(lambda: change(None))

    def _lay_out(self) -> None:
        title, symbol = self._parameter.title, self._parameter.symbol
        low, high = (round(STEPS * math.log2(end)) for end in self._parameter.span)
        self.slider.setRange(low, high)
        self.slider.setPageStep(STEPS)
        self.slider.setToolTip(f"{title} {symbol} from {low // STEPS:+d} to {high // STEPS:+d} doublings")
        self.field.setFixedWidth(FIELD)
        self.field.setToolTip(f"{title} {symbol}: a number, or a multiple of the default such as 2 {symbol}0")
        self.reset.setToolTip(f"Back to {symbol}₀, the default for this shape")
        self.reset.setFixedWidth(FIELD)
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.addWidget(QLabel(f"{title} {symbol}"), 0, 0)
        grid.addWidget(self.slider, 0, 1)
        grid.addWidget(self.field, 0, 2)
        grid.addWidget(self.multiple, 1, 1, Qt.AlignmentFlag.AlignRight)
        grid.addWidget(self.reset, 1, 2)
        grid.setColumnStretch(1, 1)

    def show_value(self, value: float | None, lambda_2: float | None) -> None:
        """Shows a value, None for the default, which is known once the first eigenvalue is."""
        self._default = default = None if lambda_2 is None else self._parameter.default(lambda_2)
        self.setEnabled(default is not None)
        self.reset.setEnabled(value is not None)
        used = default if value is None else value
        multiple = 1.0 if used is None or default is None else used / default
        with QSignalBlocker(self.slider):
            self.slider.setValue(round(STEPS * math.log2(multiple)))
        self.multiple.setText("" if default is None else f"= {multiple:.3g} {self._parameter.symbol}₀")
        self._shown = "" if used is None else f"{used:.6g}"
        if not self.field.isModified():
            self.field.setText(self._shown)

    def _slid(self, steps: int) -> None:
        # Three digits, so that what is shown in words is what is computed with.
        if self._default is not None:
            self._change(float(f"{self._default * 2.0 ** (steps / STEPS):.3g}") if steps else None)

    def _typed(self) -> None:
        if not self.field.isModified() or self._default is None:
            return
        self.field.setModified(False)
        text = self.field.text().replace("₀", "0").strip()
        unit = f"{self._parameter.symbol}0"
        try:
            if text.endswith(unit):
                value = float(text.removesuffix(unit) or 1.0) * self._default
            else:
                value = float(text)
        except ValueError:
            self._calls.complain(f"“{self.field.text()}” is not a value of {self._parameter.symbol}.")
        else:
            self._change(value)
        self.field.setText(self._shown)


def choice(items: Iterable[tuple[str, str]]) -> QComboBox:
    """A box with names and their titles, as narrow as the panel wants it."""
    box = QComboBox()
    for name, title in items:
        box.addItem(title, name)
    box.setMinimumContentsLength(10)
    box.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
    box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
    return box
