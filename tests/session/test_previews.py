"""Frames from a simplified mesh come first, say what they are, and give way to the final ones."""

from __future__ import annotations

import numpy as np
import pytest
from tests.session.bodies import WatchedSession

from idviewer.core import GPS, Diffusion, Euclidean, Mesh, Plane, read_mesh, sample_path
from idviewer.core.interior import preview
from idviewer.core.spectrum.krylov_eigenpairs import KRYLOV
from idviewer.session import eigenpair_source as eigenpairs
from idviewer.session.pipeline import Pipeline
from idviewer.session.run_to_end import run_to_end
from idviewer.session.state import Frame, FrameRequest, Progress, Query, Ready

pytestmark = pytest.mark.slow

STAGES = ("Simplifying the mesh", "Computing coarse eigenpairs", "Factoring (cannot be interrupted)",
          "Refining eigenpairs")  # fmt: skip


@pytest.fixture(autouse=True)
def _small(monkeypatch):
    settings = preview.PreviewSettings(least_vertices=2000, vertices=1200, coarser_vertices=300)
    monkeypatch.setattr(preview, "PREVIEW_SETTINGS", settings)


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return read_mesh(sample_path("hand_2k"))


def plane_at(mesh: Mesh, share: float) -> Plane:
    return Plane.along("x", share, mesh.bounds)


def results_of(pipeline: Pipeline, mesh: Mesh, query: Query) -> list:
    return [one for one in pipeline.results(FrameRequest(mesh, query)) if one is not None]


def test_a_marked_frame_comes_first_and_the_last_is_a_direct_computation(mesh):
    query = Query((plane_at(mesh, 0.5),))
    results = results_of(Pipeline(previews=True), mesh, query)
    stages = list(dict.fromkeys(one.stage for one in results if isinstance(one, Progress)))
    assert set(STAGES) <= set(stages)
    frames = [one for one in results if isinstance(one, Frame)]
    first, last = frames[0], frames[-1]
    assert [frame.preview is not None for frame in frames] == [True] + [False] * (len(frames) - 1)
    assert not first.exact
    assert "preview (error about" in first.title
    assert last.exact
    direct = run_to_end(mesh, query)
    for one, other in zip(last.slices, direct.slices, strict=True):
        np.testing.assert_array_equal(one.points, other.points)
        np.testing.assert_allclose(one.values, other.values, rtol=KRYLOV.residual)  # from another shift
    assert last.value_range == pytest.approx(direct.value_range, rel=KRYLOV.residual)
    # No jump: the same outline, and colours that span what they will span in the end.
    assert abs(first.value_range[1] - last.value_range[1]) <= first.error
    outline, later = (frame.slices[0].points[frame.slices[0].outline[0]] for frame in (first, last))
    np.testing.assert_array_equal(outline, later)
    assert np.linalg.norm(first.barycentroid - last.barycentroid) < 0.01 * mesh.diagonal


def test_values_are_within_the_error_that_a_preview_states(mesh):
    query = Query((plane_at(mesh, 0.4),), tuple(mesh.vertices.mean(axis=0).tolist()))
    first, *_, last = [
        one for one in results_of(Pipeline(previews=True), mesh, query) if isinstance(one, Frame)
    ]
    one, other = first.slices[0], last.slices[0]
    there = {tuple(point): value for point, value in zip(other.points, other.values, strict=True)}
    at = zip(map(tuple, one.points), one.values, strict=True)
    same = [(value, there[key]) for key, value in at if key in there]
    assert len(same) > 100
    shown, final = np.array(same).T
    assert np.abs(shown - final).max() <= first.error


def test_a_plane_moved_while_refining_is_answered_and_nothing_starts_anew(mesh, monkeypatch):
    begun = []
    steps = eigenpairs.eigenpair_steps
    monkeypatch.setattr(eigenpairs, "eigenpair_steps", lambda *asked: begun.append(asked) or steps(*asked))
    pipeline = Pipeline(previews=True)
    results = pipeline.results(FrameRequest(mesh, Query((plane_at(mesh, 0.5),))))
    while not (isinstance(one := next(results), Progress) and one.stage == STAGES[-1] and one.share):
        pass
    results.close()
    moved = Query((plane_at(mesh, 0.6),), tuple(mesh.vertices.mean(axis=0).tolist()))
    first, *rest = results_of(pipeline, mesh, moved)
    assert isinstance(first, Frame)
    assert first.preview is not None
    assert first.query == moved
    assert [one for one in rest if isinstance(one, Frame)][-1].exact
    assert len(begun) == 1


def test_another_distance_meanwhile_gets_a_preview_with_its_own_modes(mesh):
    pipeline, modes = Pipeline(previews=True), []
    for distance in (Diffusion(), GPS()):
        results = pipeline.results(FrameRequest(mesh, Query((plane_at(mesh, 0.5),), distance=distance)))
        for one in results:
            if isinstance(one, Ready):
                assert one.preview
                modes.append(one.modes)
            if isinstance(one, Frame):
                assert one.preview is not None
                break
        results.close()
    assert modes[1] > 2 * modes[0]


def test_what_needs_no_eigenpairs_and_who_does_not_look_on_get_no_preview(mesh):
    for pipeline, distance in ((Pipeline(previews=True), Euclidean()), (Pipeline(), Diffusion())):
        query = Query((plane_at(mesh, 0.5),), distance=distance)
        for one in pipeline.results(FrameRequest(mesh, query)):
            if isinstance(one, Frame):
                assert one.preview is None
                break
            assert not (isinstance(one, Progress) and one.stage in STAGES[:2])


def test_the_source_and_the_planes_stay(mesh):
    with WatchedSession() as desk:
        desk.session.show(mesh)
        desk.owner.run_until(lambda: desk.session.frame is not None)
        assert desk.session.frame.preview is not None
        assert desk.session.ready is None
        (plane,), source = desk.session.state.query.planes, tuple(mesh.vertices.mean(axis=0).tolist())
        np.testing.assert_allclose(plane.origin, desk.session.frame.barycentroid)
        desk.session.set(source=source)
        desk.settle()
        assert desk.session.state.query.planes == (plane,)
        last = desk.session.frame
        assert (last.exact, last.preview, last.query.source) == (True, None, source)
        assert desk.session.ready.modes > 0


@pytest.mark.parametrize("stage", STAGES)
def test_cancelled_in_a_stage_it_shows_what_there_is_and_resumes(mesh, stage):
    with WatchedSession() as desk:
        desk.session.show(mesh)
        desk.owner.run_until(lambda: any(told and told.stage == stage for (told,) in desk.told("progressed")))
        desk.session.cancel()
        desk.owner.run_all()
        assert not desk.session.busy
        frame = desk.session.frame
        assert frame.preview is not None if stage in STAGES[2:] else frame is None
        desk.session.resume()
        desk.settle()
        assert desk.session.frame.exact
        assert desk.session.frame.preview is None


@pytest.mark.parametrize("stage", STAGES)
def test_closed_in_a_stage_the_thread_ends(mesh, stage):
    with WatchedSession() as desk:
        desk.session.show(mesh)
        desk.owner.run_until(lambda: any(told and told.stage == stage for (told,) in desk.told("progressed")))
