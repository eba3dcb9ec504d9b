"""The distance's controls: they show any state without calling anything, and call once for each change."""

from __future__ import annotations

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot
from tests.core import shapes
from tests.view.frames import frame

from idviewer.core import DISTANCES, GPS, Diffusion, Distance, Euclidean, Mesh
from idviewer.session.state import Frame, Query, State
from idviewer.view.panel import Calls
from idviewer.view.panel_distance import DistanceGroup, ParameterRow

LAMBDA_2 = 0.5
DEFAULT = 0.25
"""1 / (8 lambda_2)"""


class Recorder:
    """Plays the session."""

    def __init__(self) -> None:
        self.mesh = Mesh(*shapes.icosphere(1))
        self.calls: list[Distance] = []
        self.complaints: list[str] = []
        self.group = DistanceGroup(Calls(self.set, self.complaints.append))
        self.show(Diffusion())

    def set(self, distance: Distance) -> None:
        self.calls.append(distance)
        self.show(distance)

    def show(self, distance: Distance, known: bool = True) -> None:
        made: Frame = frame(self.mesh, lambda_2=LAMBDA_2)
        self.group.show_state(State(self.mesh, Query(distance=distance)), made if known else None)

    def choose(self, name: str) -> None:
        kind = self.group.kind
        kind.setCurrentIndex(kind.findData(name))
        kind.activated.emit(kind.currentIndex())

    @property
    def row(self) -> ParameterRow:
        return self.group.rows["diffusion", "time"]


@pytest.fixture
def recorder(qtbot: QtBot) -> Recorder:
    recorder = Recorder()
    qtbot.addWidget(recorder.group)
    recorder.group.show()
    return recorder


def write(row: ParameterRow, text: str) -> None:
    row.field.setFocus()
    row.field.selectAll()
    row.field.insert(text)  # QTest knows no ₀
    QTest.keyClick(row.field, Qt.Key.Key_Return)


def test_showing_calls_nothing(recorder: Recorder) -> None:
    for time in (None, DEFAULT / 8, DEFAULT, 64 * DEFAULT, 1e-30, 1e30):
        recorder.show(Diffusion(time=time))
        recorder.show(Diffusion(time=time), known=False)
    for kind in DISTANCES.values():
        recorder.show(kind())
    assert not recorder.calls
    assert not recorder.complaints


def test_the_default_is_the_slider_s_zero(recorder: Recorder) -> None:
    row = recorder.row
    assert row.slider.value() == 0
    assert row.field.text() == "0.25"
    assert row.multiple.text() == "= 1 t₀"
    assert not row.reset.isEnabled()
    row.slider.setValue(24)
    row.slider.setValue(0)
    assert recorder.calls == [Diffusion(time=2 * DEFAULT), Diffusion()]


def test_each_step_is_its_own_time_and_the_slider_stays_where_it_is(recorder: Recorder) -> None:
    row = recorder.row
    assert 2.0 ** (row.slider.minimum() / 24) == pytest.approx(1 / 8)
    assert 2.0 ** (row.slider.maximum() / 24) == pytest.approx(64)
    for steps in range(row.slider.minimum(), row.slider.maximum() + 1):
        row.slider.setValue(steps)
        assert row.slider.value() == steps
        assert row.field.text() == f"{recorder.calls[-1].resolved_time(None) if steps else DEFAULT:.6g}"
    assert len(set(recorder.calls)) == row.slider.maximum() - row.slider.minimum() + 1


def test_what_is_shown_is_what_is_computed_with(recorder: Recorder) -> None:
    recorder.row.slider.setValue(7)
    (distance,) = recorder.calls
    assert float(recorder.row.field.text()) == distance.time


@pytest.mark.parametrize(
    ("text", "time"), [("0.75", 0.75), ("1e-3", 1e-3), ("4t0", 1.0), ("0.5 t₀", 0.125), ("t0", 0.25)]
)
def test_a_time_can_be_typed(recorder: Recorder, text: str, time: float) -> None:
    write(recorder.row, text)
    assert recorder.calls == [Diffusion(time=time)]
    assert recorder.row.field.text() == f"{time:.6g}"
    assert recorder.row.reset.isEnabled()
    recorder.row.reset.click()
    assert recorder.calls[1:] == [Diffusion()]


@pytest.mark.parametrize("text", ["soon", "", "1 2", "-1", "0", "nan", "x t0"])
def test_what_is_no_time_is_refused_in_words(recorder: Recorder, text: str) -> None:
    write(recorder.row, text or " ")
    assert not recorder.calls
    assert len(recorder.complaints) == 1
    assert recorder.row.field.text() == "0.25"


def test_leaving_the_field_alone_changes_nothing(recorder: Recorder) -> None:
    recorder.show(Diffusion(time=1 / 3))
    recorder.row.field.setFocus()
    QTest.keyClick(recorder.row.field, Qt.Key.Key_Return)
    assert not recorder.calls


def test_only_the_kind_s_own_parameters_are_seen(recorder: Recorder) -> None:
    assert recorder.row.isVisible()
    for distance in (GPS(), Euclidean()):
        recorder.show(distance)
        assert not recorder.row.isVisible()
        assert recorder.group.kind.currentText() == distance.title
    recorder.show(Diffusion(), known=False)
    assert recorder.row.isVisible()
    assert not recorder.row.isEnabled(), "the default is not known before the eigenpairs are"


def test_a_kind_chosen_again_has_its_time_again_until_the_mesh_changes(recorder: Recorder) -> None:
    recorder.row.slider.setValue(48)
    recorder.choose("biharmonic")
    recorder.choose("diffusion")
    assert recorder.calls[-1] == Diffusion(time=4 * DEFAULT)
    recorder.choose("gps")
    recorder.mesh = Mesh(*shapes.icosphere(1))
    recorder.show(GPS())
    recorder.choose("diffusion")
    assert recorder.calls[-1] == Diffusion()
