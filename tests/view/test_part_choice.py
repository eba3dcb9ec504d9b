"""Files of several shapes in the window: listed, found by name, chosen by the mouse and by keys."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtWidgets import QDialogButtonBox
from pytestqt.qtbot import QtBot
from tests.core.polygonfiles import written
from tests.view.mouse import Mouse
from tests.view.windows import focus, show_window, told, wait_until_done

from idviewer.view.part_choice import Choice, PartDialog
from idviewer.view.window import MainWindow

BOXES = {"shed": (0, 0, 1, 1), "yard": (5, 0, 3, 2), "field": (0, 5, 20, 9)}


@pytest.fixture
def fields(tmp_path: Path) -> Path:
    features = [
        {
            "type": "Feature",
            "properties": {"name": name},
            "geometry": {
                "type": "Polygon",
                "coordinates": [[[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]]],
            },
        }
        for name, (x, y, w, h) in BOXES.items()
    ]
    return written(
        tmp_path, "fields.geojson", json.dumps({"type": "FeatureCollection", "features": features})
    )


@pytest.fixture
def twelve(tmp_path: Path) -> Path:
    """Twelve blocks, the fourth of which is in two pieces."""
    voxels = np.zeros((13, 16, 5), np.uint8)
    for label in range(1, 13):
        i, j = divmod(label - 1, 4)
        voxels[4 * i + 1 : 4 * i + 4, 4 * j + 1 : 4 * j + 3, 1:4] = label
    voxels[2, 13:15, 1:4] = 0
    np.save(tmp_path / "twelve.npy", voxels)
    return tmp_path / "twelve.npy"


def dialog_of(qtbot: QtBot, window: MainWindow) -> PartDialog:
    qtbot.waitUntil(lambda: isinstance(window._dialog, PartDialog) and window._dialog.isVisible())
    dialog = window._dialog
    assert isinstance(dialog, PartDialog)
    focus(qtbot, dialog)
    return dialog


def rows_of(dialog: PartDialog) -> list[tuple[str, str]]:
    items = [dialog.list.topLevelItem(row) for row in range(dialog.list.topLevelItemCount())]
    return [(item.text(0), item.text(1)) for item in items if not item.isHidden()]


def point_in_row(dialog: PartDialog, row: int) -> tuple[float, float]:
    middle = dialog.list.visualItemRect(dialog.list.topLevelItem(row)).center()
    return middle.x(), middle.y()


def test_a_feature_is_chosen_by_the_mouse(qtbot: QtBot, mouse: Mouse, fields: Path) -> None:
    window = show_window(qtbot)
    window.open(fields)
    assert told(qtbot, window, "fields.geojson holds 3 shapes")
    dialog = dialog_of(qtbot, window)
    assert rows_of(dialog) == [("shed", "1 x 1"), ("yard", "3 x 2"), ("field", "20 x 9")]
    assert dialog.search.isHidden()
    mouse.click(dialog.list.viewport(), *point_in_row(dialog, 1))
    mouse.click(dialog.buttons.button(QDialogButtonBox.StandardButton.Open))
    wait_until_done(qtbot, window.session)
    assert window.session.state.shape.area == 6.0
    assert window._dialog is None


def test_a_choice_put_off_is_offered_by_the_message_bar(qtbot: QtBot, mouse: Mouse, fields: Path) -> None:
    window = show_window(qtbot)
    window.open(fields)
    dialog_of(qtbot, window)
    mouse.key("Escape")
    qtbot.waitUntil(lambda: window._dialog is None)
    assert window.session.state.shape is None
    focus(qtbot, window)
    mouse.click(window.messages.button)
    dialog = dialog_of(qtbot, window)
    mouse.key("Down", "Down", "Return")
    wait_until_done(qtbot, window.session)
    assert window.session.state.shape.area == 180.0
    assert dialog is not window._dialog


def test_one_of_twelve_labels_is_found_and_its_pieces_are_offered(
    qtbot: QtBot, mouse: Mouse, twelve: Path
) -> None:
    window = show_window(qtbot)
    window.open(twelve)
    dialog = dialog_of(qtbot, window)
    assert len(rows_of(dialog)) == 12
    mouse.click(dialog.search)
    mouse.type("12 voxels")
    assert rows_of(dialog) == [("4", "12 voxels")]
    mouse.key("Return")
    qtbot.waitUntil(lambda: window._dialog is not dialog)
    pieces = dialog_of(qtbot, window)
    assert told(qtbot, window, "twelve.npy holds 2 components")
    names = [name for name, _ in rows_of(pieces)]
    assert names == ["Component 1", "Component 2"]
    mouse.click(pieces.list.viewport(), *point_in_row(pieces, 1))
    mouse.key("Return")
    wait_until_done(qtbot, window.session)
    assert window.session.state.shape.volume == pytest.approx(6.0, rel=1e-2)


def test_what_is_not_found_cannot_be_opened(qtbot: QtBot, mouse: Mouse) -> None:
    dialog = PartDialog("nine", tuple(Choice(str(n), f"size {n}", part=str(n)) for n in range(9)))
    qtbot.addWidget(dialog)
    chosen: list[Choice] = []
    dialog.chosen.connect(chosen.append)
    dialog.show()
    focus(qtbot, dialog)
    mouse.click(dialog.search)
    mouse.type("x")
    opening = dialog.buttons.button(QDialogButtonBox.StandardButton.Open)
    assert (rows_of(dialog), dialog.choice, opening.isEnabled()) == ([], None, False)
    mouse.key("Return")
    assert dialog.isVisible()
    mouse.key("BackSpace")
    mouse.click(dialog.search)
    mouse.type("size 7")
    mouse.click(opening)
    assert [choice.part for choice in chosen] == ["7"]
