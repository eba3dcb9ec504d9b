"""Vertices of a polygon dragged in the window by real mouse events, and the distances that follow."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from pytestqt.qtbot import QtBot
from tests.view.mouse import Mouse
from tests.view.polygons import write_star
from tests.view.windows import (
    pixels_of,
    place,
    place_of_vertex,
    show_shape,
    told,
    vertices_of,
    wait_until_done,
)

from idviewer.core import Polygon
from idviewer.session.state import Frame
from idviewer.view.window import MainWindow

pytestmark = pytest.mark.slow
TIP = 0
"""Number of the star's upmost vertex."""


@pytest.fixture
def window(qtbot: QtBot, tmp_path: Path) -> MainWindow:
    return show_shape(qtbot, write_star(tmp_path))


def test_the_vertex_under_the_mouse_is_pointed_out(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    x, y = place_of_vertex(window, TIP)
    mouse.move(window.viewport, x + 60, y)
    qtbot.wait(50)
    before = pixels_of(window).astype(int)
    mouse.move(window.viewport, x + 4, y + 4)
    assert window.viewport.cursor().shape() == Qt.CursorShape.SizeAllCursor

    def orange() -> bool:
        row, column = round(y), round(x)
        red, green, blue = pixels_of(window)[row, column].astype(int)
        return red > 230 and 90 < green < 180 and blue < 80

    qtbot.waitUntil(orange)
    mouse.move(window.viewport, x + 60, y)
    assert window.viewport.cursor().shape() == Qt.CursorShape.ArrowCursor
    qtbot.waitUntil(lambda: np.abs(pixels_of(window).astype(int) - before).max() < 30)


def test_a_dragged_vertex_takes_the_distances_along(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    viewport, session = window.viewport, window.session
    start, first, pose = vertices_of(window), session.frame, viewport.pose
    ranges: list[tuple[float, float]] = []
    session.frame_ready.connect(lambda frame: ranges.append(frame.value_range))
    x, y = place_of_vertex(window, TIP)
    mouse.drag(viewport, (x + 2, y + 1), (x + 42, y - 39), steps=10)
    frame = wait_until_done(qtbot, session)
    moved = vertices_of(window)
    assert np.array_equal(np.delete(moved, TIP, axis=0), np.delete(start, TIP, axis=0))
    np.testing.assert_allclose(
        viewport.projection.project([[*moved[TIP], 0.0]])[0], [x + 40, y - 40], atol=1.0
    )
    assert frame.shape is session.state.shape
    assert first is not None
    assert frame.lambda_2 != first.lambda_2
    assert frame.value_range != first.value_range
    assert len(set(ranges)) > 1  # they followed
    np.testing.assert_allclose(viewport.pose.position, pose.position)
    assert window.panel.distance.kind.isEnabled()


def test_undo_and_redo(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    start, values = vertices_of(window), window.session.frame.value_range
    undo, redo = window.actions_by_name["undo"], window.actions_by_name["redo"]
    assert not undo.isEnabled()
    for vertex, way in ((TIP, 50), (16, -40)):
        x, y = place_of_vertex(window, vertex)
        mouse.drag(window.viewport, (x, y), (x, y + way))
    second = vertices_of(window)
    mouse.key("ctrl+z")
    assert vertices_of(window)[16].tolist() == start[16].tolist()
    assert vertices_of(window)[TIP].tolist() != start[TIP].tolist()
    mouse.key("ctrl+z")
    frame = wait_until_done(qtbot, window.session)
    assert np.array_equal(vertices_of(window), start)
    np.testing.assert_allclose(frame.value_range, values, rtol=1e-9)
    assert not undo.isEnabled()
    mouse.key("ctrl+shift+z", "ctrl+shift+z")
    assert np.array_equal(vertices_of(window), second)
    assert not redo.isEnabled()
    wait_until_done(qtbot, window.session)


def test_escape_gives_a_drag_up(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    start, pose = vertices_of(window), window.viewport.pose
    x, y = place_of_vertex(window, TIP)
    mouse.press(window.viewport, x, y)
    mouse.move(window.viewport, x + 30, y + 30)
    assert vertices_of(window)[TIP].tolist() != start[TIP].tolist()
    mouse.key("Escape")
    assert np.array_equal(vertices_of(window), start)
    mouse.move(window.viewport, x + 60, y + 30)
    mouse.release()
    assert np.array_equal(vertices_of(window), start)
    assert not window.actions_by_name["undo"].isEnabled()
    np.testing.assert_allclose(window.viewport.pose.position, pose.position)
    frame = wait_until_done(qtbot, window.session)
    assert frame.shape is window.session.state.shape


def test_where_edges_would_cross_the_vertex_stays_and_a_line_says_why(
    qtbot: QtBot, mouse: Mouse, window: MainWindow
) -> None:
    x, y = place_of_vertex(window, TIP)
    bad_x, bad_y = place(window.viewport, [0.0, -1.1, 0.0])
    mouse.press(window.viewport, x, y)
    mouse.move(window.viewport, x + 6, y + 20)
    good = vertices_of(window)
    mouse.move(window.viewport, bad_x, bad_y)
    text = told(qtbot, window, "stays", "edge")
    assert window.messages.kind == "error"
    assert "\n" not in text
    assert len(text) < 100
    assert np.array_equal(vertices_of(window), good)
    mouse.move(window.viewport, x, y + 30)
    assert window.messages.text == ""
    assert not np.array_equal(vertices_of(window), good)
    mouse.move(window.viewport, bad_x, bad_y)
    told(qtbot, window, "stays")
    mouse.release()
    mouse.key("ctrl+z")
    assert window.messages.text == ""
    wait_until_done(qtbot, window.session)


def test_with_shift_the_neighbours_follow(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    start = vertices_of(window)
    x, y = place_of_vertex(window, TIP)
    mouse.press(window.viewport, x, y, keys=("shift",))
    for way in (10, 20, 30):
        mouse.move(window.viewport, x, y - way)
    mouse.release(keys=("shift",))
    ways = np.linalg.norm(vertices_of(window) - start, axis=1)
    assert ways[TIP] > ways[1] > ways[2] > 0
    assert ways[1] == pytest.approx(ways[-1])
    assert (ways[10:30] == 0).all()
    wait_until_done(qtbot, window.session)


def test_a_source_that_the_outline_passes_falls_back(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    tip = place_of_vertex(window, TIP)
    x, y = place(window.viewport, [0.0, 0.9, 0.0])
    mouse.click(window.viewport, x, y)
    wait_until_done(qtbot, window.session)
    mouse.drag(window.viewport, tip, (x, y + 60))
    frame = wait_until_done(qtbot, window.session)
    assert window.session.state.query.source is None
    np.testing.assert_allclose(frame.source, frame.barycentroid)


def test_hidden_vertices_cannot_be_grabbed(mouse: Mouse, window: MainWindow) -> None:
    start = vertices_of(window)
    x, y = place_of_vertex(window, TIP)
    mouse.key("h")
    assert not window.panel.show_group.vertices.isChecked()
    mouse.drag(window.viewport, (x, y), (x + 20, y + 40))
    assert np.array_equal(vertices_of(window), start)


def test_no_stale_picture_after_a_hundred_moves(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    frames: list[Frame] = []
    window.session.set(source=(0.0, 0.0, 0.0))
    wait_until_done(qtbot, window.session)
    window.session.frame_ready.connect(frames.append)
    x, y = place_of_vertex(window, TIP)
    angles = np.linspace(0, 6 * np.pi, 100)
    way = [(x + 30 * np.sin(a), y - 40 + 40 * np.cos(a)) for a in angles] + [(x + 25, y - 30)]
    mouse.press(window.viewport, x, y)
    for to_x, to_y in way:
        mouse.move(window.viewport, round(to_x), round(to_y))
    mouse.release()
    frame = wait_until_done(qtbot, window.session)
    assert frame.shape is window.session.state.shape
    assert len(frames) > 5
    dragged = vertices_of(window)
    np.testing.assert_allclose(
        window.viewport.projection.project([[*dragged[TIP], 0.0]])[0], [x + 25, y - 30], atol=1.5
    )
    mouse.move(window.status, 5, 5)
    qtbot.wait(50)
    drawn, shape, pose = pixels_of(window).astype(int), frame.shape, window.viewport.pose
    assert isinstance(shape, Polygon)
    window.session.show(Polygon(shape.vertices, shape.loops))  # the same from nothing
    window.session.set(source=(0.0, 0.0, 0.0))
    window.viewport._camera.set_pose(pose)
    wait_until_done(qtbot, window.session)
    qtbot.waitUntil(lambda: (np.abs(pixels_of(window).astype(int) - drawn).max(axis=2) > 60).mean() < 0.004)
