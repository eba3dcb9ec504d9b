"""Pictures of a shape in any size, drawn off-screen: with or without a window, with or without a display."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from PIL import Image
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLogger, vtkUnsignedCharArray
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow
from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLRenderWindow, vtkTextureObject

from idviewer.core.io import atomic_path
from idviewer.view.camera import VIEW_ANGLE_DEGREES, Pose, look, pan, rotate, unit
from idviewer.view.polygon_view import UP_2D, VIEW_DIRECTION_2D, is_2d
from idviewer.view.scene import POINTS_PER_INCH, Scene

if TYPE_CHECKING:
    from idviewer.core import Plane
    from idviewer.session import Frame, State

Point = tuple[float, float, float]
Camera = Sequence[Sequence[float]]
"""Where the camera is, the point it looks at, and the direction of the picture's upper edge."""

WINDOW_SIZE_PX = (1280, 900)
"""A picture of this size looks like the window; in a larger one, lines and letters grow with it."""
MIN_LINE_SCALE, MIN_ROOMY_SIZE_PX = 0.85, (500, 360)
"""In a smaller one they do not shrink further than this, until the scale bar has no room left."""
FIRST_VIEW_DEGREES = (20.0, 15.0)
"""Degrees that the first view of a plane is turned sideways and upwards from its normal, 25 in all."""
FREE_BAR_WIDTH_PX = 150.0
"""Width of the scale bar in pixels, kept free by the first view."""
SAMPLES_PER_PIXEL = 8
"""Samples a pixel; a machine that cannot takes fewer."""


def image(
    state: State,
    frame: Frame | None,
    size: tuple[int, int],
    camera: Camera | None = None,
    transparent: bool = False,
) -> NDArray[np.uint8]:
    """Draw a picture without a window.

    Args:
        state: the shape, and how it is displayed.
        frame: what was computed for it; None draws the shape alone.
        size: width and height in pixels.
        camera: position, focal point and up vector; `default_camera` of the first plane if None. Polygons
            are seen in parallel projection, as large as they were from there at the focal point's depth.
        transparent: whether the background is left out; otherwise it is white.

    Returns:
        (height, width, 3) red, green, blue; (height, width, 4) with alpha, not premultiplied, if transparent.

    Raises:
        RuntimeError: this machine has no OpenGL, not even one in software.
        ValueError: the size is not positive, or more than OpenGL can draw.
    """
    if min(size) < 1:
        raise ValueError(f"a picture cannot have {size[0]} x {size[1]} pixels")
    return _image_of_all([(state, frame)], size, camera, transparent)


def _image_of_all(
    drawn: Sequence[tuple[State, Frame | None]],
    size: tuple[int, int],
    camera: Camera | None,
    transparent: bool,
) -> NDArray[np.uint8]:
    """Draw shapes that lie beside each other, with the scale bar of the first."""
    scale, (state, frame) = _scale(size), drawn[0]
    if camera is None and state.shape is not None:
        bar = FREE_BAR_WIDTH_PX * scale if frame is not None and state.display.scale_bar else 0.0
        planes = frame.query.planes if frame is not None else state.query.planes
        points = np.concatenate([one.shape.vertices for one, _ in drawn if one.shape is not None])
        camera = _camera(points, planes, size, bar)
    with _plotter(size, round(scale * POINTS_PER_INCH)) as plotter:
        scenes: list[Scene] = []
        try:
            for one, its_frame in drawn:
                scenes.append(Scene(plotter))
                scenes[-1].show(one if one is state else one.with_(scale_bar=False))
                scenes[-1].show_frame(its_frame)
            _prepare(plotter, transparent)
            if camera is not None:
                place_camera(plotter.renderer, Pose(*map(np.array, camera)), parallel=is_2d(state.shape))
            return _read(plotter, transparent)
        finally:
            for scene in scenes:
                scene.close()


def write_image(
    path: str | os.PathLike[str],
    state: State,
    frame: Frame | None,
    size: tuple[int, int],
    camera: Camera | None = None,
    transparent: bool = False,
) -> None:
    """Draw a picture, like `image`, and write it as PNG.

    It is written beside the file and then renamed, so that the file is there as a whole or not at all.

    Raises:
        RuntimeError: this machine has no OpenGL.
        OSError: the file cannot be written.
    """
    _write([(state, frame)], Path(path), size, camera, transparent)


def write_image_of_all(
    path: str | os.PathLike[str],
    drawn: Sequence[tuple[State, Frame | None]],
    size: tuple[int, int],
    transparent: bool = False,
) -> None:
    """Draw several shapes in one picture, each with its frame, and write it as `write_image` does."""
    _write(drawn, Path(path), size, None, transparent)


def _write(
    drawn: Sequence[tuple[State, Frame | None]],
    path: Path,
    size: tuple[int, int],
    camera: Camera | None,
    transparent: bool,
) -> None:
    if not path.parent.is_dir():
        raise FileNotFoundError(f"there is no folder {path.parent} to write {path.name} to")
    picture = Image.fromarray(_image_of_all(drawn, size, camera, transparent))
    with atomic_path(path) as part, part.open("xb") as file:
        picture.save(file, format="PNG")


def default_camera(
    points: NDArray[np.float64], plane: Plane | None, aspect: float = WINDOW_SIZE_PX[0] / WINDOW_SIZE_PX[1]
) -> tuple[Point, Point, Point]:
    """The first view: the whole body, a little obliquely from the side that the plane's normal points to.

    What lies in the plane is looked straight down on.

    Args:
        points: (n, 3) or (n, 2) all that is to be seen: a shape's vertices.
        plane: the plane to look at; None looks along -y.
        aspect: the picture's width over its height.

    Returns:
        Position, focal point and up vector. Up is z, or y where the normal is near z.
    """
    if points.shape[1] == 2:
        pose = look(VIEW_DIRECTION_2D, UP_2D, points, np.radians(VIEW_ANGLE_DEGREES), aspect)
        return _point(pose.position), _point(pose.focal), _point(pose.up)
    normal = np.array(plane.normal if plane is not None else (0.0, -1.0, 0.0))
    up = np.array((0.0, 1.0, 0.0) if abs(normal[2]) > 0.9 else (0.0, 0.0, 1.0))
    sideways, upwards = np.radians(FIRST_VIEW_DEGREES)
    right = unit(np.cross(up, normal))
    backwards = rotate(rotate(normal, right, -upwards), np.cross(normal, right), sideways)
    pose = look(-backwards, up, points, np.radians(VIEW_ANGLE_DEGREES), aspect)
    return _point(pose.position), _point(pose.focal), _point(pose.up)


def place_camera(renderer: vtkRenderer, pose: Pose, parallel: bool) -> None:
    """Have a renderer look from there, perspectively or not."""
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*pose.position)
    camera.SetFocalPoint(*pose.focal)
    camera.SetViewUp(*pose.up)
    camera.SetViewAngle(VIEW_ANGLE_DEGREES)
    camera.SetParallelProjection(parallel)
    if parallel:
        camera.SetParallelScale(pose.half_height)
        # A polygon has no depth of its own that the range could be taken from.
        camera.SetClippingRange(0.5 * pose.distance, 1.5 * pose.distance)
    else:
        renderer.ResetCameraClippingRange()


def _camera(
    points: NDArray[np.float64], planes: Sequence[Plane], size: tuple[int, int], bar: float
) -> Camera:
    """The first view beside a scale bar that takes so many pixels."""
    width, height = size
    flat = points.shape[1] == 2
    free = bar if flat else 2 * bar  # a body stays in the middle
    aspect = max(width - free, 0.5 * width) / height
    camera = default_camera(points, planes[0] if planes else None, aspect)
    if not flat:
        return camera
    pose = Pose(*map(np.array, camera))
    pose = pan(pose, min(bar, 0.5 * width) * pose.half_height / height, 0.0)
    return _point(pose.position), _point(pose.focal), camera[2]


def _scale(size: tuple[int, int]) -> float:
    """Scale of lines and letters against those in the window."""
    like_window, roomy = (
        min(size[0] / width, size[1] / height) for width, height in (WINDOW_SIZE_PX, MIN_ROOMY_SIZE_PX)
    )
    return max(like_window, min(MIN_LINE_SCALE, roomy))


@contextmanager
def _plotter(size: tuple[int, int], dpi: int) -> Iterator[pv.Plotter]:
    """An off-screen plotter that is closed in any case."""
    _require_opengl()
    with _quiet():
        plotter = pv.Plotter(off_screen=True, window_size=list(size))
    try:
        window = plotter.render_window
        assert isinstance(window, vtkOpenGLRenderWindow)
        window.SetMultiSamples(SAMPLES_PER_PIXEL)
        window.SetDPI(dpi)
        window.Initialize()
        # VTK would hand out a black picture.
        limit = vtkTextureObject.GetMaximumTextureSize(window)
        if max(size) > limit:
            raise ValueError(f"{size[0]} x {size[1]} pixels are too many: {limit} a side is the most here")
        yield plotter
    finally:
        plotter.close()


def _window(plotter: pv.Plotter) -> vtkRenderWindow:
    window = plotter.render_window
    assert window is not None, "the plotter is closed"
    return window


def _prepare(plotter: pv.Plotter, transparent: bool) -> None:
    renderer = plotter.renderer
    renderer.GradientBackgroundOff()
    # On black that is not there, the pixels are the picture's colours times their alpha.
    renderer.SetBackground(*((0.0, 0.0, 0.0) if transparent else (1.0, 1.0, 1.0)))
    _window(plotter).SetAlphaBitPlanes(transparent)
    renderer.ResetCameraClippingRange()


def _read(plotter: pv.Plotter, transparent: bool) -> NDArray[np.uint8]:
    window = _window(plotter)
    with _quiet():
        window.Render()
    width, height = window.GetSize()
    buffer = vtkUnsignedCharArray()
    # The back buffer's samples are averaged as they are. The front buffer's are averaged after a gamma
    # correction, which does not fit colours that are multiplied by alpha.
    if not transparent:
        window.GetPixelData(0, 0, width - 1, height - 1, 0, buffer, 0)
        return vtk_to_numpy(buffer).reshape(height, width, 3)[::-1].copy()
    window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, buffer, 0)
    premultiplied = vtk_to_numpy(buffer).reshape(height, width, 4)[::-1].astype(np.uint16)
    alpha = premultiplied[..., 3:]
    rgb = (premultiplied[..., :3] * 255 + alpha // 2) // np.maximum(alpha, 1)
    return np.concatenate([np.minimum(rgb, 255), alpha], axis=2).astype(np.uint8)


@cache
def _require_opengl() -> None:
    """Raise an error where VTK finds no OpenGL; drawing there would end the process."""
    with _quiet():
        window = vtkRenderWindow()
        window.SetOffScreenRendering(True)
        window.SetSize(16, 16)
        works = bool(window.SupportsOpenGL())
        # Its last resort, Mesa in software, is never even tried when the library is not there.
        if works and isinstance(window, vtkOpenGLRenderWindow):
            works = "not tested" not in window.GetOpenGLSupportMessage().lower()
        window.Finalize()
    if not works:
        raise RuntimeError(
            "no OpenGL to draw with: neither a display nor EGL nor OSMesa works here. On Debian and Ubuntu,"
            " `apt install libegl1 libgl1-mesa-dri` brings one that needs no graphics card and no display"
        )


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep VTK from telling standard error about each kind of window that it tries in vain."""
    before = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(before)


def _point(vector: NDArray[np.float64]) -> Point:
    x, y, z = map(float, vector)
    return x, y, z
