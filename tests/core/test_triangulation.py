"""Triangulating polygons with holes: what the band of a slice asks of the library that does it."""

from __future__ import annotations

import numpy as np
import pytest

from idviewer.core.slices.triangulation import triangulate_polygons

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
ROUNDING = 1e-15
"""Areas that are 0 may come out as little below, in the unit square."""


def cut(*loops: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    arrays = [np.asarray(loop, dtype=np.float64) for loop in loops]
    return np.concatenate(arrays), triangulate_polygons(arrays)


def areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def area_within(*loops: np.ndarray) -> float:
    sides = [(np.asarray(loop, dtype=np.float64), np.roll(loop, -1, axis=0)) for loop in loops]
    return sum(0.5 * float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()) for a, b in sides)


def star(count: int, wiggles: int, rng: np.random.Generator) -> np.ndarray:
    angle = np.arange(count) / count * 2 * np.pi
    radius = 1 + 0.4 * np.cos(wiggles * angle) + 0.1 * rng.uniform(size=count)
    return (radius * np.array([np.cos(angle), np.sin(angle)])).T


def boundary(triangles: np.ndarray) -> set[tuple[int, int]]:
    sides = set(
        map(tuple, np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2).tolist())
    )
    return {(a, b) for a, b in sides if (b, a) not in sides}


def sides_of(*loops: np.ndarray) -> set[tuple[int, int]]:
    ends = np.cumsum([len(loop) for loop in loops])
    numbers = [np.arange(end - len(loop), end) for loop, end in zip(loops, ends, strict=True)]
    return {side for own in numbers for side in zip(own.tolist(), np.roll(own, -1).tolist(), strict=True)}


@pytest.mark.parametrize("count", [3, 4, 10, 100, 1000])
@pytest.mark.parametrize("wiggles", [0, 3, 9])
def test_triangles_cover_a_star_with_holes_once(count, wiggles, rng):
    """Triangles wound alike whose sides cancel up to the loops cover the region once."""
    outer = star(count, wiggles, rng)
    holes = [0.02 * star(8, 2, rng)[::-1] + [0.05 * i, 0.03 * (i % 3)] for i in (-2, -1, 0, 1, 2)]
    loops = [outer, *holes] if count > 20 else [outer]
    points, triangles = cut(*loops)
    assert areas(points, triangles).min() >= -ROUNDING
    assert len(triangles) == len(points) - 2 + (2 * len(holes) if count > 20 else 0)
    assert areas(points, triangles).sum() == pytest.approx(area_within(*loops), rel=1e-12)
    assert boundary(triangles) == sides_of(*loops)


def test_holes_that_touch_in_corners_and_stand_on_one_line():
    # In eighths, which add without rounding.
    at = np.array([(1, 1), (2, 2), (3, 1), (4, 4), (6, 4), (1, 4), (3, 3)]) / 8
    points, triangles = cut(SQUARE, *(SQUARE[::-1] / 8 + corner for corner in at))
    assert areas(points, triangles).min() >= 0
    assert areas(points, triangles).sum() == 1 - len(at) / 64


@pytest.mark.parametrize(
    "hole", [[[0.5, 0], [0.25, 0.5], [0.75, 0.5]], [[0.25, 0], [0.25, 0.5], [0.75, 0.5], [0.75, 0]]]
)
def test_holes_that_touch_the_outline(hole):
    points, triangles = cut(SQUARE, np.array(hole))
    assert areas(points, triangles).min() >= 0
    assert areas(points, triangles).sum() == area_within(SQUARE, np.array(hole))
    assert boundary(triangles) == sides_of(SQUARE, np.array(hole))


def test_islands_in_holes():
    loops = [
        SQUARE,
        SQUARE[::-1] * 0.8 + 0.1,
        SQUARE * 0.6 + 0.2,
        SQUARE[::-1] * 0.4 + 0.3,
        SQUARE + np.array([2, 0]),
    ]
    points, triangles = cut(*loops)
    assert areas(points, triangles).min() >= 0
    assert areas(points, triangles).sum() == pytest.approx(1 - 0.64 + 0.36 - 0.16 + 1)


def test_points_on_straight_sides_stay():
    points, triangles = cut([[0, 0], [0.25, 0], [0.5, 0], [1, 0], [1, 1], [0, 1], [0, 0.5]])
    assert len(triangles) == 5
    assert set(triangles.ravel().tolist()) == set(range(7))
    assert areas(points, triangles).sum() == pytest.approx(1)


def test_repeated_points_stay():
    loop = [[0, 0], [0.25, 0], [0.25, 0], [1, 0], [1, 1], [1, 1], [1, 1], [0, 1]]
    points, triangles = cut(loop)
    assert len(triangles) == 6
    assert areas(points, triangles).min() >= 0
    assert areas(points, triangles).sum() == 1
    assert boundary(triangles) == sides_of(loop)


def test_loops_that_cross_themselves_give_triangles_all_the_same():
    loop = [[0, 0], [1, 1], [1, 0], [0, 1.5]]
    points, triangles = cut(loop)
    assert areas(points, triangles).sum() == pytest.approx(area_within(np.array(loop)))
    assert boundary(triangles) == sides_of(loop)


def test_many_points(rng):
    loop = star(50_000, 9, rng)
    points, triangles = cut(loop)
    assert len(triangles) == len(points) - 2
    assert areas(points, triangles).min() >= -ROUNDING
    assert areas(points, triangles).sum() == pytest.approx(area_within(loop), rel=1e-9)
