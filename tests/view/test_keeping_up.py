"""Whether the window follows: what a frame costs its event loop, and what many drags leave behind."""

from __future__ import annotations

import gc
import os
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtWidgets import QSlider, QStyle, QStyleOptionSlider
from pytestqt.qtbot import QtBot
from tests.view.effort import ARRAYS, BYTES, CALLS, DRAWS, LOOKS, POSTS, Effort
from tests.view.frames import along_x, disc, frame, sphere
from tests.view.mouse import Mouse
from tests.view.windows import grip, pixels_of, show_window, wait_until_done
from vtkmodules.util.numpy_support import vtk_to_numpy

from idviewer.core import InteriorDistance, Plane
from idviewer.core.io.bundled_shapes import sample_path
from idviewer.core.memory import release_free_memory
from idviewer.session.pipeline import Pipeline
from idviewer.session.planes import axis_of
from idviewer.session.state import Frame, FrameRequest, State
from idviewer.view.handle_geometry import Part
from idviewer.view.window import MainWindow

pytestmark = pytest.mark.slow


# What a frame costs

SMALL = (620, 600)
TURNS = 11
FINE, COARSE = 81, 10
"""Rings of the sections: 19,900 values and 330."""


def test_a_frame_costs_the_event_loop_little_but_for_drawing(
    qtbot: QtBot, mouse: Mouse, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All from a new plane to VTK's drawing (panel, slice, markers, bar, handle), and then the value under
    the mouse. How long that takes is a row of `make bench`.
    """
    effort = Effort(monkeypatch)
    few, many = (efforts_of_a_frame(qtbot, mouse, effort, rings) for rings in (COARSE, FINE))
    # Nothing goes through values, points or triangles one by one.
    usual = np.median([one[CALLS] for one in many])
    assert usual < 1.1 * np.median([one[CALLS] for one in few]) < 3000
    section = disc(rings=FINE)
    # Positions, level, known or not; triangles; ends and indices of the outline: in four bytes each, once.
    numbers = 5 * len(section.points) + section.triangles.size + len(section.outline[0]) + 3
    for one in many:
        assert one[ARRAYS] == 6
        assert one[BYTES] == 4 * numbers
        assert one[POSTS] == 2, "a frame, and that it was the last"
        assert one[LOOKS] == 1
        assert 1 <= one[DRAWS] <= 2, "the handle moves at once, and the slice when it comes"


def efforts_of_a_frame(qtbot: QtBot, mouse: Mouse, effort: Effort, rings: int) -> list[Counter[str]]:
    """What each of many frames gives the event loop to do; the mouse rests on the section."""
    ball, section = sphere(), disc(rings=rings, values=along_x)

    def work(request: FrameRequest) -> Iterator[Frame]:
        (plane,) = request.query.planes
        points = section.points + np.array(plane.origin)
        lifted = replace(section, plane=plane, points=points, values=points[:, 0])
        yield frame(ball, lifted, value_range=(-1.0, 1.0), query=request.query)

    window = show_window(qtbot, work, size=(1000, 700))  # type: ignore[arg-type]
    window.session.show(ball)
    wait_until_done(qtbot, window.session)
    x, y = window.viewport.projection.project([[0.4, 0.5, 0.0]])[0].round().tolist()
    mouse.move(window.viewport, x, y)
    efforts = []
    for height in np.linspace(-0.02, 0.02, TURNS).tolist():
        qtbot.wait(50)  # what the frame before has left to do
        effort.counts.clear()
        effort.around(window.session.set)(planes=(Plane((0.0, 0.0, height), (0.0, 0.0, 1.0)),))
        wait_until_done(qtbot, window.session)
        qtbot.waitUntil(lambda: effort.counts[LOOKS] > 0 and effort.counts[DRAWS] > 0)
        efforts.append(effort.counts.copy())
    assert "Euclidean" in window.status.probe.text()
    window.close()
    return efforts


# What many drags leave behind

DRAGS, SETTLED = 200, 50
"""How many, and from which one on nothing may grow any more."""
SLACK = 64e6
"""Bytes that the samples of the planes that are kept, and gaps between, may differ by."""


def test_two_hundred_drags_leave_a_true_picture_and_nothing_else(qtbot: QtBot, mouse: Mouse) -> None:
    window = show_window(qtbot, Pipeline().results, size=SMALL)
    window.open(sample_path("hand_2k"))
    wait_until_done(qtbot, window.session)
    hand = Hand(qtbot, mouse, window)
    with watched(window) as seen:
        for number in range(1, DRAGS + 1):
            hand.drag(number)
            if number in (SETTLED, DRAGS):
                wait_until_done(qtbot, window.session)
                seen.take_stock()
        hand.turn()
        frame = wait_until_done(qtbot, window.session)
        qtbot.wait(50)
        picture = pixels_of(window)
    assert seen.draws > DRAGS
    assert not seen.stale
    assert seen.in_order()
    assert len(seen.framed) > DRAGS
    assert seen.memory[1] - seen.memory[0] < SLACK
    assert seen.objects[1] == seen.objects[0]
    assert_directly_computed(frame, window.session.state)
    # A scene that forgets all it has shown and begins anew looks the same.
    window.viewport.show_frame(None)
    qtbot.wait(50)
    assert (pixels_of(window) != picture).any()
    window.viewport.show_frame(frame)
    qtbot.wait(50)
    np.testing.assert_array_equal(pixels_of(window), picture)


class Hand:
    """Drags the plane, most often by its handle, now and then with the sliders beside."""

    def __init__(self, qtbot: QtBot, mouse: Mouse, window: MainWindow) -> None:
        self._qtbot, self._mouse, self._window = qtbot, mouse, window
        mesh = window.session.state.shape
        assert mesh is not None
        self._bounds, self._axis = mesh.bounds, axis_of(window.session.state.query.planes[0]) or "y"

    def drag(self, number: int) -> None:
        """One drag, to another place each time."""
        share = 0.5 + 0.3 * float(np.sin(2.4 * number))
        slider = {7: self._window.panel.planes.slider, 8: self._time}.get(number % 10)
        if slider is not None:
            self._slide(slider, share)
        elif number % 10 == 9:
            self._slowly_push(share)
        else:
            self._push(share)

    def turn(self) -> None:
        """The plane, by its ring."""
        x, y = grip(self._window.viewport, Part.TURN)
        self._mouse.swing(self._window.viewport, [(x, y), (x - 6, y - 8), (x - 12, y - 16)])

    @property
    def _time(self) -> QSlider:
        return self._window.panel.distance.rows["diffusion", "time"].slider

    def _way(self, share: float) -> list[tuple[float, float]]:
        """From the arrow to where it has the plane at a share of the shape."""
        viewport, (plane,) = self._window.viewport, self._window.session.state.query.planes
        goal = Plane.along(self._axis, share, self._bounds).origin
        step = plane.height([goal])[0] * np.array(plane.normal)
        start = np.array(grip(viewport, Part.PUSH))
        ends = viewport.projection.project([plane.origin, plane.origin + step])
        return [tuple(start + part * (ends[1] - ends[0])) for part in np.linspace(0.0, 1.0, 5)]

    def _push(self, share: float) -> None:
        self._mouse.swing(self._window.viewport, self._way(share))

    def _slowly_push(self, share: float) -> None:
        """Waits for the picture at each step, the button still down: the slice follows the drag."""
        viewport, session = self._window.viewport, self._window.session
        way = self._way(share)
        self._mouse.press(viewport, *way[0])
        for place in way[1:]:
            self._mouse.move(viewport, *place)
            self._qtbot.waitUntil(lambda: session.frame.query == session.state.query)
        self._mouse.release()

    def _slide(self, slider: QSlider, share: float) -> None:
        option = QStyleOptionSlider()
        slider.initStyleOption(option)
        parts = (QStyle.ComplexControl.CC_Slider, option, QStyle.SubControl.SC_SliderHandle, slider)
        knob = slider.style().subControlRect(*parts).center()
        goal = slider.width() * share
        way = [(float(knob.x() + part * (goal - knob.x())), float(knob.y())) for part in np.linspace(0, 1, 5)]
        self._mouse.swing(slider, way)


class Seen:
    """What happens in a window: planes asked for and shown, pictures drawn, and what the process holds."""

    def __init__(self, window: MainWindow) -> None:
        self._session, self._plotter = window.session, window.viewport._plotter
        self.asked, self.framed = [window.session.state.query], [window.session.state.query]
        self.draws = 0
        self.stale: list[Plane] = []
        self.memory: list[int] = []
        self.objects: list[Counter[str]] = []

    def drawn(self, *_: object) -> None:
        """The slice that is drawn lies in the plane of the newest frame."""
        self.draws += 1
        actor = self._plotter.renderer.GetViewProps().GetItemAsObject(0)
        points = vtk_to_numpy(actor.GetMapper().GetInput().GetPoints().GetData())
        heights = self._session.frame.slices[0].plane.height(points * actor.GetScale() + actor.GetPosition())
        if np.abs(heights).max(initial=0.0) > 1e-6 * self._session.frame.shape.diagonal:
            self.stale.append(self._session.frame.slices[0].plane)

    def take_stock(self) -> None:
        """Counts bytes, VTK's objects and frames, and the window's actors and listeners."""
        gc.collect()
        release_free_memory()  # the gaps that tests before have left in the heap fill up in no order
        held = Counter(type(thing).__name__ for thing in gc.get_objects())
        kept = {name: count for name, count in held.items() if name.startswith("vtk") or name == "Frame"}
        kept["actors"] = self._plotter.renderer.GetViewProps().GetNumberOfItems()
        self.objects.append(Counter(kept))
        self.memory.append(int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE"))

    def in_order(self) -> bool:
        """Whether no frame answers what was asked for before that of an earlier one."""
        asked = iter(self.asked)
        latest = next(asked)
        for query in self.framed:
            while latest is not None and latest != query:
                latest = next(asked, None)
        return latest is not None


@contextmanager
def watched(window: MainWindow) -> Iterator[Seen]:
    """Sees what happens in a window."""
    seen, session, screen = Seen(window), window.session, window.viewport._plotter.GetRenderWindow()

    def asked(_old: State, new: State) -> None:
        seen.asked.append(new.query)

    def framed(frame: Frame) -> None:
        seen.framed.append(frame.query)

    session.changed.connect(asked)
    session.frame_ready.connect(framed)
    tag = screen.AddObserver("StartEvent", seen.drawn)
    yield seen
    screen.RemoveObserver(tag)
    session.frame_ready.disconnect(framed)
    session.changed.disconnect(asked)


def assert_directly_computed(frame: Frame, state: State) -> None:
    """The frame answers the state, with values that the solver gives for its points."""
    assert (frame.shape, frame.query, frame.exact) == (state.shape, state.query, True)
    (section,), query = frame.slices, state.query
    assert section.plane == query.planes[0]
    assert np.abs(section.plane.height(section.points)).max() < 1e-9
    solver = InteriorDistance(frame.shape, query.distance)
    some = np.linspace(0, len(section.points) - 1, 200).astype(int)
    direct = solver.field(frame.source, section.points[some])
    np.testing.assert_allclose(section.values[some], direct, rtol=1e-7, atol=1e-9 * frame.value_range[1])
    apart = np.linalg.norm(frame.source - solver.barycentroid().point)
    assert apart < 1e-6 * frame.shape.diagonal
