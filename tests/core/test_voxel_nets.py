"""The net between voxels against VTK's: the same where no voxels meet in an edge alone."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkSurfaceNets3D

from idviewer.core.shapes.voxel_surface import voxel_surface


def nets_of_vtk(voxels: np.ndarray, smoothing: bool) -> tuple[np.ndarray, int]:
    """Points of VTK's net in our lattice, and the number of its quads."""
    image = vtkImageData()
    image.SetDimensions(voxels.shape)
    scalars = numpy_to_vtk(voxels.astype(np.uint8).ravel(order="F"), deep=True)
    image.GetPointData().SetScalars(scalars)
    nets = vtkSurfaceNets3D()
    nets.SetInputData(image)
    nets.SetValue(0, 1)
    nets.SetOutputMeshTypeToQuads()
    nets.SetSmoothing(smoothing)
    nets.Update()
    made = nets.GetOutput()
    return vtk_to_numpy(made.GetPoints().GetData()) + 0.5, made.GetNumberOfPolys()


def test_the_same_net_as_vtk_and_as_near_to_the_body():
    places = np.indices((20, 20, 20)) - 9.3
    voxels = (places**2 * np.array([1.0, 0.7, 1.6])[:, None, None, None]).sum(axis=0) < 6.4**2
    surface = voxel_surface(voxels)
    theirs, quads = nets_of_vtk(voxels, smoothing=False)
    assert (len(theirs), 2 * quads) == (len(surface.vertices), len(surface.faces))
    smoothed, _ = nets_of_vtk(voxels, smoothing=True)
    scale = np.sqrt([1.0, 0.7, 1.6])

    def away(points: np.ndarray) -> float:
        return float(np.abs(np.linalg.norm((points - 9.8) * scale, axis=1) - 6.4).mean())

    assert away(surface.vertices) < 0.6 * away(theirs)
    assert away(surface.vertices) < 1.1 * away(smoothed)
