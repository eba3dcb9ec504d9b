"""The distance's controls: they show any state without calling anything, and call once for each change."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot
from tests.core import shapes
from tests.view.frames import frame

from idviewer.core import (
    DISTANCES,
    GPS,
    Diffusion,
    Distance,
    Euclidean,
    Geodesic,
    GivenDistances,
    Mesh,
    SpectralFilter,
    parameters_of,
)
from idviewer.session.state import Frame, Query, State
from idviewer.view.panel import Calls
from idviewer.view.panel_distance import DistanceGroup
from idviewer.view.parameter_rows import ChoiceRow, ParameterRow

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


def test_every_kind_is_in_the_menu_with_a_row_for_each_parameter(recorder: Recorder) -> None:
    titles = [recorder.group.kind.itemText(index) for index in range(recorder.group.kind.count())]
    assert titles == [kind.title for kind in DISTANCES.values()]
    for name, kind in DISTANCES.items():
        recorder.show(kind())
        shown = {key for key, row in recorder.group.rows.items() if row.isVisible()}
        assert shown == {(name, parameter) for parameter in parameters_of(kind)}


def test_a_whole_number_is_turned_and_a_choice_chosen(recorder: Recorder) -> None:
    recorder.choose("geodesic")
    landmarks = recorder.group.rows["geodesic", "landmarks"].box
    method = recorder.group.rows["geodesic", "method"].box
    assert landmarks.text() == "automatic"
    landmarks.setValue(50)
    method.setCurrentIndex(method.findData("exact"))
    method.activated.emit(method.currentIndex())
    landmarks.setValue(landmarks.minimum())
    assert recorder.calls == [
        Geodesic(),
        Geodesic(landmarks=50),
        Geodesic(landmarks=50, method="exact"),
        Geodesic(method="exact"),
    ]
    recorder.show(Geodesic(landmarks=7))
    assert (landmarks.value(), method.currentData()) == (7, "heat")
    assert len(recorder.calls) == 4, "showing called"


def test_a_wrong_expression_is_told_beside_it_and_nothing_is_lost(recorder: Recorder) -> None:
    recorder.choose("filter")
    row = recorder.group.rows["filter", "filter"]
    write(row, "1 / lambda")
    assert recorder.calls[1:] == [SpectralFilter("1 / lambda")]
    assert not row.error.isVisible()
    write(row, "1 / (lambda + os)")
    assert len(recorder.calls) == 2
    assert row.error.isVisible()
    assert '"os" at character 15' in row.error.text()
    recorder.show(SpectralFilter("1 / lambda"))
    assert row.field.text() == "1 / (lambda + os)", "what was typed can be mended"
    write(row, "1 / (lambda + 2)")
    assert recorder.calls[2:] == [SpectralFilter("1 / (lambda + 2)")]
    assert not row.error.isVisible()
    assert not recorder.complaints


def test_a_kind_that_needs_a_file_waits_for_it(recorder: Recorder) -> None:
    recorder.choose("matrix")
    row = recorder.group.rows["matrix", "matrix"]
    assert not recorder.calls, "what is shown stays"
    assert row.isVisible()
    assert "n x n distances" in row.note.text()
    recorder.show(Diffusion())
    assert recorder.group.kind.currentData() == "matrix", "a frame that arrives does not take the choice back"
    fit = recorder.group.rows["matrix", "fit"].box
    fit.setCurrentIndex(fit.findData("approximate"))
    fit.activated.emit(fit.currentIndex())
    assert not recorder.calls
    row.choose("/somewhere/d.npy")
    assert recorder.calls == [GivenDistances("/somewhere/d.npy", fit="approximate")]
    assert row.note.text() == "d.npy"


def test_a_file_dialog_that_is_cancelled_says_why_nothing_happens(recorder: Recorder, tmp_path: Path) -> None:
    recorder.choose("matrix")
    row = recorder.group.rows["matrix", "matrix"]
    row.button.click()
    assert row.dialog is not None
    assert row.dialog.isVisible()
    row.dialog.reject()
    assert row.note.text().startswith("No file was chosen, so nothing has changed.")
    assert not recorder.calls


def test_a_file_that_failed_is_asked_for_again(recorder: Recorder) -> None:
    recorder.choose("matrix")
    recorder.group.rows["matrix", "matrix"].choose("/bad.npy")
    recorder.show(Diffusion())  # the session went back
    recorder.choose("matrix")
    assert recorder.calls == [GivenDistances("/bad.npy")]
    assert recorder.group.rows["matrix", "matrix"].isVisible()


def test_a_method_that_is_not_installed_says_which_extra_it_needs(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    def method() -> ChoiceRow:
        group = DistanceGroup(Calls(lambda **fields: None, lambda text: None))
        qtbot.addWidget(group)
        return group.rows["geodesic", "method"]

    assert [method().box.itemText(index) for index in range(2)] == ["Heat method", "Exact (slow)"]
    assert "install" not in method().box.toolTip()
    monkeypatch.setitem(sys.modules, "pygeodesic", None)
    assert [method().box.itemText(index) for index in range(2)] == [
        "Heat method",
        "Exact (slow), not installed",
    ]
    assert method().box.toolTip().endswith("pip install 'idviewer[exact-geodesics]'")
