"""What a step of a vertex's drag gives the event loop to do."""

from __future__ import annotations

import numpy as np
import pytest
from pytestqt.qtbot import QtBot
from tests.view.effort import ARRAYS, CALLS, DRAWS, LOOKS, Effort
from tests.view.polygons import star
from tests.view.windows import show_window, wait_until_done

pytestmark = pytest.mark.slow
STEPS = 9


@pytest.fixture
def effort(monkeypatch: pytest.MonkeyPatch) -> Effort:
    return Effort(monkeypatch)


def test_a_step_costs_the_event_loop_little(qtbot: QtBot, effort: Effort) -> None:
    """From the mouse's move to VTK's drawing of the frame that follows, and the value under the mouse.

    How long that takes is a row of `make bench`.
    """
    few, many = (calls_of_a_step(qtbot, effort, between) for between in (4, 20))
    assert many < 1.1 * few < 3000, "nothing goes through the vertices one by one"


def calls_of_a_step(qtbot: QtBot, effort: Effort, between: int) -> int:
    """Of a polygon with ten times as many vertices as are `between` two of a star's corners."""
    window = show_window(qtbot, size=(1000, 700))
    polygon = star(points=5, between=between)
    window.session.show(polygon)
    wait_until_done(qtbot, window.session)
    calls = []
    for turn in np.linspace(0, 2 * np.pi, STEPS):
        vertices = polygon.vertices.copy()
        vertices[0] += 0.02 * np.array([np.sin(turn), 1.0 - np.cos(turn) + 0.1])
        qtbot.wait(50)  # what the frame before has left to do
        effort.counts.clear()
        effort.around(window.viewport.reshaped.emit)(vertices)
        frame = wait_until_done(qtbot, window.session)
        qtbot.waitUntil(lambda: effort.counts[LOOKS] > 0 and effort.counts[DRAWS] > 0)
        assert np.array_equal(frame.shape.vertices, vertices)
        assert effort.counts[ARRAYS] <= 13, "the slice's six, those of the outline and of the handles"
        assert effort.counts[LOOKS] == 1
        calls.append(effort.counts[CALLS])
    window.close()
    return min(calls)  # where the machine is busy, progress is told besides
