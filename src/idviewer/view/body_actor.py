"""The body: glass that shows what is inside, or a solid."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING

import numpy as np
from vtkmodules.vtkCommonCore import vtkCommand
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
from vtkmodules.vtkRenderingCore import vtkActor, vtkRenderer
from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLRenderWindow

from idviewer.view.glass_shaders import GLASS_SURFACE, TRANSLUCENT_SURFACE
from idviewer.view.polydata import Place, as_cells, layer
from idviewer.view.shaders import BACK_DEPTH_RANGE, DEPTH_ONLY

if TYPE_CHECKING:
    from idviewer.core import Mesh

MAX_TRANSLUCENT_OPACITY = 0.35
"""Up to this opacity, all of the body's front faces are seen, one through the other."""
MIN_HIDING_OPACITY = 0.7
"""The opacity from which the body begins to hide what is in it."""
FEATURE_ANGLE_DEGREES = 50.0
"""Edges sharper than this, in degrees, are shown as edges."""


def transparency(opacity: float) -> float:
    """Transparency of the body, as seen from outside: 1 through glass, less where it turns solid.

    0 where there is nothing to see through, as the body is solid, or is not there at all.

    >>> transparency(0.0), transparency(0.5), transparency(1.0)
    (0.0, 1.0, 0.0)
    """
    return float(np.clip((1.0 - opacity) / (1.0 - MIN_HIDING_OPACITY), 0.0, 1.0)) if opacity > 0.0 else 0.0


class BodyActor:
    """The body as glass: clear face on, darker towards its rim; at opacity 1 it is solid.

    All its front faces are seen as long as they are faint: of one colour, it does not matter that they are
    blended in no particular order. What opacity there is beyond that is given to the nearest ones alone.

    Attributes:
        translucent: all front faces.
        mask: the depth of the nearest ones.
        shell: the nearest ones.
    """

    def __init__(self, renderer: vtkRenderer) -> None:
        self._surface = vtkPolyData()
        self._normals = vtkPolyDataNormals()
        self._normals.SetFeatureAngle(FEATURE_ANGLE_DEGREES)
        self._normals.SplittingOn()
        self._normals.ConsistencyOff()  # the core has turned every triangle outwards
        self.translucent, self.mask, self.shell = (layer(self._surface, lit=True) for _ in range(3))
        for actor, shader in (
            (self.translucent, TRANSLUCENT_SURFACE),
            (self.mask, DEPTH_ONLY),
            (self.shell, GLASS_SURFACE),
        ):
            shader.in_depth_range(BACK_DEPTH_RANGE).install(actor)
            actor.GetProperty().SetInterpolationToPhong()
            # The far wall would only cloud what is inside.
            actor.GetProperty().BackfaceCullingOn()
        self._opacity = 0.0
        _leave_no_depth(self.translucent, renderer)
        self.show_mesh(None, Place())

    @property
    def actors(self) -> tuple[vtkActor, vtkActor, vtkActor]:
        """All three, in the order in which they must be drawn."""
        return self.translucent, self.mask, self.shell

    def show_mesh(self, mesh: Mesh | None, place: Place) -> None:
        """Show another mesh, or none."""
        if mesh is None:
            self._surface.Initialize()
        else:
            rough = vtkPolyData()
            rough.SetPoints(place.local(mesh.vertices))
            rough.SetPolys(as_cells(mesh.faces))
            self._normals.SetInputData(rough)
            self._normals.Update()
            self._surface.ShallowCopy(self._normals.GetOutput())
            self._normals.SetInputData(None)
            for actor in self.actors:
                place.apply(actor)
        self.set_opacity(self._opacity)

    def set_opacity(self, opacity: float) -> None:
        """Set the opacity from 0, not to be seen, to 1, solid."""
        self._opacity = opacity
        shown = self._surface.GetNumberOfCells() > 0
        faint = min(opacity, MAX_TRANSLUCENT_OPACITY)
        rest = (opacity - faint) / (1.0 - faint)
        self.translucent.GetProperty().SetOpacity(faint)
        self.translucent.SetVisibility(shown and 0.0 < opacity < 1.0)
        self.shell.GetProperty().SetOpacity(rest)
        self.shell.SetVisibility(shown and rest > 0.0)
        self.mask.SetVisibility(shown and rest > 0.0)


def _leave_no_depth(actor: vtkActor, renderer: vtkRenderer) -> None:
    """Have an actor hide nothing of what is drawn after it, although it is drawn in the opaque pass.

    VTK tells when a shader is ready, which is after it has set the depth mask and before it draws; it sets
    the mask anew for the next actor.
    """
    weak = weakref.ref(renderer)  # the renderer holds the actor, and the actor this function

    def lift_mask(*_: object) -> None:
        holder = weak()
        window = holder.GetRenderWindow() if holder is not None else None
        if isinstance(window, vtkOpenGLRenderWindow):
            window.GetState().vtkglDepthMask(False)

    actor.GetMapper().AddObserver(vtkCommand.UpdateShaderEvent, lift_mask)
