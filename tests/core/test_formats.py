"""The table of formats: what is added to it is read, and what lacks its reader says so."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from tests.core import meshfiles, shapes

from idviewer.core import MeshError, ShapeError, read_mesh, read_shape
from idviewer.core.io import formats
from idviewer.core.io.formats import add_reader, readable_suffixes
from idviewer.core.io.off import read_off
from idviewer.core.io.text import UnreadableError


@pytest.fixture(autouse=True)
def _table_as_before(monkeypatch):
    monkeypatch.setattr(formats, "_FORMATS", dict(formats._FORMATS))


def file_of(folder: Path, name: str) -> Path:
    path = folder / name
    path.write_bytes(meshfiles.off(*shapes.cube()))
    return path


def test_further_suffixes_are_read_by_what_was_added(tmp_path):
    seen = []

    def read(source):
        seen.append(source.path)
        return read_off(source.data)

    add_reader((".Foo", ".bar"), read)
    assert {".foo", ".bar"} <= set(readable_suffixes(3))
    assert not {".foo", ".bar"} & set(readable_suffixes(2))
    for name in ("a.foo", "a.BAR"):
        assert read_mesh(file_of(tmp_path, name)).volume == 1.0
        assert read_shape(tmp_path / name).name == "a"
    assert seen[0] == tmp_path / "a.foo"


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (UnreadableError("the end is missing"), "not a whole FOO file: the end is missing; export it again"),
        (KeyError("end"), r"not a readable FOO file \(KeyError: 'end'\); export it again"),
    ],
)
def test_errors_of_added_readers_become_one_line(tmp_path, error, told):
    def read(source):
        raise error

    add_reader((".foo",), read)
    with pytest.raises(MeshError, match=told):
        read_mesh(file_of(tmp_path, "a.foo"))


def test_a_suffix_without_its_reader_says_where_that_comes_from(tmp_path):
    add_reader((".foo",), None, hint="pip install foo")
    for read in (read_mesh, read_shape):
        with pytest.raises(
            ShapeError, match=r"the reader of '\.foo' files is missing \(pip install foo\); save"
        ) as caught:
            read(file_of(tmp_path, "a.foo"))
        assert "\n" not in str(caught.value)
    assert ".foo" not in readable_suffixes()


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".vtp", ".vtu", ".vtk"])
def test_the_core_alone_names_the_way_to_files_of_vtk(tmp_path, suffix):
    """In a process of its own, as windows of other tests register the reader."""
    path = file_of(tmp_path, f"a{suffix}")
    program = f"from idviewer.core import MeshError, read_mesh\ntry: read_mesh({str(path)!r})\n"
    program += "except MeshError as error: print(error)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert f"{path}: the reader of '{suffix}' files is missing (call idviewer.view" in done.stdout
    assert "; save it as one of .off, .obj" in done.stdout


@pytest.mark.parametrize("suffix", ["foo", "", "."])
def test_suffixes_begin_with_a_dot(suffix):
    with pytest.raises(ValueError, match="begins with a dot"):
        add_reader((suffix,), None)
