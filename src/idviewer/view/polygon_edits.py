"""Moving a polygon's vertices: what the mouse asks for, why it cannot be, and the way back."""

from __future__ import annotations

import re
from collections.abc import Callable

from idviewer.core import PolygonError
from idviewer.core.arrays import Floats
from idviewer.session import Session
from idviewer.view.message_bar import MessageBar

MAX_UNDO_STEPS = 500
"""Moves that can be taken back."""


class PolygonEdits:
    """Asks the session for other vertices, and remembers those before each move.

    Args:
        session: whose polygon is moved.
        messages: where it is said why a vertex cannot go somewhere, as long as the mouse wants that.
        on_change: called after each change of what can be taken back.
    """

    def __init__(self, session: Session, messages: MessageBar, on_change: Callable[[], None]) -> None:
        self._session, self._messages, self._on_change = session, messages, on_change
        self._before: list[Floats] = []
        self._after: list[Floats] = []
        self._reason = ""

    @property
    def can_undo(self) -> bool:
        """Whether there is a move to take back."""
        return bool(self._before)

    @property
    def can_redo(self) -> bool:
        """Whether a move that was taken back can be made again."""
        return bool(self._after)

    def move(self, vertices: Floats) -> None:
        """Move the vertices there; where that is no polygon they stay, and one line says why."""
        try:
            self._session.reshape(vertices)
        except PolygonError as error:
            self._reason = f"The vertex stays where it was: {_shortened(error)}."
            self._messages.tell("error", self._reason)
        else:
            self.forget_reason()

    def forget_reason(self) -> None:
        """Take the line away, if it is still there."""
        if self._reason and self._messages.text == self._reason:
            self._messages.clear()
        self._reason = ""

    def remember(self, before: Floats) -> None:
        """A move has ended that began with these vertices."""
        now = self._vertices
        if now is not None and now.shape == before.shape and (now != before).any():
            self._before = [*self._before[1 - MAX_UNDO_STEPS :], before]
            self._after.clear()
            self._on_change()

    def undo(self) -> None:
        """Take the last move back."""
        self._exchange(self._before, self._after)

    def redo(self) -> None:
        """Make the move again that was taken back last."""
        self._exchange(self._after, self._before)

    def forget(self) -> None:
        """Forget all moves: another shape is there."""
        self._before.clear()
        self._after.clear()
        self._reason = ""
        self._on_change()

    @property
    def _vertices(self) -> Floats | None:
        shape = self._session.state.shape
        return shape.vertices if shape is not None and shape.dimension == 2 else None

    def _exchange(self, wanted: list[Floats], other: list[Floats]) -> None:
        now = self._vertices
        if wanted and now is not None:
            other.append(now)
            self.move(wanted.pop())
            self._on_change()


def _shortened(error: PolygonError) -> str:
    """The error without the file's name, places and advice: all that is seen in the picture.

    >>> _shortened(PolygonError("star: edge 1-2 from (0, 1) to (2, 1) crosses vertex 7 (1, 0); move one"))
    'edge 1-2 crosses vertex 7'
    """
    text = re.sub(r"( from| to)? \([^)]*\)", "", str(error)).split("; ")[0]
    return text.split(": ", 1)[-1]
