"""A polygon whose vertices are dragged: frames follow, sources stay inside, invalid shapes change nothing."""

from __future__ import annotations

import numpy as np
import pytest
from tests.session.bodies import WatchedSession, egg

from idviewer.core import Diffusion, Euclidean, InteriorDistance, Polygon, PolygonError
from idviewer.core.sampling import POLYGON_PLANE
from idviewer.core.shapes.rays import Ray
from idviewer.session import kernel_compilation as kernels_module
from idviewer.session.pipeline import Pipeline
from idviewer.session.run_to_end import run_to_end
from idviewer.session.state import Frame, FrameRequest, Query

ANGLES = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
BLOB = Polygon(
    np.column_stack([np.cos(ANGLES), (1.0 + 0.3 * np.sin(3 * ANGLES)) * np.sin(ANGLES)]), name="blob"
)


def moved(vertex: int, by: tuple[float, float], polygon: Polygon = BLOB) -> np.ndarray:
    vertices = polygon.vertices.copy()
    vertices[vertex] += by
    return vertices


@pytest.fixture
def desk():
    with WatchedSession() as made:
        made.session.show(BLOB)
        made.settle()
        made.log.clear()
        yield made


@pytest.mark.slow
def test_the_last_frame_is_that_of_the_new_polygon(desk):
    desk.session.set(source=(0.2, 0.1, 0.0), isolines=9)
    desk.settle()
    desk.log.clear()
    before = desk.session.state
    desk.session.reshape(moved(0, (0.2, 0.1)))
    ((old, new),) = desk.told("changed")
    assert old == before
    assert (new.query, new.display) == (before.query, before.display)
    np.testing.assert_array_equal(new.shape.vertices, moved(0, (0.2, 0.1)))
    assert desk.session.frame.shape is BLOB, "what was shown stays until there is something newer"
    desk.settle()
    frame = desk.session.frame
    assert frame.shape is new.shape
    assert frame.exact
    (one,) = frame.slices
    assert one.plane == POLYGON_PLANE
    expected = InteriorDistance(new.shape).field([0.2, 0.1], one.points[:, :2])
    np.testing.assert_allclose(one.values, expected, rtol=1e-6, atol=1e-7 * expected.max())
    right = InteriorDistance(new.shape).barycentroid().point
    np.testing.assert_allclose(frame.barycentroid, [*right, 0.0], atol=1e-9)
    assert desk.told("opened") == []


@pytest.mark.slow
def test_a_source_left_outside_becomes_the_barycentroid(desk):
    desk.session.set(source=(0.97, 0.0, 0.0))
    desk.settle()
    desk.session.reshape(moved(0, (-0.1, 0.0)))
    assert desk.session.state.query.source is None
    desk.settle()
    np.testing.assert_array_equal(desk.session.frame.source, desk.session.frame.barycentroid)
    assert desk.told("failed") == []


@pytest.mark.one_is_quick
@pytest.mark.parametrize(
    ("vertices", "part"),
    [
        (moved(0, (-2.5, 0.3)), "cross"),
        (moved(0, tuple(BLOB.vertices[1] - BLOB.vertices[0])), "blob: "),
        (moved(0, (np.nan, 0.0)), "blob: "),
        (BLOB.vertices[:-1], "60 vertices are to be moved, and 59 are given"),
    ],
)
def test_what_is_no_polygon_is_refused_and_nothing_changes(desk, vertices, part):
    before = desk.session.state
    with pytest.raises(PolygonError, match=part):
        desk.session.reshape(vertices)
    assert desk.session.state is before
    assert not desk.session.busy
    assert desk.log == []


def test_only_polygons_have_vertices_to_be_moved():
    with WatchedSession() as desk:
        with pytest.raises(ValueError, match="only the vertices of a polygon can be moved"):
            desk.session.reshape(BLOB.vertices)
        desk.session.show(egg(1))
        with pytest.raises(ValueError, match="only the vertices of a polygon can be moved"):
            desk.session.reshape(BLOB.vertices)


def test_vertices_where_they_are_change_nothing(desk):
    desk.session.reshape(BLOB.vertices.copy())
    assert desk.log == []
    assert desk.session.state.shape is BLOB


@pytest.mark.slow
def test_during_a_drag_frames_of_polygons_passed_by_are_shown(desk):
    forms = [moved(0, (0.01 * step, 0.0)) for step in range(1, 31)]
    for vertices in forms:
        desk.session.reshape(vertices)
        told = len(desk.told("frame_ready"))
        # The next move comes when a frame of this one is on its way.
        desk.owner.run_until(lambda told=told: len(desk.told("frame_ready")) > told)
    desk.settle()
    shapes = [frame.shape for (frame,) in desk.told("frame_ready")]
    assert len(dict.fromkeys(shapes)) >= 15
    assert shapes[-1] is desk.session.state.shape
    np.testing.assert_array_equal(shapes[-1].vertices, forms[-1])
    assert desk.session.frame.exact


def test_a_late_frame_of_another_form_is_shown_but_not_of_another_polygon(desk):
    desk.session.reshape(moved(0, (0.1, 0.0)))
    first = desk.session.state.shape
    desk.session.reshape(moved(0, (0.2, 0.0)))
    desk.owner.run_until(lambda: bool(desk.told("frame_ready")))
    assert desk.told("frame_ready")[0][0].shape in (first, desk.session.state.shape)
    desk.session.reshape(moved(0, (0.3, 0.0)))
    other = Polygon([[0, 0], [1, 0], [0, 1]])
    desk.session.show(other)
    desk.log.clear()
    desk.settle()
    assert {frame.shape for (frame,) in desk.told("frame_ready")} == {other}


@pytest.mark.slow
def test_a_started_polygon_is_shown_before_a_newer_one_is_begun():
    """No checkpoint before the first frame is one at which the runner leaves a request for a newer one."""
    pipeline = Pipeline()
    list(pipeline.results(FrameRequest(BLOB, Query())))
    request = FrameRequest(BLOB.with_vertices(moved(0, (0.1, 0.0))), Query(), (0.0, 0.0, 0.0))
    results = list(pipeline.results(request))
    first = next(i for i, one in enumerate(results) if isinstance(one, Frame))
    assert {type(one).__name__ for one in results[:first]} <= {"NoneType", "Ready"}
    np.testing.assert_array_equal(results[first].source, [0.0, 0.0, 0.0])
    assert not results[first].exact
    assert results[-1].exact
    np.testing.assert_allclose(
        results[-1].source[:2], InteriorDistance(request.shape).barycentroid().point, atol=1e-9
    )


@pytest.mark.slow
def test_the_barycentroid_before_counts_only_where_it_is_inside():
    request = FrameRequest(BLOB, Query(), (5.0, 0.0, 0.0))
    first = next(one for one in Pipeline().results(request) if isinstance(one, Frame))
    np.testing.assert_allclose(first.source[:2], InteriorDistance(BLOB).barycentroid().point, atol=1e-9)


@pytest.mark.slow
def test_kernels_are_looked_at_once_when_their_coordinates_are_first_asked_for(monkeypatch):
    looked = []

    def noted(*asked):
        looked.append(asked)
        yield from ()

    monkeypatch.setattr(kernels_module, "compile_steps", noted)
    pipeline = Pipeline()
    for step in range(3):
        list(pipeline.results(FrameRequest(BLOB.with_vertices(moved(0, (0.1 * step, 0.0))), Query())))
    assert looked == [(2, "mean_value")]
    for coordinates in ("shepard", "mean_value", "shepard"):
        list(pipeline.results(FrameRequest(BLOB, Query(coordinates=coordinates))))
    assert looked == [(2, "mean_value"), (2, "shepard")]


@pytest.mark.slow
def test_a_drag_ends_at_the_frame_of_what_was_asked_last(desk):
    desk.session.set(distance=Euclidean(), coordinates="maximum_entropy")
    desk.session.click(Ray((0.3, 0.1, 3.0), (0.0, 0.0, -1.0)))
    desk.session.reshape(moved(3, (0.1, 0.2)))
    desk.session.reshape(moved(3, (0.2, 0.2)))
    desk.settle()
    frame = desk.session.frame
    np.testing.assert_array_equal(frame.shape.vertices, moved(3, (0.2, 0.2)))
    assert frame.query == Query((), (0.3, 0.1, 0.0), Euclidean(), "distance", "maximum_entropy")
    direct = run_to_end(frame.shape, frame.query)
    np.testing.assert_allclose(frame.slices[0].values, direct.slices[0].values, rtol=1e-9)


@pytest.mark.slow
def test_a_diffusion_time_stays(desk):
    desk.session.set(distance=Diffusion(time=0.2))
    desk.session.reshape(moved(0, (0.1, 0.0)))
    desk.settle()
    assert desk.session.frame.title == "Diffusion distance, t = 0.2"
