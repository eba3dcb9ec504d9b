"""Arrays as VTK sees them, and actors that draw them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkDataArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor
from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLPolyDataMapper

from idviewer.core.arrays import in_space


class Place:
    """Position and size of a body: the card gets coordinates between -1 and 1.

    It works in single precision; a body far from the origin would tremble, and a tiny one vanish.
    """

    def __init__(self, bounds: ArrayLike = ((0, 0, 0), (1, 1, 1))) -> None:
        lower, upper = in_space(np.asarray(bounds, float))
        self.centre: NDArray[np.float64] = (lower + upper) / 2
        self.size = float(np.linalg.norm(upper - lower)) or 1.0

    def local(self, positions: NDArray[np.float64]) -> vtkPoints:
        """Positions (p, 3), or (p, 2) of a polygon, in the body's own coordinates."""
        return as_points((in_space(positions) - self.centre) / self.size)

    def apply(self, actor: vtkActor) -> None:
        """Have an actor with local coordinates stand where the body is."""
        actor.SetPosition(*self.centre)
        actor.SetScale(self.size)


def as_array(values: NDArray[Any], name: str = "") -> vtkDataArray:
    """VTK's view of an array; nothing is copied, and the view keeps the array alive."""
    array: vtkDataArray = numpy_to_vtk(values)
    array.SetName(name)
    return array


def as_points(positions: NDArray[np.floating]) -> vtkPoints:
    """Positions (p, 3) in single precision."""
    points = vtkPoints()
    points.SetData(as_array(np.ascontiguousarray(positions, np.float32)))
    return points


def as_cells(indices: NDArray[np.integer]) -> vtkCellArray:
    """Cells from indices (c, k), k points each."""
    cells = vtkCellArray()
    cells.SetData(indices.shape[1], as_array(np.ascontiguousarray(indices, np.int32).ravel()))
    return cells


def as_closed_lines(loops: tuple[NDArray[np.int32], ...]) -> vtkCellArray:
    """Loops of indices, without their first index at the end."""
    cells = vtkCellArray()
    if loops:
        ends = np.cumsum([0, *(len(loop) + 1 for loop in loops)], dtype=np.int32)
        indices = np.concatenate([np.append(loop, loop[:1]) for loop in loops])
        cells.SetData(as_array(ends), as_array(indices.astype(np.int32)))
    return cells


def layer(data: vtkPolyData, lit: bool = False) -> vtkActor:
    """An actor that is blended over what was added to the renderer before it, and leaves its depth.

    Without light, its colour stays what it is, however it is turned.
    """
    mapper = vtkOpenGLPolyDataMapper()
    mapper.SetInputData(data)
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.PickableOff()
    actor.ForceOpaqueOn()  # drawn in VTK's opaque pass, in the order of the renderer's list
    if not lit:
        look = actor.GetProperty()
        look.LightingOff()
        look.SetAmbient(1.0)
        look.SetDiffuse(0.0)
        look.SetSpecular(0.0)
    return actor
