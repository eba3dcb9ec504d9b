"""Eigenpairs kept in files: by content, as computed, within a limit, and never trusted blindly."""

from __future__ import annotations

import os
import threading
from dataclasses import replace

import numpy as np
import pytest
from tests.session.bodies import egg

from idviewer.core import Mesh, Polygon, Spectrum, eigenpairs
from idviewer.core.spectrum.eigen_solver import paper_cutoff
from idviewer.core.steps import finish
from idviewer.session import array_files, spectrum_cache
from idviewer.session.spectrum_cache import SpectrumCache

MESH = egg(2)
STAR = Polygon(
    [[np.cos(a) * r, np.sin(a) * r] for a, r in zip(np.arange(30) / 30 * 6.28, [1, 2] * 15, strict=True)]
)


def low(lambda_2: float) -> float:
    """A cut-off below the paper's, as that of a longer time."""
    return 0.3 * paper_cutoff(lambda_2)


@pytest.fixture(scope="module")
def spectrum() -> Spectrum:
    return eigenpairs(MESH)


@pytest.fixture
def cache(tmp_path) -> SpectrumCache:
    return SpectrumCache(tmp_path / "deep" / "cache")


@pytest.fixture
def filled(cache, spectrum) -> SpectrumCache:
    cache.store(MESH, spectrum)
    return cache


@pytest.fixture
def gate(filled, monkeypatch):
    """Files that are begun from now on wait for it."""
    made = threading.Event()
    save = array_files._save
    monkeypatch.setattr(array_files, "_save", lambda *given: made.wait(60.0) and save(*given))
    yield made
    made.set()


def begin_writing(steps) -> None:
    """Until the file is begun."""
    while next(steps) is not None:
        pass


def complaint(cache: SpectrumCache, shape=MESH) -> str:
    spectrum, text = finish(cache.lookup_steps(shape, paper_cutoff))
    assert spectrum is None
    return text


def the_file(cache: SpectrumCache):
    (path,) = cache.folder.iterdir()
    return path


def assert_same(one: Spectrum, other: Spectrum) -> None:
    for name in ("values", "vectors", "masses"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), strict=True)
    assert (one.residual, one.bound) == (other.residual, other.bound)
    assert one.vectors.flags.c_contiguous == other.vectors.flags.c_contiguous


@pytest.mark.parametrize("shape", [MESH, STAR], ids=["mesh", "polygon"])
def test_what_is_found_is_what_was_computed(cache, shape):
    computed = eigenpairs(shape)
    assert cache.lookup(shape, paper_cutoff) is None
    cache.store(shape, computed)
    assert_same(cache.lookup(shape, paper_cutoff), computed)
    assert cache.size == the_file(cache).stat().st_size > computed.vectors.nbytes


def test_shapes_are_told_apart_by_content_not_by_name(filled, spectrum):
    again = Mesh(MESH.vertices, MESH.faces, name="another name")
    assert_same(filled.lookup(again, paper_cutoff), spectrum)
    moved = MESH.vertices.copy()
    moved[5, 1] = np.nextafter(moved[5, 1], 2.0)
    turned = np.roll(MESH.faces, 1, axis=0)
    for other in (Mesh(moved, MESH.faces), Mesh(MESH.vertices, turned)):
        assert finish(filled.lookup_steps(other, paper_cutoff)) == (None, "")


@pytest.mark.parametrize("name", ["SOLVER_VERSION", "FORMAT_VERSION"])
def test_another_version_finds_nothing(filled, monkeypatch, name):
    monkeypatch.setattr(spectrum_cache, name, 10**6)
    assert finish(filled.lookup_steps(MESH, paper_cutoff)) == (None, "")


def test_fewer_modes_are_those_of_a_fresh_computation(filled):
    fresh, found = eigenpairs(MESH, cutoff=low), filled.lookup(MESH, low)
    assert 0 < len(fresh.values) < len(filled.lookup(MESH, paper_cutoff).values)
    np.testing.assert_allclose(found.values, fresh.values, rtol=1e-10)
    np.testing.assert_allclose(np.abs(found.vectors), np.abs(fresh.vectors), rtol=0, atol=1e-8)
    np.testing.assert_allclose(found.bound, fresh.bound, rtol=1e-10)
    assert found.vectors.base is None  # so that the others do not stay in memory


def test_more_modes_are_not_found_until_they_are_stored(cache, spectrum):
    cache.store(MESH, eigenpairs(MESH, cutoff=low))
    assert finish(cache.lookup_steps(MESH, paper_cutoff)) == (None, "")
    cache.store(MESH, spectrum)
    assert_same(cache.lookup(MESH, paper_cutoff), spectrum)


def test_all_there_are_serve_every_question(cache):
    everything = eigenpairs(MESH, cutoff=lambda lambda_2: 1e9 * lambda_2)
    assert np.isinf(everything.bound)
    cache.store(MESH, everything)
    assert_same(cache.lookup(MESH, lambda lambda_2: 1e12 * lambda_2), everything)
    assert cache.lookup(MESH, paper_cutoff).bound == paper_cutoff(everything.values[0])


def test_what_is_between_the_bounds_is_not_missing(cache, spectrum):
    """A bound that is lower, with no eigenvalue between: the same pairs, and the bound asked for."""
    bound = 0.5 * (spectrum.values[-1] + spectrum.bound)
    cache.store(MESH, spectrum)
    assert_same(cache.lookup(MESH, lambda _: bound), replace(spectrum, bound=bound))


@pytest.mark.parametrize("place", [0, 3, 300, 3000, 4096, 40_000, -20])
def test_a_damaged_byte_is_told_and_replaced(filled, spectrum, place):
    path = the_file(filled)
    content = bytearray(path.read_bytes())
    content[place] ^= 0x10
    path.write_bytes(content)
    assert complaint(filled) in ("was damaged", "was of another kind")
    filled.store(MESH, spectrum)
    assert_same(filled.lookup(MESH, paper_cutoff), spectrum)


def test_half_a_file_is_told(filled):
    path = the_file(filled)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    assert complaint(filled) == "was damaged"


def test_a_file_of_the_former_format_is_not_found(filled, monkeypatch):
    """Its name is made from another version of the format."""
    the_file(filled).unlink()
    with monkeypatch.context() as patch:
        patch.setattr(spectrum_cache, "FORMAT_VERSION", 1)
        former = finish(spectrum_cache.key_steps(MESH))
    (filled.folder / f"{former}.kept").write_bytes(b"idviewer arrays 1\n")
    assert finish(filled.lookup_steps(MESH, paper_cutoff)) == (None, "")


def test_a_text_is_told(filled):
    the_file(filled).write_text("This is no spectrum.")
    assert complaint(filled) == "was of another kind"


def test_the_file_of_another_shape_is_told(filled, tmp_path):
    elsewhere = SpectrumCache(tmp_path / "elsewhere")
    elsewhere.store(STAR, eigenpairs(STAR))
    os.replace(the_file(elsewhere), the_file(filled))
    assert complaint(filled) == "was of another shape or version"


def test_a_folder_in_place_of_the_file_is_told(filled):
    path = the_file(filled)
    path.unlink()
    path.mkdir()
    assert complaint(filled) == "could not be read: Is a directory"


def test_those_used_longest_ago_make_room(tmp_path, spectrum):
    shapes = [Mesh(MESH.vertices * scale, MESH.faces) for scale in (1.0, 2.0, 3.0)]
    SpectrumCache(tmp_path).store(shapes[0], spectrum)
    one = SpectrumCache(tmp_path).size
    cache = SpectrumCache(tmp_path, limit=int(2.5 * one))
    cache.store(shapes[1], spectrum)
    for age, path in enumerate(sorted(tmp_path.iterdir())):
        os.utime(path, (1e9 + age, 1e9 + age))
    assert cache.lookup(shapes[0], paper_cutoff) is not None  # which is a use
    cache.store(shapes[2], spectrum)
    assert cache.size == 2 * one
    assert [cache.lookup(shape, paper_cutoff) is not None for shape in shapes] == [True, False, True]


def test_what_takes_a_large_share_is_not_kept(tmp_path, spectrum):
    cache = SpectrumCache(tmp_path, limit=int(1.5 * spectrum.vectors.nbytes))
    cache.store(MESH, spectrum)
    assert cache.size == 0


def test_two_that_write_at_a_time_do_no_harm(cache, spectrum, gate):
    first, second = (cache.save_steps(MESH, spectrum) for _ in range(2))
    for steps in (first, second):  # both have begun their files
        begin_writing(steps)
    assert sorted(path.suffix for path in cache.folder.iterdir()) == [".kept", ".part", ".part"]
    gate.set()
    finish(first)
    assert_same(cache.lookup(MESH, paper_cutoff), spectrum)
    finish(second)
    assert_same(cache.lookup(MESH, paper_cutoff), spectrum)
    assert the_file(cache)


def test_one_that_reads_is_not_disturbed_by_another_that_clears(filled, spectrum):
    steps = filled.lookup_steps(MESH, paper_cutoff)
    while next(steps) == 0.0:
        pass
    assert filled.clear() > 0
    assert_same(finish(steps).spectrum, spectrum)
    assert list(filled.folder.iterdir()) == []


def test_clearing_spares_what_is_not_its_own_and_what_is_being_written(filled, spectrum, gate):
    note = filled.folder / "note.txt"
    note.write_text("mine")
    size, steps = filled.size, filled.save_steps(MESH, spectrum)
    begin_writing(steps)
    assert filled.clear() == size
    gate.set()
    finish(steps)
    assert_same(filled.lookup(MESH, paper_cutoff), spectrum)
    assert note.read_text() == "mine"


def test_what_a_program_that_crashed_left_goes_after_an_hour(filled, spectrum):
    left = filled.folder / "abc.part"
    left.write_bytes(b"half")
    filled.store(MESH, spectrum)
    assert left.exists()
    os.utime(left, (1e9, 1e9))
    filled.store(MESH, spectrum)
    assert not left.exists()


def test_without_a_folder_there_is_nothing(tmp_path, spectrum):
    (tmp_path / "file").write_text("")
    cache = SpectrumCache(tmp_path / "file" / "cache")
    assert finish(cache.lookup_steps(MESH, paper_cutoff)) == (None, "")
    assert (cache.size, cache.clear()) == (0, 0)
    with pytest.raises(OSError, match="Not a directory"):
        cache.store(MESH, spectrum)


def test_the_user_s_own_is_where_their_system_keeps_caches(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert SpectrumCache.of_user().folder == tmp_path / "idviewer" / "eigenpairs"
