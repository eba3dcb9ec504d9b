"""The picture under real mouse events: what is hit, what is dragged, and when it draws."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from pytestqt.qtbot import QtBot
from tests.view.mouse import Mouse
from tests.view.windows import AXES, grip, pixels_of, place, show_shape, wait_until_done, write_ellipsoid

from idviewer.core import Plane
from idviewer.view.handle_geometry import Part
from idviewer.view.window import MainWindow

COMPACT = (660, 460)
"""A window that fits on the screen at twice its size too."""

pytestmark = pytest.mark.slow


@pytest.fixture
def window(qtbot: QtBot, tmp_path: Path) -> MainWindow:
    return show_shape(qtbot, write_ellipsoid(tmp_path))


def test_a_click_on_the_slice_puts_the_source_there(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    viewport, plane = window.viewport, window.session.state.query.planes[0]
    goal = np.array([0.55, 0.2, plane.origin[2]])
    mouse.click(viewport, *place(viewport, goal))
    source = np.array(window.session.state.query.source)
    assert np.linalg.norm(source - goal) < 1.5 * viewport.projection.pixel_size(goal)
    assert abs(plane.height([source])[0]) < 1e-9
    frame = wait_until_done(qtbot, window.session)
    np.testing.assert_allclose(frame.source, source)


@pytest.mark.parametrize("scale", ["1.5", "2"])
def test_picks_are_right_on_dense_screens(scale: str) -> None:
    if "IDVIEWER_PICKING" in os.environ:
        pytest.skip("this is the test that runs the one below")
    test = f"{__file__}::test_the_source_is_drawn_where_the_mouse_clicked"
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--no-xvfb", test]
    environment = {**os.environ, "QT_SCALE_FACTOR": scale, "IDVIEWER_PICKING": scale}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_the_source_is_drawn_where_the_mouse_clicked(qtbot: QtBot, mouse: Mouse, tmp_path: Path) -> None:
    window = show_shape(qtbot, write_ellipsoid(tmp_path), size=COMPACT)
    window.dock.hide()
    window.session.set(handle=False, isolines=0, scale_bar=False)
    viewport, scale = window.viewport, window.viewport.devicePixelRatioF()
    assert scale == float(os.environ.get("IDVIEWER_PICKING", 1))
    qtbot.waitUntil(lambda: viewport.width() > 600)
    x, y = place(viewport, [-0.5, 0.25, window.session.state.query.planes[0].origin[2]])
    mouse.click(viewport, x, y)
    wait_until_done(qtbot, window.session)
    source = viewport.projection.project([window.session.state.query.source])[0]
    np.testing.assert_allclose(source, [x, y], atol=0.51 / scale)  # a widget may begin half a pixel in

    def dot() -> np.ndarray:
        """Dark pixels near the click, from the click."""
        row, column, reach = round(y * scale), round(x * scale), round(12 * scale)
        near = pixels_of(window)[row - reach : row + reach + 1, column - reach : column + reach + 1]
        return (np.argwhere(near.max(axis=2) < 60) - reach)[:, ::-1] / scale

    qtbot.waitUntil(lambda: len(dot()) > 10)
    np.testing.assert_allclose(dot().mean(axis=0), [0, 0], atol=1.0)


def test_a_click_on_the_body_finds_the_surface(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    viewport = window.viewport
    window.session.set(planes=(Plane.along("x", 0.02, window.session.state.shape.bounds),))
    wait_until_done(qtbot, window.session)
    mouse.click(viewport, *place(viewport, [0.5, 0.0, 0.0]))
    source = np.array(window.session.state.query.source)
    assert np.sum((source / AXES) ** 2) == pytest.approx(1, abs=0.03)
    assert viewport.pose.axes[2] @ source > 0  # the near side


def test_shift_click_finds_the_surface_in_front_of_the_slice(mouse: Mouse, window: MainWindow) -> None:
    viewport = window.viewport
    mouse.click(viewport, *place(viewport, [-0.9, 0.1, 0.0]), keys=("shift",))
    source = np.array(window.session.state.query.source)
    assert np.sum((source / AXES) ** 2) == pytest.approx(1, abs=0.03)


def test_ctrl_click_finds_the_middle_of_the_chord(mouse: Mouse, window: MainWindow) -> None:
    viewport = window.viewport
    viewport.look_from("front")
    x, y = place(viewport, [0.3, -0.2, 0.0])
    ray = viewport.projection.ray(x, y)
    mouse.click(viewport, x, y, keys=("ctrl",))
    source = np.array(window.session.state.query.source)
    apart = np.cross(source - np.array(ray.origin), ray.direction)
    assert np.linalg.norm(apart) < 1e-9
    assert abs(source[2]) < 0.02


def test_a_click_beside_the_shape_changes_nothing(mouse: Mouse, window: MainWindow) -> None:
    before = window.session.state
    mouse.click(window.viewport, 5, 5)
    assert window.session.state == before


def test_a_drag_turns_the_camera_and_clicks_nothing(mouse: Mouse, window: MainWindow) -> None:
    viewport, before = window.viewport, window.session.state
    pose = viewport.pose
    start = place(viewport, [0.6, 0.2, 0.0])
    mouse.drag(viewport, start, (start[0] + 80, start[1] + 30))
    assert window.session.state == before
    assert viewport.pose.distance == pytest.approx(pose.distance)
    assert np.linalg.norm(viewport.pose.position - pose.position) > 0.3
    assert abs(viewport.pose.axes[0] @ [0, 1, 0]) < 1e-9  # upright


@pytest.mark.parametrize("how", [{"button": 2}, {"button": 3}, {"keys": ("shift",)}])
def test_the_shape_follows_a_panning_mouse(mouse: Mouse, window: MainWindow, how: dict) -> None:
    viewport = window.viewport
    focal = viewport.pose.focal
    before = viewport.projection.project([focal])[0]
    mouse.drag(viewport, (30, 60), (100, 90), **how)
    np.testing.assert_allclose(viewport.projection.project([focal])[0], before + np.array([70, 30]), atol=0.1)


def test_any_axis_can_point_upwards(mouse: Mouse, window: MainWindow) -> None:
    viewport = window.viewport
    ups = set()
    for _ in range(3):
        mouse.key("a")
        mouse.drag(viewport, (30, 60), (60, 75))  # upright with this axis from now on
        ups.add(int(np.argmin(np.abs(viewport.pose.axes[0]))))
        assert np.abs(viewport.pose.axes[0]).min() < 1e-9
    assert ups == {0, 1, 2}


def test_the_wheel_zooms_towards_the_mouse(mouse: Mouse, window: MainWindow) -> None:
    viewport = window.viewport
    distance, focal = viewport.pose.distance, viewport.pose.focal
    beside = focal + 0.3 * viewport.pose.axes[0]
    x, y = place(viewport, beside)
    mouse.wheel(viewport, x, y, 3)
    assert viewport.pose.distance < 0.75 * distance
    np.testing.assert_allclose(viewport.projection.project([beside])[0], [x, y], atol=1.0)
    mouse.wheel(viewport, x, y, -3)
    assert viewport.pose.distance == pytest.approx(distance)


def test_the_arrow_pushes_the_slice_live(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    viewport, session = window.viewport, window.session
    viewport.look_from("right")
    heights: list[float] = []
    session.frame_ready.connect(lambda frame: heights.append(frame.slices[0].plane.origin[2]))
    start_plane, x_y = session.state.query.planes[0], grip(viewport, Part.PUSH)
    goal = np.add(start_plane.origin, [0, 0, 0.15])
    way = np.subtract(*viewport.projection.project([goal, start_plane.origin]))
    mouse.drag(viewport, x_y, (x_y[0] + way[0], x_y[1] + way[1]), steps=12)
    frame = wait_until_done(qtbot, session)
    plane = session.state.query.planes[0]
    assert plane.origin[2] == pytest.approx(goal[2], abs=2 * viewport.projection.pixel_size(goal))
    assert frame.slices[0].plane == plane
    assert np.abs(plane.height(frame.slices[0].points)).max() < 1e-9
    assert heights == sorted(heights)
    assert len(set(heights)) > 1  # frames came while it was dragged, not only at the end


def test_the_ring_turns_the_plane_and_shift_snaps_it(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    viewport, session = window.viewport, window.session
    x, y = grip(viewport, Part.TURN)
    before = session.state.query
    mouse.drag(viewport, (x, y), (x - 15, y - 20))
    turned = session.state.query.planes[0]
    assert turned.origin == before.planes[0].origin
    assert 0.3 < np.dot(turned.normal, before.planes[0].normal) < 0.999
    assert session.state.query.source == before.source
    x, y = grip(viewport, Part.TURN)
    mouse.press(viewport, x, y)
    mouse.press_key("shift")
    mouse.move(viewport, x + 4, y + 6)
    mouse.release(keys=("shift",))
    shares = np.abs(session.state.query.planes[0].normal)
    assert np.all((shares < 1e-9) | (np.abs(shares - shares.max()) < 1e-9))
    wait_until_done(qtbot, session)


def test_the_small_ring_moves_the_handle_within_the_plane(mouse: Mouse, window: MainWindow) -> None:
    viewport, session = window.viewport, window.session
    x, y = grip(viewport, Part.MOVE)
    before = session.state.query.planes[0]
    mouse.drag(viewport, (x, y), (x + 40, y + 10))
    after = session.state.query.planes[0]
    assert after.normal == before.normal
    assert abs(before.height([after.origin])[0]) < 1e-12
    np.testing.assert_allclose(viewport.projection.project([after.origin])[0], [x + 40, y + 10], atol=1.5)


def test_the_handle_is_pointed_out_under_the_mouse(mouse: Mouse, window: MainWindow) -> None:
    viewport = window.viewport
    mouse.move(viewport, *grip(viewport, Part.TURN))
    assert viewport.cursor().shape() == Qt.CursorShape.PointingHandCursor
    mouse.move(viewport, 10, 10)
    assert viewport.cursor().shape() == Qt.CursorShape.ArrowCursor


def test_a_handle_that_leaves_a_mouse_at_rest_is_not_pointed_out(
    qtbot: QtBot, mouse: Mouse, window: MainWindow
) -> None:
    """Also where no frame follows."""
    viewport = window.viewport
    mouse.move(viewport, *grip(viewport, Part.MOVE))
    assert viewport.cursor().shape() == Qt.CursorShape.SizeAllCursor
    window.session.set(handle=False)
    qtbot.waitUntil(lambda: viewport.cursor().shape() == Qt.CursorShape.ArrowCursor)
    window.session.set(handle=True)
    qtbot.waitUntil(lambda: viewport.cursor().shape() == Qt.CursorShape.SizeAllCursor)


def test_a_hidden_handle_cannot_be_grabbed(mouse: Mouse, window: MainWindow) -> None:
    viewport, session = window.viewport, window.session
    x, y = grip(viewport, Part.TURN)
    session.set(handle=False)
    planes = session.state.query.planes
    mouse.drag(viewport, (x, y), (x + 30, y))
    assert session.state.query.planes == planes


def test_the_handle_follows_what_others_change(window: MainWindow) -> None:
    plane = Plane((0.1, 0.2, 0.05), (1.0, 0.0, 0.0))
    window.session.set(planes=(plane,))
    assert window.viewport.handle is not None
    assert window.viewport.handle.plane == plane


def test_it_draws_once_for_many_requests(qtbot: QtBot, window: MainWindow) -> None:
    draws: list[object] = []
    renderer = window.viewport._plotter.renderer
    tag = renderer.AddObserver("EndEvent", lambda *_: draws.append(None))
    try:
        qtbot.wait(50)  # what was asked for before
        draws.clear()
        for _ in range(50):
            window.viewport.request_draw()
        assert not draws
        qtbot.waitUntil(lambda: bool(draws))
        qtbot.wait(50)
        assert len(draws) == 1
    finally:
        renderer.RemoveObserver(tag)


def test_without_a_graphics_card_a_drag_is_drawn_without_smoothing(mouse: Mouse, window: MainWindow) -> None:
    viewport = window.viewport
    samples = viewport._plotter.GetRenderWindow().GetMultiSamples
    smooth = samples()
    during: list[int] = []
    viewport.dragged.connect(lambda _: during.append(samples()))
    where = grip(viewport, Part.PUSH)
    mouse.drag(viewport, where, (where[0] - 30, where[1] + 20))
    assert smooth > 0
    assert during
    assert set(during) == {0}
    assert samples() == smooth
