"""Repair desk: the body that is looked at, what its repairs would change, and the way back from them."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from idviewer.core import Mesh, Repairs
from idviewer.core.shapes import Health, RawBody, RepairOutcome
from idviewer.session.session import Session
from idviewer.session.signal import Signal
from idviewer.session.state import (
    Examined,
    ExamineRequest,
    Foretold,
    Repaired,
    RepairRequest,
    Request,
    Result,
    Snapshot,
)

MOST_SNAPSHOTS = 20
"""Repairs that can be taken back."""


class _Step(NamedTuple):
    """A repair that can be taken back: its title, what was shown on its other side, what it began with."""

    title: str
    snapshot: Snapshot
    refused: RawBody | None
    path: Path | None


class RepairDesk:
    """Has bodies examined and repaired by a session, and remembers what was shown before each repair.

    Attributes:
        health: of the body that is looked at; None before there is one.
        outcome: of the repairs foretold for it; None where none are, or until it is known.
        examined: Signal(health) when a body has been looked at.
        foretold: Signal(outcome) when it is known what repairs would change.
        repaired: Signal(outcome) when a repaired shape is shown.
        changed: Signal() when something can be taken back that could not, or the other way round.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self.health: Health | None = None
        self.outcome: RepairOutcome | None = None
        self.examined, self.foretold, self.repaired, self.changed = (Signal() for _ in range(4))
        self._path: Path | None = None
        self._mesh: Mesh | None = None
        self._wanted: Repairs | None = None
        self._before: list[_Step] = []
        self._after: list[_Step] = []
        session.answered.connect(self._on_answered)
        session.opened.connect(self._on_opened)

    @property
    def is_of_shown(self) -> bool:
        """Whether the body that is looked at is the shape that is shown."""
        return self._mesh is not None and self._mesh is self._session.state.shape

    @property
    def undo_title(self) -> str:
        """The repairs that can be taken back, in words; empty where there are none."""
        return self._before[-1].title if self._before else ""

    @property
    def redo_title(self) -> str:
        """The repairs that can be made again, in words; empty where there are none."""
        return self._after[-1].title if self._after else ""

    @property
    def is_modified(self) -> bool:
        """Whether what is shown was changed by repairs."""
        return bool(self._before)

    def examine_shown(self) -> bool:
        """Look at the mesh that is shown; return whether there is one, and no file is being read."""
        shape = self._session.state.shape
        if not isinstance(shape, Mesh):
            return False
        return self._examine(RawBody.of(shape), self._session.path, shape)

    def examine_refused(self, body: RawBody, path: Path | None) -> bool:
        """Look at a body that was refused; return whether no file is being read."""
        return self._examine(body, path, None)

    def foretell(self, repairs: Repairs) -> None:
        """Ask what repairs would change."""
        if self.health is not None:
            self.outcome, self._wanted = None, repairs
            if repairs:
                self._session.ask(RepairRequest(self.health.body, repairs, foretell=True))

    def repair(self, repairs: Repairs) -> None:
        """Make repairs of the body that is looked at, and show the result; where it is none, all stays."""
        if self.health is not None:
            self._session.ask(RepairRequest(self.health.body, repairs))

    def leave(self) -> None:
        """Look at no body any more."""
        self.health = self.outcome = self._mesh = self._wanted = None

    def undo(self) -> None:
        """Show what was shown before the last repair, and look at the body again if it had been refused."""
        step = self._take(self._before, self._after)
        if step is not None and step.refused is not None:
            self.examine_refused(step.refused, step.path)

    def redo(self) -> None:
        """Show the repaired shape again."""
        self._take(self._after, self._before)

    def _examine(self, body: RawBody, path: Path | None, mesh: Mesh | None) -> bool:
        self.leave()
        self._path, self._mesh = path, mesh
        return self._session.ask(ExamineRequest(body))

    def _on_answered(self, request: Request, result: Result) -> None:
        match result:
            case Examined():
                self.health = result.health
                self.examined.emit(result.health)
            case Foretold() if isinstance(request, RepairRequest) and request.repairs == self._wanted:
                self.outcome = result.outcome
                self.foretold.emit(result.outcome)
            case Repaired():
                self._show(result)

    def _show(self, result: Repaired) -> None:
        titles = "; ".join(record.sentence.partition(":")[0] for record in result.outcome.records)
        refused = None if self.is_of_shown else result.outcome.body
        path = self._path
        steps = [*self._before, _Step(titles or "repair", self._session.snapshot(), refused, path)]
        if self.is_of_shown:
            self._session.swap(result.shape, path)
        else:
            self._session.show(result.shape, path)
        self._before = steps[-MOST_SNAPSHOTS:]
        self._after.clear()
        self.leave()
        self.repaired.emit(result.outcome)
        self.changed.emit()

    def _on_opened(self, *_: object) -> None:
        self.leave()
        self._before.clear()
        self._after.clear()
        self.changed.emit()

    def _take(self, wanted: list[_Step], other: list[_Step]) -> _Step | None:
        if not wanted:
            return None
        step = wanted.pop()
        other.append(step._replace(snapshot=self._session.snapshot()))
        self.leave()
        self._session.restore(step.snapshot)
        self.changed.emit()
        return step
