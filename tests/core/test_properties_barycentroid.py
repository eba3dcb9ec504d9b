"""Section 7 of the paper: the potential U^2 = w^T A w is the mean squared distance but for a constant."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.property_shapes import (
    BY_ALL_COORDINATES,
    EVERYWHERE,
    EXACT,
    RANDOM,
    dense_modes,
    inside,
    pairs,
    shape,
    solver_of,
    thorough,
    with_vertices,
)

from idviewer.core import (
    GPS,
    Biharmonic,
    Diffusion,
    Geodesic,
    InteriorDistance,
    SpectralFilter,
    masses_of,
)

SPECTRAL = ["diffusion", "filter", "gps", "biharmonic"]


@pytest.mark.one_is_quick
@EVERYWHERE
@pytest.mark.parametrize("kind", SPECTRAL)
@BY_ALL_COORDINATES
def test_the_potential_is_the_quadratic_form_of_the_gram_matrix(name, kind, coordinates):
    """ "Minimizing this area weighted average is equivalent to minimizing U^2(p) = w(p)^T A w(p)."

    For spectral distances the constant is sum_k f(lambda_k)^2 / area, because phi_k^T M phi_k = 1 and
    1^T M phi_k = 0; A is formed here from eigenpairs of another solver.
    """
    body, points = shape(name), np.concatenate(pairs(name, 5))
    solver = solver_of(kind, body, coordinates)
    count = len(solver.spectrum.values)
    values, vectors = (every[..., :count] for every in dense_modes(body))
    factors = {
        "diffusion": np.exp(-values / (8 * values[0])),
        "filter": 1 / (1 + values / values[0]),
        "gps": values**-0.5,
        "biharmonic": 1 / values,
    }[kind]
    gram = (vectors * factors**2) @ vectors.T
    weights = solver.coordinates.weights(points)
    form = np.einsum("pi,ij,pj->p", weights, gram, weights)
    np.testing.assert_allclose(solver.potential(points) ** 2, form, rtol=1e-7)
    masses = masses_of(body) / masses_of(body).sum()
    mean = np.array([solver.field(point, body.vertices) ** 2 for point in points]) @ masses
    np.testing.assert_allclose(mean - form, (factors**2).sum() / masses_of(body).sum(), rtol=1e-7)


@pytest.mark.one_is_quick
@EVERYWHERE
@pytest.mark.parametrize("kind", [*EXACT, "geodesic"])
def test_the_potential_of_every_distance_is_the_mean_but_for_a_constant(name, kind):
    """Also where the embedded vertices are not centred, and where no embedding is at hand (commute time)."""
    body, points = shape(name), np.concatenate(pairs(name, 5))
    solver = InteriorDistance(body, Geodesic()) if kind == "geodesic" else solver_of(kind, body, "mean_value")
    masses = masses_of(body) / masses_of(body).sum()
    mean = np.array([solver.field(point, body.vertices) ** 2 for point in points]) @ masses
    difference = mean - solver.potential(points) ** 2
    assert np.ptp(mean) > 1e-2 * mean.max()
    np.testing.assert_allclose(difference, difference[0], atol=1e-9 * mean.max())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "distance"),
    [
        *((name, Diffusion()) for name in [*RANDOM, "gingerbread"]),
        *(("random mesh", one) for one in (GPS(), Biharmonic(), SpectralFilter("1 / (1 + lambda)"))),
    ],
)
def test_the_barycentroid_goes_with_the_shape(name, distance, rng):
    """Turned, moved, mirrored in the plane, and (without a parameter of the shape's unit) scaled."""
    body = shape(name)
    turn = np.linalg.qr(rng.standard_normal((body.dimension,) * 2))[0]
    if body.dimension == 3:
        turn[:, 0] *= np.sign(np.linalg.det(turn))
    size = 1.0 if isinstance(distance, SpectralFilter) else 1e-6
    shift = size * rng.standard_normal(body.dimension)
    moved = with_vertices(body, size * body.vertices @ turn + shift)
    first, second = InteriorDistance(body, distance), InteriorDistance(moved, distance)
    found, image = first.barycentroid(), second.barycentroid()
    expected = size * found.point @ turn + shift
    # U is flat at its minimum: places agree to the root of what heights agree to, and so do two minima.
    heights = second.potential(np.stack([image.point, expected]))
    np.testing.assert_allclose(heights[0], heights[1], rtol=1e-6)
    assert np.linalg.norm(image.point - expected) < 1e-3 * moved.diagonal


@pytest.mark.slow
@pytest.mark.parametrize("name", thorough(("random polygon with a hole",), RANDOM))
def test_the_barycentroid_is_insensitive_to_noise_on_the_boundary(name, rng):
    """Figure 12: "the barycentroid is insensitive to noise". 0.3 % of the diagonal moves it by 5 %."""
    body = shape(name)
    noise = 3e-3 * body.diagonal * rng.standard_normal(body.vertices.shape).clip(-2, 2)
    plain, noisy = InteriorDistance(body), InteriorDistance(with_vertices(body, body.vertices + noise))
    moved = np.linalg.norm(plain.barycentroid().point - noisy.barycentroid().point)
    assert moved < 0.05 * body.diagonal
    assert plain.potential(inside(body, rng, 200)).max() > 2 * plain.barycentroid().potential
