"""A polygon's vertices on the screen: small dots in a layer of their own, the one under the mouse larger."""

from __future__ import annotations

import numpy as np
from pyvistaqt import QtInteractor
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor, vtkRenderer

from idviewer.core import Polygon
from idviewer.view.marker_shaders import BALL
from idviewer.view.polydata import Place, as_cells, as_points, layer
from idviewer.view.scene import POINTS_PER_INCH
from idviewer.view.shaders import set_uniforms

MAX_SHOWN_VERTICES = 500
"""Of more vertices, only the one under the mouse is shown."""
VERTEX_COLOR, VERTEX_HIGHLIGHT_COLOR = (0.10, 0.12, 0.18), (1.0, 0.52, 0.08)
VERTEX_RADIUS_PX, HIGHLIGHT_RADIUS_PX = 2.4, 5.0
VERTEX_RIM_PX, HIGHLIGHT_RIM_PX = 0.0, 1.6
"""In pixels. All vertices are knots in the outline; the one pointed out has a white rim around it."""


class VertexHandles:
    """Shows where the vertices are; `vertex_geometry` knows what they do."""

    def __init__(self, plotter: QtInteractor) -> None:
        self._window = plotter.GetRenderWindow()
        self._layer = vtkRenderer()
        self._layer.SetInteractive(False)
        self._layer.SetActiveCamera(plotter.renderer.GetActiveCamera())
        self._window.SetNumberOfLayers(self._window.GetNumberOfLayers() + 1)
        self._layer.SetLayer(self._window.GetNumberOfLayers() - 1)
        self._vertices, single = vtkPolyData(), vtkPolyData()
        single.SetPoints(as_points(np.zeros((1, 3))))
        single.SetVerts(as_cells(np.zeros((1, 1), int)))
        self._all_dots, self._highlighted_dot = (
            _dots(self._vertices, VERTEX_COLOR),
            _dots(single, VERTEX_HIGHLIGHT_COLOR),
        )
        for actor in (self._all_dots, self._highlighted_dot):
            self._layer.AddActor(actor)
        self._window.AddRenderer(self._layer)
        self._shown: Polygon | None = None
        self._scale = 0.0
        self.show(None)
        self.highlight(None)

    def show(self, polygon: Polygon | None) -> None:
        """Show the vertices of another polygon, or none."""
        self._layer.SetDraw(polygon is not None)
        if polygon is None or polygon is self._shown:
            return
        self._shown = polygon
        place = Place(polygon.bounds)
        self._all_dots.SetVisibility(len(polygon.vertices) <= MAX_SHOWN_VERTICES)
        self._vertices.SetPoints(place.local(polygon.vertices))
        self._vertices.SetVerts(as_cells(np.arange(len(polygon.vertices))[:, None]))
        place.apply(self._all_dots)

    def highlight(self, vertex: int | None) -> None:
        """Point out the vertex that is under the mouse or is being dragged."""
        polygon = self._shown
        if polygon is None or vertex is None or vertex >= len(polygon.vertices):
            self._highlighted_dot.VisibilityOff()
        else:
            x, y = polygon.vertices[vertex].tolist()
            self._highlighted_dot.SetPosition(x, y, 0.0)
            self._highlighted_dot.VisibilityOn()

    def follow_window(self) -> None:
        """Keep the dots' size in pixels when the window's dots per inch change."""
        scale = self._window.GetDPI() / POINTS_PER_INCH
        if scale != self._scale:
            self._scale = scale
            _resize(self._all_dots, VERTEX_RADIUS_PX, VERTEX_RIM_PX, scale)
            _resize(self._highlighted_dot, HIGHLIGHT_RADIUS_PX, HIGHLIGHT_RIM_PX, scale)

    def close(self) -> None:
        """Take the layer out of the window."""
        self._window.RemoveRenderer(self._layer)
        self._layer.RemoveAllViewProps()
        del self._window, self._layer


def _dots(data: vtkPolyData, color: tuple[float, float, float]) -> vtkActor:
    actor = layer(data)
    actor.GetProperty().SetColor(*color)
    BALL.install(actor, relief=0.0)
    return actor


def _resize(actor: vtkActor, radius: float, rim: float, scale: float) -> None:
    half = float(np.ceil((radius + rim) * scale + 1.0))
    actor.GetProperty().SetPointSize(2 * half)
    set_uniforms(actor, ballRadius=radius * scale, rimWidth=rim * scale, spriteRadius=half)
