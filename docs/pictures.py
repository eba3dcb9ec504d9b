"""Draws the pictures of the README: python docs/pictures.py. Without a display it starts a virtual one."""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
from PIL import Image

from idviewer.core import Mesh, Plane, read_mesh, sample_path
from idviewer.session import Display, Query, State
from idviewer.session.run_to_end import run_to_end
from idviewer.view.images import image

FOLDER = Path(__file__).parent / "images"
CELL = (440, 440)
SHAPES = {
    "hand": ("y", 0.55, "top"),
    "human_walking": ("y", None, "top"),
    "octopus": ("z", None, "left"),
    "cat": ("x", None, "left"),
    "couple": ("y", None, "top"),
    "human_sitting": ("x", None, "top"),
}
"""The gallery: a plane through the barycentroid or at a fraction, and where the source is put."""


def main() -> None:
    FOLDER.mkdir(exist_ok=True)
    window_picture(FOLDER / "window.png")
    save("gallery.png", montage([gallery_cell(name) for name in SHAPES], columns=3))
    poses = ("human", "human_walking", "human_sitting")
    save("barycentroids.png", montage([potential_cell(name) for name in poses], columns=3))


def gallery_cell(name: str) -> np.ndarray:
    """A shape with the distance from one of its ends."""
    mesh = read_mesh(sample_path(name))
    axis, fraction, end = SHAPES[name]
    middle = run_to_end(mesh, Query()).barycentroid
    plane = Plane.along(axis, fraction or 0.5, mesh.bounds)
    if fraction is None:
        plane = Plane(tuple(middle.tolist()), plane.normal)
    if axis == "y":
        plane = Plane(plane.origin, (0.0, -1.0, 0.0))  # the front
    frame = run_to_end(mesh, Query(planes=(plane,)))
    points = frame.slices[0].points
    source = points[points[:, 2 if end == "top" else int(np.argmax(np.ptp(points, axis=0)))].argmax()]
    # A little inside, where a point of the outline would count as outside by its rounding.
    source = source + 0.04 * (middle - source)
    query = Query(planes=(plane,), source=tuple(source.tolist()))
    return cell(mesh, query, Display(scale_bar=False, isolines=24))


def potential_cell(name: str) -> np.ndarray:
    """A shape with the isolines of U and the barycentroid."""
    mesh = read_mesh(sample_path(name))
    middle = run_to_end(mesh, Query()).barycentroid
    planes = (Plane(tuple(middle.tolist()), (0.0, -1.0, 0.0)),)
    display = Display(scale_bar=False, barycentroid=True, isolines=24)
    return cell(mesh, Query(planes=planes, quantity="potential"), display)


def cell(mesh: Mesh, query: Query, display: Display) -> np.ndarray:
    return image(State(mesh, query, display), run_to_end(mesh, query), CELL)


def montage(cells: list[np.ndarray], columns: int) -> np.ndarray:
    rows = [np.hstack(cells[start : start + columns]) for start in range(0, len(cells), columns)]
    return np.vstack(rows)


def save(name: str, pixels: np.ndarray) -> None:
    path = FOLDER / name
    Image.fromarray(pixels).quantize(255, dither=Image.Dither.NONE).save(path, optimize=True)
    print(f"written: {path}")


def window_picture(path: Path) -> None:
    """The window as a user sees it, with the source in a finger tip."""
    display = None
    if not os.environ.get("DISPLAY"):
        from pyvirtualdisplay import Display as VirtualDisplay

        display = VirtualDisplay(size=(1280, 860), color_depth=24)
        display.start()
    from PySide6.QtWidgets import QApplication

    from idviewer.app import make_window

    application = QApplication([])
    window = make_window()
    window.resize(1280, 860)
    window.show()
    window.session.show(read_mesh(sample_path("hand")))
    wait(application, lambda: not window.session.busy)
    settled = time.monotonic() + 1.0
    wait(application, lambda: time.monotonic() > settled)
    grabbed = window.screen().grabWindow(0, 0, 0, window.width(), window.height())
    grabbed.save(str(path))
    save(path.name, np.asarray(Image.open(path).convert("RGB")))
    window.close()
    application.shutdown()
    if display is not None:
        display.stop()


def wait(application: object, done: object) -> None:
    while not done():  # type: ignore[operator]
        application.processEvents()  # type: ignore[attr-defined]


if __name__ == "__main__":
    main()
