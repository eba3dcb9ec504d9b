"""Boundary distances: full spectra against pseudo-inverses, scale laws, and what is said of missing modes."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg
from tests.core import shapes
from tests.core.test_mean_value import inner_points

from idviewer.core import (
    DISTANCES,
    GPS,
    Biharmonic,
    Diffusion,
    Distance,
    Euclidean,
    InteriorDistance,
    Mesh,
    Spectrum,
    cotangent_laplacian,
    eigenpairs,
    parameters_of,
    voronoi_areas,
)
from idviewer.core.distances import Number


def stretched(level: int, size: float = 1.0) -> Mesh:
    vertices, faces = shapes.icosphere(level)
    return Mesh(size * vertices * [1.0, 1.4, 2.1], faces)


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return stretched(3)


@pytest.fixture(scope="module")
def everything(mesh: Mesh) -> Spectrum:
    return eigenpairs(mesh, cutoff=lambda _: math.inf)


@pytest.fixture(scope="module")
def paper(mesh: Mesh) -> Spectrum:
    return eigenpairs(mesh)


def squares(mesh: Mesh, distance: Distance, spectrum: Spectrum, points: np.ndarray) -> np.ndarray:
    solver = InteriorDistance(mesh, distance, spectrum=spectrum)
    half = len(points) // 2
    return solver.distance(points[:half], points[half:]) ** 2


def weight_differences(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    weights = InteriorDistance(mesh, Euclidean()).coordinates.weights(points)
    half = len(points) // 2
    return weights[:half] - weights[half:]


@pytest.mark.slow
def test_gps_with_all_modes_is_the_commute_time_z_pinv_l_z(mesh, everything, rng):
    points = inner_points(mesh, rng, 40)
    inverse = scipy.linalg.pinvh(cotangent_laplacian(mesh).toarray())
    z = weight_differences(mesh, points)
    np.testing.assert_allclose(
        squares(mesh, GPS(), everything, points), np.einsum("pi,ij,pj->p", z, inverse, z), rtol=1e-9
    )


@pytest.mark.slow
def test_biharmonic_with_all_modes_is_the_norm_of_the_poisson_equation_s_solution(mesh, everything, rng):
    points = inner_points(mesh, rng, 40)
    inverse = scipy.linalg.pinvh(cotangent_laplacian(mesh).toarray())
    masses = voronoi_areas(mesh)
    solutions = weight_differences(mesh, points) @ inverse
    solutions -= (solutions @ masses / masses.sum())[:, None]
    np.testing.assert_allclose(
        squares(mesh, Biharmonic(), everything, points), solutions**2 @ masses, rtol=1e-9
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("distance", "scaled", "power"),
    [
        (Diffusion(), Diffusion(), -1),
        (Diffusion(time=0.2), Diffusion(time=0.2 * 3.0**2), -1),
        (GPS(), GPS(), 0),
        (Biharmonic(), Biharmonic(), 1),
        (Euclidean(), Euclidean(), 1),
    ],
)
def test_distances_scale_with_a_power_of_the_size(mesh, rng, distance, scaled, power):
    points = inner_points(mesh, rng, 40)
    plain = InteriorDistance(mesh, distance).field(points[0], points[1:])
    large = InteriorDistance(stretched(3, 3.0), scaled).field(3 * points[0], 3 * points[1:])
    np.testing.assert_allclose(large, 3.0**power * plain, rtol=1e-9)


@pytest.mark.slow
def test_biharmonic_converges_where_gps_grows_with_the_logarithm_of_the_modes():
    """Each doubling of the cut-off adds as much to GPS as the one before, and to biharmonic far less."""
    mesh = Mesh(*shapes.icosphere(3))
    spectrum = eigenpairs(mesh, cutoff=lambda _: math.inf)
    squared = (spectrum.vectors[0] - spectrum.vectors[200]) ** 2
    cuts = [10.0, 20.0, 40.0, 80.0, 160.0]
    steps = {}
    for distance in (GPS(), Biharmonic()):
        terms = squared * distance.scale(spectrum) ** 2
        sums = [terms[spectrum.values < cut].sum() for cut in cuts]
        steps[distance.name] = np.diff(sums)
    assert steps["gps"][-1] > 0.5 * steps["gps"][0]
    assert steps["biharmonic"][-1] < 0.1 * steps["biharmonic"][0]


@pytest.mark.slow
@pytest.mark.parametrize("kind", [Diffusion, GPS, Biharmonic])
def test_spectral_distances_share_the_basis_and_the_paper_s_cut_off(mesh, paper, kind, rng):
    first = InteriorDistance(mesh, spectrum=paper)
    other = first.with_distance(kind())
    assert other.boundary.basis is first.boundary.basis
    assert kind().cutoff(0.7) == Diffusion().cutoff(0.7)
    points = inner_points(mesh, rng, 20)
    direct = InteriorDistance(mesh, kind())
    np.testing.assert_allclose(other.field(points[0], points[1:]), direct.field(points[0], points[1:]))
    np.testing.assert_allclose(other.potential(points), direct.potential(points), rtol=1e-9)
    assert other.description == direct.description


@pytest.mark.slow
def test_the_interior_changes_to_a_distance_with_another_basis_and_back(mesh, paper, rng):
    points = inner_points(mesh, rng, 20)
    first = InteriorDistance(mesh, spectrum=paper)
    straight = first.with_distance(Euclidean())
    np.testing.assert_allclose(
        straight.field(points[0], points[1:]), np.linalg.norm(points[1:] - points[0], axis=1)
    )
    with pytest.raises(ValueError, match="uses no eigenpairs"):
        _ = straight.spectrum
    assert straight.with_distance(GPS()).spectrum is paper
    assert InteriorDistance(mesh, Euclidean()).with_distance(GPS()).spectrum.bound == paper.bound


def test_a_time_too_short_for_the_eigenpairs_says_what_is_missing(mesh, everything, paper):
    default = 1 / (8 * paper.values[0])
    first_missing = everything.values[len(paper.values)]
    for factor, words in ((1 / 8, "18%"), (1 / 4, "3.2%"), (1 / 2, "0.1%")):
        described = Diffusion(time=factor * default).describe(paper)
        assert described.endswith(f"; modes left out weigh up to {words}")
        weight = math.exp(-first_missing * factor * default)
        assert weight <= 1.06 * float(words[:-1]) / 100
        assert "left out" not in Diffusion(time=factor * default).describe(everything)
    for time in (None, default, 2 * default, 64 * default):
        assert "left out" not in Diffusion(time=time).describe(paper)
    assert Diffusion(time=default / 1e4).describe(paper).endswith("up to 100%")


@pytest.mark.slow
def test_a_solver_of_its_own_lacks_no_modes(mesh):
    time = 1 / (8 * 8 * eigenpairs(mesh).values[0])
    assert "left out" not in InteriorDistance(mesh, Diffusion(time=time)).description


def test_a_long_time_keeps_the_paper_s_modes():
    assert Diffusion(time=1e6).cutoff(1.0) == Diffusion().cutoff(1.0)
    assert Diffusion(time=1e-3).cutoff(1.0) > Diffusion().cutoff(1.0)


def test_parameters_are_fields_whose_default_is_none(paper):
    for kind in DISTANCES.values():
        for name, parameter in parameters_of(kind).items():
            if isinstance(parameter, Number):
                assert getattr(kind(), name) is None
                assert parameter.default(2.0) > 0
                low, high = parameter.span
                assert low < 1 < high
    (time,) = parameters_of(Diffusion()).values()
    assert time.default(float(paper.values[0])) == Diffusion().resolved_time(float(paper.values[0]))
