"""The controls: they show any state without calling anything, and call once for what the user does."""

from __future__ import annotations

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLineEdit
from pytestqt.qtbot import QtBot
from tests.core import shapes

from idviewer.core import DISTANCES, Mesh, Plane
from idviewer.session.planes import PlaneCommands, axis_of
from idviewer.session.state import Display, Frame, Query, State
from idviewer.view.panel import Calls, Panel


class Recorder:
    """Plays the session: keeps the state, notes every call and shows the new state, as the window does."""

    def __init__(self, state: State) -> None:
        self.state = state
        self.frame: Frame | None = None
        self.calls: list[dict[str, object]] = []
        self.complaints: list[str] = []
        self.commands = PlaneCommands(self)
        self.panel = Panel(Calls(self.set, self.complaints.append), self.commands)
        self.panel.show_state(state, None)

    def set(self, **fields: object) -> None:
        self.calls.append(fields)
        self.state = self.state.with_(**fields)
        self.panel.show_state(self.state, None)


@pytest.fixture
def mesh() -> Mesh:
    vertices, faces = shapes.icosphere(2)
    return Mesh(vertices * [2.0, 1.0, 0.5], faces)


@pytest.fixture
def recorder(qtbot: QtBot, mesh: Mesh) -> Recorder:
    query = Query(planes=(Plane.along("z", 0.5, mesh.bounds),), source=(0.1, 0.2, 0.3))
    recorder = Recorder(State(mesh, query, Display()))
    qtbot.addWidget(recorder.panel)
    recorder.panel.show()
    return recorder


def write(edit: QLineEdit, text: str) -> None:
    edit.setFocus()
    edit.selectAll()
    QTest.keyClicks(edit, text)
    QTest.keyClick(edit, Qt.Key.Key_Return)


def test_showing_a_state_calls_nothing(recorder: Recorder, mesh: Mesh) -> None:
    tilted = Plane((0.1, 0.2, 0.0), (1.0, 2.0, 3.0))
    other = State(
        mesh,
        Query(planes=(tilted, tilted), source=None, distance=DISTANCES["euclidean"](), quantity="potential"),
        Display(7, "even", 0.6, True, False, False, 1),
    )
    for state in (other, State(), recorder.state, State(mesh, Query())):
        recorder.panel.show_state(state, None)
    assert not recorder.calls
    assert not recorder.complaints


def test_everything_shown_is_the_states(recorder: Recorder, mesh: Mesh) -> None:
    plane = Plane.along("x", 0.25, mesh.bounds)
    display = Display(7, "even", 0.6, True, False, False, 0)
    recorder.panel.show_state(
        State(mesh, Query((plane,), (1.0, -0.5, 0.25), quantity="potential"), display), None
    )
    planes, show = recorder.panel.planes, recorder.panel.show_group
    assert [edit.text() for edit in recorder.panel.source.fields] == ["1", "-0.5", "0.25"]
    assert planes.fraction.value() == pytest.approx(0.25)
    assert planes.slider.value() == 250
    assert [button.isChecked() for button in planes.axes.values()] == [True, False, False]
    assert planes.pose.text() == "-1,0,0/1,0,0"
    assert show.quantity.currentData() == "potential"
    assert show.colormap.currentData() == "even"
    assert (show.isolines.value(), show.opacity.value()) == (7, 60)
    assert show.barycentroid.isChecked()
    assert not show.scale_bar.isChecked()
    assert not planes.handle.isChecked()


def test_a_typed_coordinate_moves_the_source_alone(recorder: Recorder) -> None:
    write(recorder.panel.source.fields[1], "-0.125")
    assert recorder.calls == [{"source": (0.1, -0.125, 0.3)}]


def test_three_numbers_can_be_pasted(recorder: Recorder) -> None:
    write(recorder.panel.source.fields[0], "0.5, 0.25, -1e-2")
    assert recorder.calls == [{"source": (0.5, 0.25, -0.01)}]


def test_leaving_a_field_alone_does_not_round_the_source(recorder: Recorder) -> None:
    recorder.set(source=(1 / 3, 2 / 3, 1 / 7))
    recorder.calls.clear()
    for edit in recorder.panel.source.fields:
        edit.setFocus()
        QTest.keyClick(edit, Qt.Key.Key_Return)
    assert not recorder.calls


def test_typing_one_coordinate_keeps_the_others_exact(recorder: Recorder) -> None:
    recorder.set(source=(1 / 3, 2 / 3, 1 / 7))
    recorder.calls.clear()
    write(recorder.panel.source.fields[0], "0.5")
    assert recorder.calls == [{"source": (0.5, 2 / 3, 1 / 7)}]


@pytest.mark.parametrize("text", ["middle", "inf", "1e400", "nan"])
def test_what_is_no_number_is_refused_in_words(recorder: Recorder, text: str) -> None:
    write(recorder.panel.source.fields[2], text)
    assert not recorder.calls
    assert text in recorder.complaints[0]
    assert recorder.panel.source.fields[2].text() == "0.3"


def test_a_source_almost_out_of_the_range_of_floats_is_shown(recorder: Recorder) -> None:
    recorder.set(source=(1e308, 0.0, -1e-308))
    assert [edit.text() for edit in recorder.panel.source.fields] == ["1e+308", "0", "0"]


def test_the_barycentroid_becomes_the_source(recorder: Recorder) -> None:
    recorder.panel.source.at_barycentroid.click()
    assert recorder.calls == [{"source": None}]
    assert not recorder.panel.source.at_barycentroid.isEnabled()


def test_the_slider_moves_the_plane_along_its_normal(recorder: Recorder) -> None:
    recorder.panel.planes.slider.setValue(750)
    (plane,) = recorder.state.query.planes
    assert plane.normal == (0.0, 0.0, 1.0)
    assert plane.origin[2] == pytest.approx(0.25)
    assert recorder.panel.planes.fraction.value() == pytest.approx(0.75)
    assert len(recorder.calls) == 1


def test_axis_buttons_turn_the_plane_about_its_origin(recorder: Recorder) -> None:
    recorder.set(planes=(Plane((0.3, 0.1, 0.05), (1.0, 1.0, 1.0)),))
    recorder.panel.planes.axes["y"].click()
    assert recorder.state.query.planes == (Plane((0.3, 0.1, 0.05), (0.0, 1.0, 0.0)),)
    assert recorder.panel.planes.axes["y"].isChecked()


def test_a_plane_that_would_miss_the_shape_goes_through_its_middle(recorder: Recorder) -> None:
    recorder.set(planes=(Plane((5.0, 0.0, 0.0), (0.0, 0.0, 1.0)),))
    recorder.panel.planes.axes["x"].click()
    assert recorder.state.query.planes[0].origin[0] == pytest.approx(0.0)


def test_a_pose_can_be_copied_and_typed(recorder: Recorder, mesh: Mesh) -> None:
    pose = recorder.panel.planes.pose
    for text in ("0.1,0.2,0/0,1,1", "x=0.25"):
        write(pose, text)
        assert recorder.state.query.planes == (Plane.parse(text, mesh.bounds),)
        shown = Plane.parse(pose.text(), mesh.bounds)
        assert shown.origin == pytest.approx(recorder.state.query.planes[0].origin)


def test_a_pose_that_means_nothing_is_refused_in_words(recorder: Recorder) -> None:
    before = recorder.panel.planes.pose.text()
    write(recorder.panel.planes.pose, "upwards")
    assert not recorder.calls
    assert "upwards" in recorder.complaints[0]
    assert recorder.panel.planes.pose.text() == before


def test_planes_are_added_chosen_and_removed(recorder: Recorder) -> None:
    planes = recorder.panel.planes
    planes.add.click()
    planes.add.click()
    assert sorted(axis_of(plane) or "" for plane in recorder.state.query.planes) == ["x", "y", "z"]
    assert recorder.state.display.active_plane == 2
    assert planes.list.count() == 3
    planes.list.setCurrentIndex(1)
    planes.list.activated.emit(1)
    second = recorder.state.query.planes[1]
    recorder.commands.move_to(0.6)
    assert recorder.state.query.planes[1] != second
    planes.remove.click()
    planes.remove.click()
    planes.remove.click()
    assert recorder.state.query.planes == ()
    assert not planes.remove.isEnabled()
    assert not planes.slider.isEnabled()
    planes.add.click()
    assert planes.slider.isEnabled()


def test_the_plane_can_be_put_through_the_source(recorder: Recorder) -> None:
    recorder.panel.planes.through_source.click()
    (plane,) = recorder.state.query.planes
    assert plane.origin == (0.1, 0.2, 0.3)
    assert plane.normal == (0.0, 0.0, 1.0)


def test_show_controls_change_the_display_and_the_query(recorder: Recorder) -> None:
    show = recorder.panel.show_group
    show.isolines.setValue(9)
    show.opacity.setValue(40)
    show.barycentroid.click()
    show.scale_bar.click()
    recorder.panel.planes.handle.click()
    kind = recorder.panel.distance.kind
    for box, name in ((show.quantity, "potential"), (kind, "euclidean"), (show.colormap, "even")):
        box.setCurrentIndex(box.findData(name))
        box.activated.emit(box.currentIndex())
    assert recorder.state.display == Display(9, "even", 0.4, True, False, False, 0)
    assert recorder.state.query.quantity == "potential"
    assert recorder.state.query.distance == DISTANCES["euclidean"]()
    assert len(recorder.calls) == 8
