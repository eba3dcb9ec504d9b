"""The viewer with a hand on its plane; prints the most memory it held, and how much of it is files.

In kilobytes; see proc(5).

python viewer_process.py MESH MOVES window|pipeline
"""

from __future__ import annotations

import sys
from pathlib import Path

from idviewer.core import Plane, read_mesh
from idviewer.session.pipeline import Pipeline
from idviewer.session.state import Frame, FrameRequest, Query, default_plane

INTERVAL = 40
"""Milliseconds between two poses."""

STEP = 0.002
"""Of the diagonal of the bounding box."""


def main() -> None:
    path, moves = Path(sys.argv[1]), int(sys.argv[2])
    status = with_window(path, moves) if sys.argv[3] == "window" else without(path, moves)
    print(kilobytes("VmHWM"), kilobytes("RssFile"))
    sys.exit(status)


def with_window(path: Path, moves: int) -> int:
    from PySide6.QtCore import QTimer
    from PySide6.QtWidgets import QApplication

    from idviewer.app import run_window

    application = QApplication(sys.argv[:1])
    hand: list[Hand] = []
    QTimer.singleShot(0, lambda: hand.append(Hand(application, moves)))
    return run_window(path)


class Hand:
    """Drags the plane when the first slice is complete, and closes the window when the last one is."""

    def __init__(self, application, moves: int) -> None:  # type: ignore[no-untyped-def]
        from PySide6.QtCore import QTimer

        from idviewer.view.window import MainWindow

        windows = application.topLevelWidgets()
        self._window = next(one for one in windows if isinstance(one, MainWindow))
        self._session, self._left = self._window.session, moves
        self._timer = QTimer(interval=INTERVAL, timeout=self._move)
        self._session.frame_ready.connect(self._look)

    def _look(self, frame: Frame) -> None:
        if not frame.exact or frame.query != self._session.state.query or self._timer.isActive():
            return
        if self._left:
            self._timer.start()
        else:
            self._window.close()

    def _move(self) -> None:
        self._left -= 1
        if not self._left:
            self._timer.stop()
        plane = self._session.state.query.planes[0]
        self._session.set(planes=(plane.moved(STEP * self._session.state.shape.diagonal),))


def without(path: Path, moves: int) -> int:
    mesh, pipeline = read_mesh(path), Pipeline()
    plane: Plane = default_plane(mesh)
    for move in range(moves + 1):
        for result in pipeline.results(FrameRequest(mesh, Query(planes=(plane,)))):
            if isinstance(result, Frame) and 0 < move < moves:
                break
        plane = plane.moved(STEP * mesh.diagonal)
    return 0


def kilobytes(name: str) -> int:
    """One of the sizes that the kernel tells of this process."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(f"{name}:"):
            return int(line.split()[1])
    raise SystemExit(f"/proc/self/status tells no {name}")


if __name__ == "__main__":
    main()
