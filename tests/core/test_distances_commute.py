"""Commute time without truncation: against the dense pseudo-inverse, by both ways, and GPS beside it."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg
from tests.core import shapes
from tests.core.test_distances_spectral import stretched, weight_differences
from tests.core.test_mean_value import inner_points

from idviewer.core import (
    GPS,
    CommuteTime,
    Diffusion,
    DistanceError,
    InteriorDistance,
    Mesh,
    cotangent_laplacian,
    eigenpairs,
    gram_distance,
)
from idviewer.core.distances import commute_time
from idviewer.core.distances.commute_time import CommuteTimeSettings
from idviewer.core.steps import finish


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return stretched(3)


@pytest.fixture(scope="module")
def solver(mesh: Mesh) -> InteriorDistance:
    return InteriorDistance(mesh, CommuteTime())


def expected(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    inverse = scipy.linalg.pinvh(cotangent_laplacian(mesh).toarray())
    z = weight_differences(mesh, points)
    return np.sqrt(np.einsum("pi,ij,pj->p", z, inverse, z))


@pytest.mark.slow
def test_by_sparse_solves_it_is_that_of_the_pseudo_inverse(mesh, rng):
    points = inner_points(mesh, rng, 40)
    solver = InteriorDistance(mesh, CommuteTime())
    np.testing.assert_allclose(solver.distance(points[:20], points[20:]), expected(mesh, points), rtol=1e-9)
    assert not solver.boundary.prepared, "pairs need no dense embedding"


@pytest.mark.slow
def test_the_dense_embedding_is_that_of_the_pseudo_inverse(mesh, solver, rng):
    points = inner_points(mesh, rng, 40)
    images = solver.embed(points)
    assert images.shape[1] == len(mesh.vertices) - 1
    np.testing.assert_allclose(
        np.linalg.norm(images[:20] - images[20:], axis=1), expected(mesh, points), rtol=1e-9
    )
    np.testing.assert_allclose(
        gram_distance(solver, points[:20], points[20:]), expected(mesh, points), rtol=1e-9
    )


@pytest.mark.slow
def test_gps_with_all_modes_is_the_commute_time_without_a_factor(mesh, solver, rng):
    points = inner_points(mesh, rng, 40)
    everything = InteriorDistance(mesh, GPS(), spectrum=eigenpairs(mesh, cutoff=lambda _: math.inf))
    np.testing.assert_allclose(
        everything.field(points[0], points[1:]), solver.field(points[0], points[1:]), rtol=1e-8
    )


@pytest.mark.slow
def test_a_field_is_many_pairs_and_points_outside_are_nan(solver, rng):
    points = np.concatenate([inner_points(solver.shape, rng, 37), [[99.0, 0.0, 0.0]]])
    field = solver.field(points[0], points)
    np.testing.assert_allclose(
        field[1:-1], solver.distance(points[1:-1], np.tile(points[0], (36, 1))), rtol=1e-9
    )
    assert field[0] < 1e-7 * field[1]
    assert np.isnan(field[-1])
    assert np.isnan(solver.field(points[-1], points)).all()


@pytest.mark.slow
def test_the_potential_is_the_same_by_both_ways(mesh, rng):
    points = inner_points(mesh, rng, 30)
    solver = InteriorDistance(mesh, CommuteTime())
    by_solves = solver.potential(points)
    finish(solver.boundary.prepare_steps())
    np.testing.assert_allclose(solver.potential(points), by_solves, rtol=1e-9)


@pytest.mark.slow
def test_it_does_not_depend_on_size_or_place(rng):
    vertices, faces = shapes.icosphere(2)
    points = inner_points(Mesh(vertices, faces), rng, 20)
    plain = InteriorDistance(Mesh(vertices, faces), CommuteTime()).distance(points[:10], points[10:])
    small = InteriorDistance(Mesh(1e-9 * vertices, faces), CommuteTime())
    np.testing.assert_allclose(small.distance(1e-9 * points[:10], 1e-9 * points[10:]), plain, rtol=1e-6)
    far = InteriorDistance(Mesh(vertices + 1e6, faces), CommuteTime())
    np.testing.assert_allclose(far.distance(points[:10] + 1e6, points[10:] + 1e6), plain, rtol=1e-6)


def test_large_meshes_have_pairs_and_a_barycentroid_but_no_dense_embedding(mesh, solver, monkeypatch, rng):
    points = inner_points(mesh, rng, 4)
    monkeypatch.setattr(commute_time, "COMMUTE_TIME_SETTINGS", CommuteTimeSettings(largest_embedding=100))
    limited = InteriorDistance(mesh, CommuteTime())
    np.testing.assert_allclose(
        limited.distance(points[:2], points[2:]), solver.distance(points[:2], points[2:])
    )
    assert np.isfinite(limited.potential(points)).all()
    with pytest.raises(DistanceError, match="GB for 642 vertices; the limit is 100: take gps"):
        limited.embed(points)


@pytest.mark.slow
def test_truncation_never_lengthens_and_more_modes_err_less(mesh):
    few = eigenpairs(mesh)
    more = eigenpairs(mesh, cutoff=lambda lambda_2: 400.0 * lambda_2)
    everything = eigenpairs(mesh, cutoff=lambda _: math.inf)
    i, j = np.random.default_rng(0).integers(0, len(mesh.vertices), (2, 40))
    i, j = i[i != j], j[i != j]
    exact = InteriorDistance(mesh, CommuteTime()).distance(mesh.vertices[i], mesh.vertices[j])
    errors = []
    for spectrum in (few, more, everything):
        truncated = InteriorDistance(mesh, GPS(), spectrum=spectrum)
        found = truncated.distance(mesh.vertices[i], mesh.vertices[j])
        assert (found <= exact * (1 + 1e-9)).all()
        errors.append((1.0 - found / exact).mean())
    assert errors[0] > errors[1] > errors[2]
    assert abs(errors[2]) < 1e-7


@pytest.mark.slow
def test_changing_from_it_and_back_keeps_the_eigenpairs(mesh, solver):
    spectral = InteriorDistance(mesh, Diffusion())
    assert not spectral.boundary.shares_basis(CommuteTime())
    assert spectral.with_distance(CommuteTime()).with_distance(GPS()).spectrum is spectral.spectrum
