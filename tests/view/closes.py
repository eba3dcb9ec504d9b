"""Closing a window in a phase of its work: `python -m tests.view.closes --count 200 --seed 2009`.

Each window is closed when its work has come to a phase, or a few turns of the event loop later.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys
import tempfile
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from PySide6.QtCore import QEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from tests.core import meshfiles, shapes
from tests.view.heard import Heard
from tests.view.windows import write_ellipsoid

from idviewer.app import make_window
from idviewer.core.interior import preview
from idviewer.core.io.bundled_shapes import sample_path
from idviewer.view.window import MainWindow

Reached = Callable[[], bool]
PATIENCE_TURNS = 150_000
SMALL_PREVIEWS = preview.PreviewSettings(least_vertices=2000, vertices=1200, coarser_vertices=300)


def wait_for(condition: Reached) -> None:
    """Let the event loop turn, every 2 ms, until something is so."""
    for _ in range(PATIENCE_TURNS):
        if condition():
            return
        QTest.qWait(2)
    raise TimeoutError("what was waited for does not come")


def in_stage(window: MainWindow, path: Path, *words: str) -> Reached:
    """Open a file; reached when a stage is named with one of these words, or all is done."""
    stages: list[str] = []
    window.session.progressed.connect(lambda progress: stages.append(getattr(progress, "stage", "")))
    window.open(path)
    return lambda: any(word in stage for stage in stages for word in words)


def at_first_frame(window: MainWindow, path: Path) -> Reached:
    """Open a file; reached with the first frame, while finer ones are made."""
    window.open(path)
    return lambda: window.session.frame is not None


def examining(window: MainWindow, path: Path) -> Reached:
    """Open a file that is refused, and look at its health."""
    window.open(path)
    wait_for(window.messages.button.isVisible)
    window.messages.button.click()
    return lambda: window.session.busy


def repairing(window: MainWindow, path: Path) -> Reached:
    """The same, and have it repaired."""
    examining(window, path)
    panel = window.health.panel
    wait_for(panel.apply.isEnabled)
    panel.apply.click()
    return lambda: window.session.busy


def with_dialog(window: MainWindow, path: Path) -> Reached:
    """Open a file and ask for a picture."""
    window.open(path)
    wait_for(lambda: window.session.state.shape is not None)
    window.ask_for_picture()
    return lambda: window._dialog is not None


def phases(folder: Path) -> dict[str, Callable[[MainWindow], Reached]]:
    """What brings a window to each phase."""
    small, large = write_ellipsoid(folder), sample_path("hand_2k")
    torn, box = folder / "torn.off", folder / "box.off"
    torn.write_bytes(meshfiles.off(*shapes.opened(shapes.icosphere(2), 1)))
    box.write_bytes(meshfiles.off(*shapes.cube()))
    return {
        "reading": lambda window: in_stage(window, large, "Reading"),
        "refining the boundary": lambda window: in_stage(window, box, "Refining the boundary"),
        "simplifying": lambda window: in_stage(window, large, "Simplifying"),
        "eigenpairs": lambda window: in_stage(window, large, "Computing coarse eigenpairs"),
        "final eigenpairs": lambda window: in_stage(window, large, "Refining eigenpairs"),
        "preparing slices": lambda window: in_stage(window, large, "Preparing slices"),
        "first frame": lambda window: at_first_frame(window, large),
        "finer slices": lambda window: at_first_frame(window, small),
        "discretisation": lambda window: in_stage(window, box, "Estimating"),
        "examining": lambda window: examining(window, torn),
        "repairing": lambda window: repairing(window, torn),
        "dialog": lambda window: with_dialog(window, small),
    }


@contextmanager
def small_previews() -> Iterator[None]:
    """Have bodies previewed that are smaller than usual."""
    usual, preview.PREVIEW_SETTINGS = preview.PREVIEW_SETTINGS, SMALL_PREVIEWS
    try:
        yield
    finally:
        preview.PREVIEW_SETTINGS = usual


def close_in(phase: Callable[[MainWindow], Reached], turns: int) -> bool:
    """Close a window of its own so many turns of 2 ms after a phase is reached; return whether it was."""
    window = make_window()
    window.resize(700, 500)
    window.show()
    reached = phase(window)
    rested = 0

    def is_over() -> bool:
        nonlocal rested
        rested = 0 if window.session.busy else rested + 1
        return reached() or rested > 50

    wait_for(is_over)
    for _ in range(turns):
        QTest.qWait(2)
    was_reached = reached()
    window.close()
    window.deleteLater()
    for _ in range(2):
        QApplication.processEvents()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    return was_reached


def play(count: int, seed: int, folder: Path) -> int:
    """Close so many windows, and print what came of it; 1 if anything was wrong."""
    application = QApplication([])
    application.setApplicationName("idviewer")
    rng, heard, reached = np.random.default_rng(seed), Heard(), Counter[str]()
    table = phases(folder)
    with heard.listen(), small_previews():
        for number in range(count):
            name = list(table)[number % len(table)]
            reached[name] += close_in(table[name], int(rng.integers(0, 20)))
            left = [one.name for one in threading.enumerate() if one is not threading.main_thread()]
            heard.complaints += [f"closing in {name} left the thread {one}" for one in left]
        gc.collect()
    heard.complaints += [
        f"never closed in {name}" for name in table if count >= len(table) and not reached[name]
    ]
    print(f"{count} closes, in the phase: {dict(reached)}")
    print(f"faults: {len(heard.complaints)}", *heard.complaints, sep="\n")
    return 1 if heard.complaints else 0


def main() -> int:
    """On the display that there is."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=2009)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        os.environ |= {"XDG_CONFIG_HOME": name, "QT_QPA_PLATFORM": "xcb", "LIBGL_ALWAYS_SOFTWARE": "1"}
        return play(given.count, given.seed, Path(name))


if __name__ == "__main__":
    sys.exit(main())
