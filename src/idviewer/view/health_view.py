"""Health in the window: its dock, the body that was refused in place of the shape, and what repairs do."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QDockWidget, QMainWindow

from idviewer.core import Shape
from idviewer.core.shapes import BrokenBodyError, FaultPlace, Health, Ray, RepairOutcome
from idviewer.session import Frame, RepairDesk, Session, State
from idviewer.view.broken_shape import BrokenShape
from idviewer.view.camera import Pose
from idviewer.view.health_panel import HealthCalls, HealthPanel
from idviewer.view.message_bar import MessageBar
from idviewer.view.viewport import Viewport

OPEN_HEALTH = "Health…"
NO_MESH = "There is no mesh to examine; polygons are checked when they are opened."


class HealthDock(QDockWidget):
    """The panel's place beside the picture.

    Signals:
        closed: it was closed, and not only hidden behind another.
    """

    closed = Signal()

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """Tell that it is closed."""
        super().closeEvent(event)
        self.closed.emit()


class HealthView:
    """Passes states and frames on to the picture, but while a body that was refused is shown instead.

    Args:
        session: whose shapes are examined and repaired.
        viewport: the picture.
        messages: where results are told.
        save: asks for a file and writes the mesh that is shown.
    """

    def __init__(
        self, session: Session, viewport: Viewport, messages: MessageBar, save: Callable[[], None]
    ) -> None:
        self._session, self._viewport, self._messages = session, viewport, messages
        self.desk = RepairDesk(session)
        calls = HealthCalls(self._go_to, self.desk.foretell, self.desk.repair, self.desk.undo, save)
        self.panel = HealthPanel(calls)
        self.dock = HealthDock("Health")
        self._refused: BrokenShape | None = None
        self._pose: Pose | None = None
        self._beneath: Shape | None = None
        self._told = ""
        self.desk.examined.connect(self._show_health)
        self.desk.foretold.connect(self.panel.show_outcome)
        self.desk.repaired.connect(self._on_repaired)
        self.desk.changed.connect(self._on_desk_changed)
        self.dock.closed.connect(self.leave)

    def add_to(self, window: QMainWindow, neighbour: QDockWidget) -> None:
        """Put the dock behind another of a window; it is hidden until it is asked for."""
        self.dock.setObjectName("health")
        self.dock.setAllowedAreas(neighbour.allowedAreas())
        self.dock.setWidget(self.panel)
        window.addDockWidget(Qt.DockWidgetArea.RightDockWidgetArea, self.dock)
        window.tabifyDockWidget(neighbour, self.dock)
        self.dock.hide()

    @property
    def is_refused_shown(self) -> bool:
        """Whether the picture shows a body that was refused, and not the session's shape."""
        return self._refused is not None

    @property
    def window_title(self) -> str:
        """The name of what is open, with a star where it was repaired."""
        path, shape = self._session.path, self._session.state.shape
        name = path.name if path is not None else shape.name if shape is not None else ""
        star = "*" if self.desk.is_modified else ""
        return f"{name}{star} — idviewer" if name else "idviewer"

    def examine_shown(self) -> None:
        """Look at the mesh that is shown."""
        if self.desk.examine_shown():
            self._raise()
        else:
            self._messages.tell("note", NO_MESH)

    def examine_refused(self, error: BrokenBodyError, path: Path | None) -> None:
        """Look at the body that an error tells of."""
        if self.desk.examine_refused(error.body, path):
            self._raise()

    def show_state(self, state: State) -> None:
        """Show a state, unless a body that was refused is shown in place of its shape."""
        if self._refused is not None and state.shape is not self._beneath:
            self._refused = self._pose = None  # another shape has come
        if self._refused is None:
            self._viewport.show_state(state)

    def show_frame(self, frame: Frame | None) -> None:
        """Likewise of a frame."""
        if self._refused is None:
            self._viewport.show_frame(frame)

    def click(self, ray: Ray, target: str) -> None:
        """Set the source of what is shown; in a body that was refused there is none."""
        if self._refused is None:
            self._session.click(ray, target)  # type: ignore[arg-type]

    def leave(self) -> None:
        """Look at no body any more; the picture is again what it was."""
        self.desk.leave()
        self.panel.show_health(None)
        self._uncover()
        self._viewport.faults.show(None)

    def close_down(self) -> None:
        """Let go of the picture; its window is about to end."""
        self.dock.closed.disconnect(self.leave)

    def _go_to(self, place: FaultPlace) -> None:
        self._viewport.faults.go_to(place)

    def _raise(self) -> None:
        self.panel.show_health(None)
        self.dock.show()
        self.dock.raise_()

    def _show_health(self, health: Health) -> None:
        self.panel.show_health(health)
        self.panel.show_undo(self.desk.undo_title)
        if self.desk.is_of_shown:
            self._uncover()
            self._viewport.faults.show(health)
        elif len(health.faces):
            self._cover(health)
        if health.suggested:
            self.desk.foretell(health.suggested)

    def _cover(self, health: Health) -> None:
        """Show a body that is no shape in place of the shape."""
        if self._refused is None and self._session.state.shape is not None:
            self._pose = self._viewport.faults.pose
        self._refused, self._beneath = BrokenShape(health), self._session.state.shape
        self._viewport.show_frame(None)
        self._viewport.show_state(State(self._refused, display=self._session.state.display))
        self._viewport.reset_view()
        self._viewport.faults.show(health)

    def _uncover(self) -> None:
        """Show the session's shape again, from where it was looked at."""
        if self._refused is None:
            return
        self._refused = None
        self._viewport.show_state(self._session.state)
        self._viewport.show_frame(self._session.frame)
        if self._session.state.shape is not None:
            self._viewport.reset_view()
            if self._pose is not None:
                self._viewport.faults.pose = self._pose
        self._pose = None

    def _on_repaired(self, outcome: RepairOutcome) -> None:
        told = " ".join(f"{record.sentence}." for record in outcome.records if record.count)
        self._told = told or "Nothing had to be repaired."
        self._messages.tell("note", self._told)
        self.desk.examine_shown()

    def _on_desk_changed(self) -> None:
        self.panel.show_undo(self.desk.undo_title)
        if self._messages.text == self._told and not self.desk.is_modified:
            self._messages.clear()
        if self.desk.health is None and not self.dock.isHidden():
            self.panel.show_health(None)
