"""Several shapes in one file: named, chosen by name or place, refused otherwise."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.core import meshfiles, shapes

from idviewer.core import MeshError, read_mesh, read_shape
from idviewer.core.errors import Part
from idviewer.core.io import Contents, FileSource, PartError, add_reader, formats, inspect_file
from idviewer.core.io.off import read_off

PARTS = (Part("left", "volume 1"), Part("7"), Part("right"))


@pytest.fixture(autouse=True)
def _table_as_before(monkeypatch):
    monkeypatch.setattr(formats, "_FORMATS", dict(formats._FORMATS))


def source(part: str | None) -> FileSource:
    return FileSource(b"", Path("a.json"), part)


@pytest.mark.parametrize(("part", "number"), [("left", 0), ("7", 1), ("right", 2), ("3", 2), ("1", 0)])
def test_a_part_goes_by_its_name_or_else_its_place(part, number):
    assert source(part).chosen(PARTS, "features") == number


def test_one_part_needs_no_choice_and_none_has_none():
    assert source(None).chosen(PARTS[:1], "features") == 0
    assert source(None).chosen((), "features") is None


@pytest.mark.parametrize(
    ("part", "told"),
    [
        (None, r"3 features: 'left' \(volume 1\), '7', 'right'; choose one by its name, part='left'"),
        ("up", r"it has no 'up' among its features; there are 'left' \(volume 1\), '7', 'right'"),
        ("0", "it has no '0'"),
        ("4", "it has no '4'"),
    ],
)
def test_what_is_ambiguous_or_missing_is_refused_with_all_parts(part, told):
    with pytest.raises(PartError, match=told) as raised:
        source(part).chosen(PARTS, "features")
    assert raised.value.parts == PARTS


def test_many_parts_are_not_all_named():
    many = [Part(str(number)) for number in range(100)]
    with pytest.raises(PartError, match=r"100 labels: '0', .*'7', \.\.\.; choose"):
        source(None).chosen(many, "labels")


def test_the_door_hands_parts_notes_and_the_unit_on(tmp_path):
    def read(given: FileSource) -> Contents:
        given.chosen(PARTS, "labels")
        return Contents(read_off(given.data).geometry, ("A label was passed over.",), "mm")

    add_reader((".nii.foo",), read, holds_parts=True)
    path = tmp_path / "body.NII.foo"
    path.write_bytes(meshfiles.off(*shapes.cube()))
    for opened in (read_mesh(path, part="left"), read_shape(path, part="2")):
        assert (opened.unit, opened.notes) == ("mm", ("A label was passed over.",))
    assert inspect_file(path, part="left").unit == "mm"
    with pytest.raises(MeshError, match=r"body.NII.foo: it holds 3 labels: ") as raised:
        read_shape(path)
    assert raised.value.parts == PARTS


def test_a_part_of_a_format_without_parts_is_refused(tmp_path):
    path = tmp_path / "body.off"
    path.write_bytes(meshfiles.off(*shapes.cube()))
    with pytest.raises(MeshError, match=r"body.off: it holds one shape, and no part 'a'; leave the part out"):
        read_mesh(path, part="a")
