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
from idviewer.session import Frame, Point, State, active_plane
from idviewer.view.camera import Pose, Projection, View
from idviewer.view.camera_controller import CameraController
from idviewer.view.fault_view import FaultView
from idviewer.view.handle_geometry import Handle, Part
from idviewer.view.mouse_state import (
    CLICK_MAX_MOVE_PX,
    CLICK_MAX_MS,
    Hit,
    MouseState,
    cursor_for,
    is_shift,
    target_of,
)
from idviewer.view.plane_handle import PlaneHandle
from idviewer.view.polygon_view import is_2d
from idviewer.view.render_widget import InteractiveQuality, make_render_widget
from idviewer.view.scene import Scene
from idviewer.view.vertex_geometry import VertexDrag, vertex_at
from idviewer.view.vertex_handles import VertexHandles


class Viewport(QWidget):
    """The picture. Everything the mouse means is emitted; nothing here changes the state.

    Signals:
        clicked: a Ray, and the target "slice-or-body", "surface" or "chord".
        hovered: the Ray under the mouse, None when it left or is over the handle.
        dragged: the Plane that the handle was dragged to.
        vertex_clicked: the (3,) vertex of a polygon that was clicked.
        reshaped: (n, 2) the vertices of a polygon while one is dragged, or when that is given up.
        reshaping_ended: (n, 2) the vertices of a polygon as they were before one was dragged.
    """

    clicked = Signal(object, str)
    hovered = Signal(object)
    dragged = Signal(object)
    vertex_clicked = Signal(object)
    reshaped = Signal(object)
    reshaping_ended = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._plotter, self._quality = make_render_widget(self), InteractiveQuality()
        self._scene = Scene(self._plotter)
        self._camera = CameraController(self._plotter, self.request_draw)
        self.faults = FaultView(self._scene, self._camera, self.request_draw)
        self._handle, self._vertices = PlaneHandle(self._plotter), VertexHandles(self._plotter)
        window = self._plotter.GetRenderWindow()
        self._observers = [(window, window.AddObserver("StartEvent", self._before_draw))]
        self._state = State()
        self._mouse: MouseState | None = None
        self._mouse_position: QPointF | None = None
        self._highlighted: Hit | None = None
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
        """Show the state's body, markers and handles; the camera stays."""
        self._state = state
        self._scene.show(state)
        self._camera.beside_bar = state.display.scale_bar
        self._handle.show(state.display.handle and self._plane is not None)
        self._vertices.show(self._polygon)
        self._vertices.highlight(self._highlighted if isinstance(self._highlighted, int) else None)
        self.request_draw()

    def show_frame(self, frame: Frame | None) -> None:
        """Show what the frame says."""
        self._scene.show_frame(frame)
        self.request_draw()
        self._look_again.start()

    def request_draw(self) -> None:
        """Have the picture drawn once when the event loop gets to it, however often this is called."""
        if not self._closed:
            self._plotter.update()

    def _set_interactive(self, dragging: bool) -> None:
        if self._quality.set_interactive(self._plotter, dragging):
            self.request_draw()

    def close_down(self) -> None:
        """Give everything back to VTK and Qt; may be called again."""
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
        # Whoever still holds this widget must not keep a render window alive.
        del self._plotter, self._camera, self.faults

    # The camera

    @property
    def pose(self) -> Pose:
        """The camera's position, focal point and up vector."""
        return self._camera.pose

    @property
    def projection(self) -> Projection:
        """The projection from world to pixels at this moment, drawn or not."""
        return self._camera.projection

    @property
    def camera_position(self) -> tuple[Point, Point, Point]:
        """Position, focal point and up vector, as pictures take them."""
        position, focal, up = (tuple(part.tolist()) for part in vars(self.pose).values())
        return position, focal, up

    def reset_view(self) -> None:
        """Show the whole shape from the side where it begins."""
        if self._state.shape is not None:
            self._camera.reset(self._state.shape, self._plane)

    def look_from(self, view: View) -> None:
        """Show the whole shape from an axis."""
        if self._state.shape is not None:
            self._camera.look_from(self._state.shape, view)

    def turn_upright(self) -> None:
        """Have another axis point upwards."""
        if self._state.shape is not None:
            self._camera.next_up(self._state.shape)

    def look_at_plane(self) -> None:
        """Show the active plane face on, from the side that its normal points to."""
        if self._state.shape is not None and self._plane is not None:
            self._camera.look_along(self._state.shape, -np.array(self._plane.normal))

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
        if self._mouse is None and self._mouse_position is not None:  # what moved may be the handle
            self._highlight(self._hit_at(self._mouse_position))

    # The mouse

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Grab a handle, or waits whether this becomes a click or a drag."""
        if self._mouse is not None:
            return
        at, button, modifiers = event.position(), event.button(), event.modifiers()
        left = button == Qt.MouseButton.LeftButton
        panning = not left or is_shift(modifiers) or is_2d(self._state.shape)
        self._mouse = MouseState(at, button, modifiers, event.timestamp(), panning=panning)
        hit, handle = self._hit_at(at) if left else None, self.handle
        if isinstance(hit, Part) and handle is not None:
            self._mouse.drag = handle.grab(hit, at.x(), at.y())
        elif isinstance(hit, int) and self._polygon is not None:
            self._mouse.vertex = VertexDrag.grab(self._polygon, hit, self.projection, at.x(), at.y())
        self._highlight(hit)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """The second press of a double click is a press like any other."""
        self.mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Drag a handle or the camera; without a button, say what is under the mouse."""
        at, mouse = event.position(), self._mouse
        before, self._mouse_position = self._mouse_position, at
        if mouse is None:
            self._hover(at)
        elif mouse.drag is not None:
            self._set_interactive(True)
            self.dragged.emit(mouse.drag(at.x(), at.y(), is_shift(event.modifiers())))
        elif mouse.cancelled:
            return
        elif mouse.moved or (at - mouse.at).manhattanLength() > CLICK_MAX_MOVE_PX:
            self._set_interactive(True)
            way = at - (before if mouse.moved and before is not None else mouse.at)
            mouse.moved = True
            if mouse.vertex is not None:
                soft = is_shift(event.modifiers())
                self.reshaped.emit(mouse.vertex.to(self.projection, at.x(), at.y(), soft))
            else:
                (self._camera.pan if mouse.panning else self._camera.orbit)(way.x(), way.y())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """End a drag, or clicks."""
        mouse = self._mouse
        if mouse is None or event.button() != mouse.button:
            return
        self._mouse = None
        self._set_interactive(False)
        still = mouse.drag is None and not mouse.moved and event.timestamp() - mouse.time < CLICK_MAX_MS
        if mouse.vertex is not None and mouse.moved and not mouse.cancelled:
            self.reshaping_ended.emit(mouse.vertex.polygon.vertices)
        elif mouse.vertex is not None and still:
            self.vertex_clicked.emit(in_space(mouse.vertex.polygon.vertices[[mouse.vertex.vertex]])[0])
        elif still and mouse.button == Qt.MouseButton.LeftButton:
            self.clicked.emit(self.projection.ray(mouse.at.x(), mouse.at.y()), target_of(mouse.modifiers))
        self._hover(event.position())

    def cancel_drag(self) -> bool:
        """Put a vertex that is being dragged back; return whether one was. The button may still be down."""
        mouse = self._mouse
        if mouse is None or mouse.vertex is None or not mouse.moved or mouse.cancelled:
            return False
        mouse.cancelled = True
        self.reshaped.emit(mouse.vertex.polygon.vertices)
        return True

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Zoom towards what is under the mouse."""
        if self._state.shape is None:
            return
        at = event.position()
        self._camera.zoom(event.angleDelta().y() / 120, at.x(), at.y(), self._state.shape.diagonal)

    def enterEvent(self, event: QEnterEvent) -> None:  # noqa: N802
        """The mouse comes in."""
        self._mouse_position = event.position()

    def leaveEvent(self, event: QEvent) -> None:  # noqa: N802
        """The mouse went away."""
        self._mouse_position = None
        if self._mouse is None:
            self._highlight(None)
            self.hovered.emit(None)

    def _hover(self, at: QPointF) -> None:
        hit = self._hit_at(at)
        self._highlight(hit)
        self.hovered.emit(None if isinstance(hit, Part) else self.projection.ray(at.x(), at.y()))

    def _hit_at(self, at: QPointF) -> Hit | None:
        """The hit there: a part of the plane's handle, or the number of a vertex."""
        if self._polygon is not None:
            return vertex_at(self._polygon, self.projection, at.x(), at.y())
        handle = self.handle
        return handle.part_at(at.x(), at.y()) if handle is not None else None

    def _rest(self) -> None:
        """Look again at what lies under a mouse that has not moved since the last frame."""
        if self._mouse is None and self._mouse_position is not None:
            self._hover(self._mouse_position)

    def _highlight(self, hit: Hit | None) -> None:
        if hit == self._highlighted:
            return
        self._highlighted = hit
        self._handle.highlight(hit if isinstance(hit, Part) else None)
        self._vertices.highlight(hit if isinstance(hit, int) else None)
        self.setCursor(cursor_for(hit))
        self.request_draw()
