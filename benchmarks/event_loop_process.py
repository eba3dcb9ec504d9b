"""Moves planes and vertices in a window; prints as JSON what that takes of the window's thread.

python event_loop_process.py STEPS
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator
from statistics import median

import numpy as np
from bodies import Body
from gui import frame_of
from PySide6.QtCore import QEventLoop, QPointF
from PySide6.QtWidgets import QApplication

from idviewer import app
from idviewer.core import Plane, Polygon, Shape, read_mesh, sample_path
from idviewer.session.runner import Work
from idviewer.session.state import Frame, FrameRequest
from idviewer.view.gui_thread import Post
from idviewer.view.viewport import Viewport
from idviewer.view.window import MainWindow

WARM = 3
"""Frames that come before the first that counts."""

STAR = 10, 20
"""Corners of a star, and parts of each of its sides."""


class Clock:
    """Adds up the time that calls take of their thread."""

    def __init__(self) -> None:
        self.seconds = 0.0

    def around(self, call: Callable[..., None]) -> Callable[..., None]:
        """The call, timed."""

        def timed(*arguments: object, **named: object) -> None:
            start = time.thread_time()
            call(*arguments, **named)
            self.seconds += time.thread_time() - start

        return timed


FRAMES, LOOKS = Clock(), Clock()


class TimedPost(Post):
    """Times what the compute thread has the event loop do."""

    def __call__(self, call: Callable[[], None]) -> None:
        super().__call__(FRAMES.around(call))


def main() -> None:
    steps = int(sys.argv[1]) + WARM
    application = QApplication(sys.argv[:1])
    app.Post = TimedPost  # type: ignore[misc]
    Viewport._before_draw = FRAMES.around(Viewport._before_draw)  # type: ignore[method-assign]
    Viewport._rest = LOOKS.around(Viewport._rest)  # type: ignore[method-assign]
    planes = moved_planes(steps)
    vertex = moved_vertex(steps)
    on_slice, on_star = "20,000 values", "a star"
    print(
        json.dumps(
            {
                "plane": {"on": on_slice, "seconds": median(frames for frames, _ in planes)},
                "look": {"on": on_slice, "seconds": median(look for _, look in planes)},
                "vertex": {"on": on_star, "seconds": median(frames + look for frames, look in vertex)},
            }
        )
    )
    application.quit()


def moved_planes(steps: int) -> list[tuple[float, float]]:
    """Seconds of each frame, and of the look at what is under the mouse afterwards."""
    body = Body(read_mesh(sample_path("hand")))
    frames = [frame_of(body, 1e-4 * step) for step in range(1, steps + 1)]
    by_planes = {frame.query.planes: frame for frame in frames}

    def work(request: FrameRequest) -> Iterator[Frame]:
        known = by_planes.get(request.query.planes, frames[0])
        yield Frame(**{**vars(known), "query": request.query})

    window = shown(work, body.mesh)  # type: ignore[arg-type]
    point = frames[0].slices[0].points.mean(axis=0)
    window.viewport._mouse = QPointF(*window.viewport.projection.project([point])[0])
    moves = [lambda plane=frame.query.planes[0]: move_plane(window, plane) for frame in frames]
    return spent(window, moves)


def move_plane(window: MainWindow, plane: Plane) -> None:
    """As its handle does."""
    window.session.set(planes=(plane,))


def moved_vertex(steps: int) -> list[tuple[float, float]]:
    """The same of a polygon whose first vertex goes around in a circle."""
    polygon = star()
    window = shown(None, polygon)
    moves = []
    for turn in np.linspace(0.0, 2.0 * np.pi, steps):
        vertices = polygon.vertices.copy()
        vertices[0] += 0.02 * np.array([np.sin(turn), 1.1 - np.cos(turn)])
        moves.append(lambda vertices=vertices: window.viewport.reshaped.emit(vertices))
    return spent(window, moves)


def star() -> Polygon:
    """A star of 200 vertices."""
    corners, parts = STAR
    angles = np.pi / 2 + 2.0 * np.pi * np.arange(corners) / corners
    radii = np.where(np.arange(corners) % 2, 0.5, 1.0)[:, None]
    tips = radii * np.column_stack([np.cos(angles), np.sin(angles)])
    share = np.arange(parts)[:, None] / parts
    sides = zip(tips, np.roll(tips, -1, axis=0), strict=True)
    return Polygon(np.concatenate([(1.0 - share) * start + share * end for start, end in sides]), name="star")


def shown(work: Work | None, shape: Shape) -> MainWindow:
    """A window with the shape's first picture."""
    window = app.make_window(work)
    window.resize(1000, 700)
    window.show()
    window.session.show(shape)
    wait_until(lambda: complete(window))
    return window


def complete(window: MainWindow) -> bool:
    """Whether the frame that the window's state asks for is there."""
    frame, state, busy = window.session.frame, window.session.state, window.session.busy
    return not busy and frame is not None and (frame.shape, frame.query) == (state.shape, state.query)


def wait_until(done: Callable[[], bool]) -> None:
    """Runs the event loop until then."""
    while not done():
        QApplication.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents)


def spent(window: MainWindow, moves: list[Callable[[], None]]) -> list[tuple[float, float]]:
    """Seconds that each move and its frame take, and the look afterwards, but for the first few."""
    found = []
    for move in moves:
        FRAMES.seconds = LOOKS.seconds = 0.0
        FRAMES.around(move)()
        wait_until(lambda: complete(window) and LOOKS.seconds > 0.0)
        QApplication.processEvents()
        found.append((FRAMES.seconds, LOOKS.seconds))
    window.close()
    return found[WARM:]


if __name__ == "__main__":
    main()
