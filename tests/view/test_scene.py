"""The scene as a whole: updates in place, no draws of its own, nothing left behind."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest
import pyvista as pv
from pyvistaqt import QtInteractor
from tests.view.frames import disc, frame, shown, sphere
from tests.view.stage import SIDE, apart, color_of, pixel, stage

from idviewer.core import Plane
from idviewer.session.state import State
from idviewer.view.scene import Scene

WHITE = (255, 255, 255)
NO_SOURCE = {"source": np.array([50.0, 0.0, 0.0])}
"""Out of the picture, so that the dot does not cover what is looked at."""


@pytest.fixture(scope="module")
def ball():
    return sphere()


def test_fifty_frames_go_through_the_same_actors(ball):
    with stage() as on:
        on.scene.show(shown(ball, opacity=0.25, isolines=10, scale_bar=True))
        on.scene.show_frame(frame(ball, disc()))
        on.picture()
        first = on.actors()
        for i in range(50):
            tilted = Plane((0, 0, 0.01 * i), (0.01 * i, 0, 1))
            on.scene.show_frame(frame(ball, disc(tilted, 0.5 + 0.01 * i, rings=5 + i % 7)))
        last = on.actors()
        picture = on.picture()
    assert [id(actor) for actor in first] == [id(actor) for actor in last]
    assert apart(picture[pixel(0.2, 0.3)], WHITE) > 20


def test_planes_come_and_go(ball):
    def planes(count):
        return frame(ball, *(disc(Plane((0, 0, 0.2 * k), (0, 0, 1)), 0.5) for k in range(count)), **NO_SOURCE)

    with stage() as on:
        on.scene.show(shown(ball))
        counts = []
        for count in (1, 3, 1, 3, 2, 0):
            on.scene.show_frame(planes(count))
            counts.append(len(on.actors()))
            assert (apart(on.picture()[pixel(0.2, 0.2)], WHITE) > 50) == (count > 0)
    assert len(set(counts[1:])) == 1


def test_the_markers_stay_on_top_of_planes_that_come_later(ball):
    with stage() as on:
        on.scene.show(shown(ball, opacity=0.25))
        on.scene.show_frame(frame(ball, disc(values=lambda p: np.ones(len(p)))))
        on.scene.show_frame(frame(ball, disc(), disc(Plane((0, 0, 0), (0, 1, 0)))))
        assert on.picture()[SIDE // 2 + 2, SIDE // 2].max() < 40


def test_another_mesh_takes_the_old_slices_away(ball):
    with stage() as on:
        on.scene.show(shown(ball, scale_bar=True))
        on.scene.show_frame(frame(ball, disc()))
        on.scene.show(shown(sphere(0.7), scale_bar=True))
        assert apart(on.picture().reshape(-1, 3), WHITE) == 0


def test_no_frame_and_no_mesh_show_nothing(ball):
    with stage() as on:
        on.scene.show(shown(ball, opacity=0.5, scale_bar=True))
        on.scene.show_frame(frame(ball, disc()))
        on.scene.show_frame(None)
        on.scene.show(State())
        assert apart(on.picture().reshape(-1, 3), WHITE) == 0


def test_what_is_shown_already_costs_nothing(ball):
    with stage() as on:
        state = shown(ball, opacity=0.25)
        on.scene.show(state)
        on.scene.show_frame(frame(ball, disc()))
        on.picture()
        before = [actor.GetRedrawMTime() for actor in on.actors()]
        on.scene.show(state.with_(opacity=0.25))
        assert [actor.GetRedrawMTime() for actor in on.actors()] == before


def test_it_never_renders_by_itself(ball):
    with stage() as on:
        renders = []
        tag = on.plotter.render_window.AddObserver("RenderEvent", lambda *_: renders.append(1))
        start = on.plotter.render_window.AddObserver("StartEvent", lambda *_: renders.append(1))
        on.scene.show(shown(ball, opacity=0.25, scale_bar=True))
        on.scene.show_frame(frame(ball, disc()))
        on.scene.show(shown(sphere(), colormap="even"))
        on.scene.show_frame(None)
        on.plotter.render_window.RemoveObserver(tag)
        on.plotter.render_window.RemoveObserver(start)
    assert renders == []


def test_closing_takes_everything_out_and_may_be_repeated(ball):
    plotter = pv.Plotter(off_screen=True, window_size=[50, 50])
    empty = plotter.renderer.GetViewProps().GetNumberOfItems()
    scene = Scene(plotter)
    made = frame(ball, disc())
    scene.show(shown(ball))
    scene.show_frame(made)
    plotter.render_window.Render()
    points = weakref.ref(made.slices[0].points)
    for _ in range(2):
        scene.close()
    assert plotter.renderer.GetViewProps().GetNumberOfItems() == empty
    scene.show(shown(ball))
    scene.show_frame(made)
    plotter.render_window.Render()
    plotter.close()
    scene.close()
    gone = weakref.ref(scene)
    del scene, made
    gc.collect()
    assert gone() is None
    assert points() is None


def test_a_plotter_may_be_closed_before_its_scene(ball):
    plotter = pv.Plotter(off_screen=True, window_size=[50, 50])
    scene = Scene(plotter)
    scene.show(shown(ball))
    plotter.close()
    scene.show(shown(ball, opacity=0.5))
    scene.show_frame(frame(ball, disc()))
    scene.close()


def test_it_draws_in_a_window_too(ball, qtbot):
    widget = QtInteractor(auto_update=False)
    qtbot.addWidget(widget)
    widget.resize(200, 200)
    scene = Scene(widget)
    scene.show(shown(ball, opacity=0.25))
    scene.show_frame(frame(ball, disc(values=lambda p: np.full(len(p), 0.4)), **NO_SOURCE))
    camera = widget.renderer.GetActiveCamera()
    camera.SetPosition(0, 0, 5)
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(0, 1, 0)
    widget.renderer.camera_set = True
    widget.renderer.ResetCameraClippingRange()
    with qtbot.waitExposed(widget):
        widget.show()
    widget.render()
    seen = widget.screenshot(return_img=True)
    scene.close()
    widget.close()
    middle = seen[seen.shape[0] // 2 + 15, seen.shape[1] // 2 + 10]
    assert apart(middle.astype(int), color_of(0.4)) <= 30
