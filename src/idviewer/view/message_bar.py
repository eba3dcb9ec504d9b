"""One line above the picture for what went wrong or was repaired; nothing waits for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QStyle,
    QToolButton,
    QWidget,
)

Kind = Literal["error", "note"]
NOTE_ICON = QStyle.StandardPixmap.SP_MessageBoxInformation
MESSAGE_BAR_STYLE = """
MessageBar[kind="error"] { background: #fdecea; border-bottom: 1px solid #e3a9a3; }
MessageBar[kind="note"] { background: #eaf2fb; border-bottom: 1px solid #a9c4e0; }
MessageBar QLabel { color: #20242a; background: transparent; }
MessageBar QToolButton { border: none; color: #20242a; padding: 2px 6px; }
MessageBar QToolButton:hover { background: rgba(0, 0, 0, 25); border-radius: 3px; }
"""


class MessageBar(QFrame):
    """Shows the latest message until it is dismissed or replaced."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._sign, self._label = QLabel(), QLabel()
        self._label.setWordWrap(True)
        self._label.setTextFormat(Qt.TextFormat.PlainText)
        self._label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._label.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.button = QPushButton()
        self.button.clicked.connect(self._act)
        self._dismiss = QToolButton()
        self._dismiss.setText("✕")
        self._dismiss.setToolTip("Dismiss")
        self._dismiss.clicked.connect(self.clear)
        self._action: Callable[[], None] | None = None
        self._remark = ""
        layout = QHBoxLayout(self)
        layout.setContentsMargins(12, 6, 8, 6)
        for widget in (self._sign, self._label, self.button, self._dismiss):
            layout.addWidget(widget)
        self.setStyleSheet(MESSAGE_BAR_STYLE)
        self.hide()

    @property
    def text(self) -> str:
        """The message that is shown, empty when there is none."""
        return "" if self.isHidden() else self._label.text()

    @property
    def kind(self) -> Kind:
        """The kind of the latest message."""
        return self.property("kind")

    def tell(self, kind: Kind, text: str, offer: tuple[str, Callable[[], None]] | None = None) -> None:
        """Show text; offer is a button's label and what it does. What is shown already costs nothing."""
        if offer is None and self._action is None and (kind, text) == (self.kind, self.text):
            return
        self.setProperty("kind", kind)
        self.style().unpolish(self)
        self.style().polish(self)
        sign = QStyle.StandardPixmap.SP_MessageBoxWarning if kind == "error" else NOTE_ICON
        self._sign.setPixmap(self.style().standardIcon(sign).pixmap(18, 18))
        self._label.setText(text)
        self._action = offer[1] if offer else None
        self.button.setText(offer[0] if offer else "")
        self.button.setVisible(offer is not None)
        self.show()

    def remark(self, text: str) -> None:
        """Show a remark on the picture as a note, until there is another or none (an empty text).

        It does not push an error aside, and does not come back once it is dismissed.
        """
        if text == self._remark:
            return
        shown, self._remark = self._remark, text
        if text and not (self.text and self.kind == "error"):
            self.tell("note", text)
        elif shown and self.text == shown:
            self.clear()

    def clear(self) -> None:
        """Hide the bar."""
        self._action = None
        self.hide()

    def _act(self) -> None:
        action = self._action
        self.clear()
        if action is not None:
            action()
