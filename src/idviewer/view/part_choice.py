"""The choice among several shapes in a file, or several components of a mesh."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QDialogButtonBox,
    QLabel,
    QLineEdit,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from idviewer.core import MeshError, ShapeError

MANY = 8
"""From so many choices on there is a field to find one by a part of its name."""

MOST_ROWS_SHOWN = 14


@dataclass(frozen=True)
class Choice:
    """One shape that can be opened.

    Attributes:
        name: of it.
        description: in a few words; may be empty.
        component: its number, for a component of a mesh.
        part: its name, for one of several shapes in a file.
    """

    name: str
    description: str
    component: int | None = None
    part: str | None = None


def choices_of(error: BaseException, part: str | None) -> tuple[Choice, ...]:
    """The shapes that an error offers to choose from; none for most errors.

    Args:
        error: of opening a file.
        part: that was asked for, to which components belong.
    """
    if isinstance(error, ShapeError) and error.parts:
        return tuple(Choice(one.name, one.description, part=one.name) for one in error.parts)
    if isinstance(error, MeshError) and error.components:
        return tuple(
            Choice(f"Component {one.number}", str(one).partition(": ")[2], one.number, part)
            for one in error.components
        )
    return ()


def describe_choices(name: str, choices: tuple[Choice, ...]) -> str:
    """Say what is to be chosen from, in a line.

    >>> describe_choices("a.nii", (Choice("3", "", part="3"), Choice("7", "", part="7")))
    'a.nii holds 2 shapes, and distances need a single one.'
    """
    kind = "shapes" if choices[0].component is None else "components"
    return f"{name} holds {len(choices):,} {kind}, and distances need a single one."


class PartDialog(QDialog):
    """Lists shapes of a file by name and description, and asks for one.

    Signals:
        chosen: a Choice.
    """

    chosen = Signal(object)

    def __init__(self, title: str, choices: tuple[Choice, ...], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle("Choose a shape")
        label = QLabel(title)
        label.setWordWrap(True)
        label.setTextFormat(Qt.TextFormat.PlainText)
        self.search = QLineEdit()
        self.search.setPlaceholderText("Find by name or description")
        self.search.setClearButtonEnabled(True)
        self.search.setVisible(len(choices) >= MANY)
        self.list = _list_of(choices)
        self.buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Open | QDialogButtonBox.StandardButton.Cancel
        )
        layout = QVBoxLayout(self)
        layout.setContentsMargins(16, 16, 16, 12)
        layout.setSpacing(10)
        for widget in (label, self.search, self.list, self.buttons):
            layout.addWidget(widget)
        self.search.textChanged.connect(self._narrow)
        self.list.itemSelectionChanged.connect(self._enable)
        self.list.itemActivated.connect(lambda item: self.accept())
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self._narrow("")
        self.list.setFocus()

    @property
    def choice(self) -> Choice | None:
        """The choice that is marked; None where none is."""
        marked = [item for item in self.list.selectedItems() if not item.isHidden()]
        return marked[0].data(0, Qt.ItemDataRole.UserRole) if marked else None

    def accept(self) -> None:
        """Close, and emit the choice; without one nothing happens."""
        choice = self.choice
        if choice is not None:
            super().accept()
            self.chosen.emit(choice)

    def _narrow(self, text: str) -> None:
        """Show what has a text in its name or description, and mark the first of them."""
        first = None
        for row in range(self.list.topLevelItemCount()):
            item = self.list.topLevelItem(row)
            assert item is not None
            fits = text.strip().lower() in f"{item.text(0)} {item.text(1)}".lower()
            item.setHidden(not fits)
            first = item if fits and first is None else first
        self.list.clearSelection()
        if first is not None:
            self.list.setCurrentItem(first)
        self._enable()

    def _enable(self) -> None:
        self.buttons.button(QDialogButtonBox.StandardButton.Open).setEnabled(self.choice is not None)


def _list_of(choices: tuple[Choice, ...]) -> QTreeWidget:
    rows = QTreeWidget()
    rows.setColumnCount(2)
    rows.setHeaderLabels(["Name", "What it is"])
    rows.setRootIsDecorated(False)
    rows.setUniformRowHeights(True)
    rows.setAlternatingRowColors(True)
    rows.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
    for choice in choices:
        item = QTreeWidgetItem([choice.name, choice.description])
        item.setData(0, Qt.ItemDataRole.UserRole, choice)
        rows.addTopLevelItem(item)
    for column in range(2):
        rows.resizeColumnToContents(column)
    rows.setColumnWidth(0, min(rows.columnWidth(0) + 16, 260))
    height = rows.sizeHintForRow(0) * min(len(choices), MOST_ROWS_SHOWN) + rows.header().sizeHint().height()
    rows.setMinimumSize(QSize(420, height + 2 * rows.frameWidth() + 2))
    return rows
