"""The first view of a mesh that takes long to sample: seen before, it is read, and it is the same."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.session.bodies import egg

from idviewer.core import Biharmonic, Diffusion, Plane
from idviewer.core.interior.interpolation import BasisInterpolation
from idviewer.session import cached_view
from idviewer.session import eigenpair_source as eigenpairs
from idviewer.session.eigenpair_source import READING
from idviewer.session.pipeline import SEARCHING, Pipeline
from idviewer.session.run_to_end import run_to_end
from idviewer.session.spectrum_cache import SpectrumCache
from idviewer.session.state import Frame, FrameRequest, Progress, Query, Ready, default_plane

MESH = egg(4)
"""It has more faces than are sampled exactly at once."""

PLANE = Plane((0.1, 0.0, 0.0), (1.0, 0.2, 0.1))
DEFAULT = Query(planes=(default_plane(MESH),))


def stages(results: list) -> list[str]:
    return list(dict.fromkeys(one.stage for one in results if isinstance(one, Progress)))


def frames(results: list) -> list[Frame]:
    return [one for one in results if isinstance(one, Frame)]


def view(cache: SpectrumCache | None, stop: bool = False) -> tuple[list, Query]:
    """What a window asks for when it opens the mesh, until the exact frame or the end."""
    pipeline = Pipeline(cache)
    told: list = []
    for result in pipeline.results(FrameRequest(MESH, DEFAULT)):
        told.append(result)
        if isinstance(result, Ready):
            break
    x, y, z = told[-1].barycentroid.tolist()
    query = Query(planes=(Plane((x, y, z), DEFAULT.planes[0].normal),))
    for result in pipeline.results(FrameRequest(MESH, query)):
        told.append(result)
        if stop and isinstance(result, Frame) and result.exact:
            break
    return [one for one in told if one is not None], query


@pytest.fixture(scope="module")
def seen(tmp_path_factory) -> tuple[SpectrumCache, list]:
    cache = SpectrumCache(tmp_path_factory.mktemp("cache"), worth=0.0)
    return cache, view(cache)[0]


@pytest.fixture
def copy(seen, tmp_path) -> SpectrumCache:
    shutil.copytree(seen[0].folder, tmp_path / "copy")
    return SpectrumCache(tmp_path / "copy", worth=0.0)


def opening_of(cache: SpectrumCache) -> Path:
    return next(path for path in cache.folder.iterdir() if path.stem.endswith(cached_view.VIEW_STEM_END))


def test_it_takes_no_sample(seen, monkeypatch):
    cache, first = seen
    monkeypatch.delattr(eigenpairs, "eigenpair_steps")
    monkeypatch.setattr(BasisInterpolation, "sample_steps", None)
    again, _ = view(cache, stop=True)
    assert stages(again) == [READING]
    (frame,) = frames(again)
    last = frames(first)[-1]
    assert frame.exact
    assert frame.query == last.query
    for name in ("values", "points", "triangles"):
        np.testing.assert_array_equal(getattr(frame.slices[0], name), getattr(last.slices[0], name))
    for one, other in zip(frame.slices[0].outline, last.slices[0].outline, strict=True):
        np.testing.assert_array_equal(one, other)
    assert (frame.value_range, frame.title, frame.error) == (last.value_range, last.title, 0.0)
    np.testing.assert_array_equal(frame.barycentroid, last.barycentroid)


def test_it_is_shown_before_the_session_has_asked(seen):
    results = Pipeline(seen[0]).results(FrameRequest(MESH, DEFAULT))
    first = next(one for one in results if isinstance(one, Frame))
    assert first.exact
    assert first.query.planes[0].origin == tuple(first.barycentroid.tolist())


@pytest.mark.slow
def test_other_frames_follow_from_it(seen):
    """Of a plane, a distance and a source that were not seen, as without the cache."""
    shown = frames(seen[1])[-1].query.planes
    knows, fresh = (Pipeline(cache) for cache in (seen[0], None))
    list(knows.results(FrameRequest(MESH, DEFAULT)))
    for query in (Query((PLANE,)), Query(shown, distance=Biharmonic()), Query(shown, (0.0, 0.3, 0.5))):
        one, other = (frames(list(made.results(FrameRequest(MESH, query))))[-1] for made in (knows, fresh))
        assert one.exact
        atol = 1e-5 * other.value_range[1]
        np.testing.assert_allclose(one.slices[0].values, other.slices[0].values, rtol=0, atol=atol)


@pytest.mark.slow
def test_other_eigenvectors_do_not_use_it(copy):
    (path,) = (path for path in list(copy.folder.iterdir()) if path != opening_of(copy))
    spectrum = copy.lookup(MESH, Diffusion().cutoff)
    copy.store(MESH, replace(spectrum, vectors=-spectrum.vectors))
    assert path in list(copy.folder.iterdir())
    assert SEARCHING in stages(view(copy)[0])
    assert SEARCHING not in stages(view(copy, stop=True)[0])


@pytest.mark.slow
def test_damage_is_remarked_once_and_mended(copy):
    path = opening_of(copy)
    content = path.read_bytes()
    at = len(content) // 2
    path.write_bytes(content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :])
    told, _ = view(copy)
    assert "The view kept of this shape was sampled again" in frames(told)[-1].remarks[0]
    assert path.read_bytes() == content
    assert frames(view(copy)[0])[0].remarks == ()


def test_the_command_line_stops_at_its_last_frame(seen, monkeypatch):
    monkeypatch.setattr(BasisInterpolation, "sample_steps", None)
    frame = run_to_end(MESH, frames(seen[1])[-1].query, Pipeline(seen[0]))
    assert frame.exact
