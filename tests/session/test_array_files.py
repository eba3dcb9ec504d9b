"""Files of arrays: what is read is what was written, and damage is noticed."""

from __future__ import annotations

import threading

import numpy as np
import pytest

from idviewer.core.steps import finish
from idviewer.session import array_files
from idviewer.session.array_files import DamagedError, read_steps, write_steps

HEADER = {"key": "ab", "bound": 0.1 + 0.2}


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
    finish(write_steps(path, HEADER, arrays))
    return path


@pytest.fixture
def gate(monkeypatch):
    """Writing waits for it."""
    made = threading.Event()
    save = array_files._save
    monkeypatch.setattr(array_files, "_save", lambda *given: made.wait(60.0) and save(*given))
    yield made
    made.set()


def read(path):
    return finish(read_steps(path, lambda header: True))


def assert_same(found, arrays):
    assert list(found) == list(arrays)
    for name, array in found.items():
        np.testing.assert_array_equal(array, arrays[name], strict=True)


def test_what_is_read_is_what_was_written(path, arrays):
    header, found = read(path)
    assert header == HEADER
    assert_same(found, arrays)
    assert found["columns"].flags.f_contiguous
    assert not found["columns"].flags.c_contiguous
    assert [one.name for one in path.parent.iterdir()] == [path.name]


def test_numpy_alone_can_read_it(path, arrays):
    with np.load(path, allow_pickle=False) as archive:
        np.testing.assert_array_equal(archive["rows"], arrays["rows"])


def test_of_what_is_not_expected_the_header_alone_is_read(path):
    assert finish(read_steps(path, lambda header: header["key"] != "ab")) == (HEADER, None)


def test_shares_grow_to_one(path):
    shares = list(read_steps(path, lambda header: True))
    assert shares == sorted(shares)
    assert 0.5 < shares[-1] <= 1.0


@pytest.mark.slow
def test_each_changed_byte_is_noticed_or_changes_nothing(path, arrays, rng):
    """A few bytes of a zip file are times and the like, which nobody reads."""
    content, noticed = path.read_bytes(), 0
    places = [*range(600), *range(len(content) - 700, len(content))]
    places += rng.integers(len(content), size=100).tolist()
    for place in places:
        damaged = bytearray(content)
        damaged[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged)
        try:
            header, found = read(path)
        except (DamagedError, OSError):  # an offset before the file's start
            noticed += 1
        else:
            assert header == HEADER
            assert_same(found, arrays)
    assert noticed > 0.7 * len(places)


def test_each_changed_number_is_noticed(path, arrays, rng):
    content = path.read_bytes()
    start = content.index(arrays["rows"].tobytes())
    for place in start + rng.integers(arrays["rows"].nbytes, size=40):
        damaged = bytearray(content)
        damaged[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged)
        with pytest.raises(DamagedError, match="was damaged"):
            read(path)


@pytest.mark.parametrize("length", [0, 5, 20, 24, 200, 5000, -1])
def test_half_a_file_is_noticed(path, length):
    path.write_bytes(path.read_bytes()[:length])
    with pytest.raises(DamagedError):
        read(path)


def test_other_signs_are_noticed(path, arrays):
    """Which is how eigenvectors differ."""
    content, rows = path.read_bytes(), arrays["rows"]
    assert content.count(rows.tobytes()) == 1
    path.write_bytes(content.replace(rows.tobytes(), (-rows).tobytes()))
    with pytest.raises(DamagedError):
        read(path)


@pytest.mark.parametrize("content", [b"Remember the milk.\n", b"\x93NUMPY\x01\x00", b"idviewer arrays 1\n"])
def test_another_file_is_of_another_kind(path, content):
    path.write_bytes(content)
    with pytest.raises(DamagedError, match="another kind"):
        read(path)


def test_objects_are_not_unpickled(path):
    np.savez(path.with_suffix(".npz"), header=np.array([object()], dtype=object))
    with pytest.raises(DamagedError):
        read(path.with_suffix(".npz"))


def test_a_defect_of_the_disk_is_no_damage(path):
    path.unlink()
    with pytest.raises(FileNotFoundError):
        read(path)


def test_what_is_given_up_leaves_what_was_there(path, arrays, gate):
    before = path.read_bytes()
    steps = write_steps(path, HEADER, {"rows": arrays["rows"] + 1.0})
    next(steps)
    assert len(list(path.parent.iterdir())) == 2
    steps.close()
    gate.set()
    for thread in threading.enumerate():
        if thread.name == "idviewer-beside":
            thread.join()
    assert [one.name for one in path.parent.iterdir()] == [path.name]
    assert path.read_bytes() == before


def test_a_full_disk_leaves_nothing_behind(path, arrays, monkeypatch):
    before = path.read_bytes()

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(array_files, "_save", full)
    with pytest.raises(OSError, match="No space left"):
        finish(write_steps(path, HEADER, arrays))
    assert [one.name for one in path.parent.iterdir()] == [path.name]
    assert path.read_bytes() == before
