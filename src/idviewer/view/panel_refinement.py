"""Choice of how the boundary is refined, and what came of it."""

from __future__ import annotations

from typing import Protocol

from PySide6.QtWidgets import QGridLayout, QLabel, QLineEdit, QWidget

from idviewer.session import Frame, State
from idviewer.view.parameter_rows import FIELD_WIDTH_PX, choice

LENGTH = "length"
FIRST_SHARE = 0.02
"""Of the diagonal: the length offered first."""

REFINEMENTS = (("auto", "Refined as needed"), ("no", "As it is"), (LENGTH, "Edges of at most"))


class _Calls(Protocol):
    def set(self, **fields: object) -> None: ...

    def complain(self, text: str) -> None: ...


class RefinementRow(QWidget):
    """A box with the kinds of refinement, a field for a length, and how many vertices were added."""

    def __init__(self, calls: _Calls) -> None:
        super().__init__()
        self._calls = calls
        self._refine: str | float = State().query.refine
        self._diagonal = 1.0
        self.box, self.field, self.told = choice(REFINEMENTS), QLineEdit(), QLabel()
        self.box.setToolTip(
            "Edges that are too long for the distance make it wrong; cutting them does not move the boundary"
        )
        self.field.setFixedWidth(FIELD_WIDTH_PX)
        self.field.setToolTip("The longest edge allowed, in the shape's unit")
        self.told.setWordWrap(True)
        self.box.activated.connect(self._chosen)
        self.field.editingFinished.connect(self._typed)
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.addWidget(QLabel("Boundary"), 0, 0)
        grid.addWidget(self.box, 0, 1)
        grid.addWidget(self.field, 0, 2)
        grid.addWidget(self.told, 1, 0, 1, 3)
        grid.setColumnStretch(1, 1)

    def show_state(self, state: State, frame: Frame | None) -> None:
        """Show the state, and what the frame says of it, without calling anything."""
        refine = self._refine = state.query.refine
        if state.shape is not None:
            self._diagonal = state.shape.diagonal
        by_length = not isinstance(refine, str)
        self.box.setCurrentIndex(self.box.findData(LENGTH if by_length else refine))
        self.field.setVisible(by_length)
        self.field.setText(f"{refine:.6g}" if by_length else "")
        told = frame.refinement if frame is not None and frame.query.refine == refine else ""
        self.told.setText(told)
        self.told.setVisible(bool(told))

    def _chosen(self) -> None:
        kind = self.box.currentData()
        if kind != LENGTH:
            self._calls.set(refine=kind)
        elif isinstance(self._refine, str):
            self._calls.set(refine=float(f"{FIRST_SHARE * self._diagonal:.3g}"))

    def _typed(self) -> None:
        if not self.field.isModified():
            return
        text = self.field.text()
        self.field.setModified(False)
        try:
            length = float(text)
        except ValueError:
            length = 0.0
        if 0.0 < length < float("inf"):
            self._calls.set(refine=length)
        else:
            self._calls.complain(f"“{text}” is not a length; type a positive number.")
            self.field.setText(f"{self._refine:.6g}" if not isinstance(self._refine, str) else "")
