"""Shells inside others: voids whichever way they are wound, and bodies inside voids."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes
from tests.core.voxels import box, emptied, voxel_surface

from idviewer.core import Mesh, MeshError, diagnose, repair_mesh
from idviewer.core.shapes.mesh_repair import repair_meshes
from idviewer.core.validation.shell_nesting import winding_numbers


def scaled(arrays, factor):
    return arrays[0] * factor, arrays[1]


def turned(arrays):
    return arrays[0], arrays[1][:, ::-1]


def nested_boxes(count):
    """Cubes about one middle, each half as large as the one around it."""
    return [shapes.moved(scaled(shapes.cube(), 0.5**k), *[0.5 - 0.5 ** (k + 1)] * 3) for k in range(count)]


def test_a_voxel_body_with_a_cavity_is_one_piece_with_a_void():
    arrays = voxel_surface(emptied(box(3, 3, 3), (1, 1, 1)))
    mesh = repair_mesh(*arrays)
    assert mesh.volume == pytest.approx(26.0)
    assert [len(shell) for shell in mesh.shells] == [108, 12]
    assert mesh.notes == ("1 shell inside the body was taken for the boundary of a void.",)
    assert Mesh(*arrays).volume == pytest.approx(26.0)


@pytest.mark.parametrize("senses", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_nesting_decides_and_not_the_winding(senses, order):
    parts = [part if sense > 0 else turned(part) for part, sense in zip(nested_boxes(2), senses, strict=True)]
    mesh = repair_mesh(*shapes.joined(*(parts[k] for k in order)))
    assert mesh.volume == pytest.approx(1.0 - 0.125)
    told = " ".join(mesh.notes)
    assert ("shell around a void of 12 faces, which was wound the other way, was turned" in told) == (
        senses == (1, 1)
    )
    assert ("outer shell" in told) == (senses == (-1, -1))
    assert ("The body, which was inside out, was turned." in told) == (senses == (-1, 1))
    if senses != (1, -1):
        with pytest.raises(MeshError, match="repair_mesh mends this"):
            Mesh(*shapes.joined(*(parts[k] for k in order)))


def test_a_body_inside_a_void_is_a_piece_of_its_own():
    pieces = repair_meshes(*shapes.joined(*nested_boxes(5)), "onion")
    volumes = [1 - 1 / 8, 1 / 64 - 1 / 512, 1 / 4096]
    assert [piece.volume for piece in pieces] == pytest.approx(volumes)
    assert [len(piece.shells) for piece in pieces] == [2, 2, 1]
    with pytest.raises(MeshError, match="3 components with 24, 24, 12 faces") as caught:
        repair_mesh(*shapes.joined(*nested_boxes(5)))
    assert [one.voids for one in caught.value.components] == [1, 1, 0]


def test_bodies_apart_have_the_voids_that_lie_in_them():
    void = scaled(shapes.octahedron(), 0.2)
    left = shapes.joined(shapes.icosphere(2), void)
    beside = shapes.joined(scaled(shapes.icosphere(2), 0.8), shapes.moved(void, 0.3, 0, 0))
    right = shapes.moved(beside, 4, 0, 0)
    first, second = repair_meshes(*shapes.joined(right, left))
    assert len(first.shells) == len(second.shells) == 2
    assert first.volume > second.volume
    assert first.bounds[1, 0] == pytest.approx(1.0)


def test_the_largest_component_is_that_of_the_largest_volume():
    small, large = shapes.icosphere(3), scaled(shapes.cube(), 9.0)
    arrays = shapes.joined(shapes.moved(small, -5, 0, 0), large)
    assert repair_mesh(*arrays, component="largest").volume == pytest.approx(729.0)
    assert repair_mesh(*arrays, component=1).volume == pytest.approx(729.0)
    assert diagnose(*arrays).component_list[0].volume == pytest.approx(729.0)
    with pytest.raises(MeshError, match="'smallest'"):
        repair_mesh(*arrays, component="smallest")


@pytest.mark.parametrize(("scale", "shift"), [(1e-9, 0.0), (1.0, 1e6), (1e20, 0.0)])
def test_no_tolerance_is_absolute(scale, shift):
    vertices, faces = voxel_surface(emptied(box(3, 3, 3), (1, 1, 1)))
    mesh = repair_mesh(vertices * scale + shift, faces)
    assert mesh.volume == pytest.approx(26.0 * scale**3, rel=1e-6)
    assert len(mesh.shells) == 2


def test_many_voids_are_found():
    places = [(i, j, k) for i in (1, 3, 5) for j in (1, 3, 5) for k in (1, 3)]
    full = emptied(box(7, 7, 5), *places)
    mesh = repair_mesh(*voxel_surface(full))
    assert mesh.volume == pytest.approx(full.sum())
    assert len(mesh.shells) == 1 + len(places)
    assert len(mesh.bridges) == len(places)


def test_shells_that_cross_are_refused_by_a_face_that_does():
    ball, other = shapes.icosphere(2), shapes.moved(shapes.icosphere(2), 1.2, 0.05, 0.02)
    with pytest.raises(MeshError, match=r"cross each other at face \d+, near") as caught:
        repair_mesh(*shapes.joined(ball, other))
    assert "unite" in str(caught.value)
    face = int(str(caught.value).split("face ")[1].split(",")[0])
    vertices, faces = shapes.joined(ball, other)
    centre = [1.2, 0.05, 0.02] if face < len(ball[1]) else [0.0, 0.0, 0.0]
    assert (np.linalg.norm(vertices[faces[face]] - centre, axis=1) < 1.0).any()


def test_winding_numbers_count_coverings(rng):
    points = rng.uniform(-1.5, 1.5, (200, 3))
    vertices, faces = shapes.joined(shapes.cube(), shapes.moved(shapes.cube(), 0.5, 0.0, 0.0))
    expected = sum(
        ((points >= low) & (points <= np.add(low, 1.0))).all(axis=1).astype(int)
        for low in ([0.0, 0.0, 0.0], [0.5, 0.0, 0.0])
    )
    np.testing.assert_allclose(winding_numbers(points, vertices[faces]), expected, atol=1e-9)


def test_the_characteristic_adds_up_over_shells():
    diagnosis = diagnose(
        *shapes.joined(scaled(shapes.torus(), 4.0), shapes.moved(scaled(shapes.cube(), 0.4), 4, 0, 0))
    )
    assert (diagnosis.euler_characteristic, diagnosis.genus) == (2, 1)
    assert diagnosis.shells == (192, 12)
    assert diagnosis.components == (204,)
    assert diagnosis.usable
