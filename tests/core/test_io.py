"""The door: whatever lies behind a path, out comes a Mesh or one line with file, cause and remedy."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.core import meshfiles, shapes
from tests.core.meshfiles import outcome

from idviewer.core.io.formats import readable_suffixes
from idviewer.core.io.meshes import inspect_file, read_mesh
from idviewer.core.shapes.mesh import Mesh, MeshError

CUBE = shapes.cube()


def write(folder: Path, suffix: str, data: bytes, stem: str = "thing") -> Path:
    path = folder / f"{stem}{suffix}"
    path.write_bytes(data)
    return path


def refusal(path: Path, **how: int) -> str:
    """The message of the error, which must be one line that begins with the path."""
    with pytest.raises(MeshError) as caught:
        read_mesh(path, **how)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    assert "\r" not in message
    assert message.isprintable()
    assert len(message) < len(str(path)) + 300
    return message.removeprefix(f"{path}: ")


@pytest.mark.parametrize("variant", meshfiles.WRITERS)
@pytest.mark.parametrize("shape", [shapes.cube, shapes.l_shape, lambda: shapes.torus(7, 5)])
def test_every_format_is_read(tmp_path, variant, shape):
    suffix, writer = meshfiles.WRITERS[variant]
    arrays = shape()
    mesh = read_mesh(write(tmp_path, suffix, writer(*arrays)))
    reference = Mesh(*arrays)
    exact = variant not in ("stl", "glb", "gltf")  # these hold single precision
    assert mesh.volume == pytest.approx(reference.volume, rel=1e-14 if exact else 1e-6)
    assert mesh.name == "thing"
    if variant.startswith("stl"):
        assert mesh.notes == (f"{arrays[1].size - len(arrays[0]):,} duplicated vertices were merged.",)
    else:
        assert np.array_equal(mesh.faces, arrays[1])
        assert np.allclose(mesh.vertices, arrays[0], rtol=0, atol=0 if exact else 1e-6)
        assert mesh.notes == ()


def test_suffixes_are_the_readable_ones_and_case_does_not_matter(tmp_path):
    assert {suffix for suffix, _ in meshfiles.WRITERS.values()} <= set(readable_suffixes(3))
    assert read_mesh(str(write(tmp_path, ".OFF", meshfiles.off(*CUBE)))).volume == 1.0


@pytest.mark.parametrize("variant", ["off", "obj", "ply", "ply_binary"])
def test_polygons_are_cut_into_triangles(tmp_path, variant):
    suffix, writer = meshfiles.WRITERS[variant]
    mesh = read_mesh(write(tmp_path, suffix, writer(*shapes.extruded(shapes.L_OUTLINE))))
    assert (mesh.volume, mesh.area) == pytest.approx((3.0, 14.0))
    assert mesh.notes == ("8 polygons with more than three corners were triangulated.",)


def test_no_such_file(tmp_path):
    for name in ("no.off", "no.step", "no"):
        assert refusal(tmp_path / name) == "there is no such file"


def test_names_that_no_file_can_have():
    with pytest.raises(MeshError, match="the file cannot be read"):
        read_mesh("nul\0.off")
    with pytest.raises(MeshError, match="the file cannot be read"):
        read_mesh("a" * 5000 + ".off")


def test_a_name_of_two_lines_is_told_on_one(tmp_path):
    with pytest.raises(MeshError, match=r"two\?lines\.off: there is no such file$"):
        read_mesh(tmp_path / "two\nlines.off")


def test_a_folder(tmp_path):
    (tmp_path / "folder.off").mkdir()
    assert refusal(tmp_path / "folder.off") == refusal(tmp_path) == "this is a folder; name a mesh file in it"


def test_a_pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe.off")
    assert refusal(tmp_path / "pipe.off") == "this is no ordinary file"


def test_a_file_that_may_not_be_read(tmp_path, monkeypatch):
    def refuse(_path: Path) -> bytes:
        raise PermissionError(13, "Permission denied")

    path = write(tmp_path, ".off", meshfiles.off(*CUBE))
    monkeypatch.setattr(Path, "read_bytes", refuse)
    assert refusal(path) == "the file cannot be read (Permission denied)"


def test_an_unknown_suffix(tmp_path):
    message = refusal(write(tmp_path, ".step", b"ISO-10303-21;"))
    assert message.startswith("'.step' files cannot be read; save it as one of .off, .obj, ")
    assert refusal(write(tmp_path, "", b"OFF")).startswith("a suffix must tell the file's format; save it as")


@pytest.mark.parametrize("suffix", readable_suffixes(3))
@pytest.mark.parametrize("data", [b"", b"\n \r\n\t"])
def test_an_empty_file(tmp_path, suffix, data):
    assert refusal(write(tmp_path, suffix, data)) == "the file is empty; export it again"


@pytest.mark.parametrize("suffix", readable_suffixes(3))
def test_files_that_are_no_mesh(tmp_path, suffix):
    rng = np.random.default_rng(5)
    texts = [
        b"hello, this is a letter\nv to you\n",
        b"<html></html>",
        b"{}",
        b"[]",
        b"0",
        b"\xff\xfe\x00",
        b"solid",
    ]
    headers = [
        b"OFF",
        b"ply\n",
        b"glTF",
        b"<VTKFile/>",
        b'{"asset": {"version": "2.0"}}',
        b"OFF\n1 0 0\n0 0 0\n",
    ]
    for data in [*texts, *headers, *(rng.bytes(size) for size in (1, 30, 84, 1000, 5000))]:
        message = refusal(write(tmp_path, suffix, data))
        assert ";" in message  # a remedy follows


@pytest.mark.one_is_quick
@pytest.mark.parametrize("variant", meshfiles.WRITERS)
def test_a_truncated_file_is_never_read_as_a_smaller_mesh(tmp_path, variant):
    suffix, writer = meshfiles.WRITERS[variant]
    data = writer(*shapes.tetrahedron())
    whole = Mesh(*shapes.tetrahedron())
    survived = []
    for size in range(len(data)):
        path = write(tmp_path, suffix, data[:size])
        mesh, message = outcome(path)
        if mesh is None:
            assert message.isprintable()
        else:
            assert np.array_equal(mesh.vertices[mesh.faces], whole.vertices[whole.faces])
            survived.append(data[size:])
    # What may be missing is the last newline, or a part of the last line of a text STL: its name.
    assert all(not rest.strip() or b"facet of a test".endswith(rest.strip()) for rest in survived)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("variant", meshfiles.WRITERS)
@settings(max_examples=60, deadline=None, derandomize=True)
@given(data=st.data())
def test_a_damaged_file_gives_a_mesh_or_an_error(tmp_path_factory, variant, data):
    suffix, writer = meshfiles.WRITERS[variant]
    content = bytearray(writer(*CUBE))
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(content) - 1))
        content[place] = data.draw(st.integers(0, 255))
    path = write(tmp_path_factory.getbasetemp(), suffix, bytes(content), stem="damaged")
    mesh, message = outcome(path)
    if mesh is None:
        assert message.isprintable()
    else:
        Mesh(mesh.vertices, mesh.faces)


def _arrays(arrays=CUBE, vertex=None, face=None):
    vertices, faces = arrays
    vertices = vertices if vertex is None else np.concatenate([vertices, [vertex]])
    faces = faces if face is None else np.concatenate([faces, [face]])
    return vertices, faces


def _broken(value: float):
    vertices, faces = shapes.cube()
    vertices[3, 1] = value
    return vertices, faces


FATAL = {
    "1 vertex whose coordinates are not finite numbers (one is [1.0, nan, 0.0]); export it again": _broken(
        np.nan
    ),
    "1 vertex whose coordinates are not finite numbers (one is [1.0, inf, 0.0]); export it again": _broken(
        np.inf
    ),
    "coordinates of a size of 1e+200, which cannot be computed with; scale it": _broken(1e200),
    "1 face that refers to a missing vertex: face 12 to vertex 8, where 0 to 7 exist; ex": _arrays(
        face=[0, 1, 8]
    ),
    "3 boundary edges in 1 loop, near (1, 0, 0); close the holes in a mesh editor": shapes.opened(CUBE),
    "1 edge with more than two faces, near (1, 1, 0); clean it in a mesh editor": shapes.non_manifold_cubes(),
    "24 boundary edges in 1 loop, near (0.7, 0, 0); a one-sided surface": shapes.moebius_band(),
    "a one-sided surface, like a Moebius band, near (": shapes.klein_bottle(),
    "2 components with 12, 8 faces; choose one by its number, component=1": shapes.two_components(),
    "no volume: the surface is closed but encloses nothing; a solid body is needed": shapes.flat_sheet(),
}


@pytest.mark.one_is_quick
@pytest.mark.parametrize(("message", "arrays"), FATAL.items(), ids=[message[:20] for message in FATAL])
@pytest.mark.parametrize("variant", ["off", "obj", "ply_binary"])
def test_what_cannot_be_mended_is_told_in_one_line(tmp_path, variant, message, arrays):
    suffix, writer = meshfiles.WRITERS[variant]
    path = write(tmp_path, suffix, writer(*arrays))
    assert refusal(path).startswith(message)
    findings = inspect_file(path).findings
    assert not inspect_file(path).usable
    assert any(finding.message.startswith(message[:20]) for finding in findings if finding.fatal)


@pytest.mark.parametrize("variant", ["off", "ply", "ply_binary"])
def test_negative_indices_are_out_of_range(tmp_path, variant):
    suffix, writer = meshfiles.WRITERS[variant]
    message = refusal(write(tmp_path, suffix, writer(*_arrays(face=[0, 1, -1]))))
    assert message.startswith(
        "1 face that refers to a missing vertex: face 12 to vertex -1, where 0 to 7 exist;"
    )


MENDED = {
    "isolated": (_arrays(vertex=[9, 9, 9]), "1 isolated vertex was dropped."),
    "duplicated": (shapes.soup(CUBE), "28 duplicated vertices were merged."),
    "inside out": ((CUBE[0], CUBE[1][:, ::-1]), "The body, which was inside out, was turned."),
    "winding": (
        (CUBE[0], np.concatenate([CUBE[1][:1, ::-1], CUBE[1][1:]])),
        "1 face wound against its neighbours was turned.",
    ),
    "repeated": (_arrays(face=[0, 1, 1]), "1 face that repeats a vertex was left out."),
    "copies": (_arrays(face=CUBE[1][3]), "1 duplicate face was left out."),
    "quads": (shapes.cube_quads(), "6 polygons with more than three corners were triangulated."),
}


@pytest.mark.one_is_quick
@pytest.mark.parametrize(("arrays", "note"), MENDED.values(), ids=list(MENDED))
@pytest.mark.parametrize("variant", ["off", "obj", "ply", "ply_binary"])
def test_what_can_be_mended_is_and_the_mesh_says_so(tmp_path, variant, arrays, note):
    suffix, writer = meshfiles.WRITERS[variant]
    path = write(tmp_path, suffix, writer(*arrays))
    mesh = read_mesh(path)
    assert (mesh.volume, mesh.area) == (pytest.approx(1.0), pytest.approx(6.0))
    assert mesh.notes == (note,)
    diagnosis = inspect_file(path)
    assert diagnosis.usable
    assert [finding.note for finding in diagnosis.findings] == [note]


@pytest.mark.parametrize("variant", ["off", "ply", "ply_binary"])
def test_points_without_faces(tmp_path, variant):
    suffix, writer = meshfiles.WRITERS[variant]
    message = refusal(write(tmp_path, suffix, writer(CUBE[0], [])))
    assert message == "no faces among 8 vertices; export the surface as triangles"


def test_lines_without_faces(tmp_path):
    obj = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2\nl 2 3\np 1\n"
    ply = (
        b"ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
        b"element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0\n1 0 0\n0 1\n"
    )
    off = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n"
    for suffix, data in ((".obj", obj), (".ply", ply)):
        assert refusal(write(tmp_path, suffix, data)).startswith("no faces among ")
    assert refusal(write(tmp_path, ".off", off)).startswith("no face with three different corners")


def test_one_of_several_components_can_be_chosen(tmp_path):
    path = write(tmp_path, ".off", meshfiles.off(*shapes.two_components()))
    with pytest.raises(MeshError) as caught:
        read_mesh(path)
    assert caught.value.components == (12, 8)
    mesh = read_mesh(path, component=2)
    assert mesh.volume == pytest.approx(4 / 3)
    assert mesh.notes == ("Component 2 of 2 (8 of 20 faces) was taken.",)
    assert refusal(path, component=3) == "no component 3: they are numbered from 1, the largest, to 2"


def test_the_cause_of_a_parser_s_stumble_is_kept_for_the_log(tmp_path):
    tree, buffer = meshfiles.gltf_tree(*CUBE)
    del tree["accessors"][0]["type"]
    path = write(tmp_path, ".glb", meshfiles.glb_of(tree, buffer))
    assert refusal(path) == "not a readable GLB file (KeyError: 'type'); export it again"
    with pytest.raises(MeshError) as caught:
        read_mesh(path)
    assert isinstance(caught.value.__cause__, KeyError)
