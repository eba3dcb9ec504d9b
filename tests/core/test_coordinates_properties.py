"""Every kind of coordinates has exactly the properties that it states, in the plane and in space."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.coordinate_bodies import CONCAVE, SHAPES, Body, clearance, inner_points, on_elements, windings

from idviewer.core import COORDINATES, Euclidean, InteriorDistance, Property
from idviewer.core.coordinates import coordinates_of
from idviewer.core.steps import finish

SHARES = {
    2: [(0.5, 0.5), (1e-9, 1 - 1e-9), (0.2, 0.8)],
    3: [(0.2, 0.3, 0.5), (0.5, 0.5, 0.0), (1e-9, 1 - 1e-9, 0.0)],
}


@pytest.fixture(params=SHAPES, ids=lambda name: name.replace(" ", "-"))
def body(request: pytest.FixtureRequest) -> Body:
    return SHAPES[request.param]


def stating(*properties: Property) -> pytest.MarkDecorator:
    names = [name for name, kind in COORDINATES.items() if kind.properties.issuperset(properties)]
    return pytest.mark.parametrize("name", names)


def weights_inside(body: Body, name: str, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    points = inner_points(body, rng)
    return points, coordinates_of(body, name).weights(points)


@pytest.mark.one_is_quick
@stating(Property.PARTITION_OF_UNITY)
def test_they_add_up_to_one(body, name, rng):
    _, weights = weights_inside(body, name, rng)
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-12)


@pytest.mark.one_is_quick
@stating(Property.LINEAR_PRECISION)
def test_they_reproduce_linear_functions(body, name, rng):
    points, weights = weights_inside(body, name, rng)
    np.testing.assert_allclose(weights @ body.vertices, points, rtol=0, atol=1e-10 * body.diagonal)


@pytest.mark.one_is_quick
@stating(Property.LAGRANGE)
def test_each_is_one_at_its_vertex_and_zero_at_the_others(body, name):
    weights = coordinates_of(body, name).weights(body.vertices)
    np.testing.assert_allclose(weights, np.eye(len(body.vertices)), atol=1e-12)


@pytest.mark.one_is_quick
@stating(Property.NON_NEGATIVITY)
def test_none_is_negative_not_even_by_rounding(body, name, rng):
    points = np.concatenate([inner_points(body, rng), body.vertices])
    kind = coordinates_of(body, name)
    assert kind.weights(points).min() >= 0
    assert (finish(kind.negativity_steps(points)) == 0).all()


@pytest.mark.one_is_quick
@stating(Property.SMOOTHNESS)
def test_second_differences_along_lines_converge(body, name, rng):
    points = inner_points(body, rng, 25)
    reach = clearance(body, points)[:, None]
    heading = rng.standard_normal(points.shape)
    heading *= 0.05 * reach / np.linalg.norm(heading, axis=1, keepdims=True)
    kind = coordinates_of(body, name)

    def second(step: float) -> np.ndarray:
        """In units of the point's distance from the boundary, the scale on which the weights vary."""
        ahead, here, behind = (kind.weights(points + side * step * heading) for side in (1, 0, -1))
        return (ahead - 2 * here + behind) / (0.05 * step) ** 2

    coarse, fine = second(1.0), second(0.5)
    # A kink would double them; they have to settle quadratically.
    assert np.abs(coarse - fine).max() <= 0.02 * max(1.0, np.abs(fine).max())


def sums_missed(body: Body, name: str, rng: np.random.Generator) -> float:
    return float(np.abs(weights_inside(body, name, rng)[1].sum(axis=1) - 1).max())


def linear_functions_missed(body: Body, name: str, rng: np.random.Generator) -> float:
    """As a share of the diagonal."""
    points, weights = weights_inside(body, name, rng)
    return float(np.abs(weights @ body.vertices - points).max()) / body.diagonal


def vertices_missed(body: Body, name: str, rng: np.random.Generator) -> float:
    return float(np.abs(coordinates_of(body, name).weights(body.vertices) - np.eye(len(body.vertices))).max())


def negative(body: Body, name: str, rng: np.random.Generator) -> float:
    return -float(weights_inside(body, name, rng)[1].min())


def kinks(body: Body, name: str, rng: np.random.Generator) -> float:
    """How much of the largest second difference along a segment inside is left at half the step; the median.

    A quarter where the weights are smooth, a half at a kink, all of it at a jump.
    """
    points = inner_points(body, rng, 80)
    starts, headings = points[:40], points[40:] - points[:40]
    largest = []
    for count in (151, 301):
        shares = np.linspace(0.25, 0.75, count)
        along = starts[:, None] + shares[:, None] * headings[:, None]
        weights = coordinates_of(body, name).weights(along.reshape(-1, body.dimension))
        second = np.abs(np.diff(weights.reshape(40, count, -1), n=2, axis=1)).max(axis=(1, 2))
        largest.append(np.nan_to_num(second, nan=0.0))  # it leaves the shape
    inside = (largest[0] > 0.0) & (largest[1] > 0.0)
    return float(np.median(largest[1][inside] / largest[0][inside]))


VIOLATIONS = {
    Property.PARTITION_OF_UNITY: (sums_missed, 1e-3),
    Property.LINEAR_PRECISION: (linear_functions_missed, 1e-3),
    Property.LAGRANGE: (vertices_missed, 1e-3),
    Property.NON_NEGATIVITY: (negative, 5e-4),
    Property.SMOOTHNESS: (kinks, 0.4),
}
"""By how much a kind that lacks the property misses it, and by how much at least in each concave shape."""
LACKED = [
    (name, each) for name, kind in COORDINATES.items() for each in Property if each not in kind.properties
]


@pytest.mark.one_is_quick
@pytest.mark.parametrize(("name", "lacked"), LACKED, ids=lambda one: getattr(one, "name", one))
@pytest.mark.parametrize("shape", CONCAVE)
def test_what_a_kind_does_not_state_it_lacks(name, lacked, shape, rng):
    violation, least = VIOLATIONS[lacked]
    assert violation(SHAPES[shape], name, rng) > least


STATED = [(name, each) for name, kind in COORDINATES.items() for each in Property if each in kind.properties]


@pytest.mark.parametrize(("name", "stated"), STATED, ids=lambda one: getattr(one, "name", one))
def test_by_the_same_measures_a_kind_has_what_it_states(name, stated, rng):
    violation, least = VIOLATIONS[stated]
    assert violation(SHAPES["star"], name, rng) < 0.7 * least


@pytest.mark.one_is_quick
@pytest.mark.parametrize("name", COORDINATES)
@pytest.mark.parametrize("shape", ["star", "torus"])
def test_negativity_is_the_sum_of_the_negative_weights(name, shape, rng):
    body = SHAPES[shape]
    points, weights = weights_inside(body, name, rng)
    found = InteriorDistance(body, Euclidean(), name).coordinates.negativity(points)
    np.testing.assert_allclose(found, np.where(weights < 0, -weights, 0).sum(axis=1), atol=1e-13)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("name", COORDINATES)
def test_on_edges_and_faces_they_are_linear_where_they_say_so(body, name):
    kind, missed = coordinates_of(body, name), 0.0
    for shares in SHARES[body.dimension]:
        points, expected = on_elements(body, np.array(shares))
        found = kind.weights(points)
        assert np.isfinite(found).all()
        missed = max(missed, np.abs(found - expected).max())
    assert (missed < 1e-12) == kind.linear_on_boundary


@pytest.mark.one_is_quick
@pytest.mark.parametrize("name", COORDINATES)
def test_points_outside_give_nan_and_points_inside_do_not(body, name, rng):
    margin = 0.2 * (body.bounds[1] - body.bounds[0])
    points = rng.uniform(body.bounds[0] - margin, body.bounds[1] + margin, size=(300, body.dimension))
    weights = coordinates_of(body, name).weights(points)
    np.testing.assert_array_equal(np.isnan(weights).all(axis=1), windings(body, points) < 0.5)
    np.testing.assert_array_equal(np.isnan(weights).any(axis=1), windings(body, points) < 0.5)
