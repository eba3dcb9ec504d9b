"""The body of a polygon: its outline, holes included, as one line of even width."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor

from idviewer.view.marker_shaders import LINE_JOINT, SURFACE_LINE
from idviewer.view.polydata import Place, as_cells, layer
from idviewer.view.shaders import BACK_DEPTH_RANGE, set_uniforms
from idviewer.view.slice_actor import OUTLINE_COLOR

if TYPE_CHECKING:
    from idviewer.core import Polygon

POLYGON_OUTLINE_WIDTH_PX = 2.2
"""In pixels."""
MIN_JOINT_ANGLE_DEGREES = 12.0
"""Degrees: where the outline turns by less, two lines meet without a gap, and a dot would only be a bump."""


class OutlineActor:
    """Lines from vertex to vertex, and round dots of their width that join them at corners.

    Attributes:
        lines: the edges.
        joints: the corners.
    """

    def __init__(self) -> None:
        self._edges, self._vertices = vtkPolyData(), vtkPolyData()
        self.lines, self.joints = layer(self._edges), layer(self._vertices)
        for actor, shader in ((self.lines, SURFACE_LINE), (self.joints, LINE_JOINT)):
            actor.GetProperty().SetColor(*OUTLINE_COLOR)
            shader.in_depth_range(BACK_DEPTH_RANGE).install(actor)
        self.set_look(1.0)
        self.show(None, Place())

    @property
    def actors(self) -> tuple[vtkActor, vtkActor]:
        """Lines and joints, in the order in which they must be drawn."""
        return self.lines, self.joints

    def show(self, polygon: Polygon | None, place: Place) -> None:
        """Show another polygon, or none."""
        for actor in self.actors:
            actor.SetVisibility(polygon is not None)
        if polygon is None:
            self._edges.Initialize()
            self._vertices.Initialize()
            return
        points = place.local(polygon.vertices)
        self._edges.SetPoints(points)
        self._edges.SetLines(as_cells(polygon.edges))
        self._vertices.SetPoints(points)
        self._vertices.SetVerts(as_cells(_corners(polygon)[:, None]))
        for actor in self.actors:
            place.apply(actor)

    def set_look(self, scale: float) -> None:
        """Set the widths; scale is device pixels in a pixel."""
        self.lines.GetProperty().SetLineWidth(POLYGON_OUTLINE_WIDTH_PX * scale)
        half = float(np.ceil(0.5 * POLYGON_OUTLINE_WIDTH_PX * scale + 1.0))
        self.joints.GetProperty().SetPointSize(2 * half)
        set_uniforms(self.joints, dotRadius=0.5 * POLYGON_OUTLINE_WIDTH_PX * scale, spriteRadius=half)


def _corners(polygon: Polygon) -> NDArray[np.intp]:
    """Numbers of the vertices at which the outline turns."""
    ways = (polygon.vertices[polygon.edges[:, 1]] - polygon.vertices) / polygon.lengths[:, None]
    arriving = np.empty_like(ways)
    arriving[polygon.edges[:, 1]] = ways
    return np.flatnonzero((ways * arriving).sum(axis=1) < np.cos(np.radians(MIN_JOINT_ANGLE_DEGREES)))
