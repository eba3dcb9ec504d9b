"""Pictures in space, drawn by the program's own renderer, so that they look like its window."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from figures.flat import INK, ISOLINES
from figures.registry import Run
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray

from idviewer.core import Mesh, Plane
from idviewer.session import Display, Query, State
from idviewer.session.pipeline import run_to_end
from idviewer.session.state import Frame
from idviewer.view.images import default_camera, image

Pixels = NDArray[np.uint8]
FRONT = (0.0, -1.0, 0.0)
SIDE = (1.0, 0.0, 0.0)


def cut(point: ArrayLike, normal: tuple[float, float, float]) -> Plane:
    """The plane through a point."""
    x, y, z = np.asarray(point, dtype=float).tolist()
    return Plane((x, y, z), normal)


def picture(
    run: Run, mesh: Mesh, query: Query, side: int = 560, barycentroid: bool = False, facing: Plane | None = None
) -> tuple[Pixels, Frame]:
    """A body with its slices, white margins cut off, and what was computed.

    Args:
        run: tiny pictures take one look at everything.
        mesh: the body.
        query: what is shown on its slices; without planes, the body alone.
        side: of the square that the body is fitted into, in pixels.
        barycentroid: whether its blue sphere is shown.
        facing: the plane that is looked at; the query's first one by default.
    """
    frame = run_to_end(mesh, query)
    display = Display(isolines=ISOLINES, scale_bar=False, handle=False, barycentroid=barycentroid)
    size = 64 if run.tiny else side
    planes = query.planes or (None,)
    camera = default_camera(mesh, facing or planes[0], 1.0)
    return cropped(image(State(mesh, query, display), frame, (size, size), camera)), frame


def cropped(pixels: Pixels, margin: int = 6) -> Pixels:
    """Without white rows and columns at the sides."""
    rows, columns = (np.flatnonzero((pixels < 250).any(axis=(axis, 2))) for axis in (1, 0))
    if not len(rows):
        return pixels
    low, high = (max(0, each[0] - margin) for each in (rows, columns)), (each[-1] + margin for each in (rows, columns))
    (top, left), (bottom, right) = low, high
    return pixels[top : bottom + 1, left : right + 1]


def show_pixels(axes: Axes, pixels: Pixels) -> None:
    """A picture as it is."""
    axes.imshow(pixels, interpolation="antialiased")
    axes.axis("off")


def fitted(pictures: Sequence[Pixels]) -> list[Pixels]:
    """White rows and columns around pictures, so that all have the same size and scale."""
    height, width = np.max([pixels.shape[:2] for pixels in pictures], axis=0)
    return [padded(pixels, height, width) for pixels in pictures]


def padded(pixels: Pixels, height: int, width: int) -> Pixels:
    """A picture in the middle of a white one."""
    above, left = (height - pixels.shape[0]) // 2, (width - pixels.shape[1]) // 2
    whole = np.full((height, width, 3), 255, dtype=np.uint8)
    whole[above : above + pixels.shape[0], left : left + pixels.shape[1]] = pixels
    return whole


__all__ = ["FRONT", "INK", "SIDE", "cropped", "cut", "fitted", "picture", "show_pixels"]
