"""A scene on an off-screen plotter whose pixels are known positions."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

from idviewer.view.colormaps import colors
from idviewer.view.scene import Scene

SIDE = 300
"""Pixels of the picture's side."""
HALF = 1.25
"""Half of what the picture shows, in units of the bodies in it."""


class Stage:
    """A scene seen along -z in parallel projection, on white."""

    def __init__(self, plotter: pv.Plotter, centre: tuple[float, float, float], unit: float) -> None:
        self.plotter = plotter
        self.scene = Scene(plotter)
        plotter.set_background("white")
        self.centre, self.unit = np.array(centre), unit
        self.look((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))

    def look(
        self, eye: tuple[float, float, float], up: tuple[float, float, float], zoom: float = 1.0
    ) -> None:
        """Looks at the centre from a direction."""
        camera = self.plotter.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(*self.centre)
        camera.SetPosition(*(self.centre + 5 * self.unit * np.array(eye)))
        camera.SetViewUp(*up)
        camera.SetParallelScale(HALF * self.unit / zoom)

    def picture(self) -> NDArray[np.int64]:
        """(SIDE, SIDE, 3) red, green and blue, the first row on top."""
        self.plotter.renderer.ResetCameraClippingRange()
        self.plotter.render_window.Render()
        pixels = vtkUnsignedCharArray()
        self.plotter.render_window.GetPixelData(0, 0, SIDE - 1, SIDE - 1, 0, pixels, 0)
        return vtk_to_numpy(pixels).reshape(SIDE, SIDE, 3)[::-1].astype(np.int64)

    def actors(self) -> list[object]:
        """What is in the renderer."""
        props = self.plotter.renderer.GetViewProps()
        return [props.GetItemAsObject(i) for i in range(props.GetNumberOfItems())]


@contextmanager
def stage(centre: tuple[float, float, float] = (0.0, 0.0, 0.0), unit: float = 1.0) -> Iterator[Stage]:
    """A stage that is cleared away afterwards."""
    plotter = pv.Plotter(off_screen=True, window_size=[SIDE, SIDE])
    try:
        made = Stage(plotter, centre, unit)
        yield made
        made.scene.close()
    finally:
        plotter.close()


def pixel(x: float, y: float, zoom: float = 1.0) -> tuple[int, int]:
    """Row and column of the pixel in which the position (x, y) is."""
    return int(SIDE * (0.5 - zoom * y / HALF / 2)), int(SIDE * (0.5 + zoom * x / HALF / 2))


def color_of(level: float, name: str = "paper") -> NDArray[np.int64]:
    """The colour of a value, given as a share of the range."""
    return colors(name)[min(int(level * 256), 255)].astype(np.int64)


def apart(rgb: NDArray[np.int64], other: NDArray[np.int64] | tuple[int, int, int]) -> int:
    """Largest difference between two colours, of 255."""
    return int(np.abs(np.asarray(rgb) - np.asarray(other)).max())


def middles_of_runs(marked: NDArray[np.bool_]) -> list[float]:
    """Middles of the runs of marked pixels along a row."""
    padded = np.concatenate([[False], marked, [False]])
    edges = np.flatnonzero(padded[1:] != padded[:-1])
    return [float(start + end - 1) / 2 for start, end in zip(edges[::2], edges[1::2], strict=True)]
