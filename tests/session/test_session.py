"""The session: equal values are a no-op, failures lose nothing, late frames are dropped."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes
from tests.session.bodies import WatchedSession, egg

from idviewer.core import (
    GPS,
    Diffusion,
    Euclidean,
    Geodesic,
    GivenEmbedding,
    Mesh,
    Plane,
)
from idviewer.core.shapes.rays import Ray
from idviewer.session.state import default_plane

MESH = egg()


def write_off(path, mesh: Mesh) -> None:
    lines = ["OFF", f"{len(mesh.vertices)} {len(mesh.faces)} 0"]
    lines += [" ".join(map(repr, vertex)) for vertex in mesh.vertices.tolist()]
    lines += [f"3 {a} {b} {c}" for a, b, c in mesh.faces.tolist()]
    path.write_text("\n".join(lines))


@pytest.fixture
def desk():
    with WatchedSession() as made:
        yield made


@pytest.fixture
def settled(desk):
    desk.session.show(MESH)
    desk.settle()
    return desk


@pytest.mark.slow
def test_a_shape_shown_again_is_computed_again(settled):
    settled.session.show(MESH)
    settled.settle()
    assert settled.session.frame.exact


@pytest.mark.slow
def test_a_mesh_shown_ends_in_an_exact_frame_through_its_barycentroid(settled):
    frame = settled.session.frame
    assert frame.exact
    assert frame.shape is MESH
    (plane,) = frame.query.planes
    assert plane.normal == default_plane(MESH).normal == (1.0, 0.0, 0.0)
    assert abs(plane.height(frame.barycentroid[None])[0]) < 1e-12
    assert settled.told("opened") == [(MESH, None)]
    assert len(settled.told("prepared")) == 1
    assert settled.told("progressed")[-1] == (None,)


@pytest.mark.slow
def test_equal_values_are_a_no_op(settled):
    before = len(settled.log)
    settled.session.set(
        isolines=20, planes=settled.session.state.query.planes, source=None, distance=Diffusion()
    )
    assert len(settled.log) == before


@pytest.mark.slow
def test_display_changes_compute_nothing(settled):
    settled.session.set(isolines=7, colormap="even")
    assert not settled.session.busy
    assert settled.session.state.display.isolines == 7
    with pytest.raises(TypeError, match="neither a query nor a display has colour"):
        settled.session.set(colour="red")


@pytest.mark.slow
def test_a_drag_ends_in_the_frame_of_its_last_plane(settled):
    planes = [Plane((x, 0.0, 0.0), (1.0, 0.0, 0.0)) for x in np.linspace(-0.5, 0.5, 30)]
    for plane in planes:
        settled.session.set(planes=(plane,))
        settled.owner.run_all()
    settled.settle()
    assert settled.session.frame.query.planes == (planes[-1],)
    assert settled.session.frame.exact
    heights = planes[-1].height(settled.session.frame.slices[0].points)
    np.testing.assert_allclose(heights, 0, atol=1e-12)


@pytest.mark.slow
def test_clicks_set_the_source(settled):
    x = settled.session.frame.query.planes[0].origin[0]
    ray = Ray((5.0, 0.2, 0.3), (-1.0, 0.0, 0.0))
    settled.session.click(ray)
    assert settled.session.state.query.source == pytest.approx((x, 0.2, 0.3))
    settled.session.click(ray, "surface")
    near = settled.session.state.query.source
    assert near[0] > x
    settled.session.click(ray, "chord")
    assert abs(settled.session.state.query.source[0]) < near[0]
    settled.session.click(Ray((5.0, 9.0, 9.0), (-1.0, 0.0, 0.0)))
    settled.settle()
    np.testing.assert_allclose(settled.session.frame.source, settled.session.state.query.source)
    assert settled.session.frame.value_range[0] == 0


@pytest.mark.slow
def test_a_click_beside_the_slice_takes_the_body(settled):
    settled.session.set(planes=(Plane((0, 0, 1.5), (0.0, 0.0, 1.0)),))
    settled.settle()
    settled.session.click(Ray((0.1, 0.1, -9.0), (0.0, 0.0, 1.0)))
    assert settled.session.state.query.source[2] == pytest.approx(1.5)
    settled.session.click(Ray((5.0, 0.2, 0.3), (-1.0, 0.0, 0.0)))
    assert settled.session.state.query.source[0] > 0.5


@pytest.mark.slow
def test_the_probe_reads_what_is_shown(settled):
    frame = settled.session.frame
    x = frame.query.planes[0].origin[0]
    probe = settled.session.probe(Ray((5.0, 0.2, 0.3), (-1.0, 0.0, 0.0)))
    np.testing.assert_allclose(probe.point, [x, 0.2, 0.3], atol=1e-12)
    nearest = np.linalg.norm(frame.slices[0].points - probe.point, axis=1).argmin()
    assert probe.value == pytest.approx(frame.slices[0].values[nearest], abs=0.05 * frame.value_range[1])
    assert settled.session.probe(Ray((5.0, 9.0, 9.0), (-1.0, 0.0, 0.0))) is None


@pytest.mark.slow
def test_a_source_outside_is_refused_and_the_old_one_kept(settled):
    settled.session.set(source=(0.1, 0.1, 0.1))
    settled.settle()
    settled.session.set(source=(50.0, 0.0, 0.0))
    settled.settle()
    assert "outside the mesh" in str(settled.told("failed")[0][0])
    assert settled.session.state.query.source == (0.1, 0.1, 0.1)
    assert settled.session.frame.query == settled.session.state.query


@pytest.mark.slow
def test_opening_replaces_the_mesh_and_failing_to_keeps_it(settled, tmp_path):
    before = settled.session.state
    settled.session.open(tmp_path / "nothing.off")
    settled.owner.run_until(lambda: bool(settled.told("failed")))
    settled.settle()
    assert settled.session.state == before
    assert settled.session.frame.shape is MESH
    path = tmp_path / "small.off"
    write_off(path, Mesh(*shapes.icosphere(2)))
    settled.session.set(isolines=5)
    settled.session.open(path)
    settled.settle()
    assert settled.session.state.shape.name == "small"
    assert settled.session.state.display.isolines == 5
    assert settled.session.frame.shape is settled.session.state.shape
    assert settled.told("opened")[-1] == (settled.session.state.shape, path)


@pytest.mark.slow
def test_opening_while_computing_keeps_the_old_computation_if_it_fails(desk, tmp_path):
    desk.session.show(MESH)
    desk.session.open(tmp_path / "nothing.off")
    desk.session.set(isolines=3)
    desk.owner.run_until(lambda: desk.session.frame is not None and desk.session.frame.exact)
    assert len(desk.told("failed")) == 1


@pytest.mark.slow
def test_planes_moved_while_opening_do_not_cancel_the_opening(settled, tmp_path):
    path = tmp_path / "small.off"
    write_off(path, Mesh(*shapes.icosphere(2)))
    settled.session.open(path)
    settled.session.set(planes=(Plane((0.1, 0, 0), (1.0, 0, 0)),))
    settled.owner.run_until(lambda: bool(settled.told("opened")[1:]))
    assert settled.session.state.shape.name == "small"
    settled.settle()


@pytest.mark.slow
def test_cancelling_keeps_the_mesh_and_resuming_goes_on(desk):
    desk.session.show(MESH)
    desk.owner.run_until(lambda: bool(desk.told("progressed")))
    desk.session.cancel()
    assert not desk.session.busy
    desk.session.set(source=(0.0, 0.0, 0.1))
    assert not desk.session.busy
    assert desk.session.state.shape is MESH
    assert desk.session.frame is None
    desk.session.resume()
    desk.settle()
    assert desk.session.frame.exact
    np.testing.assert_allclose(desk.session.frame.source, [0, 0, 0.1])


@pytest.mark.slow
def test_frames_of_another_mesh_are_dropped(settled):
    other = egg(2)
    settled.session.set(planes=(Plane((0.2, 0, 0), (1.0, 0, 0)),))
    settled.session.show(other)
    assert settled.session.frame is None
    settled.settle()
    late = [frame for (frame,) in settled.told("frame_ready") if frame.shape is other]
    assert late
    last_of_first = max(
        i for i, entry in enumerate(settled.log) if entry[0] == "frame_ready" and entry[1].shape is MESH
    )
    shown = next(i for i, entry in enumerate(settled.log) if entry == ("opened", other, None))
    assert last_of_first < shown


@pytest.mark.slow
def test_changing_the_distance_prepares_it(settled):
    settled.session.set(distance=Euclidean())
    settled.settle()
    assert settled.session.frame.title == "Euclidean distance"
    assert settled.session.ready.modes == 0


def test_closing_in_the_middle_is_quiet_and_can_be_repeated(desk):
    desk.session.show(MESH)
    desk.session.close()
    told = len(desk.log)
    desk.owner.run_all()
    assert len(desk.log) == told
    desk.session.close()


def test_a_diffusion_time_is_not_carried_to_another_mesh(desk):
    desk.session.set(distance=GPS())
    desk.session.show(egg(1))
    assert desk.session.state.query.distance == GPS()
    desk.session.set(distance=Diffusion(time=0.3))
    desk.session.show(egg(1))
    assert desk.session.state.query.distance == Diffusion()


def test_a_file_of_distances_is_not_carried_to_another_mesh(desk):
    desk.session.set(distance=GivenEmbedding("embedding.npy"))
    desk.session.show(egg(1))
    assert desk.session.state.query.distance == Diffusion()
    desk.session.set(distance=Geodesic(landmarks=50))
    desk.session.show(egg(1))
    assert desk.session.state.query.distance == Geodesic(landmarks=50)
