"""Parsing of the command line: shapes, points, sizes, tables. And whether a window can be opened.

Every error is a ValueError or an OSError whose message is the line that the user gets to read.
"""

from __future__ import annotations

import ctypes
import difflib
import math
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from idviewer.cli.options import ReadingOptions, RepairOptions
    from idviewer.core import Repairs, Shape
    from idviewer.core.validation import ComponentChoice

BARYCENTROID = "barycentroid"
MAX_PICTURE_SIDE_PX = 8192
"""Of a picture, in pixels; what every OpenGL can draw in one piece."""

Point = tuple[float, ...]
"""Three coordinates, or two in a polygon."""

AXIS_NAMES = ("x", "y", "z")
COUNT_WORDS = {2: "two", 3: "three"}

WINDOW_LIBRARIES = {
    "libGL.so.1": "libgl1",
    "libEGL.so.1": "libegl1",
    "libX11.so.6": "libx11-6",
    "libXcursor.so.1": "libxcursor1",
    "libxkbcommon.so.0": "libxkbcommon0",
}
XCB_LIBRARIES = {"libxcb-cursor.so.0": "libxcb-cursor0", "libxkbcommon-x11.so.0": "libxkbcommon-x11-0"}
"""Libraries without which Qt and VTK end the process, and their packages on Debian and Ubuntu."""


def path_of(name: str) -> Path:
    """The file of that name, or else the bundled shape of that name."""
    from idviewer.core import sample_names, sample_path

    path = Path(name)
    if path.exists():
        return path
    if name in sample_names():
        return Path(sample_path(name))
    near = difflib.get_close_matches(name, sample_names(), 1)
    hint = f"did you mean {near[0]}?" if near else "`idviewer samples` lists the shapes"
    raise FileNotFoundError(f"{name}: neither a file nor a bundled shape; {hint}")


def component_of(text: str | None) -> ComponentChoice | None:
    """A component; the commands that can take all of them look for that word first.

    >>> component_of("2"), component_of("largest"), component_of(None)
    (2, 'largest', None)
    """
    if text is None:
        return None
    if text == "largest":
        return "largest"
    try:
        return int(text)
    except ValueError:
        raise ValueError(
            f"--component {text}: give its number, 1 for that of the largest volume, or largest, or all"
        ) from None


def parts_of(path: Path) -> list[str | None]:
    """Names of the shapes in a file; none has a name where there is only one."""
    from idviewer.core import ShapeError
    from idviewer.core.io import inspect_file

    try:
        inspect_file(path)
    except ShapeError as error:
        if not error.parts:
            raise
        return [part.name for part in error.parts]
    return [None]


def shape_of(name: str, reading: ReadingOptions | None = None) -> Shape:
    """The mesh or polygon of that name; the repairs that it needed are told on standard error."""
    from idviewer.core import read_shape
    from idviewer.view.vtk_files import register_vtk_reader

    register_vtk_reader()
    if reading is None:
        shape = read_shape(path_of(name))
    else:
        repairs = repairs_of(reading)
        component = component_of(reading.component)
        shape = read_shape(path_of(name), component, part=reading.part, repairs=repairs)
    for note in shape.notes:
        print(f"idviewer: {name}: {note}", file=sys.stderr)
    return shape


def repairs_of(options: RepairOptions) -> Repairs:
    """The repairs that options ask for."""
    from dataclasses import fields

    from idviewer.core import Repairs

    return Repairs(**{one.name: getattr(options, one.name) for one in fields(Repairs)})


def point_of(text: str, option: str, dimension: int | None = None) -> Point:
    """Coordinates: two or three, while it is not known what the shape has.

    >>> point_of("-0.1,2,3e-2", "--source"), point_of("1,2", "--to", 2)
    ((-0.1, 2.0, 0.03), (1.0, 2.0))
    """
    cells = text.split(",")
    point = _numbers(cells, dimension or (2 if len(cells) == 2 else 3))
    if point is not None:
        return point
    example = f"such as {option} {'0.1,-0.2' if dimension == 2 else '0.1,-0.2,0.3'}"
    if dimension is None or _numbers(cells, len(cells)) is None:
        wanted = "two or three" if dimension is None else COUNT_WORDS[dimension]
        raise ValueError(f"{option} {text}: not a point; write {wanted} numbers, {example}")
    raise ValueError(
        f"{option} {text}: not a point of a {dimension}D shape; "
        f"write {COUNT_WORDS[dimension]} numbers, {example}"
    )


def source_of(text: str, dimension: int | None = None) -> Point | None:
    """A source; None stands for the barycentroid."""
    return None if text == BARYCENTROID else point_of(text, "--source", dimension)


def size_of(text: str) -> tuple[int, int]:
    """Width and height of a picture in pixels.

    >>> size_of("800x600")
    (800, 600)
    """
    parts = text.lower().split("x")
    if len(parts) != 2 or not all(part.isascii() and part.isdigit() for part in parts):
        raise ValueError(
            f"--size {text}: not a size; write width and height in pixels, such as --size 1280x840"
        )
    width, height = map(int, parts)
    if not (1 <= width <= MAX_PICTURE_SIDE_PX and 1 <= height <= MAX_PICTURE_SIDE_PX):
        raise ValueError(f"--size {text}: a picture has 1 to {MAX_PICTURE_SIDE_PX} pixels a side")
    return width, height


def _numbers(cells: list[str], count: int) -> Point | None:
    """Exactly so many finite numbers; None if the cells hold anything else."""
    try:
        point = tuple(map(float, cells))
    except ValueError:
        return None
    return point if len(point) == count and all(map(math.isfinite, point)) else None


def check_picture_path(path: Path) -> None:
    """Refuse what cannot be written before anything is computed."""
    if path.suffix.lower() != ".png":
        raise ValueError(f"{path}: pictures are written as PNG; name a file that ends in .png")
    _check_new_file(path)


def check_table_path(path: Path) -> None:
    """Refuse what cannot be written before anything is computed."""
    if path.suffix.lower() != ".csv":
        raise ValueError(f"{path}: tables are written as CSV; name a file that ends in .csv")
    _check_new_file(path)


def _check_new_file(path: Path) -> None:
    if path.is_dir():
        raise ValueError(f"{path}: this is a folder; name a file in it")
    if not path.parent.is_dir():
        raise ValueError(f"{path}: there is no folder {path.parent}; make it first")
    if not os.access(path.parent, os.W_OK):
        raise ValueError(
            f"{path}: nothing may be written into {path.parent.resolve()}; choose another folder"
        )


def why_no_display() -> str:
    """The reason why no window can be opened; empty where one can."""
    if sys.platform in ("win32", "darwin") or os.environ.get("WAYLAND_DISPLAY"):
        return ""
    name = os.environ.get("DISPLAY")
    if not name:
        return "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)"
    return "" if _x_server_answers() else f"no X server answers at DISPLAY={name}"


def _x_server_answers() -> bool:
    # Asked before Qt asks, because Qt ends the process where none answers.
    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError:
        return True  # need_window_libraries tells that it is missing
    x11.XOpenDisplay.restype = ctypes.c_void_p
    connection = x11.XOpenDisplay(None)
    if connection:
        x11.XCloseDisplay(ctypes.c_void_p(connection))
    return bool(connection)


def need_window_libraries() -> None:
    """Refuse to open a window where Qt or VTK would end the process."""
    needed = WINDOW_LIBRARIES | ({} if os.environ.get("WAYLAND_DISPLAY") else XCB_LIBRARIES)
    missing = [library for library in needed if not _loads(library)] if sys.platform == "linux" else []
    if missing:
        packages = " ".join(needed[library] for library in missing)
        raise OSError(
            f"the window needs {', '.join(missing)}, which this system lacks; "
            f"on Debian and Ubuntu `apt-get install {packages}` brings it"
        )


def need_picture_libraries() -> None:
    """Refuse to draw where VTK would end the process, and have it not try X11 where that is not installed."""
    if sys.platform != "linux" or (_loads("libX11.so.6") and _loads("libXcursor.so.1")):
        return
    if not _loads("libEGL.so.1") and not _loads("libOSMesa.so.8"):
        raise OSError(
            "there is no OpenGL to draw with; "
            "on Debian and Ubuntu `apt-get install libegl1 libgl1-mesa-dri` brings it"
        )
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
