"""Coordinates of every kind: motions and sizes that do not matter, odd points, distances, and their table."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.coordinate_bodies import SHAPES, clearance, inner_points, with_vertices
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
