"""Polygons: what is refused and in which words, and what the accepted ones know of themselves."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.core.outlines import SQUARE, circle, flower, regular, staircase, with_holes

from idviewer.core import Polygon, PolygonError, ShapeError

SCALES = [(1.0, 0.0), (1e-9, 0.0), (1e6, 0.0), (1e-100, 0.0), (1e100, 0.0), (1.0, 1e6)]


@pytest.mark.parametrize(
    ("vertices", "loops", "told"),
    [
        ([[0, 0], [1, 0]], None, "needs three vertices or more, and there are 2"),
        (np.empty((0, 2)), None, "there are none"),
        ([[0, 0], [1, 0], [1, 1e-17], [0, 2e-17]], None, r"is repeated as vertex 2"),
        ([[0, 0], [1, 0], [0.5, 1e-17]], None, r"from vertex 0 \(0, 0\) on encloses no area"),
        ([[0, 0], [1, 0], [1, 0], [0, 1]], None, r"vertex 1 \(1, 0\) is repeated as vertex 2; remove"),
        ([[0, 0], [1, 0], [0, 1], [0, 0]], None, r"vertex 3 \(0, 0\) is repeated as vertex 0; remove"),
        (
            [[0, 0], [2, 0], [2, 2], [1, 1], [0, 2], [1, 1]],
            None,
            r"vertex 3 \(1, 1\) is repeated as vertex 5, so the outline touches itself; move",
        ),
        (
            [[0, 0], [1, 1], [1, 0], [0, 2]],
            None,
            r"edge 0-1 from \(0, 0\) to \(1, 1\) crosses or touches edge 2-3 from \(1, 0\) to \(0, 2\); move",
        ),
        ([[0, 0], [2, 0], [2, 2], [1, 0], [0, 2]], None, "edge 0-1 .* crosses or touches edge 2-3"),
        ([[0, 0], [2, 0], [1, 0], [1, 1]], None, r"turns back on itself at vertex 1 \(2, 0\); move it"),
        ([[0, 0], [1, 1], [2, 2]], None, "turns back on itself at vertex 2"),
        ([[0, 0], [1, np.nan], [1, 1]], None, r"vertex 1 \(1, nan\) is not finite"),
        ([[0, 0], [1, 0], [1, np.inf]], None, r"vertex 2 \(1, inf\) is not finite"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0]], None, r"must have the shape \(n, 2\), not \(3, 3\)"),
        ([0, 1, 2], None, r"must have the shape \(n, 2\), not \(3,\)"),
        ("square", None, "must be numbers"),
        ([[0, 0], [1], [2, 3]], None, "must be numbers"),
        (SQUARE, [[0, 1, 2]], "vertex 3 is in no loop"),
        (SQUARE, [[0, 1, 2, 3, 1]], "vertex 1 is in 2 places"),
        (SQUARE, [[0, 1, 2, 4]], "names vertex 4, and the vertices are 0 to 3"),
        (SQUARE, [[0, 1, 2, -1]], "names vertex -1"),
        (SQUARE, [[0, 1, 2], [3]], "loop 1 needs three vertices or more, and there is one"),
        (SQUARE, [[0.0, 1.5, 2.0]], "must be lists of vertex numbers"),
        (SQUARE, [["a", "b", "c"]], "must be lists of vertex numbers"),
    ],
)
def test_what_is_no_polygon_is_refused_in_one_line(vertices, loops, told):
    with pytest.raises(PolygonError, match=told) as caught:
        Polygon(vertices, loops)
    assert "\n" not in str(caught.value)
    with pytest.raises(ShapeError, match=r"^mine: "):
        Polygon(vertices, loops, "mine")


@pytest.mark.parametrize(
    ("loops", "told"),
    [
        (
            [circle(8), circle(5, 0.2, (3, 0))],
            r"hole from vertex 8 \(3.2, 0\) on lies outside the outer loop",
        ),
        ([circle(8), circle(8, 0.6), circle(8, 0.2)], "lies inside another, that from vertex 8"),
        ([circle(8), circle(8, 0.2, (0.9, 0))], r"edge \d+-\d+ .* crosses or touches edge"),
        ([SQUARE, 0.5 * SQUARE], r"vertex 0 \(0, 0\) is repeated as vertex 4, so the outline touches"),
        ([SQUARE, [[0.5, 0.0], [0.7, 0.5], [0.3, 0.5]]], "edge 0-1 .* crosses or touches edge"),
    ],
)
def test_holes_in_the_wrong_place_are_refused(loops, told):
    with pytest.raises(PolygonError, match=told):
        Polygon.of_loops(loops)


@pytest.mark.parametrize(("scale", "offset"), SCALES)
def test_size_and_place_do_not_matter(scale, offset):
    for polygon in (flower(80), with_holes(), staircase(12)):
        moved = Polygon(polygon.vertices * scale + offset, polygon.loops)
        assert moved.perimeter == pytest.approx(polygon.perimeter * scale, rel=1e-9)
        with pytest.raises(PolygonError, match="crosses or touches"):
            moved.with_vertices(moved.vertices[np.r_[0, 7, 2:7, 1, 8 : len(moved.vertices)]])


def test_loops_are_oriented_whatever_way_and_order_they_come_in():
    outer, hole = circle(20), circle(10, 0.3)
    for loops in ([outer, hole], [outer[::-1], hole[::-1]], [hole, outer[::-1]]):
        polygon = Polygon.of_loops(loops)
        points = [polygon.vertices[loop] for loop in polygon.loops]
        signs = [
            np.sign(np.cross(np.c_[p, 0 * p[:, 0]], np.c_[np.roll(p, -1, 0), 0 * p[:, 0]])) for p in points
        ]
        assert (signs[0][:, 2] > 0).all()
        assert (signs[1][:, 2] < 0).all()
        np.testing.assert_array_equal(np.sort(np.concatenate(polygon.loops)), np.arange(30))


def test_vertices_keep_their_numbers():
    square = Polygon(SQUARE[::-1])
    np.testing.assert_array_equal(square.vertices, SQUARE[::-1])
    np.testing.assert_array_equal(square.edges, [[0, 3], [1, 0], [2, 1], [3, 2]])


def test_the_interior_lies_left_of_every_edge():
    polygon = with_holes()
    ends = polygon.vertices[polygon.edges]
    side = ends[:, 1] - ends[:, 0]
    left = ends.mean(axis=1) + 1e-3 * np.stack([-side[:, 1], side[:, 0]], axis=1)
    assert polygon.contains(left).all()
    assert not polygon.contains(2 * ends.mean(axis=1) - left).any()


def test_areas_and_lengths_in_closed_form():
    n = 36
    polygon = Polygon.of_loops([circle(n, 2.0, (7, -3)), circle(n, 0.5, (7, -3))])
    wedge = 0.5 * n * math.sin(2 * math.pi / n)
    assert polygon.area == pytest.approx(wedge * (4 - 0.25), rel=1e-13)
    assert polygon.perimeter == pytest.approx(2 * n * math.sin(math.pi / n) * 2.5, rel=1e-13)
    np.testing.assert_allclose(polygon.bounds, [[5, -5], [9, -1]], rtol=1e-13)
    assert polygon.diagonal == pytest.approx(math.sqrt(32), rel=1e-13)


def test_a_polygon_can_not_be_changed_and_takes_copies():
    given_points = SQUARE.copy()
    polygon = Polygon(given_points)
    given_points[0] = 9.0
    np.testing.assert_array_equal(polygon.vertices, SQUARE)
    everything = (
        polygon.vertices,
        *polygon.loops,
        polygon.edges,
        polygon.lengths,
        polygon.bounds,
        polygon.bridges,
    )
    for array in everything:
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0
    assert polygon == polygon
    assert polygon != Polygon(SQUARE)


def winding(loop: np.ndarray, point: np.ndarray) -> int:
    """By angles: a slow twin of the even-odd rule."""
    to = loop - point
    angle = np.arctan2(to[:, 1], to[:, 0])
    return round(float(((np.roll(angle, -1) - angle + np.pi) % (2 * np.pi) - np.pi).sum() / (2 * np.pi)))


@pytest.mark.parametrize(
    "polygon", [flower(90), with_holes(), staircase(7)], ids=["flower", "holes", "stairs"]
)
def test_contains_is_the_winding_number(polygon, rng):
    low, high = polygon.bounds
    points = rng.uniform(low - 0.1, high + 0.1, size=(500, 2))
    expected = [sum(winding(polygon.vertices[loop], p) for loop in polygon.loops) == 1 for p in points]
    np.testing.assert_array_equal(polygon.contains(points), expected)


def test_the_boundary_is_inside(rng):
    for polygon in (flower(90), with_holes(), staircase(7)):
        for offset in (0.0, 1e6):
            moved = Polygon(polygon.vertices + offset, polygon.loops)
            share = rng.uniform(size=(len(moved.vertices), 1))
            start, end = moved.vertices[moved.edges].swapaxes(0, 1)
            assert moved.contains(moved.vertices).all()
            assert moved.contains((1 - share) * start + share * end).all()


def test_contains_wants_points_of_the_plane():
    with pytest.raises(ValueError, match=r"\(p, 2\), not \(1, 3\)"):
        regular(5).contains([[0, 0, 0]])
    assert regular(5).contains(np.empty((0, 2))).shape == (0,)
