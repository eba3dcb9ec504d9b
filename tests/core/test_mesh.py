"""A Mesh is closed, two-sided, in one piece and wound outward, or it does not come into being."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes

from idviewer.core.shapes.mesh import Mesh, MeshError


@pytest.mark.parametrize(
    ("arrays", "volume", "area"),
    [
        (shapes.tetrahedron(), 1 / 6, (3 + 3**0.5) / 2),
        (shapes.cube(), 1.0, 6.0),
        (shapes.octahedron(), 4 / 3, 4 * 3**0.5),
        (shapes.l_shape(), 3.0, 14.0),
        (shapes.pinched_cubes(), 2.0, 12.0),
    ],
)
def test_volume_and_area_are_those_of_the_solid(arrays, volume, area):
    mesh = Mesh(*arrays)
    assert mesh.volume == pytest.approx(volume, rel=1e-14)
    assert mesh.area == pytest.approx(area, rel=1e-14)
    assert mesh.face_areas.sum() == pytest.approx(area, rel=1e-14)


def test_volume_and_area_of_a_sphere_are_approached_at_second_order():
    errors = []
    for level in (1, 2, 3):
        mesh = Mesh(*shapes.icosphere(level))
        errors.append([4 / 3 * np.pi - mesh.volume, 4 * np.pi - mesh.area])
    rates = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all(rates > 1.8)
    assert np.all(rates < 2.1)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_size_and_place_do_not_matter(scale, shift):
    vertices, faces = shapes.torus()
    reference = Mesh(vertices, faces)
    mesh = Mesh((vertices + shift) * scale, faces)
    # At 1e6 from the origin a coordinate keeps ten decimals.
    assert mesh.volume == pytest.approx(reference.volume * scale**3, rel=1e-14 if shift == 0 else 1e-9)
    assert mesh.area == pytest.approx(reference.area * scale**2, rel=1e-14 if shift == 0 else 1e-9)


def test_bounds_and_diagonal():
    mesh = Mesh(*shapes.moved(shapes.cube(), -1, 2, 5))
    assert mesh.bounds.tolist() == [[-1, 2, 5], [0, 3, 6]]
    assert mesh.diagonal == pytest.approx(3**0.5)


def test_edges_are_sorted_unique_and_obey_euler():
    for arrays, genus in ((shapes.icosphere(1), 0), (shapes.torus(), 1)):
        mesh = Mesh(*arrays)
        pairs = {
            tuple(sorted(pair))
            for face in arrays[1].tolist()
            for pair in zip(face, face[1:] + face[:1], strict=True)
        }
        assert [tuple(edge) for edge in mesh.edges.tolist()] == sorted(pairs)
        assert len(mesh.vertices) - len(mesh.edges) + len(mesh.faces) == 2 - 2 * genus


def test_arrays_are_read_only_copies_of_the_right_type():
    vertices, faces = shapes.cube()
    mesh = Mesh(np.asfortranarray(vertices), faces.astype(np.uint8))
    vertices[:] = np.nan
    assert mesh.volume == 1.0
    assert (mesh.vertices.dtype, mesh.faces.dtype) == (np.float64, np.int64)
    assert mesh.vertices.flags.c_contiguous
    assert mesh.faces.flags.c_contiguous
    for array in (mesh.vertices, mesh.faces, mesh.bounds, mesh.edges, mesh.face_areas):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    assert vertices.flags.writeable
    assert faces.flags.writeable


def test_a_mesh_is_frozen_and_equal_to_itself_alone():
    mesh, other = Mesh(*shapes.cube(), name="cube"), Mesh(*shapes.cube(), name="cube")
    assert mesh == mesh
    assert mesh != other
    assert len({mesh, other}) == 2
    with pytest.raises(AttributeError):
        mesh.name = "other"
    assert repr(mesh) == "Mesh('cube', 8 vertices, 12 faces)"


def _changed(arrays, vertex=None, face=None):
    vertices, faces = arrays
    if vertex is not None:
        vertices = np.concatenate([vertices, [vertex]])
    if face is not None:
        faces = np.concatenate([faces, [face]])
    return vertices, faces


REFUSED = {
    "no faces among 0 vertices": ([], []),
    "no faces among 8 vertices": (shapes.cube()[0], np.empty((0, 3), int)),
    "1 face that refers to a missing vertex: face 12 to vertex 8, where 0 to 7 exist": _changed(
        shapes.cube(), face=[0, 1, 8]
    ),
    "face 12 to vertex -1, where 0 to 7 exist": _changed(shapes.cube(), face=[0, 1, -1]),
    "1 vertex whose coordinates are not finite numbers (one is [nan, 0.0, 0.0])": (
        np.where(np.arange(24).reshape(8, 3) == 3, np.nan, shapes.cube()[0]),
        shapes.cube()[1],
    ),
    "coordinates of a size of 1e+300": (shapes.cube()[0] * 1e300, shapes.cube()[1]),
    "coordinates of a size of 1e-300": (shapes.cube()[0] * 1e-300, shapes.cube()[1]),
    "1 isolated vertex": _changed(shapes.cube(), vertex=[9, 9, 9]),
    "1 face that repeats a vertex": _changed(shapes.cube(), face=[0, 1, 1]),
    "28 duplicated vertices": shapes.soup(shapes.cube()),
    "1 duplicate face": _changed(shapes.cube(), face=shapes.cube()[1][3]),
    "3 boundary edges in 1 loop": shapes.opened(shapes.cube()),
    "1 edge with more than two faces": shapes.non_manifold_cubes(),
    "a one-sided surface": shapes.klein_bottle(),
    "1 face wound against its neighbours": (
        shapes.cube()[0],
        np.concatenate([shapes.cube()[1][:1, ::-1], shapes.cube()[1][1:]]),
    ),
    "the body, which was inside out": (shapes.cube()[0], shapes.cube()[1][:, ::-1]),
    "2 components with 8, 12 faces": shapes.two_components(),
    "no volume": shapes.flat_sheet(),
    "faces must have the shape (m, 3)": shapes.cube_quads(),
    "vertices must have the shape (n, 3)": (shapes.cube()[0][:, :2], shapes.cube()[1]),
    "whole numbers": (shapes.cube()[0], shapes.cube()[1] + 0.5),
}


@pytest.mark.parametrize(("message", "arrays"), REFUSED.items(), ids=list(REFUSED))
def test_the_constructor_repairs_nothing(message, arrays):
    with pytest.raises(MeshError) as caught:
        Mesh(*arrays, name="thing")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_could_be_repaired_says_how():
    with pytest.raises(
        MeshError, match=r"^thing: 1 isolated vertex; idviewer\.core\.repair_mesh mends this$"
    ):
        Mesh(*_changed(shapes.cube(), vertex=[9, 9, 9]), name="thing")


def test_the_components_can_be_told_from_the_error():
    with pytest.raises(MeshError) as caught:
        Mesh(*shapes.two_components())
    told = [(one.number, one.faces, round(one.volume, 12)) for one in caught.value.components]
    assert told == [(1, 8, round(4 / 3, 12)), (2, 12, 1.0)]
    assert [finding.kind for finding in caught.value.findings] == ["several_components"]


def test_floats_that_are_whole_numbers_are_indices():
    assert Mesh(shapes.cube()[0].tolist(), shapes.cube()[1].astype(float)).volume == 1.0


def test_faces_are_not_gone_through_one_by_one(calls_of):
    """How long a million of them take is a row of `make bench`."""
    few, many = (shapes.torus(count, count) for count in (10, 80))
    assert calls_of(lambda: Mesh(*many)) < 1.1 * calls_of(lambda: Mesh(*few)) < 3000
