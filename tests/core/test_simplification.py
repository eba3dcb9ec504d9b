"""Fewer vertices, the same kind of surface."""

from __future__ import annotations

import numpy as np
import pytest

from idviewer.core import Mesh, read_mesh, sample_path
from idviewer.core.shapes.simplification import simplification_steps, simplified
from idviewer.core.steps import finish


def _roundness(mesh: Mesh) -> np.ndarray:
    corners = mesh.vertices[mesh.faces]
    sides = ((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=(1, 2))
    return 4.0 * np.sqrt(3.0) * mesh.face_areas / sides


def _euler(mesh: Mesh) -> int:
    return len(mesh.vertices) - len(mesh.faces) // 2


@pytest.mark.parametrize("name", ["couple", "octopus_2k"])
def test_what_is_left_is_a_mesh_of_the_same_topology_near_the_surface(name):
    mesh = read_mesh(sample_path(name))
    small = simplified(mesh, 800)  # whose constructor examines it
    assert len(small.vertices) == 800
    assert _euler(small) == _euler(mesh)
    assert small.area == pytest.approx(mesh.area, rel=0.03)
    assert small.volume == pytest.approx(mesh.volume, rel=0.06)
    assert _roundness(small).min() > 0.2


def test_every_vertex_is_one_of_the_mesh_and_the_heir_of_those_near_it():
    mesh = read_mesh(sample_path("hand_2k"))
    result = finish(simplification_steps(mesh, 600))
    assert set(map(tuple, result.mesh.vertices)) <= set(map(tuple, mesh.vertices))
    gaps = np.linalg.norm(mesh.vertices - result.mesh.vertices[result.parents], axis=1)
    assert np.count_nonzero(gaps == 0.0) == 600
    assert gaps.max() < 0.2 * mesh.diagonal


@pytest.mark.parametrize(("scale", "offset"), [(1e-9, 0.0), (1.0, 1e6)])
def test_size_and_place_do_not_matter(scale, offset):
    mesh = read_mesh(sample_path("hand_2k"))
    moved = Mesh(scale * mesh.vertices + offset, mesh.faces)
    assert simplified(moved, 900).area == pytest.approx(scale**2 * simplified(mesh, 900).area, rel=1e-2)


def test_a_flat_surface_is_no_trouble():
    """Where all collapses cost the same, libraries built on quadrics leave the surface far behind."""
    n = 24
    u, v = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    lower, upper = (np.stack([u, v, np.full_like(u, z)], axis=2).reshape(-1, 3) for z in (0, 1))
    corner = (u[:-1, :-1] * n + v[:-1, :-1]).ravel()
    sheet = np.concatenate(
        [np.stack([corner, corner + n, corner + n + 1], 1), np.stack([corner, corner + n + 1, corner + 1], 1)]
    )
    rim = np.concatenate(
        [u[:, 0] * n, u[-1, 1:] * n + v[-1, 1:], (u[:, -1] * n + n - 1)[-2::-1], v[0, -2:0:-1]]
    )
    other = np.roll(rim, -1)
    walls = np.concatenate(
        [np.stack([rim, other, other + n * n], 1), np.stack([rim, other + n * n, rim + n * n], 1)]
    )
    box = Mesh(np.concatenate([lower, upper]), np.concatenate([sheet[:, ::-1], sheet + n * n, walls]))
    small = simplified(box, 200)
    assert len(small.vertices) == 200
    assert small.volume == pytest.approx(box.volume, rel=0.02)


def test_a_mesh_that_cannot_be_simplified_stays_as_it_is():
    tetrahedron = Mesh(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    )
    assert simplified(tetrahedron, 3) is tetrahedron
