"""The picture in the window: draws on request, and makes rays, planes and camera moves of the mouse's.

The mouse never reaches VTK: the drawing widget lets its events through to `Viewport`, so no interactor style
and none of VTK's key bindings can get in the way. Handles come first (the plane's, or a polygon's vertices),
then clicks, then the camera.
"""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QEvent, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QEnterEvent, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget

from idviewer.core import Plane, Polygon
from idviewer.core.arrays import in_space
from idviewer.session.planes import active_plane
from idviewer.session.state import Frame, Point, State
from idviewer.view.camera import Pose, Projection, View
from idviewer.view.camera_controller import CameraController
from idviewer.view.flat import is_flat
from idviewer.view.handle_geometry import Handle, Part
from idviewer.view.mouse_state import SHORT, STILL, Grip, Press, cursor_for, is_shift, target_of
from idviewer.view.plane_handle import PlaneHandle
from idviewer.view.render_widget import Smoothing, drawing_widget
from idviewer.view.scene import Scene
from idviewer.view.vertex_geometry import VertexDrag, vertex_at
from idviewer.view.vertex_handles import VertexHandles


class Viewport(QWidget):
    """The picture. Everything the mouse means is emitted; nothing here changes the state.

    Signals:
        clicked: a Ray, and the target "slice-or-body", "surface" or "chord".
        hovered: the Ray under the mouse, None when it left or is over the handle.
        dragged: the Plane that the handle was dragged to.
        pointed: the (3,) vertex of a polygon that was clicked.
        reshaped: (n, 2) the vertices of a polygon while one is dragged, or when that is given up.
        reshaping_ended: (n, 2) the vertices of a polygon as they were before one was dragged.
    """

    clicked = Signal(object, str)
    hovered = Signal(object)
    dragged = Signal(object)
    pointed = Signal(object)
    reshaped = Signal(object)
    reshaping_ended = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._plotter, self._smoothing = drawing_widget(self), Smoothing()
        self._scene = Scene(self._plotter)
        self._eye = CameraController(self._plotter, self.request_draw)
        self._handle, self._vertices = PlaneHandle(self._plotter), VertexHandles(self._plotter)
        window = self._plotter.GetRenderWindow()
        self._observers = [(window, window.AddObserver("StartEvent", self._before_draw))]
        self._state = State()
        self._press: Press | None = None
        self._mouse: QPointF | None = None
        self._pointed: Grip | None = None
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
        """Shows the state's body, markers and handles; the camera stays."""
        self._state = state
        self._scene.show(state)
        self._eye.beside_bar = state.display.scale_bar
        self._handle.show(state.display.handle and self._plane is not None)
        self._vertices.show(self._polygon)
        self._vertices.highlight(self._pointed if isinstance(self._pointed, int) else None)
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
        if self._smoothing.hurry(self._plotter, dragging):
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
        self._vertices.close()
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
        return active_plane(self._state)

    @property
    def _polygon(self) -> Polygon | None:
        """The polygon whose vertices can be dragged."""
        shape = self._state.shape
        return shape if isinstance(shape, Polygon) and self._state.display.handle else None

    @property
    def handle(self) -> Handle | None:
        """The plane's handle as the picture shows it, None while there is none."""
        if self._plane is None or not self._state.display.handle or self._closed:
            return None
        pose = self.pose
        return Handle(self._plane, self.projection, pose.position, pose.up)

    def _before_draw(self, *_: object) -> None:
        self._scene.show(self._state)  # it follows the window's dots per inch, which a draw may find changed
        self._vertices.follow_window()
        handle = self.handle
        if handle is not None:
            self._handle.place(handle)

    # The mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Grabs a handle, or waits whether this becomes a click or a drag."""
        if self._press is not None:
            return
        at, button, modifiers = event.position(), event.button(), event.modifiers()
        left = button == Qt.MouseButton.LeftButton
        panning = not left or is_shift(modifiers) or is_flat(self._state.shape)
        self._press = Press(at, button, modifiers, event.timestamp(), panning=panning)
        grip, handle = self._grip_at(at) if left else None, self.handle
        if isinstance(grip, Part) and handle is not None:
            self._press.drag = handle.grab(grip, at.x(), at.y())
        elif isinstance(grip, int) and self._polygon is not None:
            self._press.vertex = VertexDrag.grab(self._polygon, grip, self.projection, at.x(), at.y())
        self._point_out(grip)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """The second press of a double click is a press like any other."""
        self.mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Drags a handle or the camera; without a button, says what is under the mouse."""
        at, press = event.position(), self._press
        before, self._mouse = self._mouse, at
        if press is None:
            self._hover(at)
        elif press.drag is not None:
            self._hurry(True)
            self.dragged.emit(press.drag(at.x(), at.y(), is_shift(event.modifiers())))
        elif press.given_up:
            return
        elif press.moved or (at - press.at).manhattanLength() > STILL:
            self._hurry(True)
            way = at - (before if press.moved and before is not None else press.at)
            press.moved = True
            if press.vertex is not None:
                soft = is_shift(event.modifiers())
                self.reshaped.emit(press.vertex.to(self.projection, at.x(), at.y(), soft))
            else:
                (self._eye.pan if press.panning else self._eye.orbit)(way.x(), way.y())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Ends a drag, or clicks."""
        press = self._press
        if press is None or event.button() != press.button:
            return
        self._press = None
        self._hurry(False)
        still = press.drag is None and not press.moved and event.timestamp() - press.time < SHORT
        if press.vertex is not None and press.moved and not press.given_up:
            self.reshaping_ended.emit(press.vertex.polygon.vertices)
        elif press.vertex is not None and still:
            self.pointed.emit(in_space(press.vertex.polygon.vertices[[press.vertex.vertex]])[0])
        elif still and press.button == Qt.MouseButton.LeftButton:
            self.clicked.emit(self.projection.ray(press.at.x(), press.at.y()), target_of(press.modifiers))
        self._hover(event.position())

    def give_up_drag(self) -> bool:
        """Puts a vertex that is being dragged back; tells whether one was. The button may still be down."""
        press = self._press
        if press is None or press.vertex is None or not press.moved or press.given_up:
            return False
        press.given_up = True
        self.reshaped.emit(press.vertex.polygon.vertices)
        return True

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
        grip = self._grip_at(at)
        self._point_out(grip)
        self.hovered.emit(None if isinstance(grip, Part) else self.projection.ray(at.x(), at.y()))

    def _grip_at(self, at: QPointF) -> Grip | None:
        """What can be grabbed there: a part of the plane's handle, or the number of a vertex."""
        if self._polygon is not None:
            return vertex_at(self._polygon, self.projection, at.x(), at.y())
        handle = self.handle
        return handle.part_at(at.x(), at.y()) if handle is not None else None

    def _rest(self) -> None:
        """What lies under a mouse that has not moved since the last frame."""
        if self._press is None and self._mouse is not None:
            self._hover(self._mouse)

    def _point_out(self, grip: Grip | None) -> None:
        if grip == self._pointed:
            return
        self._pointed = grip
        self._handle.highlight(grip if isinstance(grip, Part) else None)
        self._vertices.highlight(grip if isinstance(grip, int) else None)
        self.setCursor(cursor_for(grip))
        self.request_draw()
