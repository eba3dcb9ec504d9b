"""The window: menus, the picture, the controls, a message bar and the status line, wired to a session."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QDialog, QDockWidget, QGridLayout, QMainWindow, QWidget

from idviewer.core import DistanceError, Shape, ShapeError, sample_names, sample_path
from idviewer.core.sampling import SourceError
from idviewer.core.shapes import BrokenBodyError, Ray
from idviewer.session import Frame, PlaneCommands, Progress, Session, State
from idviewer.view import dialogs, saving
from idviewer.view.cache_menu import clear_cache, show_cache_size
from idviewer.view.dialogs import PictureRequest
from idviewer.view.gui_thread import Post
from idviewer.view.health_view import OPEN_HEALTH, HealthView
from idviewer.view.help import HelpSheet
from idviewer.view.menu_commands import menu_commands
from idviewer.view.menus import enable_for, fill_menu_bar
from idviewer.view.message_bar import MessageBar
from idviewer.view.panel import Calls, Panel
from idviewer.view.part_choice import Choice, PartDialog, choices_of, describe_choices
from idviewer.view.polygon_edits import PolygonEdits
from idviewer.view.polygon_view import is_2d
from idviewer.view.status_line import StatusLine, probe_text
from idviewer.view.undo_menu import UndoMenu
from idviewer.view.viewport import Viewport

LOG = logging.getLogger(__name__)
SAMPLE_GROUPS = {"Meshes": 3, "Polygons": 2}
"""Groups of the bundled shapes, and their dimensions."""


class MainWindow(QMainWindow):
    """Everything the user sees. It owns the session and the post, and closes them with itself."""

    def __init__(self, session: Session, post: Post) -> None:
        super().__init__()
        self.session, self._post = session, post
        self._folder = str(Path.cwd())
        self._requested_path: Path | None = None
        self._requested_part: str | None = None
        self._dialog: QDialog | None = None
        self._closed = False
        self.viewport, self.messages = Viewport(), MessageBar()
        self._planes = PlaneCommands(session)
        self.panel = Panel(Calls(session.set, self.complain), self._planes)
        self.status = StatusLine(self.cancel, session.resume)
        self._polygon_edits = PolygonEdits(session, self.messages, self._show_undo)
        self.health = HealthView(session, self.viewport, self.messages, self.ask_for_mesh)
        self._undo = UndoMenu(self._polygon_edits, self.health.desk)
        self._lay_out()
        samples = {title: sample_names(dimension) for title, dimension in SAMPLE_GROUPS.items()}
        commands = menu_commands(session, self.viewport, self._planes) | self._menu_commands()
        self.actions_by_name = fill_menu_bar(self, commands, samples, self._open_sample)
        show_cache_size(self.actions_by_name["clear_cache"], session.cache)
        self.viewport.clicked.connect(self.health.click)
        self.viewport.vertex_clicked.connect(lambda point: session.set(source=tuple(point.tolist())))
        self.viewport.reshaped.connect(self._polygon_edits.move)
        self.viewport.reshaping_ended.connect(self._polygon_edits.remember)
        self.viewport.hovered.connect(self._show_probe)
        self.viewport.dragged.connect(self._planes.drag_to)
        self._connections: list[tuple[Any, Callable[..., None]]] = [
            (session.changed, self._on_changed),
            (session.frame_ready, self._on_framed),
            (session.failed, self.on_failed),
            (session.progressed, self._show_progress),
            (session.opened, self._on_opened),
            (session.prepared, self.status.show_ready),
            (self.health.desk.changed, self._show_modified),
        ]
        for signal, slot in self._connections:
            signal.connect(slot)
        self._on_changed(State(), session.state)
        self._show_undo()
        self._show_probe(None)

    def _lay_out(self) -> None:
        centre = QWidget()
        layout = QGridLayout(centre)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.viewport, 0, 0)
        # Over the picture, which must not jump when a message comes or goes.
        layout.addWidget(self.messages, 0, 0, Qt.AlignmentFlag.AlignTop)
        self.setCentralWidget(centre)
        self.dock = QDockWidget("Controls", self)
        self.dock.setObjectName("controls")
        sides = Qt.DockWidgetArea.LeftDockWidgetArea | Qt.DockWidgetArea.RightDockWidgetArea
        self.dock.setAllowedAreas(sides)
        self.dock.setWidget(self.panel)
        self.addDockWidget(Qt.DockWidgetArea.RightDockWidgetArea, self.dock)
        self.health.add_to(self, self.dock)
        self.resizeDocks([self.dock], [330], Qt.Orientation.Horizontal)
        self.setStatusBar(self.status)
        self.setAcceptDrops(True)
        self.setWindowTitle("idviewer")
        # The status line is lowest: it tells of progress, and had better not lie below the screen.
        self.resize(QSize(1280, 840).boundedTo(self.screen().availableSize()))

    def _menu_commands(self) -> dict[str, Callable[[], object]]:
        """Callables of the menus' lines that need the window, by their names."""
        return {
            "open": self.ask_for_shape,
            "picture": self.ask_for_picture,
            "clear_cache": lambda: clear_cache(self.session.cache, self.status.tell),
            "quit": self.close,
            "health": self.health.examine_shown,
            "undo": self._undo.undo,
            "redo": self._undo.redo,
            "controls": lambda: self.dock.setVisible(self.dock.isHidden()),
            "cancel": self.cancel,
            "keys": lambda: self._show_dialog(HelpSheet(self)),
            "about": lambda: self._show_dialog(dialogs.about_dialog(self)),
        }

    # What the session says

    def _on_changed(self, old: State, new: State) -> None:
        # A frame that is there although the shape is another is of the same polygon, reshaped.
        another = new.shape is not old.shape and self.session.frame is None
        if another:
            self.status.show_shape(new.shape)
            self._show_probe(None)
            self.health.show_frame(None)
            enable_for(self.actions_by_name, is_2d(new.shape))
        self.health.show_state(new)
        self.panel.show_state(new, self.session.frame)

    def _on_framed(self, frame: Frame) -> None:
        self.health.show_frame(frame)
        self.status.show_frame(frame, self.session.busy)
        self.messages.remark(" ".join(f"{remark.rstrip('.')}." for remark in frame.remarks))
        self.panel.show_state(self.session.state, frame)
        if self.session.busy and not frame.exact:
            self.status.show_progress(Progress("Refining"))

    def _show_progress(self, progress: Progress | None) -> None:
        self.status.show_progress(progress)
        if progress is None and self.session.stopped:  # so it is still, whatever else has ended now
            self.status.show_rest(self.session.state, self.session.frame)

    def on_failed(self, error: BaseException) -> None:
        """Tell the user one line; the log gets the trace too, where the error is ours and not the input's."""
        expected = isinstance(error, ShapeError | SourceError | DistanceError | OSError)
        LOG.error("%s", error, exc_info=None if expected else error)
        path = self._requested_path
        if path is not None and (choices := choices_of(error, self._requested_part)):
            self._offer(path, choices)
        elif isinstance(error, BrokenBodyError) and not self.health.desk.health:
            self.messages.tell(
                "error", str(error), (OPEN_HEALTH, lambda: self.health.examine_refused(error, path))
            )
        else:
            self.complain(str(error) or type(error).__name__)

    def _offer(self, path: Path, choices: tuple[Choice, ...]) -> None:
        """Ask which of a file's shapes to open; the message bar asks again."""
        several = describe_choices(path.name, choices)

        def ask() -> None:
            self.messages.tell("error", several, ("Choose one…", ask))
            dialog = PartDialog(several, choices, self)
            dialog.chosen.connect(lambda choice: self.open(path, choice.component, choice.part))
            self._show_dialog(dialog)

        ask()

    def _on_opened(self, shape: Shape, path: Path | None) -> None:
        self.viewport.reset_view()
        self._polygon_edits.forget()
        self._show_modified()
        if path is not None:
            self._folder = str(path.parent)
        if shape.notes:
            offer = (OPEN_HEALTH, self.health.examine_shown) if not is_2d(shape) else None
            self.messages.tell("note", " ".join(shape.notes), offer)
        else:
            self.messages.clear()

    def _show_modified(self) -> None:
        """Name what is open in the title, with a star where it was repaired, and what can be taken back."""
        self._show_undo()
        self.setWindowTitle(self.health.window_title)

    # What the user asks for

    def complain(self, text: str) -> None:
        """Tell the user one line, which does not block."""
        self.messages.tell("error", text)

    def open(self, path: Path | str, component: int | None = None, part: str | None = None) -> None:
        """Open a mesh or a polygon; the shape that is open stays until the new one is read."""
        self.messages.clear()
        self._requested_path, self._requested_part = Path(path), part
        self.session.open(self._requested_path, component, part)

    def _open_sample(self, name: str) -> None:
        self.open(sample_path(name))

    def ask_for_shape(self) -> None:
        """Show the file dialog."""
        dialog = dialogs.open_dialog(self._folder, self)
        dialog.fileSelected.connect(lambda path: self.open(path))
        self._show_dialog(dialog)

    def ask_for_picture(self) -> None:
        """Show the picture dialog."""
        shape = self.session.state.shape
        if shape is None:
            return
        shown = self.viewport.size() * self.viewport.devicePixelRatioF()
        dialog = dialogs.PictureDialog(
            QSize(shown.width(), shown.height()), Path.cwd() / f"{shape.name or 'picture'}.png", self
        )
        dialog.chosen.connect(self.save_picture)
        self._show_dialog(dialog)

    def save_picture(self, request: PictureRequest) -> None:
        """Write the picture that the window shows, in the requested size."""
        self._save(saving.write_picture, request, self.session, self.viewport)

    def ask_for_mesh(self) -> None:
        """Ask where to write the mesh that is shown, and write it."""
        dialog = saving.mesh_dialog(self.session, self._folder, self)
        if dialog is not None:
            write = saving.write_shown_mesh
            dialog.fileSelected.connect(lambda path: self._save(write, path, self.session))
            self._show_dialog(dialog)

    def _save(self, write: Callable[..., str], *what: object) -> None:
        try:
            self.messages.tell("note", write(*what))
        except Exception as error:
            self.on_failed(error)

    def cancel(self) -> None:
        """Give up a vertex that is being dragged, or stops the computation; what is shown stays."""
        if self.viewport.cancel_drag() or not self.session.busy:
            return
        self.session.cancel()
        self.status.show_rest(self.session.state, self.session.frame)

    def _show_probe(self, ray: Ray | None) -> None:
        probe = self.session.probe(ray) if ray is not None and not self.health.is_refused_shown else None
        self.status.show_probe(probe_text(probe, self.session.frame, self.session.state.shape))

    def _show_undo(self) -> None:
        self._undo.show(self.actions_by_name)

    def _show_dialog(self, dialog: QDialog) -> None:
        """Show a dialog beside the event loop, one at a time."""
        if self._dialog is not None:
            self._dialog.close()
        dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        dialog.finished.connect(self._forget_dialog)
        self._dialog = dialog
        dialog.show()

    def _forget_dialog(self) -> None:
        self._dialog = None

    # Files dropped on it, and its end

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:  # noqa: N802
        """Files are welcome anywhere on the window."""
        if event.mimeData().hasUrls():
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:  # noqa: N802
        """Open the one file that was dropped."""
        urls = event.mimeData().urls()
        if len(urls) != 1 or not urls[0].isLocalFile():
            self.complain("Drop one file from this machine at a time.")
            return
        event.acceptProposedAction()
        self.open(urls[0].toLocalFile())

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """End everything, in the middle of whatever it is."""
        self.close_down()
        event.accept()

    def close_down(self) -> None:
        """The session's worker first, then who listens, then the picture; may be called again."""
        if self._closed:
            return
        self._closed = True
        self.session.close()
        for signal, slot in self._connections:
            signal.disconnect(slot)
        self._post.close()
        if self._dialog is not None:
            self._dialog.close()
        self.viewport.close_down()
