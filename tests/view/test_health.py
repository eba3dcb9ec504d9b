"""The health panel with real clicks: what is wrong is shown on the body, repaired, and taken back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PySide6.QtWidgets import QFileDialog
from tests.core import meshfiles, shapes
from tests.core.test_named_repairs import torn
from tests.view.mouse import Mouse
from tests.view.windows import pixels_of, show_window, told, wait_until_done

from idviewer.core import Euclidean, Mesh, read_mesh
from idviewer.view.window import MainWindow

SIDES = ((1, 0, 0), (0, -1, 0), (0, -0.6, 0.8))


@pytest.fixture
def torn_file(tmp_path: Path) -> Path:
    path = tmp_path / "torn.off"
    path.write_bytes(meshfiles.off(*torn(shapes.icosphere(2), *SIDES)))
    return path


@pytest.fixture
def window(qtbot) -> MainWindow:
    made = show_window(qtbot, size=(1280, 720))
    made.session.set(distance=Euclidean())
    return made


def press(qtbot, mouse: Mouse, window: MainWindow, widget) -> None:
    """A click on a widget of the panel, which must be there to be seen."""
    window.health.panel.ensureWidgetVisible(widget)
    qtbot.waitUntil(widget.isVisible)
    qtbot.wait(20)
    mouse.click(widget)


def refuse(qtbot, mouse: Mouse, window: MainWindow, path: Path) -> None:
    """Open a file that is refused, and look at its health."""
    window.open(path)
    told(qtbot, window, "boundary edges in 3 loops", "--fill-holes")
    mouse.click(window.messages.button)
    qtbot.waitUntil(lambda: window.health.panel.apply.isEnabled())


def reds(window: MainWindow) -> int:
    """Pixels of the colour in which faults are marked."""
    red, green, blue = np.moveaxis(pixels_of(window).astype(int), -1, 0)
    return int(np.count_nonzero((red > 160) & (green < 90) & (blue < 90)))


@pytest.mark.slow
def test_a_torn_body_is_shown_repaired_and_taken_back(qtbot, mouse, window, torn_file, tmp_path) -> None:
    whole = tmp_path / "whole.off"
    whole.write_bytes(meshfiles.off(*shapes.octahedron()))
    window.open(whole)
    wait_until_done(qtbot, window.session)
    qtbot.waitUntil(lambda: window.windowTitle() == "whole.off — idviewer")
    before = window.session.state
    refuse(qtbot, mouse, window, torn_file)
    health, panel = window.health, window.health.panel
    assert health.is_refused_shown
    assert window.session.state is before
    assert panel.faults[0].fault.kind == "boundary_edges"
    assert panel.repairs["fill_holes"].box.isChecked()
    assert "3 holes" in panel.forecast.text()
    assert "a closed body" in panel.forecast.text()
    qtbot.waitUntil(lambda: reds(window) > 100)

    places = panel.faults[0].fault.places
    for number in (0, 1, 2, 0):
        press(qtbot, mouse, window, panel.faults[0].show_place)
        qtbot.waitUntil(lambda number=number: window.viewport.faults.chosen is places[number])
        towards = places[number].centre / np.linalg.norm(places[number].centre)
        assert window.viewport.pose.axes[2] @ towards > 0.99, "it is looked at from outside"
        assert panel.faults[0].show_place.text() == f"{number + 1} of 3"

    press(qtbot, mouse, window, panel.apply)
    qtbot.waitUntil(lambda: window.windowTitle() == "torn.off* — idviewer")
    wait_until_done(qtbot, window.session)
    repaired = window.session.state.shape
    assert isinstance(repaired, Mesh)
    assert trimesh.Trimesh(repaired.vertices, repaired.faces, process=False).is_watertight
    assert not health.is_refused_shown
    qtbot.waitUntil(lambda: panel.undo.isEnabled())
    assert window.actions_by_name["undo"].text() == "&Undo fill holes"

    press(qtbot, mouse, window, panel.save)
    qtbot.waitUntil(lambda: isinstance(window._dialog, QFileDialog))
    window._dialog.selectFile(str(tmp_path / "saved.ply"))
    window._dialog.accept()
    told(qtbot, window, "Saved")
    np.testing.assert_array_equal(read_mesh(tmp_path / "saved.ply").vertices, repaired.vertices)

    press(qtbot, mouse, window, panel.undo)
    qtbot.waitUntil(lambda: window.windowTitle() == "whole.off — idviewer")
    assert window.session.state is before
    qtbot.waitUntil(lambda: health.is_refused_shown and panel.apply.isEnabled())
    health.dock.close()
    assert not health.is_refused_shown
    assert window.session.frame.shape is before.shape


@pytest.mark.slow
def test_values_are_typed_and_told_of_when_wrong(qtbot, mouse, window, torn_file) -> None:
    refuse(qtbot, mouse, window, torn_file)
    panel = window.health.panel
    row = panel.repairs["fill_holes"]
    for text, words in (("3", "still no closed body"), ("many", "whole number"), ("2", "three edges")):
        row.field.setFocus()
        row.field.selectAll()
        mouse.type(text)
        mouse.key("Return")
        qtbot.waitUntil(lambda words=words: words in panel.forecast.text())
        assert not panel.apply.isEnabled()
    press(qtbot, mouse, window, row.box)
    qtbot.waitUntil(lambda: panel.forecast.text() == "")
    assert not panel.apply.isEnabled()


@pytest.mark.slow
def test_opening_another_shape_uncovers_it(qtbot, mouse, window, torn_file, tmp_path) -> None:
    refuse(qtbot, mouse, window, torn_file)
    assert window.health.is_refused_shown
    path = tmp_path / "whole.off"
    path.write_bytes(meshfiles.off(*shapes.octahedron()))
    window.open(path)
    wait_until_done(qtbot, window.session)
    assert not window.health.is_refused_shown
    assert window.windowTitle() == "whole.off — idviewer"
    mouse.key("F8")
    qtbot.waitUntil(lambda: window.health.panel.verdict.text() == "A closed body.")
    assert window.viewport.faults.marked is window.health.desk.health
    assert window.session.state.shape.name == "whole"


@pytest.mark.slow
def test_a_click_on_a_refused_body_sets_no_source(qtbot, mouse, window, torn_file, tmp_path) -> None:
    path = tmp_path / "whole.off"
    path.write_bytes(meshfiles.off(*shapes.octahedron()))
    window.open(path)
    wait_until_done(qtbot, window.session)
    camera = window.viewport.camera_position
    refuse(qtbot, mouse, window, torn_file)
    before = window.session.state
    away = window.viewport.pose.distance
    mouse.click(window.viewport, 300, 300)
    mouse.wheel(window.viewport, 300, 300, 2)
    assert window.session.state is before
    assert window.viewport.pose.distance < away
    window.health.dock.close()
    np.testing.assert_allclose(window.viewport.camera_position, camera, atol=1e-12)


@pytest.mark.slow
def test_closing_in_the_middle_of_an_examination(qtbot, mouse, window, torn_file) -> None:
    window.open(torn_file)
    told(qtbot, window, "--fill-holes")
    mouse.click(window.messages.button)
    window.close()
