"""Outlines that cross: all of them are found, also where only some vertices moved, and by exact signs."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.core.outlines import SQUARE, flower, regular, with_holes

from idviewer.core import Polygon, PolygonError
from idviewer.core.validation.polygon_crossings import crossing


@pytest.mark.slow
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


@pytest.mark.slow
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


def test_crossings_of_a_long_outline(rng):
    vertices = flower(90).vertices.copy()
    followers = np.roll(np.arange(90), -1)
    assert crossing(vertices, followers) is None
    vertices[[20, 60]] = vertices[[60, 20]]
    assert crossing(vertices, followers) == min(all_crossings(vertices))


def test_signs_are_exact(rng):
    """A vertex within an ulp of another edge: whether they cross is told as by rational arithmetic."""
    crossed = 0
    for _ in range(200):
        first, second = rng.uniform(0.4, 0.6, size=2), rng.uniform(10, 20, size=2)
        third = np.nextafter(0.5 * (first + second), rng.choice([-np.inf, np.inf], size=2))
        aside = np.array([first[1] - second[1], second[0] - first[0]])
        outline = np.array([first, second, second + aside, third, first + aside])
        expected = all_crossings(outline)
        assert crossing(outline, np.roll(np.arange(5), -1)) == min(expected, default=None)
        crossed += bool(expected)
    assert 20 < crossed < 180


@pytest.mark.parametrize(
    "hole",
    [
        [[0.5, 0.0], [0.7, 0.5], [0.3, 0.5]],
        [[0.2, 0.2], [0.8, 0.2], [0.5, 0.1], [0.5, 1.0]],
        [[0.0, 0.5], [0.5, 0.2], [1.0, 0.5], [0.5, 0.8]],
    ],
)
def test_holes_that_touch_are_refused_though_shapely_takes_them(hole):
    """A point in common is valid for shapely; two of them disconnect the interior."""
    with pytest.raises(PolygonError, match="crosses or touches edge"):
        Polygon.of_loops([SQUARE, hole])
