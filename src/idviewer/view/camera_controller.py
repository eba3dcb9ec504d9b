"""The camera of a drawing widget: where it stands, what it shows, and the ways to move it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pyvistaqt import QtInteractor

from idviewer.core import Plane, Shape
from idviewer.view import camera
from idviewer.view.camera import Pose, Projection
from idviewer.view.flat import is_flat
from idviewer.view.images import default_camera, place_camera

BAR_SPACE = 180
"""Device-independent pixels at the right that a whole view leaves to the scale bar."""
TURN = np.pi / 500
"""Radians that the camera turns for a pixel."""
NOTCH = 0.88
"""What one notch of the wheel multiplies the distance by."""


class CameraController:
    """Moves a plotter's camera and has it drawn; positions of the mouse are device-independent pixels."""

    def __init__(self, plotter: QtInteractor, request_draw: Callable[[], None]) -> None:
        self._plotter, self._request_draw = plotter, request_draw
        self._pole = camera.AXES[1]
        self._flat = False
        self.beside_bar = True

    @property
    def pose(self) -> Pose:
        """Where the eye stands."""
        eye = self._plotter.renderer.GetActiveCamera()
        return Pose(np.array(eye.GetPosition()), np.array(eye.GetFocalPoint()), np.array(eye.GetViewUp()))

    @property
    def projection(self) -> Projection:
        """What the picture shows at this moment, drawn or not."""
        scale = self._plotter.devicePixelRatioF()
        width = max(1, round(self._plotter.width() * scale))
        height = max(1, round(self._plotter.height() * scale))
        eye = self._plotter.renderer.GetActiveCamera()
        matrix = eye.GetCompositeProjectionTransformMatrix(width / height, -1, 1)
        return Projection(np.array(matrix.GetData()).reshape(4, 4), width, height, scale)

    def stand(self, pose: Pose) -> None:
        """Puts the camera there."""
        renderer = self._plotter.renderer
        place_camera(renderer, pose, self._flat)
        renderer.camera_set = True
        self._request_draw()

    def reset(self, shape: Shape, plane: Plane | None) -> None:
        """Shows a whole shape from the side where it begins, a polygon flat."""
        self._flat = is_flat(shape)
        position, focal, up = default_camera(shape.vertices, plane, self._aspect)
        self._pole = camera.nearest_axis(up)
        self._stand_beside_bar(Pose(np.array(position), np.array(focal), np.array(up)))

    def next_up(self, shape: Shape) -> None:
        """Has another axis point upwards; files do not say which one is meant to."""
        self._pole = np.roll(np.abs(self._pole), 1)
        self.look_along(shape, -self.pose.axes[2])

    def look_from(self, shape: Shape, view: camera.View) -> None:
        """Shows a whole shape from an axis."""
        self.look_along(shape, camera.view_direction(view, self._pole))

    def look_along(self, shape: Shape, direction: camera.Vector) -> None:
        """Shows a whole shape along a direction."""
        angle = np.radians(self._plotter.renderer.GetActiveCamera().GetViewAngle())
        up = camera.upright(direction, self._pole)
        self._stand_beside_bar(camera.look(direction, up, shape.vertices, angle, self._aspect))

    def orbit(self, right: float, down: float) -> None:
        """Turns the shape after a mouse that moved so far."""
        self.stand(camera.orbit(self.pose, self._pole, -right * TURN, down * TURN))

    def pan(self, right: float, down: float) -> None:
        """Has the shape follow a mouse that moved so far."""
        pixel = self.projection.pixel_size(self.pose.focal)
        self.stand(camera.pan(self.pose, -right * pixel, down * pixel))

    def zoom(self, notches: float, x: float, y: float, size: float) -> None:
        """Goes nearer to what is under the mouse, or away from it; size is the shape's."""
        pose, ray = self.pose, self.projection.ray(x, y)
        start, direction = np.array(ray.origin), np.array(ray.direction)
        forward = -pose.axes[2]
        fixed = start + (pose.focal - start) @ forward / (direction @ forward) * direction
        self.stand(camera.zoom(pose, NOTCH**notches, fixed, size))

    @property
    def _space(self) -> int:
        return BAR_SPACE if self.beside_bar and self._plotter.width() > 3 * BAR_SPACE else 0

    @property
    def _aspect(self) -> float:
        """Of the part of the picture that is left for the shape."""
        return (self._plotter.width() - self._space) / max(1, self._plotter.height())

    def _stand_beside_bar(self, pose: Pose) -> None:
        self.stand(pose)
        self.stand(camera.pan(pose, self._space / 2 * self.projection.pixel_size(pose.focal), 0.0))
