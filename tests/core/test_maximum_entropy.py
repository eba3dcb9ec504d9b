"""Maximum entropy coordinates: they are the minimum, near the boundary too, and never silently wrong."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize
from tests.core import shapes
from tests.core.coordinate_bodies import SHAPES, Body, inner_points, normals, on_elements

from idviewer.core import Mesh, read_mesh, sample_path
from idviewer.core.coordinates.maximum_entropy import (
    ConvergenceWarning,
    MaximumEntropyCoordinates,
    MaximumEntropySettings,
)

Wide = np.longdouble
HARMLESS = [name for name in SHAPES if name not in ("thin", "slab")]


@pytest.fixture(params=SHAPES, ids=lambda name: name.replace(" ", "-"))
def body(request: pytest.FixtureRequest) -> Body:
    return SHAPES[request.param]


def log_priors(body: Body, point: np.ndarray) -> np.ndarray:
    """As docs/coordinates.md defines them, in extended precision and without any rearrangement."""
    x = body.vertices.astype(Wide) - point.astype(Wide)
    if body.dimension == 2:
        ends = x[body.edges]
        lengths = np.sqrt((ends**2).sum(axis=2)).sum(axis=1)
        rho = lengths - np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1))
        own = (body.edges[None] == np.arange(len(x))[:, None, None]).any(axis=2)
        return np.array([np.log(rho[~mine]).sum() for mine in own])
    result = np.zeros(len(x), dtype=Wide)
    for face in body.faces:
        corners = x[face]
        opposite = np.cross(np.roll(corners, -1, axis=0), np.roll(corners, -2, axis=0)) / 2
        n = np.sqrt((opposite**2).sum(axis=1))
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0]) / 2
        area = np.sqrt((normal**2).sum())
        result[face] += n * (area / n.sum()) ** 3 / (n.sum() - area) ** 2
    return np.log(result)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("shape", HARMLESS)
def test_they_are_the_weights_nearest_to_the_priors(shape, rng):
    """log(w / m) is affine in the vertices: with linear precision that is the minimum, which is unique."""
    body = SHAPES[shape]
    points = inner_points(body, rng, 8)
    weights = MaximumEntropyCoordinates(body).weights(points)
    for point, row in zip(points, weights, strict=True):
        seen = row > 1e-250
        ratio = (np.log(row[seen].astype(Wide)) - log_priors(body, point)[seen]).astype(np.float64)
        affine = np.column_stack([np.ones(seen.sum()), body.vertices[seen] - point])
        fitted = affine @ np.linalg.lstsq(affine, ratio, rcond=None)[0]
        np.testing.assert_allclose(ratio, fitted, atol=1e-7)


@pytest.mark.parametrize("shape", ["comb", "two holes", "L prism"])
def test_another_minimiser_finds_the_same(shape, rng):
    body = SHAPES[shape]
    for point in inner_points(body, rng, 5):
        x, priors = body.vertices - point, log_priors(body, point).astype(np.float64)
        priors -= priors.max()
        found = minimize(lambda y, x=x, m=priors: np.logaddexp.reduce(m - x @ y), np.zeros(body.dimension))
        expected = np.exp(priors - x @ found.x - np.logaddexp.reduce(priors - x @ found.x))
        weights = MaximumEntropyCoordinates(body).weights(point[None])[0]
        np.testing.assert_allclose(weights, expected, atol=1e-4)


def test_in_a_simplex_they_are_the_barycentric_coordinates(rng):
    for name in ("triangle", "tetrahedron"):
        simplex = SHAPES[name]
        shares = rng.dirichlet(np.ones(len(simplex.vertices)), 50)
        weights = MaximumEntropyCoordinates(simplex).weights(shares @ simplex.vertices)
        np.testing.assert_allclose(weights, shares, atol=1e-11)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("even", [True, False])
def test_near_the_boundary_every_point_converges(body, depth, even):
    shares = np.full(body.dimension, 1 / body.dimension)
    if not even:
        shares = np.array([0.999, 0.001, 0.0])[: body.dimension]
        shares[-1] = 1 - shares[:-1].sum()
    on, linear = on_elements(body, shares)
    height = depth * np.ptp(body.vertices, axis=0).min()
    points = (on + height * normals(body))[:200]
    kind = MaximumEntropyCoordinates(body)
    weights = kind.weights(points)
    kept = np.isfinite(weights[:, 0])
    assert kept.sum() >= 0.5 * len(points)  # others are on the boundary's far side
    assert kind.unconverged == 0
    assert weights[kept].min() >= 0
    np.testing.assert_allclose(weights[kept] @ body.vertices, points[kept], atol=1e-11 * body.diagonal)
    if depth <= 1e-9 and even:
        np.testing.assert_allclose(weights[kept], linear[:200][kept], atol=3e5 * depth)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("shape", ["comb", "star", "two holes", "bumpy sphere", "torus"])
def test_the_boundary_is_the_limit_at_first_order(shape):
    body = SHAPES[shape]
    on, linear = on_elements(body, np.full(body.dimension, 1 / body.dimension))
    kind, missed = MaximumEntropyCoordinates(body), []
    for depth in (1e-7, 1e-8, 1e-9):
        weights = kind.weights(on + depth * body.diagonal * normals(body))
        missed.append(np.abs(weights - linear).max())
    np.testing.assert_allclose(np.divide(missed[:-1], missed[1:]), 10, rtol=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("sample", ["hand_2k", "octopus"])
def test_on_a_fine_mesh_every_point_converges(sample, rng):
    mesh = read_mesh(sample_path(sample))
    kind = MaximumEntropyCoordinates(mesh)
    points = rng.uniform(*mesh.bounds, (4000, 3))
    weights = kind.weights(points)
    kept = np.isfinite(weights[:, 0])
    assert kind.unconverged == 0
    np.testing.assert_allclose(weights[kept] @ mesh.vertices, points[kept], atol=1e-11 * mesh.diagonal)


@pytest.mark.slow
def test_the_maximum_principle_holds(rng):
    for name in ("comb", "bumpy sphere"):
        body = SHAPES[name]
        values = rng.standard_normal(len(body.vertices))
        carried = MaximumEntropyCoordinates(body).weights(inner_points(body, rng)) @ values
        assert values.min() <= carried.min()
        assert carried.max() <= values.max()


def test_uneven_tessellation_and_poles_do_no_harm(rng):
    """A spindle with a pole of 200 faces, whose weight must not be the 200th power of anything."""
    angle = 2 * np.pi * np.arange(200) / 200
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(200)])
    i, j = np.arange(200), np.roll(np.arange(200), -1)
    faces = np.concatenate([np.column_stack([i, j, i * 0 + 200]), np.column_stack([j, i, i * 0 + 201])])
    mesh = Mesh(np.concatenate([ring, [[0, 0, 1.0], [0, 0, -1]]]), faces)
    points = inner_points(mesh, rng)
    kind = MaximumEntropyCoordinates(mesh)
    weights = kind.weights(points)
    assert kind.unconverged == 0
    np.testing.assert_allclose(weights @ mesh.vertices, points, atol=1e-11)


def test_a_mesh_s_weights_have_a_kink_on_lines_that_extend_its_edges():
    """The one exception from smoothness: the triangle of p and such an edge has the area |.|, a cone."""
    ell = Mesh(*shapes.subdivided(*shapes.l_shape()))
    kind = MaximumEntropyCoordinates(ell)
    point, heading = np.array([0.6, 1.0, 0.5]), np.array([0.0, 0.3, 1.0])

    def bend(point: np.ndarray, step: float) -> np.ndarray:
        ahead, here, behind = kind.weights(point + np.outer([step, 0, -step], heading))
        return (ahead - 2 * here + behind) / step**2

    coarse, fine = np.abs(bend(point, 2e-4)).max(), np.abs(bend(point, 1e-4)).max()
    assert 1.8 < fine / coarse < 2.2
    beside = point + np.array([0.0, -0.013, 0.017])
    np.testing.assert_allclose(bend(beside, 2e-4), bend(beside, 1e-4), atol=1e-2)


def test_points_that_do_not_converge_are_told(monkeypatch, rng):
    body = SHAPES["comb"]
    points = np.concatenate([inner_points(body, rng, 5), body.vertices[:2], body.bounds[1:] + 1])
    kind = MaximumEntropyCoordinates(body)
    monkeypatch.setattr(MaximumEntropyCoordinates, "settings", MaximumEntropySettings(largest_residual=-1.0))
    with pytest.warns(ConvergenceWarning, match="maximum entropy coordinates of 5 points not found"):
        weights = kind.weights(points)
    assert kind.unconverged == 5
    np.testing.assert_array_equal(np.isnan(weights[:, 0]), [True] * 5 + [False] * 2 + [True])
    with pytest.warns(ConvergenceWarning):
        kind.weights(points)
    assert kind.unconverged == 10
