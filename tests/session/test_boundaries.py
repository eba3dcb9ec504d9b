"""A pipeline computes on a refined boundary and shows the shape as it was given."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import solids

from idviewer.core import Diffusion, Euclidean, GivenEmbedding, InteriorDistance, Polygon, discretisation
from idviewer.session import Frame, FrameRequest, Pipeline, Progress, Query, Ready, State, run_to_end

pytestmark = pytest.mark.refined

RECTANGLE = Polygon([[0, 0], [10, 0], [10, 1], [0, 1]])
SOURCE = (1.0, 0.5, 0.0)


def frames_of(pipeline: Pipeline, shape, query: Query) -> list[Frame]:
    return [one for one in pipeline.results(FrameRequest(shape, query)) if isinstance(one, Frame)]


def value_at(frame: Frame, point: tuple[float, float]) -> float:
    (section,) = frame.slices
    nearest = np.linalg.norm(section.points[:, :2] - point, axis=1).argmin()
    return float(section.values[nearest])


@pytest.mark.slow
def test_the_frame_is_of_the_shape_that_was_given_with_values_of_the_refined_one() -> None:
    frame = run_to_end(RECTANGLE, Query(source=SOURCE))
    solver = InteriorDistance(RECTANGLE)
    assert frame.shape is RECTANGLE
    assert frame.lambda_2 == pytest.approx((2 * np.pi / 22) ** 2, rel=3e-3)
    (section,) = frame.slices
    values = solver.field(SOURCE[:2], section.points[:, :2])
    inside = np.isfinite(values)
    np.testing.assert_allclose(section.values[inside], values[inside], atol=1e-7)
    modes = len(solver.spectrum.values)
    assert frame.refinement == f"4 -> 86 vertices, since its edges are too long for {modes} modes"


def test_what_is_told_of_readiness_is_of_the_shape_that_was_given() -> None:
    results = list(Pipeline().results(FrameRequest(RECTANGLE, Query())))
    assert [one.shape for one in results if isinstance(one, Ready)] == [RECTANGLE]


def test_as_it_is_gives_what_a_coarse_boundary_gives() -> None:
    frame = run_to_end(RECTANGLE, Query(source=SOURCE, refine="no"))
    assert (frame.refinement, frame.lambda_2) == ("", pytest.approx(0.0364, abs=1e-3))


def test_a_length_is_heeded_and_the_query_says_so() -> None:
    frame = run_to_end(RECTANGLE, Query(source=SOURCE, refine=0.1))
    assert "220 vertices" in frame.refinement
    assert frame.query.refine == 0.1
    assert State().with_(refine=0.1).query.refine == 0.1


@pytest.mark.slow
def test_another_time_keeps_the_boundary_and_given_rows_get_their_own(rng: np.random.Generator) -> None:
    pipeline = Pipeline()
    first = run_to_end(RECTANGLE, Query(source=SOURCE), pipeline)
    shorter = run_to_end(RECTANGLE, Query(source=SOURCE, distance=Diffusion(1.0)), pipeline)
    straight = run_to_end(RECTANGLE, Query(source=SOURCE, distance=Euclidean()), pipeline)
    assert first.refinement.split(" vertices")[0] == shorter.refinement.split(" vertices")[0]
    assert value_at(straight, (10.0, 0.0)) == pytest.approx(np.hypot(9.0, 0.5), rel=1e-6)
    given = run_to_end(RECTANGLE, Query(distance=GivenEmbedding(rng.normal(size=(4, 2)))), pipeline)
    assert given.refinement == ""
    again = run_to_end(RECTANGLE, Query(source=SOURCE), pipeline)
    assert value_at(again, (8.0, 0.5)) == pytest.approx(value_at(first, (8.0, 0.5)), rel=1e-9)


def test_vertices_that_move_are_refined_anew() -> None:
    pipeline = Pipeline()
    run_to_end(RECTANGLE, Query(source=SOURCE), pipeline)
    moved = RECTANGLE.with_vertices([[0, 0], [20, 0], [20, 1], [0, 1]])
    frame = run_to_end(moved, Query(source=SOURCE), pipeline)
    assert frame.shape is moved
    assert frame.lambda_2 == pytest.approx((2 * np.pi / 42) ** 2, rel=3e-3)


@pytest.mark.slow
def test_a_mesh_is_cut_along_its_refined_faces() -> None:
    cube = solids.box(1, 1, 1)
    frame = run_to_end(cube, Query(planes=(), source=(0.5, 0.5, 0.5)))
    assert frame.shape is cube
    stages = [
        one.stage
        for one in Pipeline().results(FrameRequest(cube, Query(source=(0.5, 0.5, 0.5))))
        if isinstance(one, Progress)
    ]
    assert "Refining the boundary" in stages


def test_the_error_of_the_discretisation_comes_last_and_on_request() -> None:
    query = Query(source=SOURCE)
    assert all(one.discretisation is None for one in frames_of(Pipeline(), RECTANGLE, query))
    pipeline = Pipeline(errors=True)
    *before, last = frames_of(pipeline, RECTANGLE, query)
    assert before[-1].exact
    assert all(one.discretisation is None for one in before)
    expected = discretisation(InteriorDistance(RECTANGLE)).summary
    assert last.exact
    assert last.discretisation is not None
    assert last.discretisation.total_distances == pytest.approx(expected.total_distances, rel=1e-6)
    assert last.title.endswith(f"discretisation within {100 * expected.total_distances:.2g}%")
    np.testing.assert_array_equal(last.slices[0].values, before[-1].slices[0].values)
    # It is known from then on.
    assert all(one.discretisation is not None for one in frames_of(pipeline, RECTANGLE, query))


def test_a_result_that_may_be_far_off_says_so() -> None:
    last = frames_of(Pipeline(errors=True), RECTANGLE, Query(source=SOURCE, refine="no"))[-1]
    assert any("may be off by more than 5%" in remark for remark in last.remarks)
    exact = frames_of(Pipeline(errors=True), RECTANGLE, Query(source=SOURCE, distance=Euclidean()))[-1]
    assert exact.discretisation is None
