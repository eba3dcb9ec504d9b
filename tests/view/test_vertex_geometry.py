"""Which vertex is under the mouse, and where dragging takes it: arithmetic, without a window."""

from __future__ import annotations

import numpy as np
import pytest

from idviewer.core import Polygon
from idviewer.view.camera import VIEW_ANGLE_DEGREES, Pose, Projection, look
from idviewer.view.polygon_view import UP_2D, VIEW_DIRECTION_2D
from idviewer.view.vertex_geometry import VERTEX_GRAB_DISTANCE_PX, VertexDrag, soft_drag_weights, vertex_at

SQUARE = Polygon([[0, 0], [4, 0], [4, 4], [0, 4]])
FRAMED = Polygon.of_loops([[[0, 0], [4, 0], [4, 4], [0, 4]], [[1, 1], [2, 1], [2, 2], [1, 2]]])


def circle(count: int) -> Polygon:
    angles = 2 * np.pi * np.arange(count) / count
    return Polygon(np.column_stack([np.cos(angles), np.sin(angles)]))


def down_on(pose: Pose, width: int = 400, height: int = 300) -> Projection:
    """The parallel projection of an eye that looks straight down."""
    half = pose.half_height
    matrix = np.diag([height / width / half, 1 / half, -1.0 / pose.distance, 1.0])
    matrix[:2, 3] = -matrix[[0, 1], [0, 1]] * pose.focal[:2]
    return Projection(matrix, width, height)


@pytest.fixture
def projection() -> Projection:
    return down_on(look(VIEW_DIRECTION_2D, UP_2D, SQUARE.vertices, np.radians(VIEW_ANGLE_DEGREES), 4 / 3))


@pytest.mark.parametrize("vertex", range(4))
def test_the_vertex_under_the_mouse_is_found(projection: Projection, vertex: int) -> None:
    x, y = projection.project([[*SQUARE.vertices[vertex], 0.0]])[0]
    assert (
        vertex_at(SQUARE, projection, x + 0.6 * VERTEX_GRAB_DISTANCE_PX, y - 0.6 * VERTEX_GRAB_DISTANCE_PX)
        == vertex
    )
    assert vertex_at(SQUARE, projection, x + VERTEX_GRAB_DISTANCE_PX + 0.1, y) is None


def test_north_is_up_and_east_is_right(projection: Projection) -> None:
    low_left, low_right, _, high_left = projection.project(np.column_stack([SQUARE.vertices, np.zeros(4)]))
    assert low_right[0] > low_left[0]
    assert high_left[1] < low_left[1]


def test_a_held_vertex_follows_the_mouse_and_nothing_else_moves(projection: Projection) -> None:
    x, y = projection.project([[4.0, 4.0, 0.0]])[0]
    drag = VertexDrag.grab(SQUARE, 2, projection, x + 3, y - 2)
    moved = drag.to(projection, x + 3 + 40, y - 2 + 25)
    assert np.array_equal(moved[[0, 1, 3]], SQUARE.vertices[[0, 1, 3]])
    # It keeps its place beside the mouse.
    np.testing.assert_allclose(projection.project([[*moved[2], 0.0]])[0], [x + 40, y + 25], atol=1e-6)
    np.testing.assert_allclose(drag.to(projection, x + 3, y - 2), SQUARE.vertices, atol=1e-12)


def test_the_picture_may_be_zoomed_while_a_vertex_is_held(projection: Projection) -> None:
    x, y = projection.project([[4.0, 4.0, 0.0]])[0]
    drag = VertexDrag.grab(SQUARE, 2, projection, x, y)
    pose = look(VIEW_DIRECTION_2D, UP_2D, SQUARE.vertices, np.radians(VIEW_ANGLE_DEGREES), 4 / 3)
    nearer = down_on(Pose(pose.focal + 0.5 * (pose.position - pose.focal), pose.focal, pose.up))
    moved = drag.to(nearer, 111.0, 77.0)
    np.testing.assert_allclose(nearer.project([[*moved[2], 0.0]])[0], [111.0, 77.0], atol=1e-6)


def test_in_a_soft_drag_the_neighbours_come_along_less_and_less() -> None:
    share = soft_drag_weights(circle(100), 7, reach=0.1)
    assert share[7] == 1.0
    after, before = share[8:18], share[np.arange(6, -4, -1)]
    np.testing.assert_allclose(after, before, atol=1e-12)
    assert (np.diff(after[:9]) < 0).all()
    assert (share > 1e-9).sum() == 19
    # (1 - (s/r)^2)^2 a tenth of the reach away
    assert share[8] == pytest.approx((1 - 0.1**2) ** 2)


def test_a_soft_drag_stays_on_its_loop() -> None:
    share = soft_drag_weights(FRAMED, 5, reach=0.5)
    assert (share[:4] == 0).all()
    assert share[5] == 1.0
    np.testing.assert_allclose(share[[4, 6]], (1 - 0.5**2) ** 2)
    assert share[7] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("scale", "offset"), [(1e-9, 0.0), (1.0, 1e6), (1e9, 0.0)])
def test_any_size_and_place_will_do(scale: float, offset: float) -> None:
    polygon = Polygon(SQUARE.vertices * scale + offset)
    projection = down_on(
        look(VIEW_DIRECTION_2D, UP_2D, polygon.vertices, np.radians(VIEW_ANGLE_DEGREES), 4 / 3)
    )
    x, y = projection.project([[*polygon.vertices[2], 0.0]])[0]
    assert vertex_at(polygon, projection, x, y) == 2
    moved = VertexDrag.grab(polygon, 2, projection, x, y).to(projection, x + 30, y)
    way = moved[2] - polygon.vertices[2]
    np.testing.assert_allclose(way / projection.pixel_size([*polygon.vertices[2], 0.0]), [30, 0], atol=1e-3)
