"""Polygons in the window under real mouse events: the picture, sources, the panel and files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot
from tests.view.mouse import Mouse
from tests.view.polygons import write_star
from tests.view.windows import (
    drop,
    pixels_of,
    place,
    place_of_vertex,
    show_shape,
    show_window,
    vertices_of,
    wait_until_done,
    write_ellipsoid,
)

from idviewer.core import COORDINATES, read_polygon, write_polygon
from idviewer.core.coordinates import Property
from idviewer.view.dialogs import PictureRequest
from idviewer.view.menus import NO_3D_VIEWS_TIP, NO_SLICES_TIP
from idviewer.view.status_line import POLYGON_HINT
from idviewer.view.window import MainWindow

pytestmark = pytest.mark.slow


@pytest.fixture
def window(qtbot: QtBot, tmp_path: Path) -> MainWindow:
    return show_shape(qtbot, write_star(tmp_path))


# The picture


def test_it_is_looked_straight_down_on_as_a_whole(window: MainWindow) -> None:
    viewport = window.viewport
    np.testing.assert_allclose(viewport.pose.axes[2], [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(viewport.pose.up, [0, 1, 0], atol=1e-12)
    pixels = viewport.projection.project(np.column_stack([vertices_of(window), np.zeros(40)]))
    assert pixels.min() > 0
    assert pixels[:, 1].max() < viewport.height()
    assert pixels[:, 0].max() < viewport.width() - 100  # beside the scale bar
    free = np.array([viewport.width() - 180, viewport.height()])
    assert (np.ptp(pixels, axis=0) / free).max() > 0.85
    sizes = [viewport.projection.pixel_size([x, 0.0, z]) for x, z in ((0, 0), (1, 0), (0, 1))]
    np.testing.assert_allclose(sizes, sizes[0])  # nothing is nearer


def test_a_drag_beside_the_vertices_shifts_the_picture(mouse: Mouse, window: MainWindow) -> None:
    viewport, session = window.viewport, window.session
    before, pose = session.state, viewport.pose
    x, y = place(viewport, [0.1, 0.1, 0.0])
    mouse.drag(viewport, (x, y), (x + 60, y - 45))
    np.testing.assert_allclose(viewport.projection.project([[0.1, 0.1, 0.0]])[0], [x + 60, y - 45], atol=1.0)
    np.testing.assert_allclose(viewport.pose.axes, pose.axes, atol=1e-12)
    assert session.state == before


def test_the_wheel_zooms_towards_the_mouse(mouse: Mouse, window: MainWindow) -> None:
    viewport = window.viewport
    x, y = place(viewport, [0.3, -0.2, 0.0])
    size = viewport.projection.pixel_size([0.0, 0.0, 0.0])
    mouse.wheel(viewport, x, y, 4)
    assert viewport.projection.pixel_size([0.0, 0.0, 0.0]) < 0.7 * size
    np.testing.assert_allclose(viewport.projection.project([[0.3, -0.2, 0.0]])[0], [x, y], atol=1.0)
    mouse.key("r")
    assert viewport.projection.pixel_size([0.0, 0.0, 0.0]) == pytest.approx(size)


def test_what_turns_or_slices_is_disabled_and_says_why(
    qtbot: QtBot, mouse: Mouse, window: MainWindow
) -> None:
    pose, actions = window.viewport.pose, window.actions_by_name
    mouse.key("3", "a", "0", "x", "t", "ctrl+n")
    np.testing.assert_allclose(window.viewport.pose.axes, pose.axes, atol=1e-12)
    assert actions["left"].toolTip() == NO_3D_VIEWS_TIP
    assert actions["plane_x"].toolTip() == NO_SLICES_TIP
    assert not actions["upright"].isEnabled()
    assert actions["reset"].isEnabled()
    assert window.panel.planes.isHidden()
    assert not window.panel.show_group.opacity.isVisible()
    assert not window.panel.source.fields[2].isVisible()
    assert window.status.probe.text() == POLYGON_HINT or "d = " in window.status.probe.text()


def test_after_a_polygon_a_body_has_everything_again(
    qtbot: QtBot, window: MainWindow, tmp_path: Path
) -> None:
    window.open(write_ellipsoid(tmp_path))
    wait_until_done(qtbot, window.session)
    assert window.actions_by_name["left"].isEnabled()
    assert window.actions_by_name["left"].toolTip() != NO_3D_VIEWS_TIP
    assert window.panel.planes.isVisible()
    assert window.panel.show_group.opacity.isVisible()
    assert not window.panel.show_group.vertices.isVisible()
    assert window.viewport.handle is not None
    sizes = [window.viewport.projection.pixel_size([0, 0, z]) for z in (-0.3, 0.3)]
    assert sizes[0] != pytest.approx(sizes[1])  # what is nearer is larger


@pytest.mark.parametrize("transparent", [False, True])
def test_a_picture_is_saved_as_it_is_shown(window: MainWindow, tmp_path: Path, transparent: bool) -> None:
    viewport = window.viewport
    window.session.set(scale_bar=False)
    size = (viewport.width(), viewport.height())
    window.save_picture(PictureRequest(tmp_path / "star.png", size, transparent))
    with Image.open(tmp_path / "star.png") as file:
        picture = np.asarray(file).astype(int)
    assert picture.shape == (size[1], size[0], 4 if transparent else 3)
    x, y = place(viewport, [0.0, 0.6, 0.0])
    shown = pixels_of(window).astype(int)
    near = slice(int(y) - 12, int(y) + 13), slice(int(x) - 12, int(x) + 13)
    assert np.abs(picture[near][..., :3].mean(axis=(0, 1)) - shown[near].mean(axis=(0, 1))).max() < 12
    assert not transparent or picture[2, 2, 3] == 0


# Sources


def test_a_click_inside_puts_the_source_there(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    pose = window.viewport.pose
    mouse.click(window.viewport, *place(window.viewport, [0.2, 0.15, 0.0]))
    frame = wait_until_done(qtbot, window.session)
    np.testing.assert_allclose(
        frame.source, [0.2, 0.15, 0.0], atol=1.5 * window.viewport.projection.pixel_size([0, 0, 0])
    )
    assert frame.source[2] == 0.0
    np.testing.assert_allclose(window.viewport.pose.position, pose.position)


def test_a_click_on_a_vertex_puts_the_source_on_it(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    shape = window.session.state.shape
    x, y = place_of_vertex(window, 16)
    mouse.click(window.viewport, x + 3, y - 2)
    frame = wait_until_done(qtbot, window.session)
    assert np.array_equal(frame.source[:2], shape.vertices[16])
    assert window.session.state.shape is shape


def test_a_click_outside_does_nothing(mouse: Mouse, window: MainWindow) -> None:
    before = window.session.state
    mouse.click(window.viewport, 12, 12)
    assert window.session.state == before


def test_two_coordinates_can_be_typed(qtbot: QtBot, window: MainWindow) -> None:
    field = window.panel.source.fields[0]
    field.setText("0.1, -0.2")
    field.setModified(True)
    field.editingFinished.emit()
    assert window.session.state.query.source == (0.1, -0.2, 0.0)
    wait_until_done(qtbot, window.session)


# The panel, files


def test_coordinates_are_chosen_and_tell_what_they_fulfil(
    qtbot: QtBot, mouse: Mouse, window: MainWindow
) -> None:
    before = wait_until_done(qtbot, window.session)
    box = window.panel.distance.coordinates.box
    assert [box.itemData(row) for row in range(box.count())] == list(COORDINATES)
    box.setCurrentIndex(box.findData("shepard"))
    box.activated.emit(box.currentIndex())
    assert window.session.state.query.coordinates == "shepard"
    frame = wait_until_done(qtbot, window.session)
    assert frame.slices[0].values.max() != before.slices[0].values.max()
    assert "✗ linear precision" in box.toolTip()
    assert "✓ non negativity" in box.toolTip()
    assert box.toolTip().count("✓") + box.toolTip().count("✗") == len(Property)


@pytest.mark.parametrize("suffix", [".csv", ".svg", ".json"])
def test_dropped_polygons_open(qtbot: QtBot, tmp_path: Path, suffix: str) -> None:
    window = show_window(qtbot)
    path = write_star(tmp_path)
    if suffix != ".csv":
        outline = read_polygon(path)
        path = tmp_path / f"star{suffix}"
        if suffix == ".svg":
            points = " ".join(f"{x},{y}" for x, y in outline.vertices)
            path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg"><polygon points="{points}"/></svg>')
        else:
            write_polygon(outline, path)
    drop(window, path)
    wait_until_done(qtbot, window.session)
    assert window.session.state.shape.dimension == 2
    assert window.windowTitle().startswith(path.name)


def test_samples_are_in_two_groups(window: MainWindow) -> None:
    menus = [menu for menu in window.menuBar().findChildren(QWidget) if hasattr(menu, "title")]
    samples = next(menu for menu in menus if "sample" in menu.title())
    texts = [("—" if action.isSeparator() else "") + action.text() for action in samples.actions()]
    assert [text for text in texts if text.startswith("—")] == ["—Meshes", "—Polygons"]
    assert texts.index("Hand") < texts.index("—Polygons") < texts.index("Gingerbread")


def test_remarks_are_shown_while_frames_make_them(window: MainWindow) -> None:
    bar = window.messages
    bar.remark("It has no value at a point.")
    assert (bar.text, bar.kind) == ("It has no value at a point.", "note")
    bar.clear()
    bar.remark("It has no value at a point.")
    assert bar.text == ""
    bar.remark("It has no value at two points.")
    assert bar.text == "It has no value at two points."
    bar.remark("")
    assert bar.text == ""
