"""Faults in the picture of a window: marked, and gone to."""

from __future__ import annotations

from collections.abc import Callable

from idviewer.core.shapes import FaultPlace, Health
from idviewer.view.camera import Pose
from idviewer.view.camera_controller import CameraController
from idviewer.view.scene import Scene


class FaultView:
    """Marks the faults of the body that a scene shows, and moves the camera to them.

    Attributes:
        marked: the health whose faults are marked; None while none are.
        chosen: the place that was gone to last.
    """

    def __init__(self, scene: Scene, camera: CameraController, request_draw: Callable[[], None]) -> None:
        self._scene, self._camera, self._request_draw = scene, camera, request_draw
        self.marked: Health | None = None
        self.chosen: FaultPlace | None = None

    @property
    def pose(self) -> Pose:
        """The camera's position, focal point and up vector; may be set."""
        return self._camera.pose

    @pose.setter
    def pose(self, pose: Pose) -> None:
        self._camera.set_pose(pose)

    def show(self, health: Health | None) -> None:
        """Mark the faults of the body that is shown, or none."""
        self.marked, self.chosen = health, None
        self._scene.show_faults(health)
        self._request_draw()

    def go_to(self, place: FaultPlace) -> None:
        """Bring out one place of a fault and look at it from near."""
        self.chosen = place
        self._scene.choose_fault(place)
        if self._scene.shape is not None:
            self._camera.approach(self._scene.shape, place.centre, place.radius)
        self._request_draw()
