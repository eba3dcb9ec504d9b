"""Points that rounding put just outside belong to the surface, on shapes of any size, and no others do."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize
from tests.core import shapes

from idviewer.core import (
    Euclidean,
    InteriorDistance,
    MeanValueCoordinates,
    Mesh,
    Plane,
    Polygon,
    slice_values,
)
from idviewer.core.interior import place_points
from idviewer.core.interior.point_placement import LARGEST_REACH, SURFACE_REACH
from idviewer.core.shapes.nearest_points import nearest_points

BOX = Mesh(*shapes.cube())
PLATE = Polygon.of_loops([[[0, 0], [4, 0], [4, 4], [0, 4]], [[1, 1], [2, 1], [2, 2], [1, 2]]])


def nearest_by_descent(corners: np.ndarray, point: np.ndarray) -> float:
    """The distance of a point and a triangle, by minimisation over barycentric coordinates."""
    best = min(np.linalg.norm(corners - point, axis=1))
    for start in ((1 / 3, 1 / 3), (0.5, 0.5), (0.5, 0.0), (0.0, 0.5)):
        found = minimize(
            lambda s: np.sum(
                (corners[0] + s[0] * (corners[1] - corners[0]) + s[1] * (corners[2] - corners[0]) - point)
                ** 2
            ),
            start,
            bounds=[(0, 1), (0, 1)],
            constraints={"type": "ineq", "fun": lambda s: 1 - s[0] - s[1]},
            method="SLSQP",
            options={"ftol": 1e-14},
        )
        best = min(best, np.sqrt(max(found.fun, 0.0)))
    return best


@pytest.mark.slow
def test_the_nearest_point_of_a_mesh_is_that_of_its_nearest_triangle(rng):
    mesh = Mesh(*shapes.torus(6, 4))
    points = rng.uniform(-1.6, 1.6, (6, 3))
    found = nearest_points(mesh, points, np.full(6, np.inf))
    expected = [
        min(nearest_by_descent(mesh.vertices[face], point) for face in mesh.faces) for point in points
    ]
    np.testing.assert_allclose(found.distances, expected, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(found.points - points, axis=1), found.distances, rtol=1e-12)


def test_the_nearest_point_of_a_polygon_is_shapelys(rng):
    import shapely

    points = rng.uniform(-1, 5, (50, 2))
    found = nearest_points(PLATE, points, np.full(50, np.inf))
    rings = shapely.multilinestrings(
        [np.append(PLATE.vertices[one], PLATE.vertices[one[:1]], axis=0) for one in PLATE.loops]
    )
    np.testing.assert_allclose(found.distances, shapely.distance(shapely.points(points), rings), atol=1e-12)
    near = nearest_points(PLATE, points, np.full(50, 0.3))
    assert np.array_equal(np.isfinite(near.distances), found.distances <= 0.3)
    assert np.array_equal(np.isnan(near.points[:, 0]), found.distances > 0.3)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("shift", [0.0, 1e3])
def test_points_hardly_outside_are_on_the_surface(scale, shift):
    mesh = Mesh((BOX.vertices + shift) * scale, BOX.faces)
    reach = SURFACE_REACH * mesh.diagonal / scale
    outside = np.array(
        [[0.3, 0.4, 1 + 0.9 * reach], [0.3, 0.4, 1 + 1.1 * reach], [1 + 0.5 * reach, 0.2, 0.6]]
    )
    given = (outside + shift) * scale
    placed = place_points(MeanValueCoordinates(mesh), given)
    assert (placed.moved.tolist(), placed.outside.tolist()) == ([0, 2], [1])
    expected = (np.array([[0.3, 0.4, 1.0], outside[1], [1.0, 0.2, 0.6]]) + shift) * scale
    np.testing.assert_allclose(placed.points, expected, rtol=1e-14)
    assert placed.farthest == pytest.approx(0.9 * reach * scale, rel=1e-6)
    solver = InteriorDistance(mesh, Euclidean())
    assert solver.contains(given).tolist() == [True, False, True]
    found = solver.field(mesh.centre, given) / scale
    straight = np.linalg.norm(expected - mesh.centre, axis=1) / scale
    np.testing.assert_allclose(found[[0, 2]], straight[[0, 2]], rtol=1e-9)
    assert np.isnan(found[1])


def test_rounding_widens_the_reach_up_to_a_bound():
    coordinates = MeanValueCoordinates(PLATE)
    most = LARGEST_REACH * PLATE.diagonal
    points = [[4 + 0.9e-4, 2.0], [4 + 0.9 * most, 2.0], [4 + 1.1 * most, 2.0], [1.5, 1 + 0.9e-4]]
    assert place_points(coordinates, points).outside.tolist() == [0, 1, 2, 3]
    assert place_points(coordinates, points, 1e-4).outside.tolist() == [1, 2]
    assert place_points(coordinates, points, [1.0, 1.0, 1.0, 0.0]).outside.tolist() == [2, 3]


def test_every_way_to_ask_takes_points_hardly_outside():
    solver = InteriorDistance(PLATE, Euclidean())
    inside, rim, off, hole = [1.0, 3.0], [4.0, 3.0], [4.00001, 3.0], [1.5, 1.5]
    np.testing.assert_allclose(solver.embed([off, inside]), solver.embed([rim, inside]), atol=1e-12)
    np.testing.assert_allclose(solver.potential([off]), solver.potential([rim]), atol=1e-12)
    np.testing.assert_allclose(solver.distance([off], [inside]), [3.0], atol=1e-12)
    np.testing.assert_allclose(solver.distance([inside], [off]), [3.0], atol=1e-12)
    np.testing.assert_allclose(solver.field(off, [inside, rim, hole]), [3.0, 0.0, np.nan], atol=1e-12)
    assert solver.contains([off, hole, inside, [np.nan, 0.0], [np.inf, 0.0]]).tolist() == [
        True,
        False,
        True,
        False,
        False,
    ]


def test_a_source_hardly_outside_serves_a_slice():
    solver = InteriorDistance(BOX, Euclidean())
    plane = Plane((0, 0, 0.5), (0, 0, 1))
    found = slice_values(solver, plane, source=[1.00001, 0.5, 0.5], nodes=50)
    straight = np.linalg.norm(found.points - [1.0, 0.5, 0.5], axis=1)
    np.testing.assert_allclose(found.values, straight, atol=1e-9)


def test_a_meshs_own_vertices_with_six_digits_have_distances():
    mesh = Mesh(*shapes.icosphere(2))
    mesh = Mesh(mesh.vertices * [0.07, 0.13, 0.29], mesh.faces)
    written = np.array([[float(f"{value:.6g}") for value in row] for row in mesh.vertices])
    solver = InteriorDistance(mesh, Euclidean())
    found = solver.field(mesh.centre, written)
    np.testing.assert_allclose(found, np.linalg.norm(mesh.vertices - mesh.centre, axis=1), rtol=1e-4)
