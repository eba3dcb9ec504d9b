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
from tests.core.property_shapes import tells_points_apart

from idviewer.core import (
    COORDINATES,
    Coordinates,
    Diffusion,
    Euclidean,
    InteriorDistance,
    Property,
    gram_distance,
)
from idviewer.core.coordinates import coordinates_of, register_coordinates
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
    """How much of the largest second difference along segments inside is left at half the step.

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
    return float(largest[1].max() / largest[0].max())


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


@pytest.mark.parametrize("name", COORDINATES)
def test_by_the_same_measures_a_kind_has_what_it_states(name, rng):
    for stated in COORDINATES[name].properties:
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
    assert (found > 0).all() or not tells_points_apart(name)
    assert solver.coordinates.negativity(points).shape == (20,)


def test_the_table_is_in_the_order_of_menus():
    kinds = list(COORDINATES.values())
    assert kinds == sorted(kinds, key=lambda kind: (kind.menu_order, kind.name))
    assert list(COORDINATES) == [kind.name for kind in kinds]


def test_what_is_no_kind_of_coordinates_is_not_registered():
    class Untitled(Coordinates):
        name, menu_order, properties = "untitled", 1, frozenset(Property)

    class Loose(Coordinates):
        name, title, menu_order, properties = "loose", "Loose", 1, frozenset({"smooth"})

    class Second(Coordinates):
        name, title, menu_order, properties = "shepard", "Shepard again", 1, frozenset(Property)

    before = dict(COORDINATES)
    for kind, part in (
        (
            Untitled,
            "Untitled: coordinates have a name, a title, a menu_order and properties; .* lacks 'title'",
        ),
        (Loose, "Loose: its properties are members of Property"),
        (Second, "there are two kinds of coordinates with the name 'shepard'"),
    ):
        with pytest.raises((TypeError, ValueError), match=part):
            register_coordinates(kind)
    assert before == COORDINATES


def test_the_wrong_dimension_is_one_clear_line():
    class Flat(Coordinates):
        name, title, menu_order, dimensions = "flat", "Flat coordinates", 99, (2,)

    Flat(SHAPES["comb"])
    with pytest.raises(ValueError, match="flat coordinates work in 2D, not in 3D; choose other coordinates"):
        Flat(SHAPES["cube"])
