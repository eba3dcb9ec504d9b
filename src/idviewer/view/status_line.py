"""The window's lowest line: value under the cursor, progress with a way to stop it, sizes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QLabel, QProgressBar, QPushButton, QSizePolicy, QStatusBar, QWidget

from idviewer.core import Shape
from idviewer.session import Frame, Probe, Progress, Ready, State, describe_preview, is_complete
from idviewer.view.coordinate_text import format_point, in_unit
from idviewer.view.polygon_view import is_2d

PROGRESS_DELAY_MS = 150
"""Milliseconds that work may take before the line speaks of it; what is done by then only flickers."""

PREVIEW_STYLE = "QLabel { background: #fdf0c8; color: #20242a; padding: 1px 6px; border-radius: 3px; }"

MESSAGE_MS = 6000
"""Milliseconds for which the line says what was done."""

MESH_HINT = "Click to put the source there; drag the arrow to push the slice; F1 for more"
POLYGON_HINT = "Click to put the source there; drag a vertex to reshape the polygon; F1 for more"
EMPTY_HINT = "Open a mesh or a polygon with Ctrl+O, or drop a file here"


def hint_for(shape: Shape | None) -> str:
    """A hint of what can be done with a shape."""
    if shape is None:
        return EMPTY_HINT
    return POLYGON_HINT if is_2d(shape) else MESH_HINT


def describe_probe(probe: Probe, frame: Frame) -> str:
    """The value under the mouse, where that is, and the Euclidean distance beside it."""
    point, unit = np.asarray(probe.point), frame.shape.unit
    place = format_point(point[: frame.shape.dimension].tolist(), unit)
    if frame.query.quantity == "potential":
        return f"U = {probe.value:.4g} at {place}"
    straight = in_unit(f"{float(np.linalg.norm(point - frame.source)):.4g}", unit)
    distance = in_unit(f"{probe.value:.4g}", unit if frame.query.distance.is_length else "")
    return f"d = {distance} at {place}; Euclidean {straight}"


def probe_text(probe: Probe | None, frame: Frame | None, shape: Shape | None) -> str:
    """What the mouse points at, or else a hint of what can be done."""
    if probe is None or probe.value is None or frame is None:
        return hint_for(shape)
    return describe_probe(probe, frame)


class StatusLine(QStatusBar):
    """Shows what it is told, and calls cancel or resume for its one button."""

    def __init__(
        self, cancel: Callable[[], None], resume: Callable[[], None], parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._cancel, self._resume = cancel, resume
        self.probe, self.stage, self.sizes, self.modes = QLabel(), QLabel(), QLabel(), QLabel()
        self.preview = QLabel()
        self.preview.setStyleSheet(PREVIEW_STYLE)
        self.probe.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.bar = QProgressBar()
        self.bar.setFixedWidth(160)
        self.bar.setTextVisible(False)
        self.button = QPushButton("Cancel")
        self.button.clicked.connect(self._press)
        self._stopped = False
        self._preview: float | None = None
        self._delay = QTimer(self, singleShot=True, interval=PROGRESS_DELAY_MS)
        self._delay.timeout.connect(lambda: self._show_work(True))
        self.setContentsMargins(6, 0, 0, 0)
        self.addWidget(self.probe, 1)
        for widget in (self.preview, self.stage, self.bar, self.button, self.sizes, self.modes):
            self.addPermanentWidget(widget)
        self._show_work(False)
        self._show_preview(False)

    def show_shape(self, shape: Shape | None) -> None:
        """Show the numbers of vertices and of faces or edges; the modes are not known yet."""
        facets = (
            "" if shape is None else f"{len(shape.facets):,} {'faces' if shape.dimension == 3 else 'edges'}"
        )
        self.sizes.setText("" if shape is None else f"{len(shape.vertices):,} vertices, {facets}")
        self.modes.clear()
        self._preview = None
        self._show_preview(False)

    def show_ready(self, ready: Ready) -> None:
        """Show the number of modes."""
        self.modes.setText(f"{ready.modes:,} modes" if ready.modes else "")

    def show_frame(self, frame: Frame, refining: bool) -> None:
        """Say so while the picture is a preview.

        Args:
            frame: that is shown.
            refining: whether a better one is being computed.
        """
        self._preview = frame.preview
        self._show_preview(refining)

    def _show_preview(self, refining: bool) -> None:
        self.preview.setVisible(self._preview is not None)
        words = "" if self._preview is None else describe_preview(self._preview)
        self.preview.setText(f"{words}; refining" if words and refining else words)

    def show_progress(self, progress: Progress | None) -> None:
        """Name the stage, and how far it is; None hides it."""
        if progress is None:
            self._delay.stop()
            self._show_work(False)
            return
        if self._stopped:
            self._stopped = False
            self._show_preview(True)
        self.button.setText("Cancel")
        self.stage.setText(progress.stage)
        self.bar.setRange(0, 0 if progress.share is None else 1000)
        self.bar.setValue(round(1000 * (progress.share or 0.0)))
        if self.bar.isHidden() and not self._delay.isActive():
            self._delay.start()

    def show_rest(self, state: State, frame: Frame | None) -> None:
        """Say that the computation was cancelled where a frame is not all that the state asks for."""
        if state.shape is not None and not is_complete(frame, state):
            self.show_stopped()

    def show_stopped(self) -> None:
        """Say that the computation was cancelled, and offer to start it again."""
        self._delay.stop()
        self._show_work(False)
        self._stopped = True
        self._show_preview(False)
        self.stage.setText("Cancelled")
        self.button.setText("Compute again")
        self.stage.show()
        self.button.show()

    def tell(self, text: str) -> None:
        """Say what was done, for some seconds."""
        self.showMessage(text, MESSAGE_MS)

    def show_probe(self, text: str) -> None:
        """Show what is under the cursor."""
        self.probe.setText(text)

    def _show_work(self, visible: bool) -> None:
        for widget in (self.stage, self.bar, self.button):
            widget.setVisible(visible)

    def _press(self) -> None:
        (self._resume if self._stopped else self._cancel)()
