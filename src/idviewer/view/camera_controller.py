"""The camera of a drawing widget: where it stands, what it shows, and the ways to move it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pyvistaqt import QtInteractor

from idviewer.core import Plane, Shape
from idviewer.view import camera
from idviewer.view.camera import Pose, Projection
from idviewer.view.images import default_camera, place_camera
from idviewer.view.polygon_view import is_2d

BAR_SPACE_PX = 180
"""Device-independent pixels at the right that a whole view leaves to the scale bar."""
RADIANS_PER_PX = np.pi / 500
"""Radians that the camera turns for a pixel."""
ZOOM_PER_NOTCH = 0.88
"""Factor of the distance for one notch of the wheel."""


class CameraController:
    """Moves a plotter's camera and has it drawn; positions of the mouse are device-independent pixels."""

    def __init__(self, plotter: QtInteractor, request_draw: Callable[[], None]) -> None:
        self._plotter, self._request_draw = plotter, request_draw
        self._pole = camera.UNIT_VECTORS[1]
        self._parallel = False
        self.beside_bar = True

    @property
    def pose(self) -> Pose:
        """The camera's position, focal point and up vector."""
        active = self._plotter.renderer.GetActiveCamera()
        return Pose(
            np.array(active.GetPosition()), np.array(active.GetFocalPoint()), np.array(active.GetViewUp())
        )

    @property
    def projection(self) -> Projection:
        """The projection from world to pixels at this moment, drawn or not."""
        scale = self._plotter.devicePixelRatioF()
        width = max(1, round(self._plotter.width() * scale))
        height = max(1, round(self._plotter.height() * scale))
        active = self._plotter.renderer.GetActiveCamera()
        matrix = active.GetCompositeProjectionTransformMatrix(width / height, -1, 1)
        return Projection(np.array(matrix.GetData()).reshape(4, 4), width, height, scale)

    def set_pose(self, pose: Pose) -> None:
        """Put the camera there."""
        renderer = self._plotter.renderer
        place_camera(renderer, pose, self._parallel)
        renderer.camera_set = True
        self._request_draw()

    def reset(self, shape: Shape, plane: Plane | None) -> None:
        """Show a whole shape from the side where it begins, a polygon in 2D."""
        self._parallel = is_2d(shape)
        position, focal, up = default_camera(shape.vertices, plane, self._aspect)
        self._pole = camera.nearest_axis(up)
        self._set_pose_beside_bar(Pose(np.array(position), np.array(focal), np.array(up)))

    def next_up(self, shape: Shape) -> None:
        """Have another axis point upwards; files do not say which one is meant to."""
        self._pole = np.roll(np.abs(self._pole), 1)
        self.look_along(shape, -self.pose.axes[2])

    def look_from(self, shape: Shape, view: camera.View) -> None:
        """Show a whole shape from an axis."""
        self.look_along(shape, camera.view_direction(view, self._pole))

    def look_along(self, shape: Shape, direction: camera.Vector) -> None:
        """Show a whole shape along a direction."""
        angle = np.radians(self._plotter.renderer.GetActiveCamera().GetViewAngle())
        up = camera.upright(direction, self._pole)
        self._set_pose_beside_bar(camera.look(direction, up, shape.vertices, angle, self._aspect))

    def approach(self, shape: Shape, centre: camera.Vector, radius: float) -> None:
        """Look at a ball on a shape's surface from outside, from no nearer than shows what is around it."""
        outward = centre - np.mean(shape.bounds, axis=0)
        if np.linalg.norm(outward) < 0.05 * shape.diagonal:  # in the middle: from any side
            outward = self.pose.axes[2]
        outward = camera.unit(outward)
        angle = np.radians(self._plotter.renderer.GetActiveCamera().GetViewAngle())
        distance = max(1.6 * radius, 0.15 * shape.diagonal) / np.tan(angle / 2)
        up = camera.upright(-outward, self._pole)
        self._set_pose_beside_bar(Pose(centre + distance * outward, np.array(centre), up))

    def orbit(self, right: float, down: float) -> None:
        """Turn the shape after a mouse that moved so far."""
        self.set_pose(camera.orbit(self.pose, self._pole, -right * RADIANS_PER_PX, down * RADIANS_PER_PX))

    def pan(self, right: float, down: float) -> None:
        """Have the shape follow a mouse that moved so far."""
        pixel = self.projection.pixel_size(self.pose.focal)
        self.set_pose(camera.pan(self.pose, -right * pixel, down * pixel))

    def zoom(self, notches: float, x: float, y: float, size: float) -> None:
        """Go nearer to what is under the mouse, or away from it; size is the shape's."""
        pose, ray = self.pose, self.projection.ray(x, y)
        start, direction = np.array(ray.origin), np.array(ray.direction)
        forward = -pose.axes[2]
        fixed = start + (pose.focal - start) @ forward / (direction @ forward) * direction
        self.set_pose(camera.zoom(pose, ZOOM_PER_NOTCH**notches, fixed, size))

    @property
    def _space(self) -> int:
        return BAR_SPACE_PX if self.beside_bar and self._plotter.width() > 3 * BAR_SPACE_PX else 0

    @property
    def _aspect(self) -> float:
        """Width over height of the part of the picture that is left for the shape."""
        return (self._plotter.width() - self._space) / max(1, self._plotter.height())

    def _set_pose_beside_bar(self, pose: Pose) -> None:
        self.set_pose(pose)
        self.set_pose(camera.pan(pose, self._space / 2 * self.projection.pixel_size(pose.focal), 0.0))
