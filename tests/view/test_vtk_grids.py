"""Unstructured grids in VTK's files, XML and legacy: their flat cells, and volumes among them."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (
    VTK_LINE,
    VTK_PIXEL,
    VTK_POLYGON,
    VTK_QUAD,
    VTK_TETRA,
    VTK_TRIANGLE,
    VTK_TRIANGLE_STRIP,
    VTK_VERTEX,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkIOLegacy import vtkUnstructuredGridWriter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

from idviewer.core.io import Contents, FileSource
from idviewer.view.vtk_files import read_vtk


def contents(data: bytes) -> Contents:
    return read_vtk(FileSource(data, Path("here.vtu")))


def grid(cells: list[tuple[int, list[int]]]) -> vtkUnstructuredGrid:
    points = vtkPoints()
    for x, y, z in itertools.product((0, 1), repeat=3):
        points.InsertNextPoint(x, y, z)
    made = vtkUnstructuredGrid()
    made.SetPoints(points)
    for kind, corners in cells:
        made.InsertNextCell(kind, len(corners), corners)
    return made


def grid_file(tmp_path, data: vtkUnstructuredGrid, xml: bool) -> bytes:
    path = tmp_path / "written.vtu"
    writer = vtkXMLUnstructuredGridWriter() if xml else vtkUnstructuredGridWriter()
    writer.SetFileName(str(path))
    if not xml:
        writer.SetFileType(2)
    writer.SetInputData(data)
    assert writer.Write()
    return path.read_bytes()


@pytest.mark.parametrize("xml", [False, True])
def test_the_flat_cells_of_an_unstructured_grid(tmp_path, xml):
    cells = [
        (VTK_TRIANGLE, [0, 1, 2]),
        (VTK_LINE, [0, 1]),
        (VTK_PIXEL, [4, 5, 6, 7]),
        (VTK_TRIANGLE_STRIP, [1, 2, 3, 4]),
        (VTK_VERTEX, [3]),
        (VTK_QUAD, [3, 2, 1, 0]),
        (VTK_POLYGON, [0, 2, 4, 6, 7]),
    ]
    soup = contents(grid_file(tmp_path, grid(cells), xml)).geometry
    assert len(soup.vertices) == 8
    assert soup.sizes.tolist() == [3, 4, 4, 5, 3, 3]
    turned_strip = [1, 2, 3, 3, 2, 4]
    assert soup.corners.tolist() == [0, 1, 2, 4, 5, 7, 6, 3, 2, 1, 0, 0, 2, 4, 6, 7, *turned_strip]


@pytest.mark.parametrize("xml", [False, True])
def test_a_grid_of_volumes_gives_their_outer_surface(tmp_path, xml):
    found = contents(grid_file(tmp_path, grid([(VTK_TETRA, [0, 1, 2, 4]), (VTK_QUAD, [0, 1, 3, 2])]), xml))
    assert sorted(sorted(one) for one in found.geometry.corners.reshape(-1, 3).tolist()) == [
        *([0, 1, 2], [0, 1, 4], [0, 2, 4], [1, 2, 4]),
    ]
    assert found.notes[1] == "1 flat cells beside the volumes were passed over."
