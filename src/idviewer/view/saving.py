"""Saving what the window shows: the picture, or the mesh."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QFileDialog, QWidget

from idviewer.core import Mesh, write_mesh
from idviewer.core.io import writable_suffixes
from idviewer.session import Session
from idviewer.view import images
from idviewer.view.dialogs import PictureRequest
from idviewer.view.viewport import Viewport


def write_picture(request: PictureRequest, session: Session, viewport: Viewport) -> str:
    """Write the picture that the window shows, in the requested size; return what to tell of it."""
    with _waiting():
        images.write_image(
            request.path,
            session.state,
            session.frame,
            request.size,
            camera=viewport.camera_position,
            transparent=request.transparent,
        )
    width, height = request.size
    return f"Saved {request.path} ({width} × {height} pixels)."


def mesh_dialog(session: Session, folder: str, parent: QWidget) -> QFileDialog | None:
    """Ask where to write the mesh that is shown; None where there is none."""
    shape = session.state.shape
    if not isinstance(shape, Mesh):
        return None
    kinds = ";;".join(f"{suffix[1:].upper()} (*{suffix})" for suffix in writable_suffixes())
    start = Path(folder) / f"{shape.name or 'mesh'}_repaired.ply"
    dialog = QFileDialog(parent, "Save repaired mesh", str(start), kinds)
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    dialog.setDefaultSuffix("ply")
    return dialog


def write_shown_mesh(path: str, session: Session) -> str:
    """Write the mesh that is shown; return what to tell of it."""
    assert isinstance(session.state.shape, Mesh)
    with _waiting():
        lost = write_mesh(session.state.shape, path)
    return " ".join([f"Saved {path}.", *lost])


@contextmanager
def _waiting() -> Iterator[None]:
    QGuiApplication.setOverrideCursor(Qt.CursorShape.WaitCursor)
    try:
        yield
    finally:
        QGuiApplication.restoreOverrideCursor()
