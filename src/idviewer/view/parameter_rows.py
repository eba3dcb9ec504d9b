"""The controls of a distance's parameters: one kind of row for each kind of parameter."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Protocol

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtWidgets import (
    QComboBox,
    QFileDialog,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QSizePolicy,
    QSlider,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from idviewer.core.distances import Choice, File, Formula, Integer, Number, Parameter

STEPS_PER_DOUBLING = 24
"""Of a slider, to double the value."""

FIELD_WIDTH_PX = 92
"""Width in pixels: six digits and an exponent."""


class RowCalls(Protocol):
    """Whom to tell what cannot be understood."""

    def complain(self, text: str) -> None:
        """Tell the user one line."""


class Row(Protocol):
    """Shows a parameter's value and lets it be changed."""

    def setVisible(self, visible: bool) -> None:  # noqa: N802
        """Show or hide the row."""

    def show_value(self, value: Any, lambda_2: float | None) -> None:
        """Show a value without calling anything; None for the default."""


def row_for(parameter: Parameter, change: Callable[[Any], None], calls: RowCalls) -> QWidget:
    """The row for a parameter.

    Args:
        parameter: what it is.
        change: what to do with a new value, None for the default; raises a ValueError where it means nothing.
        calls: whom to tell what cannot be understood.
    """
    match parameter:
        case Number():
            return ParameterRow(parameter, change, calls)
        case Integer():
            return IntegerRow(parameter, change, calls)
        case Choice():
            return ChoiceRow(parameter, change, calls)
        case File():
            return FileRow(parameter, change, calls)
        case Formula():
            return FormulaRow(parameter, change, calls)
    raise TypeError(f"there is no control for {type(parameter).__name__}")


class ParameterRow(QWidget):
    """A parameter's slider, logarithmic about its default, its value to read and type, and a way back.

    Args:
        parameter: what it is.
        change: what to do with a new value, None for the default.
        calls: whom to tell what cannot be understood.
    """

    def __init__(self, parameter: Number, change: Callable[[float | None], None], calls: RowCalls) -> None:
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
        low, high = (round(STEPS_PER_DOUBLING * math.log2(end)) for end in self._parameter.span)
        self.slider.setRange(low, high)
        self.slider.setPageStep(STEPS_PER_DOUBLING)
        ends = " to ".join(f"{end // STEPS_PER_DOUBLING:+d}" for end in (low, high))
        self.slider.setToolTip(f"{title} {symbol} from {ends} doublings")
        self.field.setFixedWidth(FIELD_WIDTH_PX)
        self.field.setToolTip(f"{title} {symbol}: a number, or a multiple of the default such as 2 {symbol}0")
        self.reset.setToolTip(f"Back to {symbol}₀, the default for this shape")
        self.reset.setFixedWidth(FIELD_WIDTH_PX)
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.addWidget(QLabel(f"{title} {symbol}"), 0, 0)
        grid.addWidget(self.slider, 0, 1)
        grid.addWidget(self.field, 0, 2)
        grid.addWidget(self.multiple, 1, 1, Qt.AlignmentFlag.AlignRight)
        grid.addWidget(self.reset, 1, 2)
        grid.setColumnStretch(1, 1)

    def show_value(self, value: float | None, lambda_2: float | None) -> None:
        """Show a value, None for the default, which is known once the first eigenvalue is."""
        self._default = default = None if lambda_2 is None else self._parameter.default(lambda_2)
        self.setEnabled(default is not None)
        self.reset.setEnabled(value is not None)
        used = default if value is None else value
        multiple = 1.0 if used is None or default is None else used / default
        with QSignalBlocker(self.slider):
            doublings = 0.0 if used is None or default is None else math.log2(used) - math.log2(default)
            self.slider.setValue(round(STEPS_PER_DOUBLING * doublings))  # a quotient may leave the floats
        self.multiple.setText("" if default is None else f"= {multiple:.3g} {self._parameter.symbol}₀")
        self._shown = "" if used is None else f"{used:.6g}"
        if not self.field.isModified():
            self.field.setText(self._shown)

    def _slid(self, steps: int) -> None:
        # Three digits, so that what is shown in words is what is computed with.
        if self._default is not None:
            self._change(
                float(f"{self._default * 2.0 ** (steps / STEPS_PER_DOUBLING):.3g}") if steps else None
            )

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
            self._try(value)
        self.field.setText(self._shown)

    def _try(self, value: float) -> None:
        try:
            self._change(value)
        except ValueError as error:
            self._calls.complain(str(error))


class IntegerRow(QWidget):
    """A whole number to turn or type; its lowest place stands for what is chosen by itself."""

    def __init__(self, parameter: Integer, change: Callable[[int | None], None], calls: RowCalls) -> None:
        super().__init__()
        self._lowest = parameter.lowest - 1
        self.box = QSpinBox()
        self.box.setRange(self._lowest, parameter.highest)
        self.box.setSpecialValueText(parameter.automatic)
        self.box.setToolTip(f"{parameter.title}: {parameter.help}; {parameter.domain}")
        self.box.setKeyboardTracking(False)
        self.box.valueChanged.connect(lambda value: change(None if value == self._lowest else value))
        _beside(self, parameter.title, self.box)

    def show_value(self, value: int | None, lambda_2: float | None) -> None:
        """Show a value, None for the one chosen by itself."""
        with QSignalBlocker(self.box):
            self.box.setValue(self._lowest if value is None else value)


class ChoiceRow(QWidget):
    """A few titles to choose from."""

    def __init__(self, parameter: Choice, change: Callable[[str], None], calls: RowCalls) -> None:
        super().__init__()
        self.box = choice(parameter.titles)
        self.box.setToolTip("; ".join([f"{parameter.title}: {parameter.help}", *parameter.remedies]))
        self.box.activated.connect(lambda: change(self.box.currentData()))
        _beside(self, parameter.title, self.box)

    def show_value(self, value: str, lambda_2: float | None) -> None:
        """Show what is chosen."""
        self.box.setCurrentIndex(self.box.findData(value))


class FileRow(QWidget):
    """A button that asks for a file, the file's name, and why nothing happened where nothing did."""

    def __init__(self, parameter: File, change: Callable[[str], None], calls: RowCalls) -> None:
        super().__init__()
        self._parameter, self._change = parameter, change
        self._name = ""
        self.dialog: QFileDialog | None = None
        self.button, self.note = QPushButton("Choose a file…"), QLabel()
        self.button.setToolTip(f"{parameter.title}: {parameter.domain}")
        self.button.clicked.connect(self.ask)
        self.note.setWordWrap(True)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.button)
        layout.addWidget(self.note)

    def show_value(self, value: object, lambda_2: float | None) -> None:
        """Show the file's name."""
        if value is None:
            name = f"It needs {self._parameter.domain}; what is shown stays until there is one."
        else:
            name = Path(value).name if isinstance(value, str) else str(value)
        if name != self._name:
            self._name = name
            self.note.setText(name)

    def ask(self) -> None:
        """Show the file dialog, which does not block."""
        suffixes = " ".join(f"*{suffix}" for suffix in self._parameter.suffixes)
        files = f"{self._parameter.title} ({suffixes});;All files (*)"
        self.dialog = dialog = QFileDialog(self, f"Open {self._parameter.content}", "", files)
        dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
        dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        dialog.fileSelected.connect(self.choose)
        dialog.rejected.connect(lambda: self._say("No file was chosen, so nothing has changed."))
        dialog.open()

    def choose(self, path: str) -> None:
        """Take a file."""
        try:
            self._change(path)
        except ValueError as error:
            self._say(str(error))

    def _say(self, text: str) -> None:
        self.note.setText(f"{text} {self._name}".strip())


class FormulaRow(QWidget):
    """An expression to write, and beside it what is wrong with it."""

    def __init__(self, parameter: Formula, change: Callable[[str], None], calls: RowCalls) -> None:
        super().__init__()
        self._change, self._shown = change, ""
        self.field, self.error = QLineEdit(), QLabel()
        self.field.setToolTip(f"{parameter.title}: {parameter.help}; {parameter.domain}")
        self.field.editingFinished.connect(self._typed)
        self.error.setWordWrap(True)
        self.error.hide()
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(QLabel(parameter.title))
        layout.addWidget(self.field)
        layout.addWidget(self.error)

    def show_value(self, value: object, lambda_2: float | None) -> None:
        """Show the expression, but for one that is being written or has an error beside it."""
        shown = value if isinstance(value, str) else str(value)
        if shown != self._shown:
            self._shown = shown
            self.error.hide()
            self.field.setModified(False)
        if not self.field.isModified():
            self.field.setText(shown)

    def _typed(self) -> None:
        if not self.field.isModified():
            return
        try:
            self._change(self.field.text().strip())
        except ValueError as error:
            self.error.setText(str(error))
            self.error.show()
        else:
            self.error.hide()
            self.field.setModified(False)


def _beside(row: QWidget, title: str, control: QWidget) -> None:
    layout = QHBoxLayout(row)
    layout.setContentsMargins(0, 0, 0, 0)
    layout.addWidget(QLabel(title))
    layout.addWidget(control, 1)


def choice(items: Iterable[tuple[str, str]]) -> QComboBox:
    """A box with names and their titles, as narrow as the panel wants it."""
    box = QComboBox()
    for name, title in items:
        box.addItem(title, name)
    box.setMinimumContentsLength(10)
    box.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
    box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
    return box
