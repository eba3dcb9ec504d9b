"""Surfaces of voxels: closed and manifold whatever the voxels, smooth, of their volume, near the body."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import generate_binary_structure, label

from idviewer.core import MeshError, repair_mesh
from idviewer.core.shapes.voxel_net import NET
from idviewer.core.shapes.voxel_surface import voxel_surface


def edges_of(faces):
    return np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)


def enclosed_volume(vertices, faces):
    a, b, c = (vertices - vertices.mean(axis=0))[faces].transpose(1, 0, 2)
    return np.linalg.det(np.stack([a, b, c], axis=1)).sum() / 6.0


def euler_number(voxels):
    """Of voxels joined by faces alone, counted on their dual: points, pairs, squares and cubes of them.

    Where voxels outside meet in a corner alone, the corner is taken to be inside, which is one more each.
    """
    m = np.pad(voxels, 1)
    closed = 0
    for i, j, k in np.ndindex(*(np.array(m.shape) - 1)):
        outside = ~m[i : i + 2, j : j + 2, k : k + 2]
        closed += max(label(outside, generate_binary_structure(3, 2))[1] - 1, 0)
    squares = 0
    for a, b in ((0, 1), (0, 2), (1, 2)):
        n = m & np.roll(m, -1, a)
        squares += int((n & np.roll(n, -1, b)).sum())
    pairs = sum(int((m & np.roll(m, -1, axis)).sum()) for axis in range(3))
    cubes = m
    for axis in range(3):
        cubes = cubes & np.roll(cubes, -1, axis)
    return int(m.sum()) - pairs + squares - int(cubes.sum()) + closed


@pytest.mark.parametrize("share", [0.15, 0.4, 0.6, 0.85])
def test_any_voxels_have_a_manifold_surface_of_their_topology(rng, share):
    """Twice the solid's Euler number is the surface's; two faces meet in each edge, once in either sense."""
    for size in (1, 2, 2, 3, 3, 4, 6):
        voxels = rng.random((size, size + 1, size)) < share
        if not voxels.any():
            continue
        surface = voxel_surface(voxels)
        faces = surface.faces
        edges, counts = np.unique(edges_of(faces), axis=0, return_counts=True)
        assert (counts == 2).all()
        directed = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        assert len(np.unique(directed, axis=0)) == len(directed)
        assert len(surface.vertices) - len(edges) + len(faces) == 2 * euler_number(voxels)
        assert len(np.unique(surface.vertices, axis=0)) == len(surface.vertices)


@pytest.mark.parametrize("share", [0.3, 0.6])
def test_each_piece_is_a_mesh(rng, share):
    surface = voxel_surface(rng.random((6, 6, 6)) < share)
    faces = surface.faces
    for component in range(1, 4):
        try:
            mesh = repair_mesh(surface.vertices, faces, component=component)
        except MeshError as error:
            assert "no component" in str(error) or "inside" in str(error), error  # noqa: PT017
        else:
            assert mesh.volume > 0


def test_the_smooth_surface_of_a_ball_is_near_it_and_has_its_voxels_volume():
    radius = 9.3
    middles = np.indices((22, 22, 22)) - 10.4
    ball = (middles**2).sum(axis=0) < radius**2
    surface = voxel_surface(ball)
    away = np.linalg.norm(surface.vertices - 10.9, axis=1) - radius
    assert np.abs(away).max() < 0.45
    assert np.sqrt((away**2).mean()) < 0.16  # the voxels' own corners: 0.29
    assert enclosed_volume(surface.vertices, surface.faces) == pytest.approx(ball.sum(), rel=1e-4)
    faces = surface.faces
    assert repair_mesh(surface.vertices, faces).volume == pytest.approx(ball.sum(), rel=1e-4)
    assert 0.1 < surface.displacement <= NET.reach * np.sqrt(3)


def test_vertices_stay_within_their_reach(rng):
    voxels = rng.random((7, 7, 7)) < 0.5
    surface = voxel_surface(voxels)
    corners = np.argwhere(np.ones(np.array(voxels.shape) + 1, bool))
    nearest = np.abs(surface.vertices[:, None] - corners).max(axis=2).min(axis=1)
    assert nearest.max() <= NET.reach + 0.5  # in the middle of an edge at the most
    assert (surface.vertices > -0.5).all()
    assert (surface.vertices < 7.5).all()


def test_voxels_that_meet_in_an_edge_or_a_corner_are_parted():
    for second, count in (((1, 1, 0), 16), ((1, 1, 1), 16), ((1, 0, 0), 12)):
        voxels = np.zeros((2, 2, 2), bool)
        voxels[0, 0, 0] = voxels[second] = True
        assert len(voxel_surface(voxels).vertices) == count


def test_no_voxels_have_no_surface():
    surface = voxel_surface(np.zeros((2, 3, 4), bool))
    assert (len(surface.vertices), len(surface.faces), surface.displacement) == (0, 0, 0.0)


def test_two_sides_of_a_thin_plate_do_not_meet():
    x, y, z = np.indices((12, 12, 12)) - 5.5
    plate = np.abs(x + 0.6 * y + 0.3 * z) < 0.7
    surface = voxel_surface(plate)
    faces = surface.faces
    a, b, c = surface.vertices[faces].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    assert (np.linalg.norm(normals, axis=1) > 1e-3).all()
    assert enclosed_volume(surface.vertices, surface.faces) == pytest.approx(plate.sum(), rel=1e-3)
