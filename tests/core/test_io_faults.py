"""Faults of meshes in files: what can be mended is, and is told; the rest is one line with a remedy."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import meshfiles, shapes
from tests.core.meshfiles import refusal, write

from idviewer.core.io.meshes import inspect_file, read_mesh
from idviewer.core.shapes.mesh import MeshError

CUBE = shapes.cube()


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
    "3 boundary edges in 1 loop, near (1, 0, 0); a repair mends it: --fill-holes 3": shapes.opened(CUBE),
    "2 components with 12, 12 faces; choose one by its number, component=1": shapes.non_manifold_cubes(),
    "24 boundary edges in 1 loop, near (0.7, 0, 0); a one-sided surface": shapes.moebius_band(),
    "a one-sided surface, like a Moebius band, near (": shapes.klein_bottle(),
    "2 components with 8, 12 faces; choose one by its number, component=1": shapes.two_components(),
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
    assert [one.faces for one in caught.value.components] == [8, 12]
    mesh = read_mesh(path, component=1)
    assert mesh.volume == pytest.approx(4 / 3)
    assert mesh.notes == ("Component 1 of 2 (8 of 20 faces) was taken.",)
    assert refusal(path, component=3) == "no component 3: they are numbered from 1, the largest, to 2"
