"""The pipeline: levels nest, the last equals a direct computation, half-done work is kept."""

from __future__ import annotations

import numpy as np
import pytest
from tests.session.bodies import egg

from idviewer.core import Euclidean, InteriorDistance, Plane
from idviewer.core.interior.interpolation import BasisInterpolation
from idviewer.core.sampling.plane_samples import PlaneSamples
from idviewer.session import eigenpair_source
from idviewer.session import kernel_compilation as kernels
from idviewer.session.pipeline import Pipeline
from idviewer.session.run_to_end import run_to_end
from idviewer.session.state import (
    DropRequest,
    Failure,
    Frame,
    FrameRequest,
    Opened,
    OpenRequest,
    Progress,
    Query,
    Ready,
)

MESH = egg()
PLANE = Plane((0.1, 0.0, 0.0), (1.0, 0.2, 0.1))
QUERY = Query(planes=(PLANE,), source=(0.0, 0.3, 0.5))


@pytest.fixture(scope="module")
def solver() -> InteriorDistance:
    return InteriorDistance(MESH)


@pytest.fixture(scope="module")
def pipeline() -> Pipeline:
    made = Pipeline()
    list(made.results(FrameRequest(MESH, QUERY)))
    return made


def frames_of(pipeline: Pipeline, query: Query) -> list[Frame]:
    return [one for one in pipeline.results(FrameRequest(MESH, query)) if isinstance(one, Frame)]


@pytest.mark.slow
def test_the_order_is_progress_ready_frames():
    results = [one for one in Pipeline().results(FrameRequest(MESH, QUERY)) if one is not None]
    kinds = [type(one) for one in results]
    first_frame = kinds.index(Frame)
    assert kinds[first_frame - 1] is Ready
    assert set(kinds[: first_frame - 1]) == {Progress}
    assert set(kinds[first_frame:]) == {Frame}
    stages = [one.stage for one in results if isinstance(one, Progress)]
    assert list(dict.fromkeys(stages)) == [
        "Preparing kernels (compiled once, at the first run)",
        "Computing eigenpairs",
        "Finding the barycentroid",
    ]


@pytest.mark.slow
def test_the_last_frame_is_a_direct_computation(pipeline, solver):
    last = frames_of(pipeline, QUERY)[-1]
    assert last.exact
    assert last.error == 0
    (one,) = last.slices
    inner = np.ones(len(one.points), dtype=bool)
    inner[np.concatenate(one.outline)] = False
    expected = solver.field(QUERY.source, one.points[inner])
    np.testing.assert_allclose(one.values[inner], expected, rtol=1e-9, atol=1e-12 * expected.max())
    # On the outline the values are those of the boundary embedding, linear on each face.
    pushed = one.points[~inner] * (1 - 1e-9) + 1e-9 * np.array(PLANE.origin)
    near = solver.field(QUERY.source, pushed)
    np.testing.assert_allclose(one.values[~inner], near, atol=1e-6 * expected.max())


@pytest.mark.slow
def test_coarse_frames_come_first_and_state_their_error(pipeline, solver):
    pipeline._context.samples(QUERY)._planes.clear()
    frames = frames_of(pipeline, QUERY)
    assert len(frames) == 3
    assert [frame.level for frame in frames] == list(range(len(frames)))
    assert [frame.exact for frame in frames] == [False] * (len(frames) - 1) + [True]
    for frame in frames[:-1]:
        (one,) = frame.slices
        exact = solver.field(QUERY.source, one.points)
        known = np.isfinite(exact)
        error = np.abs(one.values - exact)[known].max()
        assert error <= 2 * frame.error + 1e-12, (frame.level, error, frame.error)


@pytest.mark.slow
def test_a_new_source_samples_only_itself(pipeline, monkeypatch):
    sampled: list[int] = []
    original = BasisInterpolation.sample_steps

    def counting(self, points, **more):
        sampled.append(len(points))
        return original(self, points, **more)

    frames_of(pipeline, QUERY)
    monkeypatch.setattr(BasisInterpolation, "sample_steps", counting)
    moved = Query(planes=(PLANE,), source=(0.0, -0.3, -0.5))
    frames = frames_of(pipeline, moved)
    assert sampled == [1]
    assert [frame.exact for frame in frames] == [True], "a coarse frame was shown again"
    np.testing.assert_allclose(frames[-1].source, moved.source)


def test_a_frame_describes_itself(pipeline):
    frame = frames_of(pipeline, QUERY)[-1]
    assert frame.query == QUERY
    assert frame.shape is MESH
    assert frame.title.startswith("Diffusion distance, t = ")
    low, high = frame.value_range
    assert low == 0
    assert high >= frame.slices[0].values.max() * 0.999
    for array in (frame.source, frame.slices[0].points, frame.slices[0].values, frame.slices[0].triangles):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


@pytest.mark.slow
def test_without_a_source_it_is_the_barycentroid_and_the_potential_is_lowest_there(pipeline):
    through = pipeline._context.barycentroid(QUERY)
    query = Query(planes=(Plane(through, (1.0, 0, 0)),), quantity="potential")
    frame = frames_of(pipeline, query)[-1]
    np.testing.assert_array_equal(frame.source, frame.barycentroid)
    assert frame.title.startswith("Potential U (Diffusion distance")
    (one,) = frame.slices
    lowest = one.points[one.values.argmin()]
    assert np.linalg.norm(lowest - frame.barycentroid) < 0.05 * MESH.diagonal
    assert frame.value_range[0] <= one.values.min() * (1 + 1e-12)


@pytest.mark.slow
def test_several_planes_give_several_slices_and_a_plane_that_misses_an_empty_one(pipeline):
    beside = Plane((50.0, 0, 0), (1.0, 0, 0))
    frame = frames_of(pipeline, Query(planes=(PLANE, beside, Plane((0, 0, 0), (0, 0, 1.0)))))[-1]
    assert [len(one.points) > 0 for one in frame.slices] == [True, False, True]
    assert frames_of(pipeline, Query())[-1].slices == ()


@pytest.mark.slow
def test_preparation_goes_on_where_a_replaced_request_left_it():
    pipeline = Pipeline()
    stages = []
    first = pipeline.results(FrameRequest(MESH, QUERY))
    for result in first:
        stages.append(result)
        if len(stages) == 5:
            break
    first.close()
    later = [one for one in pipeline.results(FrameRequest(MESH, Query())) if one is not None]
    assert later[0] != stages[0], "the preparation started anew"
    assert isinstance(later[-1], Frame)


@pytest.mark.slow
@pytest.mark.parametrize(
    "work",
    [
        (eigenpair_source, "eigenpair_steps"),
        (InteriorDistance, "barycentroid_steps"),
        (kernels, "compile_steps"),
        (PlaneSamples, "_make"),
    ],
    ids=lambda work: work[1],
)
def test_after_a_defect_in_the_middle_of_the_work_the_next_request_is_answered(work, monkeypatch):
    """Whatever was half done when it failed is begun anew, and not taken for done."""

    def defective(*_, **__):
        yield 0.5
        raise RuntimeError("a defect")

    pipeline = Pipeline()
    with monkeypatch.context() as patch:
        patch.setattr(*work, defective)
        with pytest.raises(RuntimeError, match="a defect"):
            frames_of(pipeline, QUERY)
    assert frames_of(pipeline, QUERY)[-1].exact


def test_dropping_forgets_half_done_work():
    pipeline = Pipeline()
    first = pipeline.results(FrameRequest(MESH, QUERY))
    start = next(first)
    next(first)
    first.close()
    assert list(pipeline.results(DropRequest())) == []
    assert next(pipeline.results(FrameRequest(MESH, QUERY))) == start


@pytest.mark.slow
def test_a_source_outside_is_refused_with_its_coordinates(pipeline):
    results = list(pipeline.results(FrameRequest(MESH, Query(planes=(PLANE,), source=(9.0, 0.0, 0.5)))))
    assert isinstance(results[-1], Failure)
    assert str(results[-1].error).startswith("the source (9, 0, 0.5) lies outside the mesh")
    with pytest.raises(ValueError, match="outside the mesh"):
        run_to_end(MESH, Query(source=(9.0, 0.0, 0.5)))


@pytest.mark.slow
def test_the_euclidean_distance_is_straight(pipeline):
    frame = frames_of(pipeline, Query(planes=(PLANE,), source=QUERY.source, distance=Euclidean()))[-1]
    (one,) = frame.slices
    expected = np.linalg.norm(one.points - np.array(QUERY.source), axis=1)
    np.testing.assert_allclose(one.values, expected, atol=1e-12 * MESH.diagonal)


def test_opening_reads_and_failing_to_tells_why(tmp_path):
    path = tmp_path / "egg.off"
    lines = ["OFF", f"{len(MESH.vertices)} {len(MESH.faces)} 0"]
    lines += [" ".join(map(repr, vertex)) for vertex in MESH.vertices.tolist()]
    lines += [f"3 {a} {b} {c}" for a, b, c in MESH.faces.tolist()]
    path.write_text("\n".join(lines))
    progress, opened = Pipeline().results(OpenRequest(path))
    assert progress == Progress("Reading egg.off")
    assert isinstance(opened, Opened)
    np.testing.assert_array_equal(opened.shape.vertices, MESH.vertices)
    *_, failure = Pipeline().results(OpenRequest(tmp_path / "nothing.off"))
    assert isinstance(failure, Failure)
    assert "nothing.off" in str(failure.error)
