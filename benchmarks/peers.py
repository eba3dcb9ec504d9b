"""What we are measured against: the same quantities by other people's code."""

from __future__ import annotations

import math

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkMeanValueCoordinatesInterpolator

from idviewer.core import Mesh, cotangent_laplacian, voronoi_areas


class VtkWeights:
    """Mean value weights by vtkMeanValueCoordinatesInterpolator, one point a call."""

    def __init__(self, mesh: Mesh) -> None:
        self._compute = vtkMeanValueCoordinatesInterpolator.ComputeInterpolationWeights
        self._points = vtkPoints()
        self._points.SetDataTypeToDouble()
        self._points.SetData(numpy_to_vtk(mesh.vertices, deep=True))
        self._cells = vtkCellArray()
        for face in mesh.faces.tolist():
            self._cells.InsertNextCell(3, face)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        rows = np.zeros((len(points), self._points.GetNumberOfPoints()))
        for row, point in zip(rows, points, strict=True):
            self._compute(point, self._points, self._cells, row)
        return rows


def recipe(mesh: Mesh, count: int) -> np.ndarray:
    """The count smallest non-zero eigenvalues by the plain recipe: eigsh, shift-invert, SuperLU."""
    laplacian, masses = cotangent_laplacian(mesh), sparse.diags_array(voronoi_areas(mesh)).tocsc()
    shift = -0.5 * math.pi / mesh.area
    factor = splu(
        sparse.csc_array(laplacian - shift * masses),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    inverse = LinearOperator(laplacian.shape, matvec=factor.solve)
    start = np.random.default_rng(0).standard_normal(len(mesh.vertices))
    values, _ = eigsh(laplacian, count + 1, masses, sigma=shift, OPinv=inverse, tol=1e-6, v0=start)
    return np.sort(values)[1:]
