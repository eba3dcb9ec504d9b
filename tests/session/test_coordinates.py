"""Coordinates of every kind on slices of meshes: exact samples, outlines, and points without weights."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.session.bodies import WatchedSession, egg, few_samples  # noqa: F401

from idviewer.core import Diffusion, Euclidean, InteriorDistance, Mesh, Plane, read_mesh, sample_path
from idviewer.core.coordinates import maximum_entropy
from idviewer.core.coordinates.maximum_entropy import MaximumEntropyCoordinates, MaximumEntropySettings
from idviewer.core.sampling import SourceError, settings
from idviewer.core.sampling.plane_samples import PlaneSamples
from idviewer.core.sampling.sampler import Sampler
from idviewer.core.sampling.settings import SAMPLING
from idviewer.core.steps import finish
from idviewer.session.pipeline import Pipeline
from idviewer.session.state import Frame, FrameRequest, Query

MESH = egg(2)
PLANE = Plane((0.1, 0.0, 0.0), (1.0, 0.2, 0.1))
SOURCE = (0.0, 0.3, 0.5)
BOX = Mesh(
    [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)],
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
     [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]],
)  # fmt: skip


def run(pipeline: Pipeline, query: Query, mesh: Mesh = MESH) -> list:
    return [one for one in pipeline.results(FrameRequest(mesh, query)) if one is not None]


@pytest.fixture(scope="module")
def pipeline() -> Pipeline:
    made = Pipeline()
    run(made, Query((PLANE,), SOURCE))
    return made


@pytest.mark.slow
@pytest.mark.parametrize("coordinates", ["maximum_entropy", "shepard"])
@pytest.mark.parametrize("distance", [Diffusion(), Euclidean()], ids=lambda one: one.name)
def test_the_last_frame_is_the_library_s_field(pipeline, coordinates, distance):
    solver = InteriorDistance(MESH, distance, coordinates)
    for made in (pipeline, Pipeline()):
        frame = run(made, Query((PLANE,), SOURCE, distance, coordinates=coordinates))[-1]
        assert isinstance(frame, Frame)
        assert frame.exact
        assert frame.error == 0.0
        assert frame.title == f"{solver.description}; {solver.coordinates.title.lower()}"
        (one,) = frame.slices
        inner = np.setdiff1d(np.arange(len(one.points)), np.concatenate(one.outline))
        expected = solver.field(SOURCE, one.points[inner])
        np.testing.assert_allclose(one.values[inner], expected, rtol=1e-9, atol=1e-11 * expected.max())


@pytest.mark.slow
def test_what_is_not_linear_on_faces_is_evaluated_on_the_outline():
    solver = InteriorDistance(BOX, Euclidean(), "shepard")
    query = Query(
        (Plane((0.0, 0.0, 0.37), (0.0, 0.1, 1.0)),), (0.4, 0.5, 0.6), Euclidean(), coordinates="shepard"
    )
    for frame in (one for one in run(Pipeline(), query, BOX) if isinstance(one, Frame)):
        (one,) = frame.slices
        outline = np.concatenate(one.outline)
        expected = solver.field(query.source, one.points[outline])
        assert np.isfinite(expected).all()
        np.testing.assert_allclose(one.values[outline], expected, rtol=1e-9)
    straight = InteriorDistance(BOX, Euclidean()).field(query.source, one.points[outline])
    assert np.abs(one.values[outline] - straight).max() > 0.02, (
        "interpolation along edges would be this wrong"
    )
    sides = solver.field(query.source, one.points)
    assert np.nanmax(np.abs(one.values - sides)) <= 1e-9 * sides.max()


@pytest.mark.slow
def test_stated_errors_hold(pipeline):
    for coordinates in ("maximum_entropy", "shepard"):
        solver = InteriorDistance(MESH, coordinates=coordinates)
        query = Query((Plane((0.0, 0.1, 0.2), (0.3, 1.0, 0.4)),), SOURCE, coordinates=coordinates)
        frames = [one for one in run(pipeline, query) if isinstance(one, Frame)]
        assert [frame.exact for frame in frames[-3:]] == [False, False, True]
        for frame in frames:
            (one,) = frame.slices
            expected = solver.field(SOURCE, one.points)
            assert np.nanmax(np.abs(one.values - expected)) <= 2 * frame.error + 1e-7 * frame.value_range[1]
        assert frames[0].error <= 0.1 * frames[0].value_range[1]


@pytest.mark.slow
def test_where_there_is_no_approximation_large_meshes_are_sampled_exactly():
    hand = read_mesh(sample_path("hand_2k"))
    assert len(hand.faces) > SAMPLING.exact_facets
    solver = InteriorDistance(hand, Euclidean())
    assert not Sampler(solver).exact_always
    for coordinates in ("maximum_entropy", "shepard"):
        sampler = Sampler(solver.with_coordinates(coordinates))
        assert sampler.exact_always
        samples = PlaneSamples(sampler, Plane(tuple(hand.vertices.mean(axis=0)), (0.0, 1.0, 0.0)), 2000)
        assert finish(samples.level_steps(0)).rtol == 0.0


@pytest.mark.slow
def test_barycentroids_belong_to_their_coordinates(pipeline):
    centres = {}
    for coordinates in ("mean_value", "maximum_entropy", "shepard"):
        last = run(pipeline, Query((PLANE,), coordinates=coordinates))[-1]
        right = InteriorDistance(MESH, coordinates=coordinates).barycentroid().point
        np.testing.assert_allclose(last.barycentroid, right, atol=1e-7 * MESH.diagonal)
        centres[coordinates] = tuple(last.barycentroid)
    assert len(set(centres.values())) == 3


def test_changing_to_and_fro_samples_nothing_again(pipeline, monkeypatch):
    queries = [
        Query((PLANE,), SOURCE, coordinates=coordinates)
        for coordinates in ("maximum_entropy", "shepard", "mean_value")
    ]
    for query in queries:
        run(pipeline, query)
    monkeypatch.setattr(PlaneSamples, "_sample", None)  # calling it would be an error
    for query in queries:
        assert run(pipeline, query)[-1].exact


@pytest.mark.slow
def test_bases_used_longest_ago_are_dropped(pipeline, monkeypatch):
    monkeypatch.setattr(settings, "SAMPLING", replace(SAMPLING, kept_bases=2))
    made = Pipeline()
    names = ("mean_value", "shepard", "mean_value", "maximum_entropy")
    for name in names:
        run(made, Query((PLANE,), SOURCE, Euclidean(), coordinates=name))
    kept = [one.solver.coordinates.name for one in made._context._bases]
    assert kept == ["mean_value", "maximum_entropy"]


@pytest.mark.slow
def test_unknown_coordinates_are_a_failure_and_the_last_ones_come_back():
    with WatchedSession() as desk:
        desk.session.show(MESH)
        desk.settle()
        desk.session.set(coordinates="wachspress")
        desk.settle()
        assert "unknown coordinates 'wachspress'; there are: mean_value" in str(desk.told("failed")[0][0])
        assert desk.session.state.query.coordinates == "mean_value"
        desk.session.set(coordinates="shepard")
        desk.settle()
        assert desk.session.frame.query.coordinates == "shepard"
        assert desk.session.frame.exact


class TestPointsWithoutWeights:
    @pytest.fixture
    def failing(self, monkeypatch):
        """Some points in a hundred find no weights."""
        original = maximum_entropy.maximum_entropy

        def some_fail(places, inside, *more):
            original(places, inside, *more)
            *_, residuals, _steps = more
            residuals[np.abs(np.sin(1e4 * places[inside].sum(axis=1))) < 0.02] = 1e-3

        monkeypatch.setattr(maximum_entropy, "maximum_entropy", some_fail)

    @pytest.mark.slow
    @pytest.mark.parametrize("source", [SOURCE, None])
    def test_they_are_left_out_and_the_frame_says_so(self, failing, source):
        frames = [
            one
            for one in run(Pipeline(), Query((PLANE,), source, coordinates="maximum_entropy"))
            if isinstance(one, Frame)
        ]
        solver = InteriorDistance(MESH)
        for frame in frames:
            (one,) = frame.slices
            assert np.isfinite(one.values).all()
            assert np.isfinite([frame.error, *frame.value_range]).all()
            assert one.triangles.max() < len(one.points)
            assert np.isfinite(solver.field(SOURCE, one.points * (1 - 1e-9))).mean() > 0.99
        (remark,) = frames[-1].remarks
        assert remark.startswith("Maximum entropy coordinates were not found at ")
        corners = frames[-1].slices[0].points[frames[-1].slices[0].triangles]
        area = (
            0.5
            * np.linalg.norm(
                np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
            ).sum()
        )
        full = run(Pipeline(), Query((PLANE,), source, Euclidean()))[-1].slices[0]
        corners = full.points[full.triangles]
        whole = (
            0.5
            * np.linalg.norm(
                np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
            ).sum()
        )
        assert 0.7 * whole < area < whole

    @pytest.mark.slow
    def test_a_source_without_them_is_refused_for_what_it_is(self, monkeypatch):
        made = Pipeline()
        query = Query((PLANE,), SOURCE, Euclidean(), coordinates="maximum_entropy")
        run(made, query)
        monkeypatch.setattr(
            MaximumEntropyCoordinates, "settings", MaximumEntropySettings(largest_residual=-1.0)
        )
        *_, failure = run(made, Query((PLANE,), (0.0, 0.2, 0.4), Euclidean(), coordinates="maximum_entropy"))
        assert isinstance(failure.error, SourceError)
        assert str(failure.error) == (
            "maximum entropy coordinates were not found at the source (0, 0.2, 0.4); move it a little, "
            "or choose other coordinates"
        )
