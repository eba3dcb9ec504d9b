"""The Open dialog offers what can be read; the picture dialog asks for a name."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from PySide6.QtCore import QSize
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from idviewer.core import ShapeError, read_shape
from idviewer.core.io import readable_suffixes
from idviewer.view.dialogs import PictureDialog, PictureRequest, open_dialog


@pytest.fixture
def filters(qtbot: QtBot) -> dict[str, set[str]]:
    parent = QWidget()
    qtbot.addWidget(parent)
    lines = open_dialog("", parent).nameFilters()
    return {line.partition(" (")[0]: set(re.findall(r"\*((?:\.\w+)+)", line)) for line in lines}


def test_every_readable_suffix_is_offered(filters: dict[str, set[str]]) -> None:
    assert filters["Meshes"] == set(readable_suffixes(3))
    assert filters["Polygons"] == set(readable_suffixes(2))
    assert filters["Shapes"] == set(readable_suffixes())
    assert {".gltf", ".geojson"} <= filters["Shapes"]
    assert filters["All files"] == set()


def test_the_readers_name_usual_ones_among_them(filters: dict[str, set[str]], tmp_path: Path) -> None:
    path = tmp_path / "shape.doc"
    path.write_text("nothing")
    with pytest.raises(ShapeError) as caught:
        read_shape(path)
    _, named = str(caught.value).split("save it as one of ")
    usual = set(named.split(", "))
    assert usual <= filters["Shapes"]
    assert {".off", ".stl", ".3mf", ".svg"} <= usual


@pytest.mark.parametrize("text", ["", "  ", "/", "..", "pictures/.."])
def test_without_a_name_the_picture_dialog_goes_on_asking(qtbot: QtBot, text: str) -> None:
    dialog = PictureDialog(QSize(100, 80), Path("a.png"))
    qtbot.addWidget(dialog)
    chosen: list[PictureRequest] = []
    dialog.chosen.connect(chosen.append)
    dialog.show()
    dialog.path.setText(text)
    dialog.accept()
    assert dialog.isVisible()
    dialog.path.setText("~nobody_at_all/b")
    dialog.accept()
    assert [request.path for request in chosen] == [Path("~nobody_at_all/b.png")]
