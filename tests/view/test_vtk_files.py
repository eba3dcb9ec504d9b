"""VTK files: what VTK's writers write in any mode is read to the last bit, and no damage ends the process."""

from __future__ import annotations

import itertools
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from tests.core import meshfiles, shapes
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (
    vtkCellArray,
    vtkPolyData,
)
from vtkmodules.vtkFiltersCore import vtkStripper
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter, vtkUnstructuredGridWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from idviewer.cli import shape_info
from idviewer.cli.options import BodyChoice
from idviewer.cli.parsing import shape_of
from idviewer.core import Mesh, MeshError, Repairs, read_mesh, repair_mesh
from idviewer.core.io import Contents, FileSource, UnreadableError, formats, readable_suffixes
from idviewer.view import vtk_reader_process
from idviewer.view.vtk_files import VTK_SUFFIXES, read_vtk, register_vtk_reader

ASCII, BINARY, APPENDED = range(3)
COMPRESSORS = ["NONE", "ZLIB", "LZ4", "LZMA"]  # as VTK numbers them


def contents(data: bytes) -> Contents:
    return read_vtk(FileSource(data, Path("here.vtp")))


def read(data: bytes):
    return contents(data).geometry


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


def legacy(tmp_path, writer: vtkPolyDataWriter | vtkUnstructuredGridWriter, data, binary: bool) -> bytes:
    path = tmp_path / "written.vtk"
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    writer.SetFileType(2 if binary else 1)
    assert writer.Write()
    return path.read_bytes()


@pytest.mark.one_is_quick
@pytest.mark.parametrize("mode", [ASCII, BINARY, APPENDED])
@pytest.mark.parametrize("compressor", COMPRESSORS)
def test_every_way_of_writing(tmp_path, mode, compressor):
    vertices, polygons = shapes.extruded(shapes.L_OUTLINE)
    for single, header, ids, encode, order in itertools.product((0, 1), (32, 64), (32, 64), (0, 1), (0, 1)):
        data = polydata(vertices, polygons, bool(single))
        # 64-byte blocks, so that arrays have several, the last one not full.
        how = {"header": header, "ids": ids, "encode": encode, "order": order, "block": 64}
        arrays = vtk_reader_process.read(written(tmp_path, data, mode, compressor, **how))
        assert np.array_equal(arrays["points"], vertices)
        assert arrays["sizes"].tolist() == [len(polygon) for polygon in polygons]
        assert arrays["corners"].tolist() == [corner for polygon in polygons for corner in polygon]


def test_several_pieces_are_joined(tmp_path):
    # A writer with data of its own would write all of it into every piece; this source makes pieces.
    sphere = vtkSphereSource()
    sphere.SetThetaResolution(16)
    sphere.SetPhiResolution(8)
    sphere.Update()
    sizes = sphere.GetOutput().GetNumberOfPoints(), sphere.GetOutput().GetNumberOfPolys()
    data = written(tmp_path, sphere, APPENDED, "ZLIB", pieces=4)
    assert data.count(b"<Piece") == 4
    soup = read(data)
    mesh = repair_mesh(soup.vertices, soup.corners.reshape(-1, 3))
    assert (len(mesh.vertices), len(mesh.faces)) == sizes


def test_strips(tmp_path):
    vertices, faces = shapes.icosphere(2)
    stripper = vtkStripper()
    stripper.SetInputData(polydata(vertices, faces))
    stripper.Update()
    assert stripper.GetOutput().GetNumberOfStrips() > 1
    for mode in (ASCII, BINARY, APPENDED):
        soup = read(written(tmp_path, stripper.GetOutput(), mode))
        assert len(soup.sizes) == len(faces)
        mesh = repair_mesh(soup.vertices, soup.corners.reshape(-1, 3))
        assert mesh.notes == ()
        assert mesh.volume == pytest.approx(Mesh(vertices, faces).volume, rel=1e-12)


@pytest.mark.parametrize("binary", [False, True])
def test_legacy_files(tmp_path, binary):
    vertices, polygons = shapes.extruded(shapes.L_OUTLINE)
    soup = read(legacy(tmp_path, vtkPolyDataWriter(), polydata(vertices, polygons), binary))
    assert np.array_equal(soup.vertices, vertices)
    assert soup.sizes.tolist() == [len(polygon) for polygon in polygons]
    assert soup.corners.tolist() == [corner for polygon in polygons for corner in polygon]


def test_other_data_are_refused_by_their_name(tmp_path):
    with pytest.raises(UnreadableError, match="it holds STRUCTURED_POINTS, not POLYDATA or UNSTRUCTURED"):
        read(b"# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET STRUCTURED_POINTS\n")
    with pytest.raises(UnreadableError, match="it holds ImageData, not PolyData or UnstructuredGrid"):
        read(b'<?xml version="1.0"?><VTKFile type="ImageData"></VTKFile>')
    with pytest.raises(UnreadableError, match="truncated, or no file of VTK"):
        read(b"solid cube")


@pytest.mark.one_is_quick
@pytest.mark.parametrize("compressor", COMPRESSORS)
@pytest.mark.parametrize("encode", [0, 1])
def test_truncated_files_are_refused(tmp_path, compressor, encode):
    whole = written(tmp_path, polydata(*shapes.cube()), APPENDED, compressor, encode=encode)
    for size in (0, 40, len(whole) // 2, len(whole) - 30, len(whole) - 5):
        with pytest.raises(UnreadableError, match="truncated"):
            read(whole[:size])


@pytest.mark.slow
@pytest.mark.parametrize("binary", [False, True])
def test_truncated_legacy_files_are_refused_or_hold_no_polygons(tmp_path, binary):
    whole = legacy(tmp_path, vtkPolyDataWriter(), polydata(*shapes.cube()), binary)
    reference = read(whole)
    for size in range(0, len(whole), len(whole) // 12):
        try:
            soup = read(whole[:size])
        except UnreadableError:
            continue
        if len(soup.sizes):
            assert np.array_equal(soup.vertices, reference.vertices)
            assert np.array_equal(soup.corners, reference.corners)


@pytest.mark.slow
@pytest.mark.parametrize("compressor", ["NONE", "ZLIB"])
def test_damaged_files_end_in_one_line(tmp_path, compressor, capfd):
    whole = written(tmp_path, polydata(*shapes.cube()), APPENDED, compressor, encode=0)
    rng = np.random.default_rng(0)
    for _ in range(25):
        damaged = bytearray(whole)
        damaged[rng.integers(len(damaged))] = rng.integers(256)
        with suppress(UnreadableError):  # many a byte is that of a coordinate
            read(bytes(damaged))
    assert capfd.readouterr() == ("", "")


def test_what_ends_the_process_of_the_reader_ends_no_other(tmp_path):
    # The last offset is missing: VTK takes whatever lies in memory there for the length of the next array.
    whole = written(tmp_path, polydata(*shapes.cube()), APPENDED, encode=0)
    end = whole.rindex(b"</AppendedData>")
    with pytest.raises(UnreadableError, match="truncated or damaged"):
        read(whole[: end - 100] + whole[end - 1 :])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"<VTKFile", b"<VTKfile", "no XML file of VTK"),
        (b'NumberOfPoints="8"', b'NumberOfPoints="9"', "truncated or damaged"),
        (b'NumberOfPolys="12"', b'NumberOfPolys="13"', "truncated or damaged"),
        (b'NumberOfPoints="8"', b'NumberOfPoints="800000000000000"', "truncated or damaged"),
        (b'Name="offsets"', b'Name="ends"', "truncated or damaged"),
        (b"\n3 6 9", b"\n3 9 6", "truncated or damaged"),
        (b"\n0 2 3", b"\n0 2 8", "fewer points than its cells name"),
    ],
)
def test_files_that_contradict_themselves(old, new, message):
    data = meshfiles.vtp(*shapes.cube())
    assert old in data
    with pytest.raises(UnreadableError, match=message):
        read(data.replace(old, new))


def test_the_reader_is_named_without_loading_vtk():
    assert VTK_SUFFIXES == (".vtp", ".vtu", ".vtk")
    code = "import sys, idviewer.view.vtk_files; assert 'vtkmodules' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_when_registered_they_are_read_like_other_files(tmp_path, monkeypatch):
    monkeypatch.setattr(formats, "_FORMATS", dict(formats._FORMATS))
    path = tmp_path / "cube.vtp"
    path.write_bytes(meshfiles.vtp(*shapes.cube()))
    register_vtk_reader()
    assert set(VTK_SUFFIXES) <= set(readable_suffixes(3))
    assert read_mesh(path).volume == pytest.approx(1.0)
    path.write_bytes(meshfiles.vtp(*shapes.cube()).replace(b"<VTKFile", b"<VTKfile"))
    with pytest.raises(MeshError, match=r"cube\.vtp: not a whole VTP file: .*; export it again"):
        read_mesh(path)


def test_the_command_line_reads_them(tmp_path):
    path = tmp_path / "cube.vtp"
    path.write_bytes(meshfiles.vtp(*shapes.cube()))
    text, usable = shape_info.mesh("cube", path, BodyChoice(), Repairs(), "no", json=False)
    assert usable
    assert "12" in text
    assert shape_of(str(path)).volume == pytest.approx(1.0)
