"""The camera's arithmetic, against theorems and against VTK."""

from __future__ import annotations

import numpy as np
import pytest
from vtkmodules.vtkRenderingCore import vtkCamera

from idviewer.view import camera
from idviewer.view.camera import Pose, Projection

UP = np.array([0.0, 1.0, 0.0])


def projection(
    pose: Pose, width: int = 800, height: int = 600, scale: float = 1.0, size: float = 1.0
) -> Projection:
    eye = vtkCamera()
    eye.SetPosition(*pose.position)
    eye.SetFocalPoint(*pose.focal)
    eye.SetViewUp(*pose.up)
    eye.SetClippingRange(pose.distance - 0.9 * size, pose.distance + 2 * size)
    matrix = eye.GetCompositeProjectionTransformMatrix(width / height, -1, 1)
    return Projection(np.array(matrix.GetData()).reshape(4, 4), width, height, scale)


def some_pose(rng: np.random.Generator, size: float = 1.0, centre: float = 0.0) -> Pose:
    back = camera.unit(rng.normal(size=3))
    focal = centre + size * rng.normal(size=3)
    return Pose(focal + 3 * size * back, focal, camera.upright(-back, UP))


@pytest.mark.parametrize(("size", "centre"), [(1.0, 0.0), (1e-9, 0.0), (1.0, 1e6), (1e4, 0.0)])
def test_a_ray_meets_the_point_that_is_drawn_under_it(
    rng: np.random.Generator, size: float, centre: float
) -> None:
    pose = some_pose(rng, size, centre)
    lens = projection(pose, size=size)
    points = pose.focal + 0.3 * size * rng.normal(size=(20, 3))
    for point, (x, y) in zip(points, lens.project(points), strict=True):
        ray = lens.ray(x, y)
        apart = np.linalg.norm(np.cross(point - np.array(ray.origin), ray.direction))
        assert apart < 1e-6 * size + 1e-8 * centre * 1e-4


@pytest.mark.parametrize("scale", [1.0, 1.5, 2.0])
def test_the_middle_pixel_looks_at_the_focal_point(rng: np.random.Generator, scale: float) -> None:
    pose = some_pose(rng)
    lens = projection(
        pose, 801, 601, scale
    )  # the middle of the picture is the middle of device pixel 400, 300
    ray = lens.ray(400 / scale, 300 / scale)
    np.testing.assert_allclose(ray.direction, camera.unit(pose.focal - pose.position), atol=1e-9)
    np.testing.assert_allclose(lens.project([pose.focal])[0], [400 / scale, 300 / scale], atol=1e-6)


def test_pixels_count_from_the_upper_left_corner(rng: np.random.Generator) -> None:
    pose = some_pose(rng)
    right, up, _ = pose.axes
    here, to_right, above = projection(pose).project(
        [pose.focal, pose.focal + 0.1 * right, pose.focal + 0.1 * up]
    )
    assert to_right[0] > here[0]
    assert above[1] < here[1]


def test_pixel_size_is_what_a_pixel_covers(rng: np.random.Generator) -> None:
    pose = some_pose(rng)
    lens = projection(pose, scale=1.5)
    size = lens.pixel_size(pose.focal)
    ends = lens.project([pose.focal, pose.focal + 40 * size * pose.axes[0]])
    assert ends[1, 0] - ends[0, 0] == pytest.approx(40)


def test_orbit_neither_rolls_nor_moves_what_is_looked_at(rng: np.random.Generator) -> None:
    pose = some_pose(rng)
    for yaw, pitch in rng.normal(size=(40, 2)):
        turned = camera.orbit(pose, UP, yaw, pitch)
        assert turned.distance == pytest.approx(pose.distance)
        np.testing.assert_array_equal(turned.focal, pose.focal)
        assert abs(turned.axes[0] @ UP) < 1e-9
        assert turned.up @ UP > -1e-9
        pose = turned


def test_orbit_stops_at_the_poles_and_comes_back(rng: np.random.Generator) -> None:
    pose = some_pose(rng)
    over_the_pole = camera.orbit(pose, UP, 0.0, 10.0)
    np.testing.assert_allclose(over_the_pole.axes[2], UP, atol=1e-9)
    back = camera.orbit(over_the_pole, UP, 0.0, -np.pi / 2)
    assert abs(back.axes[2] @ UP) < 1e-9
    np.testing.assert_allclose(back.axes[0], pose.axes[0], atol=1e-9)


def test_zoom_keeps_the_point_under_the_mouse(rng: np.random.Generator) -> None:
    pose = some_pose(rng)
    fixed = pose.focal + 0.2 * pose.axes[0] - 0.1 * pose.axes[1]
    before = projection(pose).project([fixed])
    nearer = camera.zoom(pose, 0.5, fixed, size=1.0)
    np.testing.assert_allclose(projection(nearer).project([fixed]), before, atol=1e-6)
    assert nearer.distance == pytest.approx(pose.distance / 2)


def test_zoom_has_bounds(rng: np.random.Generator) -> None:
    pose = some_pose(rng)
    assert camera.zoom(pose, 1e-9, pose.focal, size=1.0).distance == pytest.approx(
        camera.NEAREST_IN_DIAGONALS
    )
    assert camera.zoom(pose, 1e9, pose.focal, size=1.0).distance == pytest.approx(
        camera.FARTHEST_IN_DIAGONALS
    )


@pytest.mark.parametrize("pole", [*np.eye(3), *-np.eye(3)])
def test_axis_views_are_the_six_directions(pole: np.ndarray) -> None:
    names: tuple[camera.View, ...] = ("front", "back", "left", "right", "top", "bottom")
    ways = np.array([camera.view_direction(name, pole) for name in names])
    np.testing.assert_allclose(ways[1::2], -ways[::2])
    assert len({tuple(way) for way in ways}) == 6
    for way in ways:
        up = camera.upright(way, pole)
        assert abs(up @ way) < 1e-12
        assert np.linalg.norm(up) == pytest.approx(1)


def test_y_up_shapes_are_seen_from_the_front_with_x_to_the_right() -> None:
    direction = camera.view_direction("front", UP)
    pose = Pose(-direction, np.zeros(3), camera.upright(direction, UP))
    np.testing.assert_allclose(pose.axes, np.eye(3), atol=1e-12)


@pytest.mark.parametrize("aspect", [0.5, 1.0, 2.0])
def test_look_fits_the_points_closely(rng: np.random.Generator, aspect: float) -> None:
    points = rng.normal(size=(50, 3)) * [1, 3, 0.5] + 7
    pose = camera.look(rng.normal(size=3), UP, points, np.radians(30), aspect)
    lens = projection(pose, round(1000 * aspect), 1000, size=pose.distance)
    pixels = lens.project(points) / [1000 * aspect, 1000]
    assert pixels.min() > 0
    assert pixels.max() < 1
    assert np.ptp(pixels, axis=0).max() > 0.75
