"""Changing the distance: no sample is taken anew, and each frame says truthfully what it shows."""

from __future__ import annotations

import numpy as np
import pytest
from tests.session.bodies import egg

from idviewer.core import GPS, Biharmonic, Diffusion, Distance, Euclidean, InteriorDistance, MeshError, Plane
from idviewer.core.interior import barycentroid as barycentroid_module
from idviewer.core.interior.interpolation import BasisInterpolation
from idviewer.core.sampling.plane_samples import PlaneSamples
from idviewer.session import eigenpair_source as eigenpairs_module
from idviewer.session.pipeline import Pipeline
from idviewer.session.state import DropRequest, Failure, Frame, FrameRequest, Query, Ready

MESH = egg(2)
PLANE = Plane((0.1, 0.0, 0.0), (1.0, 0.2, 0.1))
SOURCE = (0.0, 0.3, 0.5)
OTHERS = [Diffusion(time=0.3), GPS(), Biharmonic()]


@pytest.fixture
def pipeline() -> Pipeline:
    made = Pipeline()
    list(made.results(FrameRequest(MESH, Query((PLANE,), SOURCE))))
    return made


@pytest.fixture
def sampled(monkeypatch) -> list[int]:
    """How many points were sampled, call by call."""
    counts: list[int] = []
    original = BasisInterpolation.sample_steps

    def counting(self, points, **more):
        counts.append(len(points))
        return original(self, points, **more)

    monkeypatch.setattr(BasisInterpolation, "sample_steps", counting)
    return counts


def asked(distance: Distance, source: tuple[float, float, float] | None = SOURCE, **more) -> FrameRequest:
    return FrameRequest(MESH, Query((PLANE,), source, distance, **more))


def until_a_frame(results) -> Frame:
    return next(one for one in results if isinstance(one, Frame))


@pytest.mark.slow
@pytest.mark.parametrize("distance", OTHERS, ids=lambda one: one.name)
def test_another_time_or_kind_is_shown_before_anything_is_sampled(pipeline, sampled, distance):
    frame = until_a_frame(pipeline.results(asked(distance)))
    assert sampled == []
    assert frame.error == 0
    solver = InteriorDistance(MESH, distance)
    assert frame.title == solver.description
    (one,) = frame.slices
    inner = np.ones(len(one.points), dtype=bool)
    inner[np.concatenate(one.outline)] = False
    expected = solver.field(SOURCE, one.points[inner])
    np.testing.assert_allclose(one.values[inner], expected, rtol=1e-9, atol=1e-12 * expected.max())
    assert frame.value_range[1] == pytest.approx(float(solver.field(SOURCE, MESH.vertices).max()), rel=1e-9)


@pytest.mark.slow
def test_no_plane_is_sampled_again_to_the_last_frame(pipeline, monkeypatch):
    monkeypatch.setattr(PlaneSamples, "_sample", None)  # calling it would be an error
    for distance in OTHERS:
        for query in (asked(distance), asked(distance, None), asked(distance, None, quantity="potential")):
            results = list(pipeline.results(query))
            assert not [one for one in results if isinstance(one, Failure)]
            assert results[-1].exact


@pytest.mark.slow
def test_the_barycentroid_shown_before_stands_for_the_right_one_until_that_is_found(pipeline):
    before = list(pipeline.results(asked(Diffusion(), None)))[-1]
    assert before.exact
    frames = [one for one in pipeline.results(asked(Biharmonic(), None)) if isinstance(one, Frame)]
    first, last = frames[0], frames[-1]
    for point in (first.source, first.barycentroid):
        np.testing.assert_array_equal(point, before.barycentroid)
    solver = InteriorDistance(MESH, Biharmonic())
    right = solver.barycentroid().point
    assert [frame.exact for frame in frames] == [False, True]
    np.testing.assert_allclose(last.barycentroid, right, atol=1e-9 * MESH.diagonal)
    np.testing.assert_array_equal(last.source, last.barycentroid)
    # Both say truly from where they are measured.
    for frame in frames:
        (one,) = frame.slices
        inner = np.setdiff1d(np.arange(len(one.points)), np.concatenate(one.outline))
        expected = solver.field(frame.source, one.points[inner])
        np.testing.assert_allclose(one.values[inner], expected, rtol=1e-9, atol=1e-12 * expected.max())


@pytest.mark.slow
def test_the_potential_s_range_follows_the_distance(pipeline):
    frames = list(pipeline.results(asked(GPS(), None, quantity="potential")))
    first, last = (one for one in frames if isinstance(one, Frame))
    solver = InteriorDistance(MESH, GPS())
    assert last.value_range[0] == pytest.approx(solver.barycentroid().potential, rel=1e-9)
    at_the_old_one = float(solver.potential(first.barycentroid[None])[0])
    assert first.value_range[0] == pytest.approx(at_the_old_one, rel=1e-9)
    assert first.value_range[1] == pytest.approx(last.value_range[1], rel=1e-12)


@pytest.mark.slow
def test_a_distance_shown_before_is_settled_at_once(pipeline, sampled):
    list(pipeline.results(asked(GPS(), None)))
    sampled.clear()
    frames = [one for one in pipeline.results(asked(Diffusion())) if isinstance(one, Frame)]
    assert [frame.exact for frame in frames] == [True]
    assert sampled == []


@pytest.mark.slow
def test_a_search_goes_on_where_a_newer_query_stopped_it(pipeline, monkeypatch):
    searches = []
    original = barycentroid_module.interior_sample_steps

    def counting(mesh):
        searches.append(mesh)
        return original(mesh)

    monkeypatch.setattr(barycentroid_module, "interior_sample_steps", counting)
    results = pipeline.results(asked(GPS()))
    until_a_frame(results)
    for _ in range(30):
        next(results)
    results.close()
    moved = FrameRequest(MESH, Query((Plane((0, 0, 0), (0, 0, 1.0)),), SOURCE, GPS()))
    assert list(pipeline.results(moved))[-1].exact
    assert len(searches) == 1
    results = pipeline.results(asked(Biharmonic()))
    until_a_frame(results)
    for _ in range(6):
        next(results)
    list(pipeline.results(DropRequest()))
    list(pipeline.results(asked(Biharmonic())))
    assert len(searches) == 3, "dropping forgets half-done work"


def nothing(_mesh):
    yield
    return np.empty((0, 3))


@pytest.mark.slow
def test_a_search_that_fails_is_told_and_can_be_repeated(pipeline, monkeypatch):
    with monkeypatch.context() as broken:
        broken.setattr(barycentroid_module, "interior_sample_steps", nothing)
        *_, failure = pipeline.results(asked(GPS()))
        assert isinstance(failure, Failure)
        assert isinstance(failure.error, MeshError)
    assert list(pipeline.results(asked(GPS())))[-1].exact


@pytest.mark.slow
def test_eigenpairs_are_computed_once_and_only_when_needed(monkeypatch):
    computed = []
    original = eigenpairs_module.eigenpair_steps

    def counting(mesh, *asked):
        computed.append(mesh)
        return original(mesh, *asked)

    monkeypatch.setattr(eigenpairs_module, "eigenpair_steps", counting)
    pipeline = Pipeline()
    told, times = [], []
    for distance in (Euclidean(), Diffusion(), Euclidean(), GPS(), Diffusion(time=1.0)):
        results = list(pipeline.results(asked(distance)))
        times.append(len(computed))
        told.append([one.modes > 0 for one in results if isinstance(one, Ready)])
        assert results[-1].exact
        assert (results[-1].lambda_2 is None) == (times[-1] == 0)
    assert times == [0, 1, 1, 1, 1]
    assert told == [[False], [True], [False], [True], []]


def test_a_time_shorter_than_the_eigenpairs_allow_says_so_in_the_title(pipeline):
    lambda_2 = until_a_frame(pipeline.results(asked(Diffusion()))).lambda_2
    short = until_a_frame(pipeline.results(asked(Diffusion(time=1 / (8 * 8 * lambda_2)))))
    assert short.title.endswith("modes left out weigh up to 18%")
