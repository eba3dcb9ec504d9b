"""The picture in the window: draws on request, and makes rays, planes and camera moves of the mouse's.

The mouse never reaches VTK: the drawing widget lets its events through to `Viewport`, so no interactor style
and none of VTK's key bindings can get in the way. The plane handle comes first, then clicks, then the camera.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QEvent, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QEnterEvent, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget
from pyvistaqt import QtInteractor

from idviewer.core import Plane
from idviewer.session.state import Frame, Point, State
from idviewer.view.camera import Pose, Projection, View
from idviewer.view.eye import Eye
from idviewer.view.handle_geometry import Drag, Handle, Part
from idviewer.view.plane_handle import PlaneHandle
from idviewer.view.scene import Scene

STILL, SHORT = 4.0, 800
"""A click moves less than so many device-independent pixels and lasts less than so many milliseconds."""
CURSORS = {
    Part.PUSH: Qt.CursorShape.SizeVerCursor,
    Part.TURN: Qt.CursorShape.PointingHandCursor,
    Part.MOVE: Qt.CursorShape.SizeAllCursor,
}


@dataclass
class _Press:
    """What the mouse is doing while a button is down."""

    at: QPointF
    button: Qt.MouseButton
    modifiers: Qt.KeyboardModifier
    time: int
    drag: Drag | None = None
    panning: bool = False
    moved: bool = False


class Viewport(QWidget):
    """The picture. Everything the mouse means is emitted; nothing here changes the state.

    Signals:
        clicked: a Ray, and the target "slice-or-body", "surface" or "chord".
        hovered: the Ray under the mouse, None when it left or is over the handle.
        dragged: the Plane that the handle was dragged to.
    """

    clicked = Signal(object, str)
    hovered = Signal(object)
    dragged = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._plotter = _drawing_widget(self)
        self._scene = Scene(self._plotter)
        self._eye = Eye(self._plotter, self.request_draw)
        self._handle = PlaneHandle(self._plotter)
        window = self._plotter.GetRenderWindow()
        self._observers = [(window, window.AddObserver("StartEvent", self._before_draw))]
        self._state = State()
        self._press: _Press | None = None
        self._mouse: QPointF | None = None
        self._pointed: Part | None = None
        self._smoothing: int | None = None
        self._closed = False
        # Once for all frames since the last turn of the event loop, and after the draw, which comes first.
        self._look_again = QTimer(self, singleShot=True, interval=0)
        self._look_again.timeout.connect(self._rest)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._plotter)

    # What is shown

    def show_state(self, state: State) -> None:
        """Shows the state's body, markers and handle."""
        new_mesh = state.shape is not self._state.shape
        self._state = state
        self._scene.show(state)
        self._eye.beside_bar = state.display.scale_bar
        self._handle.show(state.display.handle and self._plane is not None)
        if new_mesh:
            self.reset_view()
        self.request_draw()

    def show_frame(self, frame: Frame | None) -> None:
        """Shows what the frame says."""
        self._scene.show_frame(frame)
        self.request_draw()
        self._look_again.start()

    def request_draw(self) -> None:
        """Has the picture drawn once when the event loop gets to it, however often this is called."""
        if not self._closed:
            self._plotter.update()

    def _hurry(self, dragging: bool) -> None:
        """Without a graphics card, draws without smoothing while the mouse drags: three times as fast."""
        window = self._plotter.GetRenderWindow()
        if self._smoothing is None:
            software = any(name in window.ReportCapabilities() for name in ("llvmpipe", "softpipe"))
            self._smoothing = window.GetMultiSamples() if software else 0
        wanted = 0 if dragging else self._smoothing
        if self._smoothing and window.GetMultiSamples() != wanted:
            window.SetMultiSamples(wanted)
            self.request_draw()

    def close_down(self) -> None:
        """Gives everything back to VTK and Qt; may be called again."""
        if self._closed:
            return
        self._closed = True
        self._look_again.stop()
        for subject, tag in self._observers:
            subject.RemoveObserver(tag)
        self._observers.clear()
        self._handle.close()
        self._scene.close()
        self._plotter.close()
        del self._plotter, self._eye  # whoever still holds this widget must not keep a render window alive

    # The camera

    @property
    def pose(self) -> Pose:
        """Where the eye stands."""
        return self._eye.pose

    @property
    def projection(self) -> Projection:
        """What the picture shows at this moment, drawn or not."""
        return self._eye.projection

    @property
    def camera_position(self) -> tuple[Point, Point, Point]:
        """Position, focal point and up vector, as pictures take them."""
        position, focal, up = (tuple(part.tolist()) for part in vars(self.pose).values())
        return position, focal, up

    def reset_view(self) -> None:
        """Shows the whole shape from the side where it begins."""
        if self._state.shape is not None:
            self._eye.reset(self._state.shape, self._plane)

    def look_from(self, view: View) -> None:
        """Shows the whole shape from an axis."""
        if self._state.shape is not None:
            self._eye.look_from(self._state.shape, view)

    def turn_upright(self) -> None:
        """Has another axis point upwards."""
        if self._state.shape is not None:
            self._eye.next_up(self._state.shape)

    def look_at_plane(self) -> None:
        """Shows the active plane face on, from the side that its normal points to."""
        if self._state.shape is not None and self._plane is not None:
            self._eye.look_along(self._state.shape, -np.array(self._plane.normal))

    # The handle

    @property
    def _plane(self) -> Plane | None:
        planes, active = self._state.query.planes, self._state.display.active_plane
        return planes[active] if self._state.shape is not None and active < len(planes) else None

    @property
    def handle(self) -> Handle | None:
        """The plane's handle as the picture shows it, None while there is none."""
        if self._plane is None or not self._state.display.handle or self._closed:
            return None
        pose = self.pose
        return Handle(self._plane, self.projection, pose.position, pose.up)

    def _before_draw(self, *_: object) -> None:
        self._scene.show(self._state)  # it follows the window's dots per inch, which a draw may find changed
        handle = self.handle
        if handle is not None:
            self._handle.place(handle)

    # The mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Grabs the handle, or waits whether this becomes a click or a drag."""
        if self._press is not None:
            return
        at, button, modifiers = event.position(), event.button(), event.modifiers()
        left = button == Qt.MouseButton.LeftButton
        panning = not left or _shift(modifiers)
        self._press = _Press(at, button, modifiers, event.timestamp(), panning=panning)
        handle = self.handle
        part = handle.part_at(at.x(), at.y()) if handle is not None and left else None
        if handle is not None and part is not None:
            self._press.drag = handle.grab(part, at.x(), at.y())
            self._point_out(part)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """The second press of a double click is a press like any other."""
        self.mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Drags the handle or the camera; without a button, says what is under the mouse."""
        at, press = event.position(), self._press
        before, self._mouse = self._mouse, at
        if press is None:
            self._hover(at)
        elif press.drag is not None:
            self._hurry(True)
            self.dragged.emit(press.drag(at.x(), at.y(), _shift(event.modifiers())))
        elif press.moved or (at - press.at).manhattanLength() > STILL:
            self._hurry(True)
            way = at - (before if press.moved and before is not None else press.at)
            (self._eye.pan if press.panning else self._eye.orbit)(way.x(), way.y())
            press.moved = True

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Ends a drag, or clicks."""
        press = self._press
        if press is None or event.button() != press.button:
            return
        self._press = None
        self._hurry(False)
        still = press.drag is None and not press.moved and event.timestamp() - press.time < SHORT
        if still and press.button == Qt.MouseButton.LeftButton:
            self.clicked.emit(self.projection.ray(press.at.x(), press.at.y()), _target(press.modifiers))
        self._hover(event.position())

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Zooms towards what is under the mouse."""
        if self._state.shape is None:
            return
        at = event.position()
        self._eye.zoom(event.angleDelta().y() / 120, at.x(), at.y(), self._state.shape.diagonal)

    def enterEvent(self, event: QEnterEvent) -> None:  # noqa: N802
        """The mouse comes in."""
        self._mouse = event.position()

    def leaveEvent(self, event: QEvent) -> None:  # noqa: N802
        """The mouse went away."""
        self._mouse = None
        if self._press is None:
            self._point_out(None)
            self.hovered.emit(None)

    def _hover(self, at: QPointF) -> None:
        handle = self.handle
        part = handle.part_at(at.x(), at.y()) if handle is not None else None
        self._point_out(part)
        self.hovered.emit(None if part else self.projection.ray(at.x(), at.y()))

    def _rest(self) -> None:
        """What lies under a mouse that has not moved since the last frame."""
        if self._press is None and self._mouse is not None:
            self._hover(self._mouse)

    def _point_out(self, part: Part | None) -> None:
        if part is self._pointed:
            return
        self._pointed = part
        self._handle.highlight(part)
        self.setCursor(CURSORS[part] if part else Qt.CursorShape.ArrowCursor)
        self.request_draw()


def _shift(modifiers: Qt.KeyboardModifier) -> bool:
    return bool(modifiers & Qt.KeyboardModifier.ShiftModifier)


def _target(modifiers: Qt.KeyboardModifier) -> str:
    if modifiers & Qt.KeyboardModifier.ControlModifier:
        return "chord"
    return "surface" if _shift(modifiers) else "slice-or-body"


def _drawing_widget(parent: QWidget) -> QtInteractor:
    """A plotter that draws when Qt paints and at no other time, and takes no mouse, key or drop."""
    plotter = QtInteractor(parent, auto_update=False)
    plotter.suppress_rendering = True
    plotter.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
    plotter.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    plotter.setAcceptDrops(False)
    return plotter
