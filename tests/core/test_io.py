"""The door: whatever lies behind a path, out comes a Mesh or one line with file, cause and remedy."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.core import meshfiles, shapes
from tests.core.meshfiles import outcome, refusal, write

from idviewer.core.io.atomic_write import atomic_path
from idviewer.core.io.formats import readable_suffixes
from idviewer.core.io.meshes import read_mesh
from idviewer.core.shapes.mesh import Mesh, MeshError

CUBE = shapes.cube()


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
    # What may be missing is the last newline, or a part of the last line of a text STL.
    last_line = b"endsolid facet of a test"
    assert all(not rest.strip() or last_line.endswith(rest.strip()) for rest in survived)


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


def test_the_cause_of_a_parser_s_stumble_is_kept_for_the_log(tmp_path):
    tree, buffer = meshfiles.gltf_tree(*CUBE)
    del tree["accessors"][0]["type"]
    path = write(tmp_path, ".glb", meshfiles.glb_of(tree, buffer))
    assert refusal(path) == "not a readable GLB file (KeyError: 'type'); export it again"
    with pytest.raises(MeshError) as caught:
        read_mesh(path)
    assert isinstance(caught.value.__cause__, KeyError)


def test_a_name_that_no_file_can_have_is_an_error_of_the_system(tmp_path):
    with pytest.raises(OSError, match="no file can have this name"), atomic_path(tmp_path / "a\0b.png"):
        pass
    assert not list(tmp_path.iterdir())
