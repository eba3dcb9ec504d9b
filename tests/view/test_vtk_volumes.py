"""Volume meshes in VTK's files: their outer surface, of every kind of cell, held against VTK's own cells."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkGenericCell, vtkUnstructuredGrid
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

from idviewer.core import repair_mesh
from idviewer.core.io import UnreadableError
from idviewer.core.validation import Cells, surface_of_cells
from idviewer.core.validation.cell_surfaces import CELL_KINDS
from idviewer.view import vtk_reader_process
from idviewer.view.vtk_files import _NAMES, _VOLUMES, surface_of

TETRA, VOXEL, HEXAHEDRON, WEDGE, PYRAMID, POLYHEDRON = 10, 11, 12, 13, 14, 42
NUMBERS = np.arange(3 * 3 * 2).reshape(2, 3, 3)
POINTS = np.array(list(itertools.product((0.0, 1, 2), repeat=3)))[:, ::-1]
"""Of a lattice of 2 x 2 x 2 cubes."""


def lattice(x: int, y: int, z: int) -> int:
    return x + 3 * y + 9 * z


def cubes() -> list[list[int]]:
    """Seven of the eight, corners as VTK numbers those of a hexahedron: an L in every direction, volume 7."""
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    return [
        [lattice(x + a, y + b, z + c) for c in (0, 1) for a, b in ring]
        for x, y, z in itertools.product((0, 1), repeat=3)
        if (x, y, z) != (1, 1, 1)
    ]


def cut(kind: int) -> tuple[np.ndarray, list[tuple[int, list[int]]]]:
    """The same body of cells of one kind."""
    points, cells = POINTS, []
    for cube in cubes():
        if kind == VOXEL:
            cells.append([cube[i] for i in (0, 1, 3, 2, 4, 5, 7, 6)])
        elif kind == WEDGE:
            cells += [[cube[i] for i in (0, 1, 2, 4, 5, 6)], [cube[i] for i in (0, 2, 3, 4, 6, 7)]]
        elif kind == TETRA:  # six around the diagonal from 0 to 6, alike in all cubes
            path = [1, 2, 3, 7, 4, 5]
            cells += [[cube[0], cube[path[i]], cube[path[i - 5]], cube[6]] for i in range(6)]
        elif kind == PYRAMID:
            middle = len(points)
            points = np.concatenate([points, [points[cube].mean(axis=0)]])
            sides = CELL_KINDS["hexahedron"].faces
            cells += [[*(cube[i] for i in side[::-1]), middle] for side in sides]
        else:
            cells.append(cube)
    return points, [(kind, cell) for cell in cells]


def grid(points: np.ndarray, cells: list[tuple[int, list[int]]]) -> vtkUnstructuredGrid:
    made, stored = vtkUnstructuredGrid(), vtkPoints()
    stored.SetData(numpy_to_vtk(np.ascontiguousarray(points, dtype=np.float64), deep=True))
    made.SetPoints(stored)
    for kind, corners in cells:
        if kind == POLYHEDRON:
            faces = CELL_KINDS["hexahedron"].faces
            stream = vtkIdList()
            flat = [number for face in faces for number in (len(face), *(corners[i] for i in face))]
            for number in (len(faces), *flat):
                stream.InsertNextId(number)
            made.InsertNextCell(kind, stream)
        else:
            made.InsertNextCell(kind, len(corners), corners)
    return made


def file_of(tmp_path, data: vtkUnstructuredGrid, mode: int = 2, compressor: int = 2) -> bytes:
    """A .vtu; appended and compressed by LZ4, unless told otherwise."""
    path = tmp_path / "written.vtu"
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    writer.SetDataMode(mode)
    writer.SetCompressorType(compressor)
    assert writer.Write()
    return path.read_bytes()


def mesh_of(arrays, welded: bool = False):
    soup = surface_of(arrays, welded).geometry
    return repair_mesh(soup.vertices, np.split(soup.corners, np.cumsum(soup.sizes)[:-1]))


@pytest.mark.parametrize("kind", [TETRA, VOXEL, HEXAHEDRON, WEDGE, PYRAMID, POLYHEDRON])
def test_the_outer_surface_of_every_kind_of_cell(tmp_path, kind):
    points, cells = cut(kind)
    arrays = vtk_reader_process.read(file_of(tmp_path, grid(points, cells)))
    mesh = mesh_of(arrays)
    assert (mesh.volume, mesh.area) == (pytest.approx(7.0, rel=1e-12), pytest.approx(24.0, rel=1e-12))
    assert len(mesh.vertices) == 26
    assert not any("turned" in note for note in mesh.notes)
    assert surface_of(arrays).notes[0].startswith("The outer surface of ")


def test_cells_of_several_kinds_meet(tmp_path):
    cells = [
        *[(HEXAHEDRON, cube) for cube in cubes()[:3]],
        *[(VOXEL, [cube[i] for i in (0, 1, 3, 2, 4, 5, 7, 6)]) for cube in cubes()[3:5]],
        *[(POLYHEDRON, cube) for cube in cubes()[5:]],
        (5, [0, 1, 3]),
        (3, [0, 1]),
    ]
    arrays = vtk_reader_process.read(file_of(tmp_path, grid(POINTS, cells), mode=0, compressor=0))
    assert mesh_of(arrays).volume == pytest.approx(7.0, rel=1e-12)
    assert surface_of(arrays).notes == (
        "The outer surface of 5 volume cells and polyhedra was taken.",
        "1 flat cells beside the volumes were passed over.",
    )


@pytest.mark.parametrize("number", _VOLUMES)
def test_faces_are_those_of_vtk(number):
    kind = _VOLUMES[number]
    known = CELL_KINDS[_NAMES.get(kind, kind)]
    cell = vtkGenericCell()
    cell.SetCellType(number)
    for place in range(cell.GetNumberOfPoints()):
        cell.GetPointIds().SetId(place, place)
    assert cell.GetNumberOfPoints() == known.points
    if kind == "voxel":
        return
    faces = set()
    for place in range(cell.GetNumberOfFaces()):
        face = cell.GetFace(place).GetPointIds()
        ring = [face.GetId(i) for i in range(face.GetNumberOfIds())]
        # Points in the middle of faces are left out.
        faces.add(frozenset(one for one in ring if one in set(itertools.chain(*known.faces))))
    assert faces == {frozenset(face) for face in known.faces}


def quadratic_tetra(rng) -> tuple[np.ndarray, list[int]]:
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    middles = np.array([corners[list(edge)].mean(axis=0) for edge in edges])
    return np.concatenate([corners, middles + 0.05 * rng.standard_normal((6, 3))]), list(range(10))


def test_curved_faces_pass_through_the_points_on_their_edges(rng):
    points, cell = quadratic_tetra(rng)
    made = grid(points, [(24, cell)])
    surface = vtkDataSetSurfaceFilter()
    surface.SetInputData(made)
    surface.SetNonlinearSubdivisionLevel(1)
    surface.Update()
    assert surface.GetOutput().GetNumberOfPolys() == 16
    six = 0.0
    for number in range(16):  # VTK hands one cell out again and again
        triangle = surface.GetOutput().GetCell(number).GetPoints()
        six += np.linalg.det([triangle.GetPoint(corner) for corner in range(3)])
    (corners, sizes), _ = surface_of_cells(points, [Cells("tetra10", np.array([cell]))])
    mesh = repair_mesh(points, corners.reshape(-1, 3))
    assert len(sizes) == 16
    assert mesh.volume == pytest.approx(abs(six) / 6, rel=1e-6)


@pytest.mark.parametrize(("kind", "cells", "total"), [("quad8", 6, 30), ("triangle6", 4, 16)])
def test_curved_flat_cells_are_cut_too(kind, cells, total):
    solid, known = {"quad8": "hexahedron20", "triangle6": "tetra10"}[kind], None
    known = CELL_KINDS[solid]
    # Faces of a solid list corner, middle, corner, ...; flat cells list corners first.
    blocks = np.array([[*face[::2], *face[1::2]] for face in known.faces])
    assert len(blocks) == cells
    points = np.random.default_rng(1).standard_normal((known.points, 3))
    (corners, sizes), notes = surface_of_cells(points, [Cells(kind, blocks)])
    assert (len(sizes), notes) == (total, ())
    of_solid = surface_of_cells(points, [Cells(solid, np.arange(known.points)[None])])[0]

    def rings(polygons):
        return {frozenset(one.tolist()) for one in np.split(polygons[0], np.cumsum(polygons[1])[:-1])}

    assert rings((corners, sizes)) == rings(of_solid)


def test_pieces_have_no_walls_between_them_and_ghosts_are_no_cells(tmp_path):
    points, cells = cut(HEXAHEDRON)
    double = np.concatenate([points, points])
    apart = [
        (kind, [corner + 27 * (number % 2) for corner in cell]) for number, (kind, cell) in enumerate(cells)
    ]
    made = grid(double, [*apart, (HEXAHEDRON, [13, 14, 17, 16, 22, 23, 26, 25])])
    ghosts = vtkUnsignedCharArray()
    ghosts.SetName("vtkGhostType")
    for number in range(8):
        ghosts.InsertNextValue(1 if number == 7 else 0)
    made.GetCellData().AddArray(ghosts)
    arrays = vtk_reader_process.read(file_of(tmp_path, made))
    assert mesh_of(arrays, welded=True).volume == pytest.approx(7.0, rel=1e-12)
    assert len(surface_of(arrays).geometry.sizes) == 30  # the walls between the pieces, too


def test_unknown_cells_are_refused_by_their_number(tmp_path):
    data = file_of(tmp_path, grid(POINTS, [(71, list(range(10)))]))
    with pytest.raises(
        UnreadableError, match="it holds cells of VTK's type 71; extract the surface and save"
    ):
        surface_of(vtk_reader_process.read(data))


def test_cells_that_refer_to_missing_points_are_refused():
    with pytest.raises(ValueError, match="fewer points than its cells name"):
        surface_of_cells(np.zeros((3, 3)), [Cells("tetra", np.array([[0, 1, 2, 3]]))])
    with pytest.raises(ValueError, match="cells of the kind tetra have 4 points"):
        Cells("tetra", np.array([[0, 1, 2]]))
