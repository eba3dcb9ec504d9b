"""Surfaces that touch themselves in edges and vertices, faces given twice, and walls inside."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes
from tests.core.voxels import box, emptied, voxel_surface

from idviewer.core import Mesh, MeshError, Repairs, repair_mesh
from idviewer.core.shapes.mesh_repair import repair_meshes
from idviewer.core.validation.topology import Topology


def is_manifold(mesh):
    topology = Topology(mesh.faces, len(mesh.vertices))
    return topology.closed and len(topology.vertex_fans()) == len(mesh.vertices)


def solid_voxels(full):
    """Number of parts of a grid, of which voxels belong together that share a face."""
    from scipy.ndimage import label

    return label(full)[1]


def test_an_edge_in_which_a_body_touches_itself_is_cut():
    # Two towers on one slab touch in an edge.
    full = emptied(box(2, 2, 3), (0, 0, 1), (1, 1, 1), (0, 0, 2), (1, 1, 2))
    arrays = voxel_surface(full)
    assert len(Topology(arrays[1], len(arrays[0])).non_manifold_edges) == 2
    mesh = repair_mesh(*arrays)
    assert mesh.volume == pytest.approx(full.sum())
    assert is_manifold(mesh)
    assert len(mesh.vertices) == len(arrays[0]) + 2  # the lowest one stays whole
    assert mesh.notes == (
        "2 edges with more than two faces, where the body touches itself, were cut into copies with two "
        "faces each.",
    )
    np.testing.assert_array_equal(mesh.file_vertices, np.arange(len(arrays[0])))
    assert (np.bincount(mesh.numbering.origins) == 2).sum() == 2


@pytest.mark.parametrize("seed", range(24))
def test_any_voxel_body_becomes_the_parts_that_share_faces(seed):
    full = np.random.default_rng(seed).random((4, 4, 4)) < 0.55
    vertices, faces = voxel_surface(full)
    if seed % 3 == 0:
        vertices, faces = shapes.soup((vertices, faces))
    pieces = repair_meshes(vertices, faces)
    assert sum(piece.volume for piece in pieces) == pytest.approx(full.sum())
    assert len(pieces) == solid_voxels(full)
    assert all(is_manifold(piece) for piece in pieces)
    volumes = [piece.volume for piece in pieces]
    assert volumes == sorted(volumes, reverse=True)


@pytest.mark.parametrize("share", [0.2, 0.5])
def test_windings_need_not_agree_for_a_cut(share, rng):
    full = emptied(box(2, 2, 3), (0, 0, 1), (1, 1, 1), (0, 0, 2), (1, 1, 2))
    vertices, faces = voxel_surface(full)
    flipped = rng.random(len(faces)) < share
    mesh = repair_mesh(vertices, np.where(flipped[:, None], faces[:, ::-1], faces))
    assert mesh.volume == pytest.approx(full.sum())
    assert is_manifold(mesh)


def test_bodies_that_share_an_edge_or_a_vertex_are_two():
    for arrays in (shapes.non_manifold_cubes(), shapes.pinched_cubes()):
        pieces = repair_meshes(*arrays)
        assert [piece.volume for piece in pieces] == pytest.approx([1.0, 1.0])
        assert all(is_manifold(piece) for piece in pieces)


def double_sided(arrays, chosen):
    """Some faces a second time, from behind and on vertices of their own."""
    vertices, faces = arrays
    return shapes.joined(arrays, (vertices, faces[chosen][:, ::-1]))


@pytest.mark.parametrize("count", [108, 50, 1])
def test_faces_given_from_both_sides_are_taken_once(count):
    cube = voxel_surface(box(3, 3, 3))
    vertices, faces = double_sided(cube, np.arange(count))
    mesh = repair_mesh(vertices, faces)
    assert mesh.volume == pytest.approx(27.0)
    assert len(mesh.faces) == 108
    assert any((f"{count} " in note and "taken once" in note) or "left out" in note for note in mesh.notes)
    on_the_same = np.concatenate([cube[1], cube[1][:count, ::-1]])
    assert repair_mesh(cube[0], on_the_same).volume == pytest.approx(27.0)


def test_a_body_given_twice_is_one():
    mesh = repair_mesh(*shapes.joined(shapes.icosphere(1), shapes.icosphere(1)))
    assert mesh.volume == pytest.approx(Mesh(*shapes.icosphere(1)).volume)


def with_wall(twice):
    """Two cubes that share a side, welded; the side is there once, or twice as two cells would have it."""
    vertices, faces = voxel_surface(box(2, 1, 1))
    corners = [
        np.flatnonzero((vertices == point).all(axis=1))[0]
        for point in ([1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1])
    ]
    a, b, c, d = corners
    wall = [[a, b, c], [a, c, d]]
    return vertices, np.concatenate([faces, wall, [row[::-1] for row in wall]] if twice else [faces, wall])


@pytest.mark.parametrize("twice", [False, True])
def test_inner_walls_are_named_and_can_be_left_out(twice):
    with pytest.raises(
        MeshError, match=r"2 faces inside the body \(inner walls\), near \(1, .*drop_walls=True"
    ):
        repair_mesh(*with_wall(twice))
    mesh = repair_mesh(*with_wall(twice), repairs=Repairs(drop_walls=True))
    assert mesh.volume == pytest.approx(2.0)
    assert mesh.area == pytest.approx(10.0)
    assert "2 faces inside the body (inner walls) were left out." in mesh.notes


def test_a_fin_is_named_and_can_be_left_out():
    vertices, faces = shapes.cube()
    fin = np.concatenate([faces, [[0, 1, 8]]])
    arrays = np.concatenate([vertices, [[0.5, -1.0, -1.0]]]), fin
    with pytest.raises(MeshError, match=r"1 face that bounds no solid \(a fin\)"):
        repair_mesh(*arrays)
    mesh = repair_mesh(*arrays, repairs=Repairs(drop_walls=True))
    assert mesh.volume == pytest.approx(1.0)
    assert len(mesh.vertices) == 8
    assert mesh.file_vertices[8] == -1
