"""VTP files against VTK itself: what its writer writes in any mode, our reader reads to the last bit."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from tests.core import meshfiles, shapes
from tests.core.meshfiles import outcome
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkStripper
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from idviewer.core.io.text import UnreadableError
from idviewer.core.io.vtp import read_vtp
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.repair import repair_mesh

ASCII, BINARY, APPENDED = range(3)
COMPRESSORS = ["NONE", "ZLIB", "LZ4", "LZMA"]  # as VTK numbers them


def polydata(vertices, polygons, single: bool = False) -> vtkPolyData:
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.asarray(vertices, np.float32 if single else np.float64), deep=True))
    cells, lines = vtkCellArray(), vtkCellArray()
    for polygon in polygons:
        cells.InsertNextCell(len(polygon), [int(corner) for corner in polygon])
    lines.InsertNextCell(2, [0, 1])
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetPolys(cells)
    data.SetLines(lines)
    # Further arrays, one with information keys in its XML element, are none of ours.
    heights = numpy_to_vtk(np.ascontiguousarray(vertices), deep=True)
    heights.SetName("heights")
    heights.GetRange(-1)
    data.GetPointData().AddArray(heights)
    return data


def written(
    tmp_path, data: vtkPolyData | vtkSphereSource, mode: int, compressor: str = "NONE", **how: int
) -> bytes:
    path = tmp_path / "written.vtp"
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    if isinstance(data, vtkPolyData):
        writer.SetInputData(data)
    else:
        writer.SetInputConnection(data.GetOutputPort())
    writer.SetDataMode(mode)
    writer.SetCompressorType(COMPRESSORS.index(compressor))
    writer.SetHeaderType(how.get("header", 32))
    writer.SetIdType(how.get("ids", 64))
    writer.SetEncodeAppendedData(how.get("encode", 1))
    writer.SetByteOrder(how.get("order", 1))
    writer.SetBlockSize(how.get("block", 32768))
    writer.SetNumberOfPieces(how.get("pieces", 1))
    assert writer.Write()
    return path.read_bytes()


@pytest.mark.one_is_quick
@pytest.mark.parametrize("mode", [ASCII, BINARY, APPENDED])
@pytest.mark.parametrize("compressor", ["NONE", "ZLIB", "LZMA"])
def test_every_way_of_writing(tmp_path, mode, compressor):
    vertices, polygons = shapes.extruded(shapes.L_OUTLINE)
    for single, header, ids, encode, order in itertools.product((0, 1), (32, 64), (32, 64), (0, 1), (0, 1)):
        data = polydata(vertices, polygons, bool(single))
        # 64-byte blocks, so that arrays have several, the last one not full.
        how = {"header": header, "ids": ids, "encode": encode, "order": order, "block": 64}
        read = read_vtp(written(tmp_path, data, mode, compressor, **how))
        assert np.array_equal(read.vertices, vertices)
        assert read.sizes.tolist() == [len(polygon) for polygon in polygons]
        assert read.corners.tolist() == [corner for polygon in polygons for corner in polygon]


def test_several_pieces_are_joined(tmp_path):
    # A writer with data of its own would write all of it into every piece; this source makes pieces.
    sphere = vtkSphereSource()
    sphere.SetThetaResolution(16)
    sphere.SetPhiResolution(8)
    sphere.Update()
    sizes = sphere.GetOutput().GetNumberOfPoints(), sphere.GetOutput().GetNumberOfPolys()
    data = written(tmp_path, sphere, APPENDED, "ZLIB", pieces=4)
    assert data.count(b"<Piece") == 4
    read = read_vtp(data)
    mesh = repair_mesh(read.vertices, read.corners.reshape(-1, 3))
    assert (len(mesh.vertices), len(mesh.faces)) == sizes


def test_strips(tmp_path):
    vertices, faces = shapes.icosphere(2)
    stripper = vtkStripper()
    stripper.SetInputData(polydata(vertices, faces))
    stripper.Update()
    assert stripper.GetOutput().GetNumberOfStrips() > 1
    for mode in (ASCII, BINARY, APPENDED):
        read = read_vtp(written(tmp_path, stripper.GetOutput(), mode))
        assert len(read.sizes) == len(faces)
        mesh = repair_mesh(read.vertices, read.corners.reshape(-1, 3))
        assert mesh.notes == ()
        assert mesh.volume == pytest.approx(Mesh(vertices, faces).volume, rel=1e-12)


def test_lz4_is_refused_by_its_name(tmp_path):
    data = polydata(*shapes.cube())
    with pytest.raises(
        UnreadableError, match="compression by vtkLZ4DataCompressor is not supported; use ZLib or none"
    ):
        read_vtp(written(tmp_path, data, APPENDED, "LZ4"))
    assert len(read_vtp(written(tmp_path, data, ASCII, "LZ4")).sizes) == 12  # text is not compressed


@pytest.mark.one_is_quick
@pytest.mark.parametrize("mode", [BINARY, APPENDED])
@pytest.mark.parametrize("compressor", ["NONE", "ZLIB", "LZMA"])
@pytest.mark.parametrize("encode", [0, 1])
def test_truncated_and_damaged_files_are_refused(tmp_path, mode, compressor, encode):
    whole = written(tmp_path, polydata(*shapes.cube()), mode, compressor, encode=encode)
    reference = read_vtp(whole)
    for size in range(0, len(whole), 29):
        try:
            read = read_vtp(whole[:size])
        except UnreadableError:
            continue
        assert not whole[size:].strip()
        assert np.array_equal(read.vertices, reference.vertices)
    rng = np.random.default_rng(0)
    path = tmp_path / "damaged.vtp"
    for _ in range(50):
        damaged = bytearray(whole)
        damaged[rng.integers(len(damaged))] = rng.integers(256)
        path.write_bytes(damaged)
        _, message = outcome(path)
        assert message is None or message.isprintable()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b'type="PolyData"', b'type="UnstructuredGrid"', "it holds UnstructuredGrid, not PolyData"),
        (b"<VTKFile", b"<VTKfile", "no XML"),
        (b'NumberOfPoints="8"', b'NumberOfPoints="9"', "it announces 27 coordinates and holds 24"),
        (b'NumberOfPolys="12"', b'NumberOfPolys="13"', "it announces 13 polys and holds 12"),
        (b'Name="offsets"', b'Name="ends"', "it announces 12 polys and holds 0"),
        (b"\n3 6 9", b"\n3 9 6", "do not fit their offsets"),
        (b'format="ascii"', b'format="zip"', "the array format zip is not supported"),
    ],
)
def test_files_that_contradict_themselves(old, new, message):
    data = meshfiles.vtp(*shapes.cube())
    assert old in data
    with pytest.raises(UnreadableError, match=message):
        read_vtp(data.replace(old, new))
