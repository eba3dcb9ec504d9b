"""A shape seen before: its eigenpairs come from the cache, and what is wrong there is told and mended."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from tests.session.bodies import WatchedSession, egg

from idviewer.core import Diffusion, Euclidean, Mesh, Plane
from idviewer.session import array_cache, array_files
from idviewer.session import eigenpair_source as eigenpairs
from idviewer.session.eigenpair_source import COMPUTING, READING
from idviewer.session.pipeline import Pipeline
from idviewer.session.run_to_end import run_to_end
from idviewer.session.spectrum_cache import SpectrumCache
from idviewer.session.state import Frame, FrameRequest, Progress, Query

MESH = egg(2)
PLANE = Plane((0.1, 0.0, 0.0), (1.0, 0.2, 0.1))
QUERY = Query(planes=(PLANE,), source=(0.0, 0.3, 0.5))


@pytest.fixture
def cache(tmp_path) -> SpectrumCache:
    """One that keeps also what took no time."""
    return SpectrumCache(tmp_path / "cache", worth=0.0)


@pytest.fixture
def filled(cache) -> SpectrumCache:
    run_to_end(MESH, QUERY, Pipeline(cache))
    return cache


@pytest.fixture
def no_solver(monkeypatch):
    """Fails a test that computes eigenpairs."""

    def refuse(*_):
        raise AssertionError("eigenpairs were computed")

    monkeypatch.setattr(eigenpairs, "eigenpair_steps", refuse)


def results(cache: SpectrumCache | None, query: Query = QUERY, mesh: Mesh = MESH) -> list:
    return [one for one in Pipeline(cache).results(FrameRequest(mesh, query)) if one is not None]


def stages(results: list) -> list[str]:
    return list(dict.fromkeys(one.stage for one in results if isinstance(one, Progress)))


def frames(results: list) -> list[Frame]:
    return [one for one in results if isinstance(one, Frame)]


def files(cache: SpectrumCache) -> list[Path]:
    return list(cache.folder.iterdir()) if cache.folder.exists() else []


def test_a_shape_seen_before_never_calls_the_solver(filled, no_solver):
    again = results(filled, mesh=Mesh(MESH.vertices, MESH.faces, name="another name"))
    assert READING in stages(again)
    assert COMPUTING not in stages(again)
    assert frames(again)[-1].exact
    assert frames(again)[-1].remarks == ()


def test_its_frames_are_those_of_a_fresh_computation(filled):
    for fresh, again in zip(frames(results(None)), frames(results(filled)), strict=True):
        np.testing.assert_array_equal(again.slices[0].values, fresh.slices[0].values)
        assert (again.value_range, again.title) == (fresh.value_range, fresh.title)


def test_a_session_opens_it_without_the_solver(filled, no_solver):
    with WatchedSession(filled) as desk:
        desk.session.show(MESH)
        desk.settle()
        assert desk.session.frame.exact
        assert desk.told("failed") == []


def test_the_first_frame_does_not_wait_for_the_writing(cache):
    steps = Pipeline(cache).results(FrameRequest(MESH, QUERY))
    next(one for one in steps if isinstance(one, Frame))
    assert files(cache) == []
    list(steps)
    assert cache.lookup(MESH, Diffusion().cutoff) is not None


def test_writing_goes_on_with_the_next_request(cache):
    pipeline = Pipeline(cache)
    for _ in range(20):  # as in a drag, each is left one step after its first frame
        steps = pipeline.results(FrameRequest(MESH, QUERY))
        next(one for one in steps if isinstance(one, Frame))
        next(steps)
        steps.close()
        if [path.suffix for path in files(cache)] == [array_cache.SUFFIX]:
            break
    else:
        pytest.fail("it was never finished")


def test_a_shorter_time_computes_and_keeps_more(filled):
    short = Query(QUERY.planes, QUERY.source, Diffusion(time=0.05 * 0.23))
    assert COMPUTING in stages(results(filled, short))
    assert COMPUTING not in stages(results(filled, short))
    assert COMPUTING not in stages(results(filled))


@pytest.mark.parametrize("damage", ["a byte", "half", "a text"])
def test_damage_is_remarked_once_and_mended(filled, damage):
    (path,) = files(filled)
    content = path.read_bytes()
    at = len(content) // 2
    path.write_bytes(
        {
            "a byte": content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :],
            "half": content[:at],
            "a text": b"This is no spectrum.",
        }[damage]
    )
    told = results(filled)
    assert COMPUTING in stages(told)
    assert {len(frame.remarks) for frame in frames(told)} == {1}
    assert "computed again: their file was" in frames(told)[0].remarks[0]
    assert path.read_bytes() == content
    assert frames(results(filled))[0].remarks == ()


def test_a_remark_is_of_its_shape_alone(filled):
    (path,) = files(filled)
    path.write_text("This is no spectrum.")
    pipeline, other = Pipeline(filled), egg(1)
    first, second = (
        frames(
            list(
                pipeline.results(
                    FrameRequest(
                        mesh, Query(QUERY.planes, None, Euclidean() if mesh is other else Diffusion())
                    )
                )
            )
        )
        for mesh in (MESH, other)
    )
    assert first[-1].remarks
    assert not second[-1].remarks


def test_what_takes_no_time_is_not_kept(tmp_path):
    cache = SpectrumCache(tmp_path, worth=60.0)
    run_to_end(MESH, QUERY, Pipeline(cache))
    assert files(cache) == []


def test_damage_is_mended_also_where_it_takes_no_time(filled):
    (path,) = files(filled)
    path.write_text("This is no spectrum.")
    run_to_end(MESH, QUERY, Pipeline(SpectrumCache(filled.folder, worth=60.0)))
    assert frames(results(filled))[0].remarks == ()


def test_a_full_disk_is_one_remark_and_no_error(cache, monkeypatch):
    def full(*_):
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr(array_files, "_save", full)
    pipeline = Pipeline(cache)
    first, second = (frames(list(pipeline.results(FrameRequest(mesh, QUERY)))) for mesh in (MESH, egg(1)))
    assert first[0].remarks == ()
    assert f"not kept in {cache.folder} (No space left on device)" in first[-1].remarks[0]
    assert [frame.remarks for frame in second] == [()] * len(second)
    assert files(cache) == []


def test_a_folder_that_cannot_be_made_is_one_remark(tmp_path):
    (tmp_path / "file").write_text("")
    told = frames(results(SpectrumCache(tmp_path / "file", worth=0.0)))
    assert "File exists" in told[-1].remarks[0]
    assert told[-1].exact


def test_clearing_while_something_is_computed(cache):
    told = []
    for result in Pipeline(cache).results(FrameRequest(MESH, QUERY)):
        cache.clear()
        told.append(result)
    assert frames(told)[-1].exact
    assert frames(told)[-1].remarks == ()


def test_without_a_cache_nothing_is_written(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    results(None)
    assert not list(tmp_path.iterdir())
