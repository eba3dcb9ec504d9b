"""Files of arrays: what is read is what was written, and any damage is noticed."""

from __future__ import annotations

import io
import os

import numpy as np
import pytest

from idviewer.core.steps import finish
from idviewer.session import stored_arrays
from idviewer.session.stored_arrays import DamagedError, read_about, read_steps, write_steps

ABOUT = {"key": "ab", "bound": 0.1 + 0.2}


@pytest.fixture
def arrays(rng):
    rows = rng.standard_normal((700, 3))
    return {
        "rows": rows,
        "columns": np.asfortranarray(rows[:500]),
        "every other": rows[::2, 1],
        "odd": np.arange(7, dtype=np.int32),
        "numbers": np.arange(512),
        "none": np.empty((0, 4)),
    }


@pytest.fixture
def path(tmp_path, arrays):
    path = tmp_path / "some.arrays"
    finish(write_steps(path, ABOUT, arrays))
    return path


def read(file):
    about, entries = read_about(file)
    return about, finish(read_steps(file, entries))


def read_file(path):
    with open(path, "rb", buffering=0) as file:
        return read(file)


def test_what_is_read_is_what_was_written(path, arrays):
    about, found = read_file(path)
    assert about == ABOUT
    assert list(found) == list(arrays)
    for name, array in found.items():
        np.testing.assert_array_equal(array, arrays[name], strict=True)
    assert found["columns"].flags.f_contiguous
    assert not found["columns"].flags.c_contiguous
    assert [one.name for one in path.parent.iterdir()] == [path.name]


def test_pieces_make_no_difference(path, monkeypatch):
    whole = read_file(path)[1]
    monkeypatch.setattr(stored_arrays, "PIECE", 100)
    for name, array in read_file(path)[1].items():
        np.testing.assert_array_equal(array, whole[name])


def test_each_changed_byte_is_noticed(path, rng):
    content = path.read_bytes()
    places = [0, 15, 18, 20, 24, 100, 4096, len(content) - 1]
    for place in [*places, *rng.integers(len(content), size=40)]:
        damaged = bytearray(content)
        damaged[place] ^= 1 << int(rng.integers(8))
        with open_bytes(path, bytes(damaged)) as file, pytest.raises(DamagedError):
            read(file)


@pytest.mark.parametrize("length", [0, 5, 20, 24, 200, 5000, -1])
def test_half_a_file_is_noticed(path, length):
    content = path.read_bytes()
    with open_bytes(path, content[:length]) as file, pytest.raises(DamagedError):
        read(file)


def test_other_signs_are_noticed(path, arrays):
    """Which is how eigenvectors differ."""
    content, rows = path.read_bytes(), arrays["rows"]
    assert content.count(rows.tobytes()) == 1
    with (
        open_bytes(path, content.replace(rows.tobytes(), (-rows).tobytes())) as file,
        pytest.raises(DamagedError),
    ):
        read(file)


def test_a_text_is_of_another_kind(path):
    with open_bytes(path, b"Remember the milk.\n") as file, pytest.raises(DamagedError, match="another kind"):
        read(file)


def test_what_is_given_up_leaves_what_was_there(path, arrays):
    before = path.read_bytes()
    steps = write_steps(path, ABOUT, {"rows": arrays["rows"] + 1.0})
    for _ in range(3):
        next(steps)
    assert len(list(path.parent.iterdir())) == 2
    steps.close()
    assert [one.name for one in path.parent.iterdir()] == [path.name]
    assert path.read_bytes() == before


def test_a_full_disk_leaves_nothing_behind(path, arrays, monkeypatch):
    before = path.read_bytes()

    def full(*_):
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr(stored_arrays, "_put_steps", full)
    with pytest.raises(OSError, match="No space left"):
        finish(write_steps(path, ABOUT, arrays))
    assert [one.name for one in path.parent.iterdir()] == [path.name]
    assert path.read_bytes() == before


def open_bytes(path, content: bytes) -> io.FileIO:
    path.write_bytes(content)
    return open(path, "rb", buffering=0)
