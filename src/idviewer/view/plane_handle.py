"""The plane handle on the screen: a few actors in a layer of their own, so that the body never hides it."""

from __future__ import annotations

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from pyvistaqt import QtInteractor
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkRenderingCore import vtkRenderer

from idviewer.view.camera import cross
from idviewer.view.handle_geometry import ARROW_HALF_LENGTH, ARROW_START, MOVE_RING_RADIUS, Handle, Part

HANDLE_COLOR, HANDLE_HIGHLIGHT_COLOR = "#3c4654", "#ff8c1a"
HALO_COLOR = "#ffffff"
"""Around everything, because the handle is seen against all colours of a slice."""
HEAD_LENGTH, HEAD_RADIUS, SHAFT_RADIUS, HALO_WIDTH = 0.26, 0.085, 0.024, 0.022
"""Sizes in ring radii."""


class PlaneHandle:
    """Shows where the handle is; `handle_geometry` knows what it does."""

    def __init__(self, plotter: QtInteractor) -> None:
        self._window = plotter.GetRenderWindow()
        self._main = plotter.renderer
        self._layer = vtkRenderer()
        self._layer.SetInteractive(False)
        self._window.SetNumberOfLayers(max(2, self._window.GetNumberOfLayers()))
        self._layer.SetLayer(self._window.GetNumberOfLayers() - 1)
        self._actors = {part: _actor(mesh) for part, mesh in _shapes().items()}
        self._halos = {part: _halo(mesh) for part, mesh in _shapes(HALO_WIDTH).items()}
        self._pose = vtkMatrix4x4()
        for actor in self._everything():
            actor.SetUserMatrix(self._pose)
            self._layer.AddActor(actor)
        self._window.AddRenderer(self._layer)
        self.show(False)

    def show(self, visible: bool) -> None:
        """Show or hide the handle."""
        self._layer.SetDraw(visible)

    def highlight(self, part: Part | None) -> None:
        """Colour the part that is under the mouse or is being dragged."""
        for other, actor in self._actors.items():
            actor.prop.color = HANDLE_HIGHLIGHT_COLOR if other is part else HANDLE_COLOR

    def place(self, handle: Handle) -> None:
        """Put the actors where the handle is, seen by the eye that sees the scene."""
        self._pose.DeepCopy(_matrix(handle))
        for actor in (self._actors[Part.PUSH], self._halos[Part.PUSH]):
            actor.visibility = not handle.foreshortened
        camera = self._layer.GetActiveCamera()
        camera.DeepCopy(self._main.GetActiveCamera())
        self._layer.ResetCameraClippingRange()

    def _everything(self) -> list[pv.Actor]:
        return [*self._actors.values(), *self._halos.values()]

    def close(self) -> None:
        """Take the layer out of the window."""
        self._window.RemoveRenderer(self._layer)
        self._layer.RemoveAllViewProps()
        del self._window, self._main, self._layer


def _actor(mesh: pv.PolyData) -> pv.Actor:
    actor = pv.Actor(mapper=pv.DataSetMapper(mesh))
    actor.prop.color = HANDLE_COLOR
    actor.prop.ambient, actor.prop.diffuse, actor.prop.specular = 0.55, 0.5, 0.1
    actor.prop.interpolation = "gouraud"
    actor.pickable = False
    return actor


def _halo(mesh: pv.PolyData) -> pv.Actor:
    """The far side alone of a thicker copy, so that it is seen around the part and never in front of it."""
    actor = pv.Actor(mapper=pv.DataSetMapper(mesh))
    actor.prop.color, actor.prop.lighting, actor.prop.culling = HALO_COLOR, False, "front"
    actor.pickable = False
    return actor


def _shapes(margin: float = 0.0) -> dict[Part, pv.PolyData]:
    """The parts of a handle with ring radius 1 at the origin whose normal is z, thicker by a margin.

    The middle stays free: that is where the source often is.
    """
    line = SHAFT_RADIUS + margin
    low, high = (
        _shaft(-ARROW_HALF_LENGTH, -ARROW_START, line),
        _shaft(ARROW_START, ARROW_HALF_LENGTH - HEAD_LENGTH, line),
    )
    head = pv.Cone(
        center=(0, 0, ARROW_HALF_LENGTH - HEAD_LENGTH / 2),
        direction=(0, 0, 1),
        height=HEAD_LENGTH + 3 * margin,
        radius=HEAD_RADIUS + margin,
        resolution=32,
    )
    tail = pv.Sphere(radius=2 * SHAFT_RADIUS + margin, center=(0, 0, -ARROW_HALF_LENGTH))
    return {
        Part.PUSH: low.append_polydata(high, head, tail),
        Part.TURN: _torus(1.0, line),
        Part.MOVE: _torus(MOVE_RING_RADIUS, line),
    }


def _shaft(low: float, high: float, radius: float) -> pv.PolyData:
    middle = (0.0, 0.0, (low + high) / 2)
    return pv.Cylinder(center=middle, direction=(0, 0, 1), radius=radius, height=high - low, resolution=24)


def _torus(radius: float, thickness: float) -> pv.PolyData:
    torus = pv.ParametricTorus(ringradius=radius, crosssectionradius=thickness, u_res=120, v_res=16, w_res=1)
    return torus.compute_normals(auto_orient_normals=True)


def _matrix(handle: Handle) -> list[float]:
    right = np.asarray(handle.plane.basis)[0]
    pose: NDArray[np.float64] = np.eye(4)
    pose[:3, :3] = handle.radius * np.column_stack([right, cross(handle.normal, right), handle.normal])
    pose[:3, 3] = handle.origin
    return pose.ravel().tolist()
