"""Repairs: each is made, noted, and leaves the same solid."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.core import shapes

from idviewer.core.shapes.diagnosis import diagnose
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.mesh_repair import repair_mesh


class Faults(NamedTuple):
    """Of a file: corners split, faces turned; and how many vertices stand alone, faces come twice."""

    split: bool
    turn: bool
    isolated: int
    copies: int


def same_solid(mesh, arrays):
    reference = Mesh(*arrays)
    assert mesh.volume == pytest.approx(reference.volume, rel=1e-12)
    assert mesh.area == pytest.approx(reference.area, rel=1e-12)
    assert diagnose(mesh).genus == diagnose(reference).genus
    assert set(map(tuple, mesh.vertices.tolist())) == set(map(tuple, reference.vertices.tolist()))
    Mesh(mesh.vertices, mesh.faces)  # stands up to the strict check


def test_a_faultless_mesh_stays_as_it_is():
    vertices, faces = shapes.torus()
    mesh = repair_mesh(vertices, faces, name="ring")
    assert np.array_equal(mesh.vertices, vertices)
    assert np.array_equal(mesh.faces, faces)
    assert (mesh.name, mesh.notes) == ("ring", ())
    with pytest.raises(ValueError, match="read-only"):
        mesh.vertices[0] = 0


def test_duplicated_vertices_are_merged():
    mesh = repair_mesh(*shapes.soup(shapes.torus()))
    same_solid(mesh, shapes.torus())
    assert mesh.notes == ("480 duplicated vertices were merged.",)


def test_negative_zero_is_zero():
    vertices, faces = shapes.soup(shapes.cube())
    vertices[::2] = np.where(vertices[::2] == 0, -0.0, vertices[::2])
    same_solid(repair_mesh(vertices, faces), shapes.cube())


def test_nearly_coincident_boundary_vertices_are_merged_if_that_closes_the_surface():
    rng = np.random.default_rng(0)
    vertices, faces = shapes.soup(shapes.torus())
    mesh = repair_mesh(vertices + 1e-8 * rng.standard_normal(vertices.shape), faces)
    assert mesh.notes == (
        "480 boundary vertices were merged with a neighbour within a millionth of the size.",
    )
    assert mesh.volume == pytest.approx(Mesh(*shapes.torus()).volume, rel=1e-6)
    with pytest.raises(MeshError, match="boundary edges"):
        repair_mesh(vertices + 1e-4 * rng.standard_normal(vertices.shape), faces)


@pytest.mark.parametrize(("shift", "shared"), [((1, 1, 1), 1), ((1, 1, 0), 2), ((1, 0, 0), 4)])
def test_bodies_that_only_touch_are_kept_apart(shift, shared):
    touching = shapes.joined(shapes.cube(), shapes.moved(shapes.cube(), *shift))
    with pytest.raises(MeshError, match="2 components with 12, 12 faces"):
        repair_mesh(*touching)
    mesh = repair_mesh(*touching, component=2)
    same_solid(mesh, shapes.moved(shapes.cube(), *shift))
    verb = (
        "vertex that coincides with another was" if shared == 1 else "vertices that coincide with others were"
    )
    assert mesh.notes[0] == f"{shared} {verb} kept apart."


def test_faces_between_coinciding_vertices_are_collapsed():
    vertices, faces = shapes.icosphere(1)
    a, b = faces[0, :2]
    vertices[b] = vertices[a]
    mesh = repair_mesh(vertices, faces)
    assert len(mesh.faces) == len(faces) - 2
    assert mesh.notes == ("1 duplicated vertex was merged.",)


def test_isolated_vertices_are_dropped():
    vertices, faces = shapes.cube()
    mesh = repair_mesh(np.concatenate([[[7, 7, 7]], vertices, [[8, 8, np.nan]]]), faces + 1)
    same_solid(mesh, shapes.cube())
    assert mesh.notes == ("2 isolated vertices were dropped.",)


def test_collapsed_and_duplicate_faces_are_left_out():
    vertices, faces = shapes.cube()
    extra = [[0, 0, 1], [2, 3, 2], faces[4], np.roll(faces[5], 1), faces[6, ::-1]]
    mesh = repair_mesh(vertices, np.concatenate([faces, extra]))
    same_solid(mesh, shapes.cube())
    assert mesh.notes == ("2 faces that repeat a vertex were left out.", "3 duplicate faces were left out.")


def test_a_body_with_both_sides_of_every_face_loses_one():
    vertices, faces = shapes.torus()
    mesh = repair_mesh(vertices, np.concatenate([faces, faces[:, ::-1]]))
    same_solid(mesh, shapes.torus())


def test_inside_out_is_turned():
    vertices, faces = shapes.torus()
    mesh = repair_mesh(vertices, faces[:, ::-1])
    same_solid(mesh, shapes.torus())
    assert mesh.notes == ("The body, which was inside out, was turned.",)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_windings_are_made_to_agree(share):
    vertices, faces = shapes.torus()
    turned = np.random.default_rng(1).random(len(faces)) < share
    mesh = repair_mesh(vertices, np.where(turned[:, None], faces[:, ::-1], faces))
    same_solid(mesh, shapes.torus())
    assert "wound against their neighbours were turned." in mesh.notes[0]


def test_polygons_are_cut_into_triangles():
    mesh = repair_mesh(*shapes.cube_quads())
    same_solid(mesh, shapes.cube())
    assert mesh.notes == ("6 polygons with more than three corners were triangulated.",)


def _with_vertex_on_an_edge(count: int = 1):
    """A tetrahedron; vertices on its edge 0-1 belong to the side 0 1 3 alone, and faces without area."""
    vertices, faces = shapes.tetrahedron()
    on_edge = np.column_stack([np.arange(1, count + 1) / (count + 1), np.zeros(count), np.zeros(count)])
    chain = [0, *range(4, 4 + count), 1]
    fan = [[a, b, 3] for a, b in pairwise(chain)]
    flat = [[0, chain[i + 1], chain[i]] for i in range(1, len(chain) - 1)]
    rest = [face for face in faces.tolist() if face != [0, 1, 3]]
    return np.concatenate([vertices, on_edge]), np.array(rest + fan + flat)


@pytest.mark.parametrize("count", [1, 2, 5])
@pytest.mark.parametrize("scale", [1e-9, 1.0])
def test_faces_without_area_are_flipped_away(count, scale):
    vertices, faces = _with_vertex_on_an_edge(count)
    mesh = repair_mesh(vertices * scale, faces)
    assert mesh.volume == pytest.approx(scale**3 / 6, rel=1e-12)
    assert mesh.area == pytest.approx(scale**2 * (3 + 3**0.5) / 2, rel=1e-12)
    assert mesh.face_areas.min() > 1e-3 * scale**2
    assert (len(mesh.vertices), len(mesh.faces)) == (len(vertices), len(faces))
    (note,) = mesh.notes
    assert "without area" in note


def test_edges_without_length_are_collapsed():
    vertices, faces = shapes.icosphere(1)
    # The two ends of an edge come to lie 1e-15 apart: two needles.
    a, b = faces[0, :2]
    vertices[b] = vertices[a] + [1e-15, 0, 0]
    mesh = repair_mesh(vertices, faces)
    assert len(mesh.vertices) == len(vertices) - 1
    assert len(mesh.faces) == len(faces) - 2
    assert "without area" in mesh.notes[0]


def test_faces_without_area_that_cannot_be_removed_are_an_error():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]])
    with pytest.raises(MeshError, match="4 faces without area"):
        repair_mesh(vertices, shapes.tetrahedron()[1])


def test_one_of_several_components_can_be_taken():
    with pytest.raises(MeshError, match=r"2 components with 8, 12 faces; choose one .*component=1"):
        repair_mesh(*shapes.two_components())
    largest = repair_mesh(*shapes.two_components(), component=1)
    same_solid(largest, shapes.moved(shapes.octahedron(), 5, 0, 0))
    assert largest.notes == ("Component 1 of 2 (8 of 20 faces) was taken.",)
    assert np.array_equal(repair_mesh(*shapes.two_components(), component="largest").faces, largest.faces)
    same_solid(repair_mesh(*shapes.two_components(), component=2), shapes.cube())


@pytest.mark.parametrize("component", [0, -1, 3])
def test_a_component_that_is_not_there_is_an_error(component):
    with pytest.raises(
        MeshError, match=f"no component {component}: they are numbered from 1, the largest, to 2"
    ):
        repair_mesh(*shapes.two_components(), component=component)
    with pytest.raises(MeshError, match=f"no component {component}: there is only one"):
        repair_mesh(*shapes.cube(), component=component)


def test_a_sound_component_can_be_taken_from_among_unsound_ones():
    arrays = shapes.joined(shapes.opened(shapes.torus()), shapes.moved(shapes.cube(), 9, 0, 0))
    assert repair_mesh(*arrays, component=2).volume == pytest.approx(1.0)
    with pytest.raises(MeshError, match="3 boundary edges in 1 loop") as caught:
        repair_mesh(*arrays, component=1)
    assert caught.value.components == ()  # choosing again is no way out


@pytest.mark.parametrize("arrays", [shapes.moebius_band(), shapes.klein_bottle()])
def test_one_sided_surfaces_are_an_error(arrays):
    with pytest.raises(MeshError, match="one-sided"):
        repair_mesh(*arrays)


def test_the_error_names_everything_fatal_and_what_to_do():
    vertices, faces = shapes.joined(shapes.opened(shapes.cube()), shapes.moved(shapes.cube(), 5, 0, 0))
    with pytest.raises(MeshError) as caught:
        repair_mesh(vertices, faces, name="thing.off")
    assert str(caught.value) == (
        "thing.off: 2 components with 12, 11 faces; 3 boundary edges in 1 loop, near (1, 0, 0);"
        " choose one by its number, component=1 (the largest) to component=2,"
        " or take all, each on its own, with component='all'"
    )


def test_wrong_shapes_are_mesh_errors():
    with pytest.raises(MeshError, match=r"thing: vertices must have the shape \(n, 3\)"):
        repair_mesh([[0, 0]], [[0, 0, 0]], name="thing")


@pytest.mark.slow
@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    shape=st.sampled_from([shapes.cube, shapes.torus, shapes.l_shape, shapes.octahedron]),
    seed=st.integers(0, 2**32 - 1),
    faults=st.builds(
        Faults,
        split=st.booleans(),
        turn=st.booleans(),
        isolated=st.integers(0, 3),
        copies=st.integers(0, 3),
    ),
    scale=st.sampled_from([1e-9, 1.0, 1e6]),
)
def test_any_mixture_of_faults_leaves_the_same_solid(shape, seed, faults, scale):
    rng = np.random.default_rng(seed)
    reference = shape()
    reference = reference[0] * scale, reference[1]
    vertices, faces = shapes.soup(reference) if faults.split else reference
    vertices = np.concatenate([vertices, 3 * scale * rng.random((faults.isolated, 3))])
    order = rng.permutation(len(vertices))
    vertices, faces = vertices[order], np.argsort(order)[faces]
    faces = np.concatenate([faces, faces[rng.integers(len(faces), size=faults.copies)]])
    if faults.turn:
        backwards = rng.random(len(faces)) < 0.5
        faces = np.where(backwards[:, None], faces[:, ::-1], faces)
    same_solid(repair_mesh(vertices, faces[rng.permutation(len(faces))]), reference)
