"""Laplacian and eigenpairs: theorems and closed forms. Counts and dense pairs: test_spectrum_counts.py."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes

import idviewer.core.spectrum.eigen_solver as spectrum_module
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.spectrum.eigen_solver import eigenpair_steps, eigenpairs, paper_cutoff
from idviewer.core.spectrum.laplacian import cotangent_laplacian, voronoi_areas
from idviewer.core.steps import finish


def stretched(level: int = 2) -> Mesh:
    vertices, faces = shapes.icosphere(level)
    return Mesh(vertices * [1.0, 1.7, 2.9], faces)


def test_the_laplacian_is_the_gradient_s_square():
    """L = G^T A G with G the gradient on faces, written apart from the cotangents."""
    mesh = stretched()
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    double_area = np.linalg.norm(normal, axis=1)
    normal /= double_area[:, None]
    energy = np.zeros((len(mesh.vertices),) * 2)
    gradients = [np.cross(normal, edge) / double_area[:, None] for edge in (c - b, a - c, b - a)]
    for i in range(3):
        for j in range(3):
            value = np.einsum("fi,fi->f", gradients[i], gradients[j]) * double_area / 2
            np.add.at(energy, (mesh.faces[:, i], mesh.faces[:, j]), value)
    np.testing.assert_allclose(cotangent_laplacian(mesh).toarray(), energy, atol=1e-12)


def test_the_laplacian_of_a_linear_function_on_flat_ground_vanishes():
    vertices, faces = shapes.subdivided(*shapes.subdivided(*shapes.cube()))
    mesh = Mesh(vertices, faces)
    inner = (np.sum((vertices == 0) | (vertices == 1), axis=1) == 1) & (vertices[:, 2] == 1)
    assert inner.sum() > 5
    np.testing.assert_allclose((cotangent_laplacian(mesh) @ vertices[:, 0])[inner], 0, atol=1e-14)


def test_areas_add_up_and_match_voronoi_cells():
    mesh = stretched()
    areas = voronoi_areas(mesh)
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(mesh.area, rel=1e-13)
    # On a regular grid of right triangles every inner vertex owns one square.
    vertices, faces = shapes.subdivided(*shapes.subdivided(*shapes.cube()))
    inner = (np.sum((vertices == 0) | (vertices == 1), axis=1) == 1) & (vertices[:, 2] == 1)
    np.testing.assert_allclose(voronoi_areas(Mesh(vertices, faces))[inner], 1 / 16, rtol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("error", [-0.05, 0.0, 0.05])
def test_an_estimate_of_lambda_2_changes_the_way_and_not_the_result(error):
    """Shifted among the eigenvalues, in a cluster (6 occurs five times) or not, it finds them all."""
    sphere = Mesh(*shapes.icosphere(4))
    plain = eigenpairs(sphere, cutoff=lambda lambda_2: 20.5 * lambda_2)
    estimated = finish(
        eigenpair_steps(sphere, lambda lambda_2: 20.5 * lambda_2, (1.0 + error) * plain.values[0])
    )
    np.testing.assert_allclose(estimated.values, plain.values, rtol=1e-9)
    overlap = plain.vectors.T @ (plain.masses[:, None] * estimated.vectors)
    np.testing.assert_allclose(np.linalg.svd(overlap)[1], 1.0, atol=1e-9)


@pytest.mark.slow
def test_a_large_mesh_is_estimated_from_a_simplified_one(monkeypatch):
    mesh = Mesh(*shapes.icosphere(5))
    seen = []
    original = spectrum_module._krylov_steps

    def watched(shape, masses, cutoff, estimate=None):
        seen.append((len(masses), estimate))
        return original(shape, masses, cutoff, estimate)

    monkeypatch.setattr(spectrum_module, "_krylov_steps", watched)
    values = eigenpairs(mesh).values
    assert [count for count, _ in seen] == [
        spectrum_module.EIGEN_SOLVER.estimate_vertices,
        len(mesh.vertices),
    ]
    assert seen[1][1] == pytest.approx(values[0], rel=0.03)
    degree = np.round((np.sqrt(1 + 4 * values) - 1) / 2).astype(int)
    np.testing.assert_array_equal(np.bincount(degree)[1:14], 2 * np.arange(1, 14) + 1)


@pytest.mark.slow
def test_eigenvalues_of_a_sphere_converge_at_second_order():
    expected = np.array([2.0] * 3 + [6.0] * 5 + [12.0] * 7)
    errors = []
    for level in (2, 3, 4):
        values = eigenpairs(Mesh(*shapes.icosphere(level)), cutoff=lambda lambda_2: 8 * lambda_2).values
        errors.append(np.abs(values[: len(expected)] / expected - 1).max())
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (rates > 1.8).all(), (errors, rates)


def test_the_paper_s_cut_off_keeps_modes_above_one_millionth():
    assert np.exp(-paper_cutoff(0.37) / (8 * 0.37)) == pytest.approx(1e-6)


@pytest.mark.slow
def test_size_scales_the_spectrum():
    mesh = Mesh(*shapes.torus(40, 24))
    plain = eigenpairs(mesh, cutoff=lambda lambda_2: 10 * lambda_2)
    for scale in (1e-9, 1e6):
        scaled = eigenpairs(Mesh(mesh.vertices * scale, mesh.faces), cutoff=lambda lambda_2: 10 * lambda_2)
        np.testing.assert_allclose(scaled.values * scale**2, plain.values, rtol=1e-9)


def test_a_mesh_too_coarse_for_the_distance_is_refused_in_one_line():
    with pytest.raises(MeshError, match=r"about \d+ modes, more than a mesh of 2562 vertices") as caught:
        eigenpairs(stretched(4), cutoff=lambda lambda_2: 1e6 * lambda_2)
    assert "\n" not in str(caught.value)


def test_the_smallest_meshes_keep_what_they_have():
    spectrum = eigenpairs(Mesh(*shapes.tetrahedron()))
    assert spectrum.vectors.shape == (4, 3)
