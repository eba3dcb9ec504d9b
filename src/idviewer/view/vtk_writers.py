"""Writers of VTK's XML files: a boundary with fields at its vertices, and samples on a regular grid."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkDataSet, vtkImageData, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter, vtkXMLPolyDataWriter

from idviewer.core.arrays import in_space
from idviewer.core.io import atomic_path
from idviewer.view.polydata import as_array, as_cells

Fields = Mapping[str, NDArray[Any]]


def write_vtp(
    path: str | os.PathLike[str], vertices: NDArray[np.float64], facets: NDArray[np.integer], fields: Fields
) -> None:
    """Write a boundary with fields at its vertices as VTP, with every digit.

    Args:
        path: of the file.
        vertices: (n, 3), or (n, 2) of a polygon.
        facets: (m, 3) triangles, or (m, 2) edges.
        fields: (n,) by their names.

    Raises:
        OSError: it cannot be written.
    """
    points = vtkPoints()
    points.SetData(as_array(np.ascontiguousarray(in_space(vertices), np.float64)))
    data = vtkPolyData()
    data.SetPoints(points)
    cells: vtkCellArray = as_cells(facets)
    if facets.shape[1] == 3:
        data.SetPolys(cells)
    else:
        data.SetLines(cells)
    _write(vtkXMLPolyDataWriter(), data, Path(path), fields)


def write_vti(
    path: str | os.PathLike[str],
    origin: NDArray[np.float64],
    spacing: float,
    shape: tuple[int, ...],
    fields: Fields,
) -> None:
    """Write samples on a regular grid as VTI, with every digit.

    Args:
        path: of the file.
        origin: (3,) the lowest corner, or (2,).
        spacing: of the nodes along each axis.
        shape: how many nodes there are along x, y and z.
        fields: arrays of that shape by their names.

    Raises:
        OSError: it cannot be written.
    """
    data = vtkImageData()
    data.SetDimensions(*shape, *(1,) * (3 - len(shape)))
    data.SetOrigin(*in_space(origin[None])[0].tolist())
    data.SetSpacing(spacing, spacing, spacing)
    # VTK counts along x first.
    flat = {name: np.ascontiguousarray(values.ravel(order="F")) for name, values in fields.items()}
    _write(vtkXMLImageDataWriter(), data, Path(path), flat)


def _write(writer: Any, data: vtkDataSet, path: Path, fields: Fields) -> None:
    for name, values in fields.items():
        data.GetPointData().AddArray(as_array(values, name))
    with atomic_path(path) as part:
        part.touch()  # that it cannot be made is an error of this program, VTK would only tell its log
        writer.SetFileName(str(part))
        writer.SetInputData(data)
        if not writer.Write():
            raise OSError(f"{path}: the file could not be written; is the disk full?")
