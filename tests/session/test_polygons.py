"""Polygons through the pipeline and the session: one slice that shows all, in the plane z = 0."""

from __future__ import annotations

import numpy as np
import pytest
from tests.session.bodies import WatchedSession, egg, few_samples  # noqa: F401

from idviewer.core import (
    Biharmonic,
    CommuteTime,
    Diffusion,
    Euclidean,
    Geodesic,
    InteriorDistance,
    Plane,
    Polygon,
    polygon_section,
    read_shape,
    sample_path,
    write_polygon,
)
from idviewer.core.sampling import POLYGON_PLANE
from idviewer.core.shapes.rays import Ray
from idviewer.session.picking import pick
from idviewer.session.pipeline import Pipeline
from idviewer.session.run_to_end import run_to_end
from idviewer.session.state import Failure, Frame, FrameRequest, Progress, Query, Ready

L_SHAPE = Polygon([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]], name="L")
RING = read_shape(sample_path("ring"))
STAR = read_shape(sample_path("star"))
SQUARE = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])


def frames_of(polygon: Polygon, query: Query, pipeline: Pipeline | None = None) -> list[Frame]:
    results = (pipeline or Pipeline()).results(FrameRequest(polygon, query))
    return [one for one in results if isinstance(one, Frame)]


def placed(polygon: Polygon, scale: float, offset: float) -> Polygon:
    return Polygon(polygon.vertices * scale + offset, polygon.loops)


@pytest.mark.slow
@pytest.mark.parametrize("polygon", [L_SHAPE, RING, STAR], ids=lambda one: one.name)
@pytest.mark.parametrize("coordinates", ["mean_value", "maximum_entropy", "shepard"])
def test_every_value_of_the_last_frame_is_the_library_s(polygon, coordinates):
    source = polygon.vertices[:2].mean(axis=0)
    for distance in (Diffusion(), Euclidean(), CommuteTime()):
        query = Query(source=(*source.tolist(), 0.0), distance=distance, coordinates=coordinates)
        frame = frames_of(polygon, query)[-1]
        (one,) = frame.slices
        assert frame.exact
        assert frame.remarks == ()
        assert (one.points[:, 2] == 0.0).all()
        solver = InteriorDistance(polygon, distance, coordinates)
        expected = solver.field(source, one.points[:, :2])
        assert np.isfinite(expected).all()
        # Points on edges lie on them only to rounding, and weights are steep there.
        np.testing.assert_allclose(one.values, expected, rtol=1e-6, atol=1e-7 * expected.max())
        inner = np.setdiff1d(np.arange(len(one.points)), np.concatenate(one.outline))
        np.testing.assert_allclose(one.values[inner], expected[inner], rtol=1e-9, atol=1e-11 * expected.max())
        largest = float(solver.field(source, polygon.vertices).max())
        assert frame.value_range == pytest.approx((0.0, largest), rel=1e-9)


@pytest.mark.parametrize("polygon", [L_SHAPE, RING], ids=lambda one: one.name)
def test_the_slice_covers_the_polygon_and_nothing_else(polygon):
    (one,) = frames_of(polygon, Query(planes=(Plane((9.0, 9.0, 9.0), (1.0, 0, 0)),)))[-1].slices
    assert one.plane == POLYGON_PLANE
    (ax, ay), (bx, by), (cx, cy) = (one.points[one.triangles[:, k], :2].T for k in range(3))
    areas = 0.5 * ((bx - ax) * (cy - ay) - (cx - ax) * (by - ay))
    assert areas.min() >= -1e-12 * polygon.area
    assert areas.sum() == pytest.approx(polygon.area, rel=1e-9)
    assert len(one.outline) == len(polygon.loops)
    assert polygon.contains(one.points[:, :2]).all()


@pytest.mark.one_is_quick
@pytest.mark.parametrize(("scale", "offset"), [(1e-9, 0.0), (1.0, 1e6), (1e3, -1e6)])
@pytest.mark.parametrize("coordinates", ["mean_value", "shepard"])
def test_neither_scale_nor_place_matter(scale, offset, coordinates):
    moved = placed(L_SHAPE, scale, offset)
    near = frames_of(L_SHAPE, Query(source=(0.5, 0.5, 0.0), distance=Euclidean(), coordinates=coordinates))
    source = (0.5 * scale + offset, 0.5 * scale + offset, 0.0)
    far = frames_of(moved, Query(source=source, distance=Euclidean(), coordinates=coordinates))
    rounding = 1e-9 + 1e-15 * abs(offset) / scale
    assert far[-1].value_range[1] == pytest.approx(near[-1].value_range[1] * scale, rel=rounding)
    straight = np.linalg.norm(far[-1].slices[0].points - source, axis=1)
    if coordinates == "mean_value":
        np.testing.assert_allclose(far[-1].slices[0].values, straight, atol=10 * rounding * straight.max())


def test_along_a_long_edge_straight_distances_are_seen():
    (one,) = frames_of(SQUARE, Query(source=(0.5, 0.5, 0.0), distance=Euclidean()))[0].slices
    corners = one.points[one.triangles]
    middles, values = corners.mean(axis=1), one.values[one.triangles].mean(axis=1)
    away = np.linalg.norm(middles - [0.5, 0.5, 0.0], axis=1)
    assert np.abs(values - away).max() < 0.03, "four outline points would be wrong by 0.2"


@pytest.mark.slow
def test_coarse_frames_state_an_error_that_holds():
    for coordinates in ("mean_value", "maximum_entropy", "shepard"):
        query = Query(source=(0.0, 0.2, 0.0), coordinates=coordinates)
        solver = InteriorDistance(STAR, coordinates=coordinates)
        frames = frames_of(STAR, query)
        assert [frame.level for frame in frames] == [0, 1, 2]
        assert [frame.exact for frame in frames] == [False, False, True]
        for frame in frames:
            (one,) = frame.slices
            expected = solver.field(query.source[:2], one.points[:, :2])
            assert np.nanmax(np.abs(one.values - expected)) <= 2 * frame.error + 1e-7 * expected.max()
        assert 0.0 < frames[0].error < 0.1 * frames[0].value_range[1]


@pytest.mark.slow
def test_the_barycentroid_is_in_space_and_the_library_s():
    results = list(Pipeline().results(FrameRequest(STAR, Query())))
    (ready,) = (one for one in results if isinstance(one, Ready))
    last = results[-1]
    solver = InteriorDistance(STAR)
    right = solver.barycentroid()
    for point in (ready.barycentroid, last.barycentroid, last.source):
        np.testing.assert_allclose(point, [*right.point, 0.0], atol=1e-9)
        assert point[2] == 0.0
    potential = frames_of(STAR, Query(quantity="potential"))[-1]
    assert potential.value_range[0] == pytest.approx(right.potential, rel=1e-9)
    (one,) = potential.slices
    expected = solver.potential(one.points[:, :2])
    np.testing.assert_allclose(one.values, expected, rtol=1e-6, atol=1e-7 * expected.max())


def test_a_source_outside_is_refused_and_named():
    *_, failure = Pipeline().results(FrameRequest(RING, Query(source=(0.0, 0.0, 0.0))))
    assert isinstance(failure, Failure)
    assert str(failure.error).startswith("the source (0, 0) lies outside the polygon; choose a point inside")


def test_short_work_is_not_told_and_so_is_not_left():
    pipeline = Pipeline()
    list(pipeline.results(FrameRequest(SQUARE, Query())))
    results = list(pipeline.results(FrameRequest(L_SHAPE, Query())))
    first = next(i for i, one in enumerate(results) if isinstance(one, Frame))
    assert not [one for one in results[:first] if isinstance(one, Progress)]


@pytest.mark.slow
def test_distances_and_coordinates_share_what_they_can(monkeypatch):
    pipeline = Pipeline()
    frames_of(STAR, Query(distance=Geodesic()), pipeline)
    monkeypatch.setattr(Geodesic, "basis_steps", None)  # calling it would be an error
    for coordinates in ("shepard", "maximum_entropy", "mean_value"):
        assert frames_of(STAR, Query(distance=Geodesic(), coordinates=coordinates), pipeline)[-1].exact
    frames_of(STAR, Query(distance=Biharmonic(), coordinates="shepard"), pipeline)
    with monkeypatch.context() as broken:
        broken.setattr("idviewer.session.eigenpair_source.eigenpair_steps", None)
        assert frames_of(STAR, Query(coordinates="maximum_entropy"), pipeline)[-1].exact


class TestPicking:
    @pytest.mark.parametrize("target", ["slice-or-body", "surface", "chord"])
    def test_a_ray_meets_the_plane_inside_or_nothing(self, target):
        def hit(x: float, y: float, direction=(0.0, 0.0, -1.0)):
            return pick(RING, None, Ray((x - 2 * direction[0], y - 2 * direction[1], 2.0), direction), target)

        np.testing.assert_allclose(hit(0.4, 0.1), [0.4, 0.1, 0.0])
        np.testing.assert_allclose(hit(0.4, 0.1, (0.3, -0.2, -1.0)), [0.4, 0.1, 0.0], atol=1e-12)
        hole = RING.vertices[RING.loops[1]].mean(axis=0)
        assert hit(*hole) is None
        assert hit(0.9, 0.9) is None
        assert pick(RING, None, Ray((0.4, 0.1, 1.0), (1.0, 0.0, 0.0)), target) is None

    def test_where_a_polygon_is_finer_than_its_slice_a_click_still_meets_it(self):
        thin = Polygon([[0, 0], [1, 0], [1, 1e-6], [0.5, 1e-6], [0.5, 1], [0, 1]])
        point = pick(thin, None, Ray((0.9, 5e-7, 1.0), (0.0, 0.0, -1.0)), "slice-or-body")
        np.testing.assert_allclose(point, [0.9, 5e-7, 0.0])


class TestSession:
    def test_a_polygon_is_opened_shown_and_clicked(self, tmp_path):
        write_polygon(L_SHAPE, tmp_path / "corner.csv")
        with WatchedSession() as desk:
            desk.session.set(distance=Diffusion(time=0.3), source=(0.0, 0.0, 9.0))
            desk.session.open(tmp_path / "corner.csv")
            desk.settle()
            session = desk.session
            assert session.state.shape.name == "corner"
            assert session.state.query == Query()
            assert session.frame.exact
            assert session.frame.shape is session.state.shape
            session.click(Ray((3.5, 0.5, 5.0), (0.0, 0.0, -1.0)))
            assert session.state.query.source == (3.5, 0.5, 0.0)
            session.click(Ray((3.5, 2.5, 5.0), (0.0, 0.0, -1.0)))
            assert session.state.query.source == (3.5, 0.5, 0.0)
            desk.settle()
            probe = session.probe(Ray((0.5, 2.5, 5.0), (0.0, 0.0, -1.0)))
            expected = InteriorDistance(session.state.shape).field([3.5, 0.5], [[0.5, 2.5]])
            assert probe.value == pytest.approx(float(expected[0]), rel=1e-3)
            assert session.probe(Ray((3.5, 2.5, 5.0), (0.0, 0.0, -1.0))) is None
            session.set(source=(3.5, 2.5, 0.0))
            desk.settle()
            assert "lies outside the polygon" in str(desk.told("failed")[0][0])
            assert session.state.query.source == (3.5, 0.5, 0.0)

    def test_what_is_no_polygon_fails_and_leaves_what_was_there(self, tmp_path):
        (tmp_path / "bow.csv").write_text("0,0\n1,1\n1,0\n0,1\n")
        with WatchedSession() as desk:
            desk.session.show(SQUARE)
            desk.settle()
            desk.session.open(tmp_path / "bow.csv")
            desk.owner.run_until(lambda: bool(desk.told("failed")))
            desk.settle()
            assert "bow.csv" in str(desk.told("failed")[0][0])
            assert desk.session.state.shape is SQUARE

    @pytest.mark.slow
    def test_meshes_and_polygons_take_turns(self):
        mesh = egg(1)
        with WatchedSession() as desk:
            for shape in (SQUARE, mesh, L_SHAPE):
                desk.session.set(distance=Euclidean(), coordinates="shepard")
                desk.session.show(shape)
                desk.settle()
                frame = desk.session.frame
                assert frame.shape is shape
                assert frame.exact
                assert len(frame.query.planes) == (shape is mesh)
                assert frame.query.coordinates == "shepard"
                assert frame.title == "Euclidean distance; shepard's weights"


@pytest.mark.parametrize(
    ("distance", "title"),
    [(Euclidean(), "Euclidean distance in mm"), (Biharmonic(), "Biharmonic distance, ")],
)
def test_lengths_are_in_the_shapes_unit(distance, title):
    frame = frames_of(SQUARE.with_labels(unit="mm"), Query(distance=distance))[-1]
    assert frame.title.startswith(title)
    assert (" in mm" in frame.title) == distance.is_length
    assert frame.shape.unit == "mm"


def test_short_edges_are_not_divided():
    (one,) = frames_of(RING, Query())[-1].slices
    count = len(np.concatenate(one.outline))
    assert count == len(polygon_section(RING).in_plane) == len(RING.vertices)
    np.testing.assert_allclose(one.points[:count, :2], RING.vertices, atol=1e-15)


def test_it_runs_to_its_end_without_a_session():
    assert run_to_end(SQUARE, Query()).exact
