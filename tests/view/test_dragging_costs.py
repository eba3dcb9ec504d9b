"""What a step of a vertex's drag costs the event loop, but for VTK's drawing."""

from __future__ import annotations

import numpy as np
import pytest
from pytestqt.qtbot import QtBot
from tests.view.polygons import star
from tests.view.test_keeping_up import UNDISTURBED, Clock, TimedPost
from tests.view.windows import show_window, wait_until_done

from idviewer import app
from idviewer.view.viewport import Viewport

pytestmark = [pytest.mark.slow, pytest.mark.alone]
BUDGET = 0.008
"""Seconds, for 200 vertices: half the time that a screen shows a picture."""


def test_a_step_costs_the_event_loop_little(qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> None:
    """From the mouse's move to VTK's drawing of the frame that follows, and the value under the mouse.

    The thread's own time is taken, which what else the machine is doing has little to do with.
    """
    clock = Clock()
    monkeypatch.setattr(app, "Post", lambda: TimedPost(clock))
    monkeypatch.setattr(Viewport, "_before_draw", clock.around(Viewport._before_draw))
    monkeypatch.setattr(Viewport, "_rest", clock.around(Viewport._rest))
    window = show_window(qtbot, size=(1000, 700))
    polygon = star(points=5, between=20)
    assert len(polygon.vertices) == 200
    window.session.show(polygon)
    wait_until_done(qtbot, window.session)
    costs = []
    for turn in np.linspace(0, 2 * np.pi, 31):
        vertices = polygon.vertices.copy()
        vertices[0] += 0.02 * np.array([np.sin(turn), 1.0 - np.cos(turn) + 0.1])
        clock.seconds = 0.0
        clock.around(window.viewport.reshaped.emit)(vertices)
        frame = wait_until_done(qtbot, window.session)
        qtbot.wait(20)
        assert np.array_equal(frame.shape.vertices, vertices)
        costs.append(clock.seconds)
    assert np.quantile(costs, UNDISTURBED) < BUDGET
