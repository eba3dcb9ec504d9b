"""Gmsh, GIFTI and FreeSurfer: what other libraries write is read as it is meant; refusals."""

from __future__ import annotations

import warnings
from pathlib import Path

import meshio
import nibabel
import numpy as np
import pytest
from nibabel.freesurfer import write_geometry
from tests.core import shapes
from tests.core.meshfiles import refusal, write

from idviewer.core.io import libraries, library_process, library_readers
from idviewer.core.io.contents import Contents, FileSource, PartError
from idviewer.core.io.libraries import arrays_by
from idviewer.core.io.library_readers import read_freesurfer, read_gifti, read_gmsh
from idviewer.core.io.memory_bound import MemoryBound
from idviewer.core.io.meshes import read_mesh
from idviewer.core.io.text import UnreadableError
from idviewer.core.shapes.mesh_repair import repair_mesh

BODY = shapes.l_shape()
CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1.0]])
TETRA = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


@pytest.fixture
def here(monkeypatch):
    """Libraries are called in this process: starting another takes most of a second."""

    def call(name, task, blobs, **how):
        try:
            with warnings.catch_warnings(action="ignore"):
                return library_process.TASKS[task](list(blobs), how)
        except (Exception, SystemExit) as error:
            raise UnreadableError(f"truncated or damaged ({error})") from error

    monkeypatch.setattr(library_readers, "arrays_by", call)


def source(data: bytes, part: str | None = None) -> FileSource:
    return FileSource(data, Path("a.gii"), part)


def gmsh(tmp_path, points, cells, form: str = "gmsh", binary: bool = True) -> bytes:
    path = tmp_path / "written.msh"
    meshio.write(path, meshio.Mesh(points, cells), file_format=form, binary=binary)
    return path.read_bytes()


def volume(read: Contents) -> float:
    soup = read.geometry
    return repair_mesh(soup.vertices, np.split(soup.corners, np.cumsum(soup.sizes)[:-1])).volume


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("form", ["gmsh", "gmsh22"])
@pytest.mark.parametrize("binary", [True, False])
def test_gmsh_of_surfaces_and_volumes(tmp_path, form, binary):
    shifted = CUBE + np.array([1.0, 0, 0])
    points, cells = np.concatenate([CUBE, shifted]), np.array([np.arange(8), np.arange(8, 16)])
    onto = {8: 1, 11: 2, 12: 5, 15: 6}
    cells = np.array([[onto.get(corner, corner) for corner in cell] for cell in cells.tolist()])
    blocks, told = [("hexahedron", cells)], ["The outer surface of 2 volume cells was taken."]
    if form == "gmsh22":  # in version 4, meshio writes one kind of element alone
        blocks += [("quad", np.array([[0, 1, 2, 3]])), ("line", np.array([[0, 1]]))]
        told.append("1 flat cells beside the volumes were passed over.")
    read = read_gmsh(source(gmsh(tmp_path, points, blocks, form, binary)))
    assert volume(read) == pytest.approx(2.0, rel=1e-12)
    assert len(read.geometry.sizes) == 10
    assert read.notes == tuple(told)
    surface = read_gmsh(source(gmsh(tmp_path, BODY[0], [("triangle", BODY[1])], form, binary)))
    assert np.array_equal(surface.geometry.corners.reshape(-1, 3), BODY[1])
    assert (surface.notes, volume(surface)) == ((), pytest.approx(3.0, rel=1e-12))


MSH = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n{}\n$EndNodes\n"
MSH += "$Elements\n1\n1 {} 2 1 1 {}\n$EndElements\n"


def msh(kind: int, points: np.ndarray) -> bytes:
    """One element, its points in the order of Gmsh's manual."""
    rows = "\n".join(f"{n} {x!r} {y!r} {z!r}" for n, (x, y, z) in enumerate(points.tolist(), 1))
    return MSH.format(len(points), rows, kind, " ".join(str(n + 1) for n in range(len(points)))).encode()


TETRA_EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3)]
CUBE_EDGES = [(0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)]


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    ("kind", "corners", "edges", "expected"), [(11, TETRA, TETRA_EDGES, 1 / 6), (17, CUBE, CUBE_EDGES, 1.0)]
)
def test_curved_elements_of_gmsh_have_its_order_of_edges(kind, corners, edges, expected):
    middles = np.array([corners[list(edge)].mean(axis=0) for edge in edges])
    read = read_gmsh(source(msh(kind, np.concatenate([corners, middles]))))
    assert volume(read) == pytest.approx(expected, rel=1e-12)
    # A wrong order would cross itself, and have another area.
    soup = read.geometry
    mesh = repair_mesh(soup.vertices, np.split(soup.corners, np.cumsum(soup.sizes)[:-1]))
    assert mesh.area == pytest.approx(6.0 if kind == 17 else 1.5 + 3**0.5 / 2, rel=1e-12)


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("binary", [True, False])
@pytest.mark.parametrize("form", ["gmsh", "gmsh22"])
def test_gmsh_files_that_are_cut_are_refused(tmp_path, form, binary):
    data = gmsh(tmp_path, BODY[0], [("triangle", BODY[1])], form, binary)
    for size in range(10, len(data) - 14, 61):
        with pytest.raises(UnreadableError, match=r"truncated|no file of Gmsh"):
            read_gmsh(source(data[:size]))


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"solid x", "no file of Gmsh in version 2 or 4"),
        (msh(4, TETRA).replace(b"1 2 3 4\n$EndE", b"1 2 3 9\n$EndE"), "truncated or damaged"),
        (msh(21, np.random.default_rng(0).random((10, 3))), "elements of the kind triangle10"),
        (msh(4, TETRA).replace(b"2.2 0 8", b"9.9 0 8"), "truncated or damaged"),
    ],
)
def test_gmsh_refusals(data, message):
    with pytest.raises(UnreadableError, match=message):
        read_gmsh(source(data))


def gifti(*surfaces, encoding: str = "GIFTI_ENCODING_B64GZ", space: int = 3) -> bytes:
    image = nibabel.gifti.GiftiImage()
    for points, faces in surfaces:
        system = nibabel.gifti.GiftiCoordSystem(dataspace=space, xformspace=space)
        image.add_gifti_data_array(
            nibabel.gifti.GiftiDataArray(
                points.astype(np.float32),
                "NIFTI_INTENT_POINTSET",
                "NIFTI_TYPE_FLOAT32",
                encoding,
                coordsys=system,
            )
        )
        image.add_gifti_data_array(
            nibabel.gifti.GiftiDataArray(
                faces.astype(np.int32), "NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32", encoding
            )
        )
    return image.to_bytes()


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    "encoding", ["GIFTI_ENCODING_B64GZ", "GIFTI_ENCODING_B64BIN", "GIFTI_ENCODING_ASCII"]
)
def test_gifti(encoding):
    read = read_gifti(source(gifti(BODY, encoding=encoding)))
    assert np.array_equal(read.geometry.vertices, BODY[0])
    assert np.array_equal(read.geometry.corners.reshape(-1, 3), BODY[1])
    assert (read.unit, read.notes) == ("mm", ("Its coordinates are in Talairach's space.",))
    assert read_gifti(source(gifti(BODY, space=0))).notes == ("Its coordinates are in an unknown space.",)


@pytest.mark.usefixtures("here")
def test_gifti_with_several_surfaces_wants_one_chosen():
    data = gifti(BODY, shapes.tetrahedron())
    with pytest.raises(PartError, match="it holds 2 surfaces: 'surface 1', 'surface 2'; choose one"):
        read_gifti(source(data))
    assert len(read_gifti(source(data, "surface 2")).geometry.sizes) == 4


@pytest.mark.usefixtures("here")
def test_gifti_refusals():
    image = nibabel.gifti.GiftiImage()
    image.add_gifti_data_array(nibabel.gifti.GiftiDataArray(np.zeros(5, np.float32), "NIFTI_INTENT_SHAPE"))
    data = gifti(BODY)
    for wrong, message in (
        (image.to_bytes(), "values on a surface, and no surface"),
        (data[: len(data) // 2], "truncated or damaged"),
        (b"<html/>", "no GIFTI file"),
        (
            data.replace(b"<!DOCTYPE GIFTI", b"<!DOCTYPE x [<!ENTITY a 'b'>]><!DOCTYPE GIFTI"),
            "declares entities",
        ),
        (data.replace(b"GZipBase64Binary", b"ExternalFileBinary"), "keeps its data in another file"),
        (data.replace(b'Dim0="12"', b'Dim0="13"'), "truncated or damaged"),
    ):
        with pytest.raises(UnreadableError, match=message):
            read_gifti(source(wrong))


def freesurfer(tmp_path, centre=None, arrays=BODY) -> bytes:
    info = None
    if centre is not None:
        axes = {"xras": [-1, 0, 0], "yras": [0, 0, -1], "zras": [0, 1, 0], "cras": centre}
        info = {"head": np.array([2, 0, 20]), "valid": "1  # valid", "filename": "vol.mgz"}
        info |= {"volume": np.array([256] * 3), "voxelsize": np.ones(3)}
        info |= {key: np.array(value, dtype=float) for key, value in axes.items()}
    write_geometry(tmp_path / "lh.written", *arrays, create_stamp="made by a test", volume_info=info)
    return (tmp_path / "lh.written").read_bytes()


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    ("centre", "told"),
    [(None, ""), ([0, 0, 0], ""), ([1, -2.5, 0], "; the scanner's are these plus (1, -2.5, 0)")],
)
def test_freesurfer(tmp_path, centre, told):
    for suffix in (".pial", ".white", ".sphere.reg", ".PIAL.T1"):
        mesh = read_mesh(write(tmp_path, suffix, freesurfer(tmp_path, centre), stem="lh"))
        assert np.array_equal(mesh.vertices, BODY[0])
        assert np.array_equal(mesh.faces, BODY[1])
        assert (mesh.unit, mesh.notes) == ("mm", (f"Its coordinates are FreeSurfer's own{told}.",))


@pytest.mark.usefixtures("here")
def test_freesurfer_refusals(tmp_path):
    data = freesurfer(tmp_path)
    for size in (2, 10, 40, 100, len(data) - 1):
        with pytest.raises(UnreadableError, match=r"truncated or damaged|does not begin as a surface"):
            read_freesurfer(source(data[:size]))
    with pytest.raises(UnreadableError, match="does not begin as a surface of FreeSurfer does"):
        read_freesurfer(source(b"ply\n" + data))


@pytest.mark.parametrize(
    ("suffix", "package"), [(".msh", "meshio"), (".gii", "nibabel"), (".pial", "nibabel")]
)
def test_without_the_extra_the_command_that_adds_it_is_named(tmp_path, monkeypatch, suffix, package):
    monkeypatch.setattr(libraries.importlib.util, "find_spec", lambda name: None)
    data = {".msh": msh(4, TETRA), ".gii": gifti(BODY), ".pial": freesurfer(tmp_path)}[suffix]
    message = refusal(write(tmp_path, suffix, data))
    assert message.endswith(
        f"by {package}, and the package {package} is missing; pip install 'idviewer[formats]' adds it"
    )


@pytest.mark.slow
def test_the_process_of_a_library_reads_refuses_and_is_bounded(tmp_path, monkeypatch):
    mesh = read_mesh(write(tmp_path, ".pial", freesurfer(tmp_path), stem="lh"))
    assert mesh.volume == pytest.approx(3.0)
    data = freesurfer(tmp_path)
    with pytest.raises(UnreadableError, match=r"^truncated or damaged \("):
        read_freesurfer(source(data[:-1]))
    place = data.index(b"\n\n") + 2
    monster = data[:place] + (700_000_000).to_bytes(4, "big") + data[place + 4 :]
    with pytest.raises(UnreadableError, match="asks for more memory than a file of its size can need"):
        read_freesurfer(source(monster))
    monkeypatch.setattr(libraries, "_LIBRARY_PROGRAM", tmp_path / "ends.py")
    (tmp_path / "ends.py").write_text("import os; os.abort()")
    with pytest.raises(UnreadableError, match="truncated or damaged, so much that nibabel gave up on it"):
        arrays_by("nibabel", "freesurfer", [b""])


@pytest.mark.slow
def test_a_library_that_does_not_end_is_ended(tmp_path, monkeypatch):
    program = (
        Path(library_process.__file__).read_text().replace("mesh = DracoPy.decode(blob)", "while True: pass")
    )
    (tmp_path / "spins.py").write_text(program)
    monkeypatch.setattr(libraries, "_LIBRARY_PROGRAM", tmp_path / "spins.py")
    monkeypatch.setattr(libraries, "MEMORY_BOUND", MemoryBound(seconds=1, seconds_per_megabyte=0.0))
    with pytest.raises(UnreadableError, match="so much that DracoPy gave up on it"):
        arrays_by("DracoPy", "draco", [b"DRACO"], attributes=[[0]])
