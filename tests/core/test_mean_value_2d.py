"""Mean value coordinates of polygons: a slow twin, the boundary's neighbourhood, and corners."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.core import shapes
from tests.core.coordinate_bodies import inner_points, normals, on_elements

from idviewer.core import Polygon
from idviewer.core.coordinates.mean_value import mean_value_weights

OUTLINES = shapes.outlines()


@pytest.fixture(params=OUTLINES, ids=lambda name: name.replace(" ", "-"))
def outline(request: pytest.FixtureRequest) -> Polygon:
    return OUTLINES[request.param]


def twin(outline: Polygon, point: np.ndarray) -> np.ndarray:
    """Hormann and Floater 2006, the way it is written: angles, their tangents, one edge at a time."""
    result = np.zeros(len(outline.vertices))
    for i, j in outline.edges:
        a, b = outline.vertices[i] - point, outline.vertices[j] - point
        angle = math.atan2(a[0] * b[1] - a[1] * b[0], a @ b)
        result[i] += math.tan(angle / 2) / np.linalg.norm(a)
        result[j] += math.tan(angle / 2) / np.linalg.norm(b)
    return result / result.sum()


def test_weights_are_those_of_the_slow_twin(outline, rng):
    points = inner_points(outline, rng)
    expected = [twin(outline, point) for point in points]
    np.testing.assert_allclose(mean_value_weights(outline, points), expected, atol=1e-11)


def test_in_a_triangle_they_are_the_barycentric_coordinates(rng):
    shares = rng.dirichlet(np.ones(3), 50)
    triangle = OUTLINES["triangle"]
    np.testing.assert_allclose(mean_value_weights(triangle, shares @ triangle.vertices), shares, atol=1e-13)


def test_in_the_centre_of_a_regular_polygon_all_are_equal():
    weights = mean_value_weights(Polygon(shapes.star(9, 0.0)), np.zeros((1, 2)))
    np.testing.assert_allclose(weights, 1 / 9, atol=1e-15)


def test_inside_a_convex_polygon_they_are_positive(rng):
    assert mean_value_weights(OUTLINES["heptagon"], inner_points(OUTLINES["heptagon"], rng)).min() > 0


@pytest.mark.one_is_quick
@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("share", [0.5, 0.1, 0.999])
def test_just_inside_they_are_still_right_and_tend_to_the_linear_ones(outline, depth, share):
    on, linear = on_elements(outline, np.array([1 - share, share]))
    height = depth * np.ptp(outline.vertices, axis=0).min()
    points = on + height * normals(outline)
    weights = mean_value_weights(outline, points)
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-12)
    np.testing.assert_allclose(weights @ outline.vertices, points, atol=1e-13 * outline.diagonal)
    # A few times the depth as a share of the distance to the nearer end, or to the other side.
    lengths = np.linalg.norm(np.diff(outline.vertices[outline.edges], axis=1)[:, 0], axis=1)
    room = np.minimum(lengths, np.ptp(outline.vertices, axis=0).min())
    limit = 20 * height / (room * min(share, 1 - share))
    near = limit < 0.1
    difference = np.abs(weights - linear).max(axis=1)
    assert (difference <= limit + 1e-11)[near].all()


def test_beyond_an_edge_in_its_line_nothing_happens():
    """On the line of the inner edges of the L, where an angle changes its sign."""
    ell = OUTLINES["L"]
    for tilt in (0.0, 1e-15, 1e-12, 1e-9, 1e-6):
        points = np.array([[0.4, 1.0 + tilt], [1.0 + tilt, 0.3]])
        weights = mean_value_weights(ell, points)
        np.testing.assert_allclose(weights @ ell.vertices, points, atol=1e-14)
        exact = mean_value_weights(ell, np.array([[0.4, 1.0], [1.0, 0.3]]))
        np.testing.assert_allclose(weights, exact, atol=5 * tilt + 1e-13)
