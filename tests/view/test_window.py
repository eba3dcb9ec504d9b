"""The window as its user meets it: opening, computing, cancelling, closing."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QSize
from PySide6.QtGui import QScreen
from PySide6.QtWidgets import QDialogButtonBox, QFileDialog, QWidget
from pytestqt.qtbot import QtBot
from tests.core import shapes
from tests.view.mouse import Mouse
from tests.view.windows import (
    AXES,
    Gate,
    drop,
    focus,
    pixels_of,
    show_shape,
    show_window,
    told,
    wait_until_done,
    write_ellipsoid,
)
from trimesh import Trimesh

from idviewer.app import make_window
from idviewer.session.pipeline import Pipeline
from idviewer.view.status_line import EMPTY_HINT, MESH_HINT
from idviewer.view.window import MainWindow

pytestmark = pytest.mark.slow


@pytest.fixture
def ellipsoid(tmp_path: Path) -> Path:
    return write_ellipsoid(tmp_path)


@pytest.fixture
def window(qtbot: QtBot, ellipsoid: Path) -> MainWindow:
    return show_shape(qtbot, ellipsoid)


# Opening


def test_the_hint_says_what_to_do_next(qtbot: QtBot, mouse: Mouse, ellipsoid: Path) -> None:
    window = show_window(qtbot)
    mouse.move(window.status, 5, 5)  # not over the picture
    assert window.status.probe.text() == EMPTY_HINT
    window.open(ellipsoid)
    wait_until_done(qtbot, window.session)
    assert window.status.probe.text() == MESH_HINT


def test_the_final_frame_is_exact_and_fills_the_slice(qtbot: QtBot, ellipsoid: Path) -> None:
    window = show_shape(qtbot, ellipsoid, work=Pipeline().results)
    frame = wait_until_done(qtbot, window.session)
    assert frame.exact
    assert window.windowTitle().startswith("ellipsoid.ply")
    assert "642 vertices" in window.status.sizes.text()
    assert "modes" in window.status.modes.text()
    assert window.status.bar.isHidden()
    colours = pixels_of(window).reshape(-1, 3).astype(int)
    vivid = np.ptp(colours, axis=1) > 100
    assert vivid.mean() > 0.05


def test_the_menu_opens_a_file_by_its_name(qtbot: QtBot, mouse: Mouse, ellipsoid: Path) -> None:
    window = show_window(qtbot)
    mouse.key("ctrl+o")
    dialog = window.findChild(QFileDialog)
    focus(qtbot, dialog)
    mouse.type(str(ellipsoid))
    mouse.key("Return")
    wait_until_done(qtbot, window.session)
    assert window.session.state.shape.name == "ellipsoid"


def test_the_menu_bar_works_with_the_mouse(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    bar = window.menuBar()
    view = next(action for action in bar.actions() if action.text() == "&View")
    place = bar.actionGeometry(view).center()
    mouse.click(bar, place.x(), place.y())
    menu = view.menu()
    qtbot.waitUntil(menu.isVisible)
    entry = menu.actionGeometry(window.actions_by_name["top"]).center()
    mouse.click(menu, entry.x(), entry.y())
    qtbot.waitUntil(lambda: abs(window.viewport.pose.axes[2] @ [0, 1, 0]) > 0.999)


def test_a_file_dragged_from_another_program_is_opened(qtbot: QtBot, mouse: Mouse, ellipsoid: Path) -> None:
    window = show_window(qtbot)
    script = Path(__file__).with_name("drag_source.py")
    command = [sys.executable, str(script), str(ellipsoid), "1150", "700", "150"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout is not None
        assert other.stdout.readline() == "shown\n"
        mouse.drag_from_elsewhere((1200, 750), window.viewport, 300, 300)
        qtbot.waitUntil(lambda: window.session.state.shape is not None)
        other.terminate()
        assert "CopyAction" in other.stdout.read()
    wait_until_done(qtbot, window.session)
    assert window.session.state.shape.name == "ellipsoid"


def test_no_widget_keeps_a_dropped_file_from_the_window(window: MainWindow) -> None:
    at: QWidget | None = window.childAt(window.viewport.mapTo(window, window.viewport.rect().center()))
    while at is not window:
        assert at is not None
        assert not at.acceptDrops()
        at = at.parentWidget()
    assert window.acceptDrops()


def test_two_dropped_files_are_refused_in_words(qtbot: QtBot, window: MainWindow, ellipsoid: Path) -> None:
    before = window.session.state
    drop(window, ellipsoid, ellipsoid)
    assert "one file" in told(qtbot, window)
    assert window.session.state == before


@pytest.mark.parametrize("name", ["missing.ply", "notes.txt", "broken.off", "open.ply"])
def test_a_wrong_file_leaves_the_old_shape(
    qtbot: QtBot, window: MainWindow, tmp_path: Path, name: str
) -> None:
    before, frame = window.session.state, window.session.frame
    path = tmp_path / name
    if name == "notes.txt":
        path.write_text("not a mesh")
    elif name == "broken.off":
        path.write_text("OFF\n4 4 0\n0 0 0\n")
    elif name == "open.ply":
        Trimesh(*shapes.opened(shapes.icosphere(1)), process=False).export(path)
    drop(window, path)
    assert name.split(".")[0] in told(qtbot, window, name.split(".")[0])
    assert window.messages.kind == "error"
    assert "\n" not in window.messages.text
    assert window.session.state == before
    after = window.session.frame
    assert (after.shape, after.query) == (frame.shape, frame.query)


def test_one_of_several_components_can_be_opened(qtbot: QtBot, mouse: Mouse, tmp_path: Path) -> None:
    vertices, faces = shapes.icosphere(3)
    small = shapes.moved(shapes.icosphere(1), 5.0, 0.0, 0.0)
    path = tmp_path / "two.ply"
    Trimesh(*shapes.joined((vertices * AXES, faces), small), process=False).export(path)
    window = show_window(qtbot)
    window.open(path)
    told(qtbot, window, "two", "components")
    dialog = window._dialog
    focus(qtbot, dialog)
    assert "80 faces" in dialog.choice.description  # the larger volume, of fewer faces
    mouse.click(dialog.buttons.button(QDialogButtonBox.StandardButton.Open))
    wait_until_done(qtbot, window.session)
    assert len(window.session.state.shape.faces) == 80


def test_repairs_are_told_and_dismissed(qtbot: QtBot, mouse: Mouse, tmp_path: Path) -> None:
    vertices, faces = shapes.icosphere(3)
    path = tmp_path / "soup.stl"
    # Inside out, and STL files do not share vertices.
    Trimesh(vertices * AXES, faces[:, ::-1], process=False).export(path)
    window = show_window(qtbot)
    window.open(path)
    wait_until_done(qtbot, window.session)
    assert window.messages.kind == "note"
    assert window.messages.text == " ".join(window.session.state.shape.notes)
    mouse.click(window.messages._dismiss)
    assert window.messages.text == ""


# Computing


def test_the_body_shows_at_once_and_work_can_be_cancelled_and_resumed(
    qtbot: QtBot, mouse: Mouse, ellipsoid: Path
) -> None:
    gate = Gate()
    window = show_window(qtbot, gate.work)
    empty = pixels_of(window)
    window.open(ellipsoid)
    qtbot.waitUntil(window.status.bar.isVisible)
    qtbot.waitUntil(lambda: window.status.stage.text() == "Waiting at the gate")
    assert window.status.bar.value() == 500
    qtbot.waitUntil(lambda: np.abs(pixels_of(window).astype(int) - empty).max(axis=2).mean() > 1)
    assert window.session.frame is None
    mouse.click(window.status.button)
    assert not window.session.busy
    assert window.status.stage.text() == "Cancelled"
    assert window.status.button.text() == "Compute again"
    gate.let_through()
    mouse.click(window.status.button)
    wait_until_done(qtbot, window.session)
    assert window.status.stage.isHidden()
    assert window.status.button.isHidden()


def test_escape_cancels(qtbot: QtBot, mouse: Mouse, ellipsoid: Path) -> None:
    window = show_window(qtbot, Gate().work)
    window.open(ellipsoid)
    qtbot.waitUntil(window.status.bar.isVisible)
    mouse.key("Escape")
    assert not window.session.busy
    assert window.session.state.shape is not None


def test_the_window_can_be_used_while_it_computes(qtbot: QtBot, mouse: Mouse, ellipsoid: Path) -> None:
    gate = Gate()
    window = show_window(qtbot, gate.work)
    window.open(ellipsoid)
    qtbot.waitUntil(window.status.bar.isVisible)
    pose = window.viewport.pose
    mouse.drag(window.viewport, (50, 50), (120, 80))
    assert np.linalg.norm(window.viewport.pose.position - pose.position) > 0.1
    mouse.click(window.panel.planes.axes["x"])
    gate.let_through()
    frame = wait_until_done(qtbot, window.session)
    assert frame.slices[0].plane.normal == (1.0, 0.0, 0.0)


# Closing


def test_it_closes_in_the_middle_of_a_computation(qtbot: QtBot, ellipsoid: Path) -> None:
    window = show_window(qtbot, Gate().work)
    window.open(ellipsoid)
    qtbot.waitUntil(window.status.bar.isVisible)
    assert window.close()
    window.close_down()  # again
    assert not window.isVisible()


def test_it_closes_in_the_middle_of_a_drag(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    handle = window.viewport.handle
    x, y = window.viewport.projection.project(handle.ring)[10]
    mouse.press(window.viewport, round(x), round(y))
    mouse.move(window.viewport, round(x) + 5, round(y) + 5)
    assert window.close()
    mouse.release_anywhere()


def test_an_empty_window_does_nothing_and_closes(qtbot: QtBot, mouse: Mouse) -> None:
    window = show_window(qtbot)
    for name, action in window.actions_by_name.items():
        if name not in {"quit", "open", "about", "keys"}:
            action.trigger()
    mouse.click(window.viewport, 200, 200)
    mouse.wheel(window.viewport, 200, 200, 1)
    assert window.session.state.shape is None
    mouse.key("ctrl+q")
    qtbot.waitUntil(lambda: not window.isVisible())


def test_it_fits_on_a_small_screen(qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(QScreen, "availableSize", lambda screen: QSize(1280, 720))
    window = make_window(Pipeline().results)
    qtbot.addWidget(window)
    with qtbot.waitExposed(window):
        window.show()
    assert (window.width(), window.height()) == (1280, 720)
    assert window.status.geometry().bottom() < 720
