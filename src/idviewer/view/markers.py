"""The source, a black dot, and the barycentroid, a blue ball: of one size at any zoom, and always seen."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor

from idviewer.view.body_actor import transparency
from idviewer.view.marker_shaders import BALL, BALL_AT_FRONT
from idviewer.view.polydata import as_cells, as_points, layer
from idviewer.view.shaders import BACK_DEPTH_RANGE, FRONT_DEPTH_RANGE, Shader, set_uniforms

if TYPE_CHECKING:
    from idviewer.session import Frame

SOURCE_COLOR = (0.02, 0.02, 0.03)
BARYCENTROID_COLOR = (0.10, 0.30, 0.95)
SOURCE_RADIUS_PX, BARYCENTROID_RADIUS_PX = 5.5, 8.0
"""In pixels."""
RIM_WIDTH_PX = 1.4
"""Width of the white rim in pixels; without it a black dot is lost on dark blue."""
HIDDEN_BALL_OPACITY = 0.38
"""Opacity of a ball that something hides."""


class Markers:
    """Balls at the frame's source and barycentroid; where something hides one, it shines through faintly."""

    def __init__(self) -> None:
        # The smaller, black one last: it stays visible on the blue one.
        self._barycentroid = _Ball(BARYCENTROID_COLOR, BARYCENTROID_RADIUS_PX)
        self._source = _Ball(SOURCE_COLOR, SOURCE_RADIUS_PX)
        self._frame: Frame | None = None
        self._with_barycentroid = False

    @property
    def actors(self) -> tuple[vtkActor, ...]:
        """All balls, in the order in which they are drawn."""
        return *self._barycentroid.actors, *self._source.actors

    def show_frame(self, frame: Frame | None) -> None:
        """Show another frame's points, or none."""
        self._frame = frame
        if frame is not None:
            self._source.move(frame.source)
            self._barycentroid.move(frame.barycentroid)
        self._update()

    def set_look(self, barycentroid: bool, opacity: float, scale: float, in_2d: bool = False) -> None:
        """Whether the barycentroid is shown, the opacity of the body around, and device pixels in a pixel.

        In 2D the balls are discs.
        """
        self._with_barycentroid = barycentroid
        for ball in (self._source, self._barycentroid):
            ball.resize(scale)
            ball.set_transparency(transparency(opacity))
            ball.set_relief(not in_2d)
        self._update()

    def _update(self) -> None:
        frame = self._frame
        self._source.set_visible(frame is not None and frame.query.quantity == "distance")
        self._barycentroid.set_visible(frame is not None and self._with_barycentroid)


class _Ball:
    """Drawn faintly over everything, then over the glass, then where nothing at all hides it."""

    def __init__(self, color: tuple[float, float, float], radius: float) -> None:
        self._radius = radius
        shaders = (
            BALL_AT_FRONT,
            BALL.in_depth_range(FRONT_DEPTH_RANGE),
            BALL.in_depth_range(BACK_DEPTH_RANGE),
        )
        self.actors = tuple(_point_actor(color, shader) for shader in shaders)
        self.actors[0].GetProperty().SetOpacity(HIDDEN_BALL_OPACITY)
        self.resize(1.0)
        self.set_relief(True)
        self.set_visible(False)

    def move(self, position: np.ndarray) -> None:
        for actor in self.actors:
            actor.SetPosition(*position)

    def resize(self, scale: float) -> None:
        half = np.ceil((self._radius + RIM_WIDTH_PX) * scale + 1.0)
        for actor in self.actors:
            actor.GetProperty().SetPointSize(2 * half)
            set_uniforms(
                actor, ballRadius=self._radius * scale, rimWidth=RIM_WIDTH_PX * scale, spriteRadius=half
            )

    def set_transparency(self, share: float) -> None:
        self.actors[1].GetProperty().SetOpacity(share)

    def set_relief(self, relief: bool) -> None:
        for actor in self.actors:
            set_uniforms(actor, relief=float(relief))

    def set_visible(self, visible: bool) -> None:
        for actor in self.actors:
            actor.SetVisibility(visible)


def _point_actor(color: tuple[float, float, float], shader: Shader) -> vtkActor:
    """A single point at the actor's position, so that single precision does not move it."""
    data = vtkPolyData()
    data.SetPoints(as_points(np.zeros((1, 3))))
    data.SetVerts(as_cells(np.zeros((1, 1), int)))
    actor = layer(data)
    actor.ForceOpaqueOff()
    actor.ForceTranslucentOn()  # after all else, and leaving no depth that would cut the next ball
    actor.GetProperty().SetColor(*color)
    shader.install(actor)
    return actor
