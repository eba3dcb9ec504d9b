"""A slice: coloured by value, with isolines, and outlined. Arrays are replaced in place, actors never."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkCommonCore import vtkScalarsToColors
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor
from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLPolyDataMapper

from idviewer.view.body_actor import transparency
from idviewer.view.isolines import ISOLINES
from idviewer.view.marker_shaders import SURFACE_LINE
from idviewer.view.polydata import Place, as_array, as_cells, as_closed_lines, layer
from idviewer.view.shaders import BACK_DEPTH_RANGE, DEPTH_ONLY, FRONT_DEPTH_RANGE, set_uniforms

if TYPE_CHECKING:
    from idviewer.core.sampling import SliceValues

OUTLINE_COLOR = (0.05, 0.06, 0.10)
"""The colour of outlines."""
OUTLINE_OPACITY = 0.88
ISOLINE_WIDTH_PX, OUTLINE_WIDTH_PX = 1.3, 1.7
"""In pixels."""
COLOR_SHARE_UNDER_GLASS = 0.84
"""Share of its own colour that a slice keeps under the glass; in the rest, the glass is seen."""


class SliceActor:
    """Actor of one plane's section.

    Attributes:
        base: the section itself, hidden or tinted by the body in front of it.
        edge: where the plane meets the body's surface.
        mask: the section's depth, in front of the body; only needed where there are several sections.
        clear: the section once more, over the glass and where no other section hides it. It gives back most
            of the colour that the glass has taken, above all under the rim, which is nearly opaque.
        outline: the edge once more, over the glass.
    """

    def __init__(self, table: vtkScalarsToColors) -> None:
        self._section = vtkPolyData()
        self._loops = vtkPolyData()
        self.base, self.clear = (
            _coloured(self._section, table, depth_range)
            for depth_range in (BACK_DEPTH_RANGE, FRONT_DEPTH_RANGE)
        )
        self.edge, self.outline = (
            _inked(self._loops, depth_range) for depth_range in (BACK_DEPTH_RANGE, FRONT_DEPTH_RANGE)
        )
        self.mask = layer(self._section)
        DEPTH_ONLY.in_depth_range(FRONT_DEPTH_RANGE).install(self.mask)
        self._transparency = 0.0
        self._alone = self._edged = True
        self.hide()

    @property
    def actors(self) -> tuple[vtkActor, ...]:
        """All layers in the order in which they must be drawn, the body between the first and the others."""
        return self.base, self.edge, self.mask, self.clear, self.outline

    def show(self, section: SliceValues, value_range: tuple[float, float], place: Place, alone: bool) -> None:
        """Show another section; value_range is what the colours span, alone whether there is no other."""
        self._alone = alone
        if not len(section.triangles):
            self.hide()
            return
        level, known = _levels(section.values, value_range)
        points = place.local(section.points)
        self._section.SetPoints(points)
        self._section.SetPolys(as_cells(section.triangles))
        self._section.GetPointData().AddArray(as_array(level, "level"))
        self._section.GetPointData().AddArray(as_array(known, "known"))
        self._loops.SetPoints(points)
        self._loops.SetLines(as_closed_lines(section.outline))
        for actor in self.actors:
            place.apply(actor)
        self._set_visible(True)

    def hide(self) -> None:
        """Show nothing, and let go of the arrays."""
        self._section.Initialize()
        self._loops.Initialize()
        self._set_visible(False)

    def set_look(self, isolines: int, opacity: float, scale: float, edged: bool = True) -> None:
        """Set the steps between isolines, the opacity of the body around, and device pixels in a pixel.

        A section that is not edged is left to whoever draws the outline: of a polygon, that is the body.
        """
        self._edged = edged
        for actor in (self.base, self.clear):
            set_uniforms(actor, isolines=float(isolines), lineWidth=ISOLINE_WIDTH_PX * scale)
        self._transparency = transparency(opacity)
        self.clear.GetProperty().SetOpacity(COLOR_SHARE_UNDER_GLASS * self._transparency)
        for actor, share in ((self.edge, 1.0), (self.outline, self._transparency)):
            actor.GetProperty().SetLineWidth(OUTLINE_WIDTH_PX * scale)
            actor.GetProperty().SetOpacity(OUTLINE_OPACITY * share)
        self._set_visible(bool(self.base.GetVisibility()))

    def _set_visible(self, visible: bool) -> None:
        self.base.SetVisibility(visible)
        self.edge.SetVisibility(visible and self._edged)
        for actor in (self.clear, self.outline):
            actor.SetVisibility(visible and self._transparency > 0.0)
        self.mask.SetVisibility(visible and self._transparency > 0.0 and not self._alone)


def _levels(
    values: NDArray[np.float64], value_range: tuple[float, float]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Values as shares of their range, and 1 where a value is known, 0 where it is NaN."""
    low, high = value_range
    known = np.isfinite(values)
    span = high - low
    level = (values - low) / span if span > 0.0 else np.zeros_like(values)
    return np.where(known, level, 0.0).astype(np.float32), known.astype(np.float32)


def _coloured(data: vtkPolyData, table: vtkScalarsToColors, depth_range: str) -> vtkActor:
    actor = layer(data)
    mapper = actor.GetMapper()
    assert isinstance(mapper, vtkOpenGLPolyDataMapper)
    mapper.ScalarVisibilityOn()
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray("level")
    mapper.SetLookupTable(table)
    mapper.UseLookupTableScalarRangeOn()
    # First interpolated, then coloured; the other way round would mix colours that are not in the table.
    mapper.InterpolateScalarsBeforeMappingOn()
    for name in ("level", "known"):
        mapper.MapDataArrayToVertexAttribute(name, name, vtkDataObject.FIELD_ASSOCIATION_POINTS, -1)
    ISOLINES.in_depth_range(depth_range).install(actor, isolines=0.0, lineWidth=ISOLINE_WIDTH_PX)
    return actor


def _inked(data: vtkPolyData, depth_range: str) -> vtkActor:
    actor = layer(data)
    actor.GetProperty().SetColor(*OUTLINE_COLOR)
    SURFACE_LINE.in_depth_range(depth_range).install(actor)
    return actor
