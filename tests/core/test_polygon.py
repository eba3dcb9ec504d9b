"""Polygons: what is refused and in which words, and what the accepted ones know of themselves."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.core.outlines import SQUARE, circle, flower, regular, staircase, with_holes

from idviewer.core import Polygon, PolygonError, ShapeError
from idviewer.core._polygon_crossings import crossing, turns

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
        polygon.wires,
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


# --- moving vertices ---


def test_moved_vertices_are_checked_like_new_ones(rng):
    """Random drags of one vertex: accepted or refused exactly as the constructor does."""
    polygon, refused = flower(60), 0
    for _ in range(300):
        vertices = polygon.vertices.copy()
        vertices[rng.integers(60)] += rng.normal(scale=0.4, size=2)
        expected = answer(lambda: Polygon(vertices, name="flower"))  # noqa: B023
        assert answer(lambda: polygon.with_vertices(vertices)) == expected  # noqa: B023
        refused += expected is not None
    assert 50 < refused < 280


def test_moved_onto_others_or_turned_inside_out():
    square = Polygon(SQUARE, name="square")
    with pytest.raises(PolygonError, match=r"^square: vertex 0 .* is repeated as vertex 2"):
        square.with_vertices([[1, 1], [1, 0], [1, 1], [0, 1]])
    with pytest.raises(PolygonError, match="4 vertices are to be moved, and 3 are given"):
        square.with_vertices(SQUARE[:3])
    with pytest.raises(PolygonError, match="not finite"):
        square.with_vertices(SQUARE * np.nan)
    mirrored = square.with_vertices(SQUARE * [-1, 1])
    assert mirrored.area == 1.0
    assert (mirrored.name, mirrored.loops[0].tolist()) == ("square", [0, 3, 2, 1])
    folded = regular(40)
    vertices = folded.vertices.copy()
    vertices[3] = 2 * vertices[1] - vertices[2]
    with pytest.raises(PolygonError, match=r"turns back|crosses"):
        folded.with_vertices(vertices)


def test_a_hole_dragged_out_is_refused():
    plate = with_holes()
    with pytest.raises(PolygonError, match="outside the outer loop"):
        plate.with_vertices(
            np.where(np.isin(np.arange(96), plate.loops[1])[:, None], 5.0, 0.0) + plate.vertices
        )


def answer(make) -> str | None:
    try:
        make()
    except PolygonError as error:
        return str(error)
    return None


# --- crossings ---


def all_crossings(vertices: np.ndarray) -> set[tuple[int, int]]:
    """Every pair of edges that meet, in rational numbers: the slow twin."""
    points = [tuple(map(Fraction, p)) for p in vertices.tolist()]
    n = len(points)

    def turn(a, b, c):
        value = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        return (value > 0) - (value < 0)

    def within(a, b, p):
        return all(min(a[k], b[k]) <= p[k] <= max(a[k], b[k]) for k in (0, 1))

    def meet(a, b, c, d):
        o = turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b)
        if o[0] * o[1] < 0 and o[2] * o[3] < 0:
            return True
        ends = ((a, b, c), (a, b, d), (c, d, a), (c, d, b))
        return any(turned == 0 and within(*end) for turned, end in zip(o, ends, strict=True))

    return {
        (i, j)
        for i in range(n)
        for j in range(i + 2, n - (i == 0))
        if meet(points[i], points[(i + 1) % n], points[j], points[(j + 1) % n])
    }


@given(st.lists(st.tuples(st.integers(0, 12), st.integers(0, 12)), min_size=4, max_size=12, unique=True))
def test_crossings_are_found_where_there_are_some(corners):
    """On a small lattice nearly everything touches, lines up or crosses."""
    vertices = np.array(corners, dtype=np.float64)
    expected = all_crossings(vertices)
    found = crossing(vertices, np.roll(np.arange(len(vertices)), -1))
    assert (found is None) == (not expected)
    assert found is None or found in expected
    for scale, shift in ((0.1, 0.3), (1e-9, 1.0)):
        moved = vertices * scale + shift
        assert (crossing(moved, np.roll(np.arange(len(vertices)), -1)) is None) == (not all_crossings(moved))


def test_long_outlines_are_checked_in_portions(monkeypatch):
    monkeypatch.setattr("idviewer.core._polygon_crossings.PAIRS", 7)
    vertices = flower(90).vertices.copy()
    followers = np.roll(np.arange(90), -1)
    assert crossing(vertices, followers) is None
    vertices[[20, 60]] = vertices[[60, 20]]
    assert crossing(vertices, followers) in all_crossings(vertices)


def test_turns_are_exact(rng):
    """Points within an ulp of a line: the sign is that of rational arithmetic."""
    first = rng.uniform(0.4, 0.6, size=(200, 2))
    second = rng.uniform(10, 20, size=(200, 2))
    third = np.nextafter(0.5 * (first + second), rng.choice([-np.inf, np.inf], size=(200, 2)))
    expected = []
    for a, b, c in zip(first.tolist(), second.tolist(), third.tolist(), strict=True):
        (ax, ay), (bx, by), (cx, cy) = (map(Fraction, p) for p in (a, b, c))
        value = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        expected.append((value > 0) - (value < 0))
    np.testing.assert_array_equal(turns(first, second, third), expected)


# --- sampling along the boundary ---


def test_a_square_is_sampled_evenly_and_exactly():
    sampled = Polygon(3 * SQUARE + 5, name="square").resampled(48)
    assert len(sampled.vertices) == 48
    np.testing.assert_allclose(sampled.lengths, 0.25, rtol=1e-12)
    assert sampled.area == pytest.approx(9.0, rel=1e-14)
    assert sampled.name == "square"
    assert all((sampled.vertices == corner).all(axis=1).any() for corner in 3 * SQUARE + 5)


def test_smooth_outlines_are_sampled_evenly():
    sampled = regular(1000).resampled(100)
    np.testing.assert_allclose(sampled.lengths, 2 * math.sin(math.pi / 100), rtol=1e-4)
    assert flower(400).resampled(133).area == pytest.approx(flower(400).area, rel=1e-2)


def test_loops_share_points_by_their_length():
    plate = with_holes().resampled(300)
    lengths = [plate.lengths[loop].sum() for loop in plate.loops]
    shares = [len(loop) / 300 for loop in plate.loops]
    np.testing.assert_allclose(shares, np.array(lengths) / sum(lengths), atol=0.03)


def test_sampling_keeps_corners_also_when_there_are_few_points():
    stairs = staircase(9)
    assert stairs.resampled(len(stairs.vertices)).area == pytest.approx(stairs.area, rel=1e-14)
    with pytest.raises(
        PolygonError, match=r"with 5 points: 5 points are too few for the 20 corners; ask for more"
    ):
        stairs.resampled(5)
    with pytest.raises(PolygonError, match="with 2 points: "):
        regular(100).resampled(2)


def test_too_coarse_a_sampling_says_so():
    angles = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    radii = 1 + 0.5 * np.cos(3 * angles)
    outer, inner = (np.stack([r * np.cos(angles), r * np.sin(angles)], axis=1) for r in (radii, 0.98 * radii))
    with pytest.raises(PolygonError, match=r"with 26 points: edge .* crosses"):
        Polygon.of_loops([outer, np.roll(inner, 14, axis=0)]).resampled(26)


# --- wires ---


def test_one_loop_has_no_wires():
    assert regular(9).wires.shape == (0, 2)


def test_wires_are_the_minimum_spanning_tree(rng):
    from scipy.sparse.csgraph import minimum_spanning_tree

    centres = [(x, y) for x in range(4) for y in range(3)]
    holes = [circle(9, rng.uniform(0.1, 0.4), centre) for centre in centres]
    plate = Polygon.of_loops([np.array([[-1, -1], [5, -1], [5, 4], [-1, 4]]), *holes])
    apart = np.zeros((len(plate.loops),) * 2)
    for i, one in enumerate(plate.loops):
        for j, other in enumerate(plate.loops[:i]):
            gaps = plate.vertices[one][:, None] - plate.vertices[other]
            apart[i, j] = np.linalg.norm(gaps, axis=2).min()
    assert plate.wires.shape == (12, 2)
    assert plate.wire_lengths.sum() == pytest.approx(minimum_spanning_tree(apart).sum(), rel=1e-12)
    reached = set(plate.loops[0].tolist())
    for near, far in plate.wires.tolist():
        assert near in reached
        assert far not in reached
        reached |= set(next(loop for loop in plate.loops if far in loop).tolist())
