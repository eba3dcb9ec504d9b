"""Cutting polygons with holes into triangles."""

from __future__ import annotations

import manifold3d
import numpy as np
import pytest

from idviewer.core._kernels.geometry.ears import cut_ears

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])


def cut(*loops: np.ndarray) -> tuple[np.ndarray, np.ndarray | None]:
    points = np.concatenate([np.asarray(loop, dtype=np.float64) for loop in loops])
    return points, cut_ears(points, np.cumsum([0, *map(len, loops)]))


def areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def star(count: int, wiggles: int, rng: np.random.Generator) -> np.ndarray:
    angle = np.arange(count) / count * 2 * np.pi
    radius = 1 + 0.4 * np.cos(wiggles * angle) + 0.1 * rng.uniform(size=count)
    return (radius * np.array([np.cos(angle), np.sin(angle)])).T


def boundary(triangles: np.ndarray) -> set[tuple[int, int]]:
    sides = set(
        map(tuple, np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2).tolist())
    )
    return {(a, b) for a, b in sides if (b, a) not in sides}


@pytest.mark.parametrize("count", [3, 4, 10, 100, 1000])
@pytest.mark.parametrize("wiggles", [0, 3, 9])
def test_triangles_cover_a_star_with_holes_once(count, wiggles, rng):
    """Triangles wound alike whose sides cancel up to the loops cover the region once."""
    outer = star(count, wiggles, rng)
    holes = [0.02 * star(8, 2, rng)[::-1] + [0.05 * i, 0.03 * (i % 3)] for i in (-2, -1, 0, 1, 2)]
    loops = [outer, *holes] if count > 20 else [outer]
    points, triangles = cut(*loops)
    assert triangles is not None
    assert areas(points, triangles).min() >= 0
    theirs = manifold3d.triangulate(loops)
    assert len(triangles) == len(theirs) == len(points) - 2 + (2 * len(holes) if count > 20 else 0)
    assert areas(points, triangles).sum() == pytest.approx(areas(points, np.asarray(theirs)).sum(), rel=1e-12)
    assert boundary(triangles) == boundary(np.asarray(theirs))


def test_holes_that_touch_in_corners_and_stand_on_one_line():
    # In eighths, which add without rounding.
    at = np.array([(1, 1), (2, 2), (3, 1), (4, 4), (6, 4), (1, 4), (3, 3)]) / 8
    points, triangles = cut(SQUARE, *(SQUARE[::-1] / 8 + corner for corner in at))
    assert triangles is not None
    assert areas(points, triangles).min() >= 0
    assert areas(points, triangles).sum() == 1 - len(at) / 64


def test_islands_in_holes():
    loops = [
        SQUARE,
        SQUARE[::-1] * 0.8 + 0.1,
        SQUARE * 0.6 + 0.2,
        SQUARE[::-1] * 0.4 + 0.3,
        SQUARE + np.array([2, 0]),
    ]
    points, triangles = cut(*loops)
    assert triangles is not None
    assert areas(points, triangles).min() >= 0
    assert areas(points, triangles).sum() == pytest.approx(1 - 0.64 + 0.36 - 0.16 + 1)


def test_points_on_straight_sides_stay():
    points, triangles = cut([[0, 0], [0.25, 0], [0.5, 0], [1, 0], [1, 1], [0, 1], [0, 0.5]])
    assert triangles is not None
    assert len(triangles) == 5
    assert areas(points, triangles).sum() == pytest.approx(1)


def test_what_cannot_be_cut_says_so():
    assert cut(SQUARE[::-1])[1] is None
    assert cut([[0, 0], [1, 1], [1, 0], [0, 1.5]])[1] is None
