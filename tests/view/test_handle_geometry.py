"""The plane handle's geometry, without a window: what is where, and what dragging does."""

from __future__ import annotations

import numpy as np
import pytest
from tests.view.test_camera import UP, projection, some_pose

from idviewer.core import Plane
from idviewer.view.camera import Pose, unit, upright
from idviewer.view.handle_geometry import ARROW_HALF_LENGTH, RING_RADIUS_PX, Handle, Part

FAR = 100.0


def handle(normal: object, pose: Pose, scale: float = 1.0) -> Handle:
    plane = Plane(tuple(pose.focal), tuple(unit(normal)))  # type: ignore[arg-type]
    return Handle(plane, projection(pose, scale=scale), pose.position, pose.up)


@pytest.fixture
def pose() -> Pose:
    """Looks at the origin from z; x is to the right, y upwards."""
    return Pose(np.array([0.0, 0.0, 5.0]), np.zeros(3), UP)


@pytest.mark.parametrize("scale", [1.0, 2.0])
@pytest.mark.parametrize("distance", [0.5, 3.0, 40.0])
def test_it_keeps_its_size_on_the_screen(rng: np.random.Generator, distance: float, scale: float) -> None:
    back = unit(rng.normal(size=3))
    pose = Pose(distance * back, np.zeros(3), upright(-back, UP))
    there = handle(back, pose, scale)
    ring = there.projection.project(there.ring)
    middle = there.projection.project([there.origin])[0]
    np.testing.assert_allclose(np.linalg.norm(ring - middle, axis=1), RING_RADIUS_PX, rtol=1e-6)


def test_its_parts_are_found_where_they_are_drawn(rng: np.random.Generator) -> None:
    for _ in range(20):
        pose = some_pose(rng)
        there = handle(rng.normal(size=3), pose)
        if there.foreshortened:
            continue
        tip = there.projection.project(there.arrow)[1]
        middle = there.projection.project([there.origin])[0]
        assert there.part_at(*tip) is Part.PUSH
        assert there.part_at(*middle) is Part.MOVE
        assert there.part_at(*(middle + FAR)) is None
        away = np.argmax(np.linalg.norm(there.projection.project(there.ring) - middle, axis=1))
        assert there.part_at(*there.projection.project(there.ring)[away]) is Part.TURN


def test_an_arrow_towards_the_eye_makes_room_for_the_middle(pose: Pose) -> None:
    there = handle([0.05, 0, 1], pose)
    assert there.foreshortened
    assert there.part_at(*there.projection.project([there.origin])[0]) is Part.MOVE
    assert there.part_at(*there.projection.project(there.arrow)[1]) is not Part.PUSH


def test_pushing_follows_the_mouse_along_the_normal(rng: np.random.Generator) -> None:
    for _ in range(20):
        there = handle(rng.normal(size=3), some_pose(rng))
        if there.foreshortened:
            continue
        grip = there.origin + 0.8 * ARROW_HALF_LENGTH * there.radius * there.normal
        goal = grip + 0.1 * there.normal
        (x, y), (to_x, to_y) = there.projection.project([grip, goal])
        moved = there.grab(Part.PUSH, x, y)(to_x, to_y)
        np.testing.assert_allclose(moved.origin, there.origin + 0.1 * there.normal, atol=1e-9)
        assert moved.normal == there.plane.normal


def test_moving_keeps_the_plane_and_follows_the_mouse(rng: np.random.Generator) -> None:
    for _ in range(20):
        there = handle(rng.normal(size=3), some_pose(rng))
        if abs(there.sight[2] @ there.normal) < 0.3:
            continue
        goal = there.origin + [0.05, -0.08] @ there.plane.basis
        (x, y), (to_x, to_y) = there.projection.project([there.origin, goal])
        moved = there.grab(Part.MOVE, x, y)(to_x, to_y)
        np.testing.assert_allclose(moved.origin, goal, atol=1e-9)
        assert abs(there.plane.height([moved.origin])[0]) < 1e-12


def test_moving_an_edge_on_plane_does_not_lose_it(pose: Pose) -> None:
    there = handle([1, 0, 1e-3], pose)
    x, y = there.projection.project([there.origin])[0]
    moved = there.grab(Part.MOVE, x, y)(x + 30, y - 40)
    assert abs(there.plane.height([moved.origin])[0]) < 1e-9
    assert np.linalg.norm(moved.origin) < 1.0


def test_turning_at_the_rim_rolls_the_plane_in_the_screen(pose: Pose) -> None:
    there = handle([0, 1, 0], pose)  # the ring is a line from left to right
    right = there.projection.project(there.ring)[:, 0].argmax()
    x, y = there.projection.project(there.ring)[right]
    turned = there.grab(Part.TURN, x, y)(x, y - 20)
    assert turned.origin == there.plane.origin
    assert turned.normal[0] < 0  # the right end went up
    assert np.arccos(turned.normal[1]) == pytest.approx(np.arctan(20 / RING_RADIUS_PX), abs=0.1)


def test_turning_is_smooth_and_can_go_all_the_way_round(pose: Pose) -> None:
    there = handle([0, 0, 1], pose)
    right = there.projection.project(there.ring)[:, 0].argmax()
    x, y = there.projection.project(there.ring)[right]
    drag = there.grab(Part.TURN, x, y)
    normals = np.array([drag(x - step, y).normal for step in range(round(2 * RING_RADIUS_PX))])
    steps = np.arccos(np.clip((normals[1:] * normals[:-1]).sum(1), -1, 1))
    assert steps.max() < 1.1 * np.pi / 2 / RING_RADIUS_PX
    np.testing.assert_allclose(drag(x - 2 * RING_RADIUS_PX, y).normal, [0, 0, -1], atol=0.05)
    assert drag(x, y).normal == pytest.approx(there.plane.normal)


def test_the_far_side_of_the_ring_goes_with_the_mouse_too(pose: Pose) -> None:
    there = handle(unit([0.0, 1.0, 0.6]), pose)
    ring = there.projection.project(there.ring)
    for index in range(0, 72, 6):
        x, y = ring[index]
        turned = there.grab(Part.TURN, x, y)(x + 3, y + 2)
        grabbed = there.ring[index] - there.origin
        axis = np.cross(there.normal, turned.normal)
        # What was grabbed moves with the plane: apply the same least rotation to it.
        angle = np.arctan2(np.linalg.norm(axis), there.normal @ turned.normal)
        assert angle < 0.2
        way = np.cross(unit(axis), grabbed) * angle
        shown = there.projection.project([there.ring[index], there.ring[index] + way])
        if abs(unit(grabbed)[2]) < 0.9:
            assert (shown[1] - shown[0]) @ [3, 2] > -1e-6


def test_shift_snaps_to_the_nearest_axis_or_diagonal(rng: np.random.Generator) -> None:
    there = handle(rng.normal(size=3), some_pose(rng))
    x, y = there.projection.project(there.ring)[10]
    drag = there.grab(Part.TURN, x, y)
    for dx, dy in rng.normal(scale=30, size=(10, 2)):
        snapped, free = drag(x + dx, y + dy, True).normal, drag(x + dx, y + dy).normal
        shares = np.abs(snapped) / np.max(np.abs(snapped))
        assert all(share == pytest.approx(0, abs=1e-12) or share == pytest.approx(1) for share in shares)
        assert np.dot(snapped, free) > 0.85
