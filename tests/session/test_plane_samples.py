"""A moved plane's frames: how wrong they are, what they say of it, and that nothing is sampled twice."""

from __future__ import annotations

import numpy as np
import pytest
from tests.session.bodies import egg, random_planes

from idviewer.core import GPS, Biharmonic, Diffusion, InteriorDistance, Plane, read_mesh, sample_path
from idviewer.core.sampling.plane_samples import PlaneSamples
from idviewer.core.sampling.sampler import Sampler
from idviewer.core.sampling.settings import SAMPLING
from idviewer.core.spectrum.memory_estimate import SMALL_VERTICES
from idviewer.core.steps import finish
from idviewer.session.pipeline import Pipeline
from idviewer.session.state import Frame, FrameRequest, Query

HAND = read_mesh(sample_path("hand_2k"))
BOUNDS = 8e-3, 1e-3, 1e-4
"""Largest error of the frames by level, in largest distances on the slice."""


@pytest.fixture(scope="module")
def solver() -> InteriorDistance:
    return InteriorDistance(HAND)


@pytest.fixture(scope="module")
def sampler(solver) -> Sampler:
    made = Sampler(solver)
    finish(made.prepare_steps())
    return made


@pytest.fixture(scope="module")
def pipeline() -> Pipeline:
    made = Pipeline()
    list(made.results(FrameRequest(HAND, Query())))
    return made


def frames_of(pipeline: Pipeline, query: Query, count: int | None = None) -> list[Frame]:
    frames = []
    for one in pipeline.results(FrameRequest(HAND, query)):
        if isinstance(one, Frame):
            frames.append(one)
            if len(frames) == count:
                break
    return frames


def error_and_largest(frame: Frame, solver: InteriorDistance) -> tuple[float, float]:
    """The frame's largest error at points inside, and the largest distance on the slice."""
    (one,) = frame.slices
    inner = np.setdiff1d(np.arange(len(one.points)), np.concatenate(one.outline))
    inner = inner[:: max(1, len(inner) // 1000)]
    exact = solver.field(frame.source, one.points[inner])
    known = np.isfinite(exact)
    error = np.abs(one.values[inner] - exact)[known].max(initial=0.0)
    return float(error), float(one.values.max())


def dragged(count: int) -> list[Plane]:
    """A plane pushed through the palm and turned meanwhile."""
    low, high = HAND.bounds
    angles, shares = np.linspace(0.0, 0.7, count), np.linspace(0.3, 0.7, count)
    origins = low + shares[:, None] * (high - low)
    return [
        Plane(tuple(o), (0.0, float(np.sin(a)), float(np.cos(a))))
        for o, a in zip(origins, angles, strict=True)
    ]


@pytest.mark.slow
def test_every_frame_of_a_drag_is_as_accurate_as_promised(pipeline, solver):
    errors = []
    for plane in dragged(8):
        frames = frames_of(pipeline, Query((plane,)), 3)
        assert [frame.level for frame in frames] == [0, 1, 2]
        assert not any(frame.exact for frame in frames)
        told = [error_and_largest(frame, solver) for frame in frames]
        errors.append([error / largest for error, largest in told])
    assert (np.max(errors, axis=0) <= BOUNDS).all(), np.max(errors, axis=0)
    assert np.median(errors, axis=0)[0] <= 5e-3


@pytest.mark.slow
@pytest.mark.parametrize("distance", [Diffusion(), GPS(), Biharmonic()], ids=lambda one: one.name)
def test_frames_state_an_error_that_holds(pipeline, solver, distance):
    solver = solver.with_distance(distance)
    ratios = []
    for plane in random_planes(HAND, 6, np.random.default_rng(len(distance.name))):
        for frame in frames_of(pipeline, Query((plane,), distance=distance), 3):
            error, largest = error_and_largest(frame, solver)
            ratios.append(error / frame.error)
            assert frame.error <= 0.1 * largest
    assert max(ratios) <= 2.0
    assert np.mean(np.array(ratios) <= 1.0) >= 0.85
    assert np.median(ratios) >= 0.1, "the stated error says nothing"


@pytest.mark.slow
def test_a_source_on_the_slice_is_as_accurate(pipeline, solver):
    plane = dragged(3)[1]
    middle = frames_of(pipeline, Query((plane,)), 1)[0].slices[0].points.mean(axis=0)
    query = Query((plane,), tuple(middle.tolist()))
    for frame, bound in zip(frames_of(pipeline, query, 3), BOUNDS, strict=True):
        error, largest = error_and_largest(frame, solver)
        assert error <= 1.5 * bound * largest
        assert frame.error > 0.0


@pytest.mark.slow
def test_the_last_level_is_a_direct_computation(pipeline, solver):
    plane = dragged(5)[2]
    frame = frames_of(pipeline, Query((plane,)))[-1]
    assert frame.exact
    assert frame.error == 0.0
    error, largest = error_and_largest(frame, solver)
    assert error <= 1e-12 * largest


@pytest.mark.slow
def test_a_level_samples_no_point_again_at_its_tolerance(sampler, monkeypatch):
    taken: dict[float, list[np.ndarray]] = {}
    original = sampler.sample_steps

    def counting(points, rtol):
        taken.setdefault(rtol, []).append(np.asarray(points))
        return original(points, rtol)

    monkeypatch.setattr(sampler, "sample_steps", counting)
    samples = PlaneSamples(sampler, dragged(3)[1], 30000)
    assert samples.levels == 4
    for level in range(4):
        finish(samples.level_steps(level))
    assert len(taken) == 3
    assert min(taken) == 0.0
    for parts in taken.values():
        points = np.concatenate(parts)
        assert len(np.unique(points.round(9), axis=0)) == len(points)
    before = sum(map(len, taken.values()))
    for level in range(4):
        assert finish(samples.level_steps(level)).rtol == 0.0, "a coarser slice was shown again"
    assert sum(map(len, taken.values())) == before


@pytest.mark.slow
def test_a_level_goes_on_where_it_was_left(sampler, monkeypatch):
    sampled: list[int] = []
    original = sampler.sample_steps

    def counting(points, rtol):
        sampled.append(len(points))
        return original(points, rtol)

    samples = PlaneSamples(sampler, dragged(3)[1], 30000)
    expected = PlaneSamples(sampler, dragged(3)[1], 30000)
    for level in range(3):
        finish(samples.level_steps(level))
    monkeypatch.setattr(sampler, "sample_steps", counting)
    for _ in range(6):
        steps = samples.level_steps(3)
        for _ in range(3):
            next(steps)
        steps.close()
    finish(samples.level_steps(3))
    began = len(sampled)
    finish(expected.level_steps(3))
    assert len(sampled) == 2 * began


@pytest.mark.slow
def test_neither_source_nor_time_nor_kind_takes_samples_on_the_plane(pipeline, monkeypatch):
    plane = dragged(5)[3]
    frames_of(pipeline, Query((plane,)))
    monkeypatch.setattr(PlaneSamples, "_sample", None)  # calling it would be an error
    source = tuple(HAND.vertices.mean(axis=0).tolist())
    for query in (
        Query((plane,), source),
        Query((plane,), source, GPS()),
        Query((plane,), source, Diffusion(time=0.5 * HAND.diagonal**2)),
        Query((plane,), quantity="potential"),
    ):
        assert frames_of(pipeline, query)[-1].exact


@pytest.mark.slow
def test_a_new_source_is_shown_before_its_exact_sample_is_taken(pipeline, solver):
    plane = dragged(5)[3]
    frames_of(pipeline, Query((plane,)))
    source = tuple((HAND.vertices.mean(axis=0) + 0.01 * HAND.diagonal).tolist())
    first, last = frames_of(pipeline, Query((plane,), source))
    assert (first.exact, last.exact) == (False, True)
    for frame, bound in ((first, 2e-5), (last, 1e-12)):
        error, largest = error_and_largest(frame, solver)
        assert error <= bound * largest
        assert frame.error >= (error if frame is first else 0.0)
    assert [frame.exact for frame in frames_of(pipeline, Query((plane,), source))] == [True]


@pytest.mark.slow
def test_thin_and_many_loops_are_filled(sampler, rng):
    tips = random_planes(HAND, 60, rng)
    most = max(tips, key=lambda plane: len(PlaneSamples(sampler, plane, 2000).section.loops))
    thin = Plane(
        tuple(HAND.vertices[HAND.vertices[:, 2].argmax()] - [0, 0, 1e-3 * HAND.diagonal]), (0, 0, 1.0)
    )
    for plane in (most, thin):
        samples = PlaneSamples(sampler, plane, 2000)
        for level in range(samples.levels):
            one = finish(samples.level_steps(level))
            corners = one.points[one.triangles]
            sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            area = 0.5 * (sides @ np.array(plane.normal)).sum()
            assert area == pytest.approx(samples.section.area, rel=1e-9)
            assert np.isfinite(one.rows).all()
            assert one.triangles.max() == len(one.points) - 1
    assert len(PlaneSamples(sampler, most, 2000).section.loops) >= 3


def test_a_plane_that_misses_the_body_gives_an_empty_slice(sampler):
    samples = PlaneSamples(sampler, Plane((9.0, 9.0, 9.0 + HAND.diagonal), (0, 0, 1.0)), 2000)
    for level in range(samples.levels):
        one = finish(samples.level_steps(level))
        assert len(one.points) == len(one.triangles) == len(one.norms.distances(np.ones(1))) == 0


@pytest.mark.slow
def test_on_a_small_mesh_every_sample_is_exact():
    solver = InteriorDistance(egg(2))
    assert len(solver.shape.faces) <= SAMPLING.exact_facets
    sampler = Sampler(solver)
    assert sampler.ready
    samples = PlaneSamples(sampler, Plane((0.1, 0, 0), (1.0, 0, 0)), 30000)
    assert samples.levels == 3
    assert [finish(samples.level_steps(level)).rtol for level in range(3)] == [0.0, 0.0, 0.0]


def test_the_memory_foretold_counts_with_the_trees_that_are_built():
    """A compact shape has twice as many facets as vertices, and some 170 modes."""
    assert 160 < SAMPLING.tree_products / (2 * SMALL_VERTICES) < 180
