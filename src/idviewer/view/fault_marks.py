"""Faults of a body, marked on it; and the body itself, where it is none that could be shown otherwise."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor, vtkProperty

from idviewer.view.marker_shaders import BALL, SURFACE_LINE
from idviewer.view.polydata import Place, as_cells, layer
from idviewer.view.shaders import BACK_DEPTH_RANGE, POSITION_TAG, Shader, set_uniforms

if TYPE_CHECKING:
    from idviewer.core.shapes import FaultPlace, Health

BROKEN_COLOR, BROKEN_INSIDE_COLOR = (0.66, 0.68, 0.71), (0.44, 0.45, 0.48)
FAULT_COLOR, CHOSEN_COLOR = (0.84, 0.10, 0.10), (1.0, 0.62, 0.0)
FAULT_OPACITY, HIDDEN_FAULT_OPACITY = 1.0, 0.35
"""Of marks, and of what is seen of them through the body."""
FAULT_WIDTH_PX, CHOSEN_WIDTH_PX, POINT_RADIUS_PX = 3.0, 6.0, 6.0
"""In pixels."""

_AT_FRONT = Shader(vertex={POSITION_TAG: "gl_Position.z = -0.999 * gl_Position.w;"})


class FaultMarks:
    """The marks of all faults, those of the chosen place in another colour, and the grey broken body.

    Attributes:
        body: the surface of a body that is no mesh, seen from both sides.
        marks: all faults: faint over everything, then as far as they are seen.
        chosen: the same of the place that was chosen.
    """

    def __init__(self) -> None:
        self._surface = vtkPolyData()
        self.body = layer(self._surface, lit=True)
        _colour_sides(self.body)
        SURFACE_BEHIND.install(self.body)
        self.marks, self.chosen = _Marks(FAULT_COLOR), _Marks(CHOSEN_COLOR)
        self.set_look(1.0)
        self.show(None, Place(), alone=False)

    def show(self, health: Health | None, place: Place, alone: bool) -> None:
        """Mark the faults of a body, or of none.

        Args:
            health: of the body.
            place: of what is shown.
            alone: whether the body is shown by these marks alone, since it is no shape.
        """
        self.choose(None, place)
        alone = alone and health is not None and len(health.faces) > 0
        self.body.SetVisibility(alone)
        if health is None or not alone:
            self._surface.Initialize()
        else:
            self._surface.SetPoints(place.local(health.vertices))
            self._surface.SetPolys(as_cells(health.faces))
            place.apply(self.body)
        # Several components are no marks: they would cover all of the body.
        faults = () if health is None else health.faults
        told = [one for one in faults if one.kind != "several_components"]
        self.marks.show([found for fault in told for found in fault.places], place)

    def choose(self, chosen: FaultPlace | None, place: Place) -> None:
        """Bring one place out, or none."""
        self.chosen.show([] if chosen is None else [chosen], place)

    def set_look(self, scale: float) -> None:
        """Set the widths; scale is device pixels in a pixel."""
        self.marks.set_look(FAULT_WIDTH_PX * scale, POINT_RADIUS_PX * scale)
        self.chosen.set_look(CHOSEN_WIDTH_PX * scale, 1.4 * POINT_RADIUS_PX * scale)


class _Marks:
    """Lines, faces and dots of one colour."""

    def __init__(self, color: tuple[float, float, float]) -> None:
        self._lines, self._faces, self._points = (vtkPolyData() for _ in range(3))
        seen = SURFACE_LINE.in_depth_range(BACK_DEPTH_RANGE)
        self._pairs = [(layer(data), layer(data)) for data in (self._faces, self._lines)]
        self._dots = layer(self._points)
        for hidden, plain in self._pairs:
            _AT_FRONT.install(hidden)
            seen.install(plain)
            hidden.GetProperty().SetOpacity(HIDDEN_FAULT_OPACITY)
            plain.GetProperty().SetOpacity(FAULT_OPACITY)
        BALL.in_depth_range(BACK_DEPTH_RANGE).install(self._dots)
        set_uniforms(self._dots, relief=1.0)
        for actor in self.actors:
            actor.GetProperty().SetColor(*color)

    @property
    def actors(self) -> tuple[vtkActor, ...]:
        return *(actor for pair in self._pairs for actor in pair), self._dots

    def show(self, places: list[FaultPlace], place: Place) -> None:
        if not places:  # as a rule: a polygon's dragged vertex is a new shape
            for actor in self.actors:
                actor.SetVisibility(False)
            return
        segments = _joined([one.segments for one in places], 2)
        triangles = _joined([one.triangles for one in places], 3)
        dots = np.array([one.centre for one in places if one.radius == 0.0]).reshape(-1, 3)
        for data, corners in ((self._lines, segments), (self._faces, triangles)):
            count, size, _ = corners.shape
            data.SetPoints(place.local(corners.reshape(-1, 3)))
            cells = as_cells(np.arange(count * size).reshape(count, size))
            (data.SetLines if size == 2 else data.SetPolys)(cells)
        self._points.SetPoints(place.local(dots))
        self._points.SetVerts(as_cells(np.arange(len(dots))[:, None]))
        for actor in self.actors:
            place.apply(actor)
            actor.SetVisibility(actor.GetMapper().GetInput().GetNumberOfCells() > 0)

    def set_look(self, width: float, radius: float) -> None:
        for hidden, plain in self._pairs:
            hidden.GetProperty().SetLineWidth(0.5 * width)
            plain.GetProperty().SetLineWidth(width)
        half = float(np.ceil(radius + 2.0))
        self._dots.GetProperty().SetPointSize(2 * half)
        set_uniforms(self._dots, ballRadius=radius, rimWidth=1.4, spriteRadius=half)


SURFACE_BEHIND = Shader(vertex={POSITION_TAG: ""}).in_depth_range(BACK_DEPTH_RANGE)
"""A surface in the depth range that is left to bodies."""


def _joined(parts: list[NDArray[np.float64]], size: int) -> NDArray[np.float64]:
    return np.concatenate([np.empty((0, size, 3)), *parts])


def _colour_sides(actor: vtkActor) -> None:
    """One grey outside, and a darker one inside, which is seen through holes."""
    outside, inside = actor.GetProperty(), vtkProperty()
    for look, color in ((outside, BROKEN_COLOR), (inside, BROKEN_INSIDE_COLOR)):
        look.SetColor(*color)
        look.SetAmbient(0.25)
        look.SetDiffuse(0.75)
    outside.BackfaceCullingOff()
    actor.SetBackfaceProperty(inside)
