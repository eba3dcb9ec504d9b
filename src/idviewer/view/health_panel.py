"""The health panel: what is wrong with a body and where, and the repairs that can be made of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QFrame,
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from idviewer.core import Repairs, ShapeError
from idviewer.core.shapes import NAMED_REPAIRS, Fault, FaultPlace, Health, NamedRepair, RepairOutcome

MOST_FAULTS = 40
"""Lines of the list."""
DEFAULT_HOLE_EDGES = 30
"""Of a hole that is filled, where nothing else is suggested."""
DEFAULT_GAP_SHARE = 1e-4
"""Of the body's size: the width of gaps that are welded, where nothing else is suggested."""
FATAL_SIGN, OTHER_SIGN = "✕", "ℹ"
NO_BODY, WAITING = "No body is looked at.", "…"


@dataclass(frozen=True)
class HealthCalls:
    """Calls that the panel may make.

    Attributes:
        go_to: a place of a fault.
        foretell: what repairs would change.
        repair: make them.
        undo: what was shown before the last repair.
        save: the mesh that is shown.
    """

    go_to: Callable[[FaultPlace], None]
    foretell: Callable[[Repairs], None]
    repair: Callable[[Repairs], None]
    undo: Callable[[], None]
    save: Callable[[], None]


class HealthPanel(QScrollArea):
    """Findings with buttons that show them, repairs with what they will do, and a way back."""

    def __init__(self, calls: HealthCalls, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._calls = calls
        self.title, self.verdict = QLabel(NO_BODY), _wrapped()
        self.faults: list[FaultRow] = []
        self.repairs = {name: RepairRow(one, self._ask) for name, one in NAMED_REPAIRS.items()}
        self.forecast, self.apply = _wrapped(), QPushButton("Apply")
        self.undo, self.save = QPushButton("Undo"), QPushButton("Save repaired mesh…")
        self.apply.clicked.connect(lambda: self._calls.repair(self.chosen))
        self.undo.clicked.connect(lambda: self._calls.undo())
        self.save.clicked.connect(lambda: self._calls.save())
        self._list = QVBoxLayout()
        self._lay_out()
        self.show_health(None)
        self.show_undo("")

    def _lay_out(self) -> None:
        content = QWidget()
        layout, box = QVBoxLayout(content), QGroupBox("Repairs")
        layout.setContentsMargins(10, 8, 10, 8)
        self.title.setStyleSheet("font-weight: bold")
        layout.addWidget(self.title)
        layout.addWidget(self.verdict)
        layout.addLayout(self._list)
        inner = QVBoxLayout(box)
        for row in self.repairs.values():
            inner.addWidget(row)
        inner.addWidget(self.forecast)
        buttons = QHBoxLayout()
        for button in (self.apply, self.undo):
            buttons.addWidget(button)
        inner.addLayout(buttons)
        inner.addWidget(self.save)
        layout.addWidget(box)
        layout.addStretch(1)
        self.setWidget(content)
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)

    @property
    def chosen(self) -> Repairs:
        """The repairs that are ticked, with their values.

        Raises:
            ShapeError: a value is none.
        """
        return Repairs(**{name: row.value for name, row in self.repairs.items() if row.box.isChecked()})

    def show_health(self, health: Health | None) -> None:
        """Show the health of another body, or of none."""
        for row in self.faults:
            self._list.removeWidget(row)
            row.deleteLater()
        self.faults = []
        self.title.setText(NO_BODY if health is None else health.body.name or "Body")
        self.verdict.setText("" if health is None else _verdict(health))
        if health is not None:
            self.faults = [FaultRow(fault, self._calls.go_to) for fault in health.faults[:MOST_FAULTS]]
        for row in self.faults:
            self._list.addWidget(row)
        for name, repair in self.repairs.items():
            suggested = None if health is None else health.suggested.asked.get(name)
            repair.suggest(suggested, 1.0 if health is None else health.outcome.report.size)
            repair.setEnabled(health is not None)
        self.apply.setEnabled(False)
        self.forecast.setText("")

    def show_outcome(self, outcome: RepairOutcome) -> None:
        """Show what the repairs that are ticked would change."""
        lines = [f"{record.sentence}." for record in outcome.records]
        if outcome.usable:
            told = outcome.diagnosis
            lines.append(f"Result: a closed body of {told.faces:,} faces, volume {told.volume or 0.0:.4g}.")
        else:
            lines.append(f"Result: still no closed body: {outcome.problem}.")
        self.forecast.setText("\n".join(lines))
        self.apply.setEnabled(outcome.usable)

    def show_undo(self, title: str) -> None:
        """Offer to take repairs back, given in words; with none there is nothing to save either."""
        self.undo.setEnabled(bool(title))
        self.undo.setToolTip(title or "Nothing has been repaired")
        self.save.setEnabled(bool(title))

    def _ask(self) -> None:
        """Have it foretold what is ticked now."""
        self.apply.setEnabled(False)
        try:
            repairs = self.chosen
        except ShapeError as error:
            self.forecast.setText(str(error))
            return
        self.forecast.setText(WAITING if repairs else "")
        self._calls.foretell(repairs)


class FaultRow(QFrame):
    """One fault, and a button that goes to its places in turn."""

    def __init__(self, fault: Fault, go_to: Callable[[FaultPlace], None]) -> None:
        super().__init__()
        self.fault, self._go_to, self._next = fault, go_to, 0
        sign, self.text, self.show_place = QLabel(), _wrapped(fault.text), QPushButton("Show")
        sign.setText(FATAL_SIGN if fault.fatal else OTHER_SIGN)
        sign.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.show_place.setVisible(bool(fault.places))
        self.show_place.clicked.connect(self._show_next)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 2, 0, 2)
        layout.addWidget(sign)
        layout.addWidget(self.text, 1)
        layout.addWidget(self.show_place)

    def _show_next(self) -> None:
        places = self.fault.places
        self._go_to(places[self._next])
        if len(places) > 1:
            self.show_place.setText(f"{self._next + 1} of {len(places)}")
        self._next = (self._next + 1) % len(places)


class RepairRow(QWidget):
    """One repair: whether to make it, and its value."""

    def __init__(self, repair: NamedRepair, on_change: Callable[[], None]) -> None:
        super().__init__()
        self._repair, self._on_change = repair, on_change
        self.box, self.field = QCheckBox(repair.title), QLineEdit()
        self.setToolTip(repair.explanation)
        self.field.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self.field.setMaximumWidth(90)
        self.field.setToolTip(repair.parameter)
        self.field.setVisible(bool(repair.parameter))
        self.box.toggled.connect(on_change)
        self.field.editingFinished.connect(self._on_typed)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.box)
        layout.addStretch(1)
        layout.addWidget(QLabel(repair.parameter))
        layout.addWidget(self.field)

    def _on_typed(self) -> None:
        if self.box.isChecked():
            self._on_change()

    @property
    def value(self) -> Any:
        """The repair's value.

        Raises:
            ShapeError: what is typed is no number.
        """
        if not self._repair.parameter:
            return True
        text = self.field.text().strip().replace(",", "")
        try:
            return int(text) if self._repair.whole else float(text)
        except ValueError:
            kind = "whole number" if self._repair.whole else "number"
            raise ShapeError(f"{self._repair.parameter} {text!r}: give a {kind}") from None

    def suggest(self, value: object, size: float) -> None:
        """Take over a suggestion; without one the repair is not ticked, and its value is a usual one."""
        with QSignalBlocker(self.box), QSignalBlocker(self.field):
            self.box.setChecked(value is not None)
            if self._repair.parameter:
                usual = DEFAULT_HOLE_EDGES if self._repair.whole else _round_share(size)
                self.field.setText(f"{usual if value is None else value}")


def _round_share(size: float) -> float:
    """A power of ten near a small share of a size."""
    return float(f"1e{round(math.log10(DEFAULT_GAP_SHARE * (size or 1.0)))}") if math.isfinite(size) else 1e-4


def _verdict(health: Health) -> str:
    if health.outcome.usable:
        found = len([fault for fault in health.faults if fault.kind != "note"])
        return "A closed body." if not found else "A closed body; things to know of it:"
    return "No closed body: distances need one."


def _wrapped(text: str = "") -> QLabel:
    label = QLabel(text)
    label.setWordWrap(True)
    label.setTextFormat(Qt.TextFormat.PlainText)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    return label
