"""The window's keys, controls and dialogs under real mouse and key events."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from PySide6.QtWidgets import QSlider, QStyle, QStyleOptionSlider
from pytestqt.qtbot import QtBot
from tests.core import shapes
from tests.view.mouse import Mouse
from tests.view.windows import (
    AXES,
    focus,
    pixels_of,
    show_shape,
    show_window,
    told,
    wait_until_done,
    write_ellipsoid,
)

from idviewer.core import DISTANCES, GPS, Diffusion, InteriorDistance, Mesh
from idviewer.core.distances import missing_parameters
from idviewer.core.sampling.plane_samples import PlaneSamples
from idviewer.session.pipeline import Pipeline
from idviewer.view import help as help_sheet
from idviewer.view.dialogs import PictureDialog
from idviewer.view.help import HelpSheet
from idviewer.view.menus import MENUS
from idviewer.view.window import MainWindow

pytestmark = pytest.mark.slow


@pytest.fixture
def ellipsoid(tmp_path: Path) -> Path:
    return write_ellipsoid(tmp_path)


@pytest.fixture
def window(qtbot: QtBot, ellipsoid: Path) -> MainWindow:
    return show_shape(qtbot, ellipsoid)


# Keys and controls


def test_letters_change_the_view_and_nothing_of_vtk_answers(mouse: Mouse, window: MainWindow) -> None:
    session = window.session
    mouse.click(window.viewport, 5, 5)
    mouse.key("x")
    assert session.state.query.planes[0].normal == (1.0, 0.0, 0.0)
    mouse.key("b", "h")
    assert session.state.display.barycentroid
    assert not session.state.display.handle
    mouse.key("u")
    assert session.state.query.quantity == "potential"
    mouse.key("1")
    assert window.viewport.pose.axes[2][2] == pytest.approx(1)
    renderer = window.viewport._plotter.renderer
    before = [actor.GetProperty().GetRepresentation() for actor in renderer.GetActors()]
    mouse.key("w", "q", "e", "p", "j", "3", "s", "f")
    assert [actor.GetProperty().GetRepresentation() for actor in renderer.GetActors()] == before
    assert not window.viewport._plotter.render_window.GetStereoRender()
    assert window.isVisible()


def test_keys_typed_into_a_field_are_text(mouse: Mouse, window: MainWindow) -> None:
    mouse.click(window.panel.planes.pose)
    mouse.key("ctrl+a")
    mouse.type("x=0.25")
    mouse.key("Return")
    assert window.session.state.query.planes[0].origin[0] == pytest.approx(-0.5 * AXES[0])
    assert not window.session.state.display.barycentroid


def test_page_keys_push_the_plane(mouse: Mouse, window: MainWindow) -> None:
    mouse.click(window.viewport, 5, 5)
    before = window.session.state.query.planes[0].origin[2]
    mouse.key("Prior", "Prior", "Prior", "Next")
    assert window.session.state.query.planes[0].origin[2] == pytest.approx(before + 2 * 0.01 * 2 * AXES[2])


def test_the_slider_moves_the_slice(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    slider = window.panel.planes.slider
    width, middle = slider.width(), slider.height() / 2
    mouse.drag(slider, (width / 2, middle), (width * 0.75, middle))
    frame = wait_until_done(qtbot, window.session)
    assert 0.1 < frame.slices[0].plane.origin[2] < 0.35
    assert window.panel.planes.fraction.value() > 0.6


def test_a_source_can_be_typed(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    mouse.click(window.panel.source.fields[0])
    mouse.key("ctrl+a")
    mouse.type("0.5 0.1 -0.05")
    mouse.key("Return")
    frame = wait_until_done(qtbot, window.session)
    assert frame.source.tolist() == [0.5, 0.1, -0.05]


def test_a_source_outside_is_refused_in_words(qtbot: QtBot, window: MainWindow) -> None:
    window.session.set(source=(9.0, 9.0, 9.0))
    assert "outside" in told(qtbot, window, "outside")
    assert window.session.state.query.source is None
    wait_until_done(qtbot, window.session)


def test_the_potential_is_lowest_at_the_barycentroid(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    tick = window.panel.show_group.barycentroid
    window.panel.ensureWidgetVisible(tick)
    mouse.click(tick, 8, tick.height() // 2)
    window.session.set(quantity="potential")
    frame = wait_until_done(qtbot, window.session)
    assert window.session.state.display.barycentroid
    values, points = frame.slices[0].values, frame.slices[0].points
    lowest = points[np.nanargmin(values)]
    assert np.linalg.norm(lowest - frame.barycentroid) < 0.1
    x, y = window.viewport.projection.project([frame.barycentroid])[0]
    window._show_probe(window.viewport.projection.ray(x, y))
    assert window.status.probe.text().startswith("U = ")


def test_the_barycentroid_becomes_the_source_again(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    window.session.set(source=(0.5, 0.0, 0.0))
    wait_until_done(qtbot, window.session)
    mouse.click(window.panel.source.at_barycentroid)
    frame = wait_until_done(qtbot, window.session)
    np.testing.assert_array_equal(frame.source, frame.barycentroid)
    assert float(window.panel.source.fields[0].text()) == pytest.approx(frame.source[0], abs=1e-6)


def test_every_distance_can_be_shown(qtbot: QtBot, window: MainWindow) -> None:
    """All but those that need a file first, which the panel's own tests show."""
    ready = {name: kind for name, kind in DISTANCES.items() if not missing_parameters(kind())}
    titles = set()
    for name, kind in ready.items():
        window.session.set(distance=kind())
        titles.add(wait_until_done(qtbot, window.session).title)
        assert window.panel.distance.kind.currentData() == name
    assert len(titles) == len(ready) >= 6


def test_dragging_the_time_recolours_live_without_sampling(
    qtbot: QtBot, mouse: Mouse, ellipsoid: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = show_shape(qtbot, ellipsoid, work=Pipeline().results)
    session, row = window.session, window.panel.distance.rows["diffusion", "time"]
    before, titles = session.frame, []
    session.frame_ready.connect(lambda frame: titles.append(frame.title))
    monkeypatch.setattr(PlaneSamples, "_sample", None)  # calling it would be an error
    x, middle = handle_of(row.slider)
    pixels = pixels_of(window)
    mouse.press(row.slider, x, middle)
    for step in range(1, 7):
        count = len(titles)
        mouse.move(row.slider, x + step * row.slider.width() / 12, middle)
        qtbot.waitUntil(lambda count=count: len(titles) > count)
    assert len(set(titles)) >= 4, "the picture follows while the button is down"
    mouse.release()
    frame = wait_until_done(qtbot, session)
    time, default = session.state.query.distance.time, 1 / (8 * frame.lambda_2)
    assert 2 * default < time < 64 * default
    assert frame.exact
    assert frame.title == f"Diffusion distance, t = {time:.3g}"
    assert float(row.field.text()) == time
    assert row.multiple.text() == f"= {time / default:.3g} t₀"
    assert frame.value_range[1] < before.value_range[1]
    assert np.mean(np.any(pixels_of(window) != pixels, axis=2)) > 0.01
    solver = InteriorDistance(frame.shape, Diffusion(time=time))
    np.testing.assert_allclose(frame.barycentroid, solver.barycentroid().point, atol=1e-6 * AXES.max())
    mouse.click(row.reset)
    assert wait_until_done(qtbot, session).title == before.title


def handle_of(slider: QSlider) -> tuple[float, float]:
    """Where a horizontal slider can be taken hold of."""
    option = QStyleOptionSlider()
    slider.initStyleOption(option)
    style = slider.style()
    box = style.subControlRect(
        QStyle.ComplexControl.CC_Slider, option, QStyle.SubControl.SC_SliderHandle, slider
    )
    return box.center().x(), box.center().y()


def test_a_time_can_be_typed_and_nonsense_is_refused(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    row = window.panel.distance.rows["diffusion", "time"]
    mouse.click(row.field)
    mouse.key("ctrl+a")
    mouse.type("2t0")
    mouse.key("Return")
    frame = wait_until_done(qtbot, window.session)
    assert window.session.state.query.distance.time == pytest.approx(2 / (8 * frame.lambda_2))
    mouse.key("ctrl+a")
    mouse.type("0")
    mouse.key("Return")
    told(qtbot, window, "must be a positive number, not 0")
    assert float(row.field.text()) == pytest.approx(2 / (8 * frame.lambda_2), rel=1e-5)


def test_kinds_without_a_time_show_none(qtbot: QtBot, window: MainWindow) -> None:
    row = window.panel.distance.rows["diffusion", "time"]
    assert row.isVisible()
    assert row.isEnabled()
    window.session.set(distance=GPS())
    assert not row.isVisible()


def test_the_value_under_the_mouse_is_told(mouse: Mouse, window: MainWindow) -> None:
    viewport, plane = window.viewport, window.session.state.query.planes[0]
    x, y = np.round(viewport.projection.project([[-0.8, 0.1, plane.origin[2]]])[0])
    mouse.move(viewport, x, y)
    text = window.status.probe.text()
    probe = window.session.probe(viewport.projection.ray(x, y))
    assert text.startswith(f"d = {probe.value:.4g} at (")
    assert f"Euclidean {np.linalg.norm(probe.point - window.session.frame.source):.4g}" in text
    mouse.move(viewport, 3, 3)
    assert not window.status.probe.text().startswith("d =")


def test_a_second_plane_shows_a_second_slice(qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
    mouse.click(window.panel.planes.add)
    frame = wait_until_done(qtbot, window.session)
    assert len(frame.slices) == 2
    assert all(len(one.triangles) for one in frame.slices)
    assert window.viewport.handle.plane == frame.slices[1].plane


# Saving


@pytest.mark.parametrize("transparent", [False, True])
def test_a_picture_is_saved_in_the_chosen_size(
    qtbot: QtBot, mouse: Mouse, window: MainWindow, tmp_path: Path, transparent: bool
) -> None:
    mouse.key("ctrl+s")
    dialog = window.findChild(PictureDialog)
    focus(qtbot, dialog)
    dialog.width_box.setValue(400)
    dialog.height_box.setValue(300)
    assert dialog.size_choice.currentText() == "Custom"
    dialog.transparent.setChecked(transparent)
    dialog.path.setText(str(tmp_path / "picture"))
    mouse.click(dialog.buttons.button(dialog.buttons.StandardButton.Save))
    assert "400 × 300" in told(qtbot, window, "Saved")
    with Image.open(tmp_path / "picture.png") as picture:
        assert picture.size == (400, 300)
        assert picture.mode == ("RGBA" if transparent else "RGB")
        assert (picture.getpixel((2, 2))[-1] == 0) == transparent
    assert sorted(path.name for path in tmp_path.iterdir()) == ["ellipsoid.ply", "picture.png"]


def test_a_picture_that_cannot_be_written_is_told(
    qtbot: QtBot, mouse: Mouse, window: MainWindow, tmp_path: Path
) -> None:
    mouse.key("ctrl+s")
    dialog = window.findChild(PictureDialog)
    dialog.path.setText(str(tmp_path / "nowhere" / "picture.png"))
    dialog.accept()
    assert "nowhere" in told(qtbot, window, "picture.png")
    assert window.messages.kind == "error"


# Help


def test_every_key_of_the_menus_is_in_the_sheet() -> None:
    sheet = help_sheet.sheet_html().replace(" + ", "+")
    sheet = sheet.replace("Page up", "PgUp").replace("Page down", "PgDown")
    written = sheet.split()
    for entry in (entry for entries in MENUS.values() for entry in entries if entry.keys):
        key = entry.keys.split("+")[-1] if entry.keys.startswith("Shift+Pg") else entry.keys
        assert any(key in word for word in written), entry


def test_the_sheet_opens_beside_the_window(qtbot: QtBot, mouse: Mouse) -> None:
    window = show_window(qtbot)
    mouse.key("F1")
    sheet = window.findChild(HelpSheet)
    qtbot.waitUntil(sheet.isVisible)
    assert not sheet.isModal()
    window.actions_by_name["about"].trigger()
    qtbot.waitUntil(lambda: window.findChild(HelpSheet) is None)


def test_the_window_keeps_a_mesh_that_is_shown(qtbot: QtBot) -> None:
    vertices, faces = shapes.icosphere(3)
    window = show_window(qtbot)
    window.session.show(Mesh(vertices * AXES, faces, name="handed over"))
    wait_until_done(qtbot, window.session)
    assert window.windowTitle().startswith("handed over")
    assert window.messages.text == ""
