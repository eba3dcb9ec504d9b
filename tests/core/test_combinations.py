"""Every distance with every kind of coordinates on a mesh, a polygon and a polygon with holes."""

from __future__ import annotations

from functools import cache, partial

import numpy as np
import pytest
from tests.core.property_shapes import BY_ALL_COORDINATES, complete, inside, shape, tells_points_apart

from idviewer.core import (
    DISTANCES,
    Coordinates,
    DistanceError,
    InteriorDistance,
    gram_distance,
    interior_distance,
    pairwise_distance,
)

SHAPES = pytest.mark.parametrize("name", ["random mesh", "random polygon", "random polygon with a hole"])


@cache
def solver_of(name: str, kind: str) -> InteriorDistance:
    """With mean value coordinates."""
    body = shape(name)
    return InteriorDistance(body, complete(kind, body.vertices))


@pytest.mark.one_is_quick
@SHAPES
@pytest.mark.parametrize("kind", DISTANCES)
@BY_ALL_COORDINATES
def test_all_go_together(name, kind, coordinates, rng):
    body = shape(name)
    solver = solver_of(name, kind).with_coordinates(coordinates)
    points = np.concatenate([inside(body, rng, 3), body.vertices[:2], body.bounds[1:] + body.diagonal])
    i, j = (axis.ravel() for axis in np.indices((6, 6)))
    for values in (
        solver.distance(points[i], points[j]),
        gram_distance(solver, points[i], points[j]),
        np.concatenate([solver.field(point, points) for point in points]),
    ):
        apart = values.reshape(6, 6)
        assert np.isnan(apart[-1]).all()
        assert np.isnan(apart[:, -1]).all()
        within = apart[:-1, :-1]
        assert np.isfinite(within).all()
        np.testing.assert_allclose(within, within.T, rtol=1e-9)
        assert np.diag(within).max() <= 1e-7 * within.max()
        if tells_points_apart(coordinates):
            assert within[~np.eye(5, dtype=bool)].min() > 1e-4 * within.max()
    assert np.isfinite(solver.embed(points[:-1])).all()
    assert np.isnan(solver.embed(points[-1:])).all()
    assert (solver.potential(points[:-1]) >= 0).all()
    for each in (solver.potential(points), solver.coordinates.negativity(points)):
        np.testing.assert_array_equal(np.isnan(each), [False] * 5 + [True])
    np.testing.assert_array_equal(solver.contains(points), [True] * 5 + [False])
    assert solver.description.startswith(solver.boundary.distance.title)


@pytest.mark.one_is_quick
@SHAPES
@pytest.mark.parametrize("kind", DISTANCES)
def test_no_points_give_no_distances(name, kind):
    body = shape(name)
    solver, none = solver_of(name, kind), np.empty((0, body.dimension))
    assert solver.distance(none, none).shape == (0,)
    assert solver.field(body.vertices[0], none).shape == (0,)
    assert solver.embed(none).shape == (0, solver.boundary.basis.shape[1])
    assert solver.potential(none).shape == (0,)
    assert solver.coordinates.negativity(none).shape == (0,)


@SHAPES
@pytest.mark.parametrize("kind", ["diffusion", "commute"])
def test_points_of_the_other_dimension_are_refused_in_one_line(name, kind):
    body = shape(name)
    solver = solver_of(name, kind)
    wrong = np.zeros((2, 5 - body.dimension))
    right = body.vertices[:2]
    for call in (
        lambda: solver.distance(wrong, right),
        lambda: solver.distance(right, wrong),
        lambda: gram_distance(solver, wrong, right),
        lambda: pairwise_distance(solver, right, wrong),
        lambda: solver.field(right[0], wrong),
        lambda: solver.field(wrong[0], right),
        lambda: solver.embed(wrong),
        lambda: solver.potential(wrong),
        lambda: solver.coordinates.negativity(wrong),
        lambda: solver.contains(wrong),
        lambda: interior_distance(body, wrong, right),
    ):
        with pytest.raises(ValueError, match=rf"must have shape \(p, {body.dimension}\), not") as error:
            call()
        assert "\n" not in str(error.value)


@SHAPES
@pytest.mark.parametrize("kind", ["diffusion", "commute"])
def test_lists_of_different_lengths_are_refused_in_one_line(name, kind):
    body = shape(name)
    solver = solver_of(name, kind)
    for call in (solver.distance, partial(gram_distance, solver), partial(pairwise_distance, solver)):
        with pytest.raises(
            ValueError, match="between 3 points and 2 points: there must be as many of both"
        ) as error:
            call(body.vertices[:3], body.vertices[:2])
        assert "\n" not in str(error.value)


def test_dimensions_that_a_kind_does_not_know_are_refused_in_one_line():
    class Flat(Coordinates):
        name, title, menu_order, dimensions = "flat", "Flat coordinates", 99, (2,)

    class Solid(DISTANCES["euclidean"]):
        name, title, dimensions = "solid", "Solid distance", (3,)

    with pytest.raises(DistanceError, match="the solid distance works in 3D, and the shape is 2D; choose"):
        InteriorDistance(shape("random polygon"), Solid())
    with pytest.raises(ValueError, match="flat coordinates work in 2D, not in 3D; choose other coordinates"):
        Flat(shape("random mesh"))
