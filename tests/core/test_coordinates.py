"""Every kind of coordinates has exactly the properties that it states, in the plane and in space."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.coordinate_bodies import (
    CONCAVE,
    SHAPES,
    Body,
    clearance,
    inner_points,
    on_elements,
    windings,
    with_vertices,
)

from idviewer.core import (
    COORDINATES,
    Coordinates,
    Diffusion,
    Euclidean,
    InteriorDistance,
    Property,
    gram_distance,
)
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


def lacking(lacked: Property) -> pytest.MarkDecorator:
    names = [name for name, kind in COORDINATES.items() if lacked not in kind.properties]
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


@pytest.mark.one_is_quick
@lacking(Property.NON_NEGATIVITY)
@pytest.mark.parametrize("shape", CONCAVE)
def test_without_that_property_some_are_negative_in_concave_shapes(name, shape, rng):
    points, weights = weights_inside(SHAPES[shape], name, rng)
    assert weights.min() < -5e-4
    negativity = InteriorDistance(SHAPES["torus"], Euclidean(), name).coordinates.negativity
    if shape == "torus":
        expected = np.where(weights < 0, -weights, 0).sum(axis=1)
        np.testing.assert_allclose(negativity(points), expected, atol=1e-13)


@pytest.mark.one_is_quick
@lacking(Property.LINEAR_PRECISION)
@pytest.mark.parametrize("shape", ["triangle", "star", "two holes", "tetrahedron", "bumpy sphere"])
def test_without_that_property_linear_functions_are_missed(name, shape, rng):
    points, weights = weights_inside(SHAPES[shape], name, rng)
    assert np.abs(weights @ SHAPES[shape].vertices - points).max() > 1e-3 * SHAPES[shape].diagonal


def test_every_property_that_some_kind_lacks_is_disproved_above():
    lacked = {each for kind in COORDINATES.values() for each in Property if each not in kind.properties}
    assert lacked == {Property.NON_NEGATIVITY, Property.LINEAR_PRECISION}


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


@pytest.mark.one_is_quick
@pytest.mark.parametrize("name", COORDINATES)
@pytest.mark.parametrize(("scale", "shift"), [(1e-9, 0.0), (1.0, 1e6), (1e-9, 1e-3), (1e6, 0.0)])
@pytest.mark.parametrize("shape", ["L", "star", "two holes", "bumpy sphere"])
def test_size_and_place_do_not_matter(name, scale, shift, shape, rng):
    body = SHAPES[shape]
    # What the move costs the input itself: a shape that is 1e6 of its sizes away has ten digits.
    rounding = np.finfo(float).eps * (1 + shift / scale)
    there = with_vertices(body, body.vertices * scale + shift)
    points = inner_points(body, rng)
    expected = coordinates_of(body, name).weights(points)
    deep = clearance(body, points) > 1e-3 * body.diagonal
    found = coordinates_of(there, name).weights(points * scale + shift)
    np.testing.assert_allclose(found[deep], expected[deep], atol=1e-10 + 1e4 * rounding)
    own = coordinates_of(there, name).weights(there.vertices)
    np.testing.assert_allclose(own, np.eye(len(own)), atol=1e-12)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("name", COORDINATES)
@pytest.mark.parametrize("shape", ["comb", "two holes", "L prism", "bumpy sphere"])
def test_rigid_motions_leave_them_alone(name, shape, rng):
    body = SHAPES[shape]
    rotation = np.linalg.qr(rng.standard_normal((body.dimension, body.dimension)))[0]
    rotation[:, 0] *= np.linalg.det(rotation)
    turned = with_vertices(body, body.vertices @ rotation + 0.3)
    points = inner_points(body, rng)
    expected = coordinates_of(body, name).weights(points)
    found = coordinates_of(turned, name).weights(points @ rotation + 0.3)
    np.testing.assert_allclose(found, expected, atol=1e-8)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("name", COORDINATES)
@pytest.mark.parametrize("shape", ["star", "bumpy sphere"])
def test_interpolation_is_the_product_with_the_weights(name, shape, rng):
    body, kind = SHAPES[shape], coordinates_of(SHAPES[shape], name)
    points = np.concatenate([inner_points(body, rng, 33), body.vertices[:2], body.bounds[1:] + 1])
    values = rng.standard_normal((len(body.vertices), 7))
    *_, last = kind.interpolate_steps(points, values)
    assert last == 1
    found = finish(kind.interpolate_steps(points, values))
    np.testing.assert_allclose(found, kind.weights(points) @ values, atol=1e-12)
    assert np.isnan(found[-1]).all()
    assert np.isnan(finish(kind.negativity_steps(points))[-1])


@pytest.mark.parametrize("name", COORDINATES)
@pytest.mark.parametrize("shape", ["comb", "cube"])
def test_odd_points(name, shape):
    kind, dimension = coordinates_of(SHAPES[shape], name), SHAPES[shape].dimension
    assert kind.weights(np.empty((0, dimension))).shape == (0, len(SHAPES[shape].vertices))
    strange = np.full((3, dimension), [[np.nan], [np.inf], [1e300]])
    assert np.isnan(kind.weights(strange)).all()
    with pytest.raises(ValueError, match=rf"shape \(p, {dimension}\), not"):
        kind.weights(np.zeros((2, 5)))


@pytest.mark.slow
@pytest.mark.parametrize("name", COORDINATES)
def test_interior_distances_of_a_mesh_work_with_all_of_them(name, rng):
    body = SHAPES["bumpy sphere"]
    solver = InteriorDistance(body, Diffusion(), name)
    points = inner_points(body, rng, 12)
    rough = InteriorDistance(body, Diffusion(), name, rtol=1e-3, spectrum=solver.spectrum)
    p, q = points[:6], points[6:]
    exact, embedded = solver.distance(p, q), solver.coordinates.weights(points) @ solver.boundary.embedding
    np.testing.assert_allclose(exact, np.linalg.norm(embedded[:6] - embedded[6:], axis=1), rtol=1e-9)
    np.testing.assert_allclose(gram_distance(solver, p, q), exact, rtol=1e-7)
    largest = np.linalg.norm(solver.boundary.embedding[:, None] - solver.boundary.embedding, axis=2).max()
    np.testing.assert_allclose(rough.distance(p, q), exact, atol=1e-3 * largest)
    if rough.coordinates.approximation(rough.boundary.basis, np.ones(rough.boundary.basis.shape[1])) is None:
        np.testing.assert_array_equal(rough.embed(points), solver.embed(points))


@pytest.mark.parametrize("name", COORDINATES)
def test_interior_distances_of_a_polygon_work_with_all_of_them(name, rng):
    body = SHAPES["two holes"]
    solver = InteriorDistance(body, Euclidean(), name, rtol=1e-3)
    points = inner_points(body, rng, 20)
    expected = np.linalg.norm(points[:10] - points[10:], axis=1)
    found = solver.distance(points[:10], points[10:])
    if Property.LINEAR_PRECISION in COORDINATES[name].properties:
        np.testing.assert_allclose(found, expected, atol=1e-10)
    assert (found > 0).all()
    assert solver.coordinates.negativity(points).shape == (20,)


def test_the_table_is_in_the_order_of_ranks():
    ranks = [kind.menu_order for kind in COORDINATES.values()]
    assert ranks == sorted(set(ranks))
    assert list(COORDINATES) == ["mean_value", "maximum_entropy", "shepard"]


def test_the_wrong_dimension_is_one_clear_line():
    class Flat(Coordinates):
        name, title, menu_order, dimensions = "flat", "Flat coordinates", 99, (2,)

    Flat(SHAPES["comb"])
    with pytest.raises(ValueError, match="flat coordinates work in 2D, not in 3D; choose other coordinates"):
        Flat(SHAPES["cube"])
