"""The door for polygon files, and the one for files of either kind of shape."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path

from idviewer.core.arrays import Floats
from idviewer.core.errors import ShapeError
from idviewer.core.io.atomic_write import atomic_path
from idviewer.core.io.files import bytes_of, told, wrong_suffix
from idviewer.core.io.meshes import READABLE_SUFFIXES, read_mesh
from idviewer.core.io.outlines import read_csv, read_json
from idviewer.core.io.text import UnreadableError
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.polygon import Polygon, PolygonError
from idviewer.core.shapes.shape import PolygonLike, as_polygon

POLYGON_SUFFIXES = (".csv", ".svg", ".json", ".geojson")
"""Suffixes of the polygon files that can be read, in lower case and with their dot."""


def read_polygon(
    path: str | os.PathLike[str], samples: int | None = None, element: str | None = None
) -> Polygon:
    """The polygon in a file: CSV, SVG, JSON or GeoJSON, told by its suffix.

    CSV holds x,y in each line, a header perhaps, and a blank line or nan,nan between loops. JSON holds a list
    of [x, y], or {"outer": [...], "holes": [[...], ...]}, or a GeoJSON Polygon, also as a feature. Of an SVG
    drawing the first path is taken, or else its first other shape; curves become chords within 1e-4 of the
    diagonal, and y points up.

    Args:
        path: of the file.
        samples: how many points to take along the boundary (see `Polygon.resampled`); the file's own vertices
            by default.
        element: id of the SVG element to take.

    Raises:
        PolygonError: there is no such file, it cannot be read, it is damaged, or what it holds is no simple
            polygon. The message is one line that names the file.
    """
    path = Path(path)
    try:
        polygon = Polygon.of_loops(_loops(path, element))
        polygon = polygon if samples is None else polygon.resampled(samples)
    except PolygonError as error:
        raise PolygonError(f"{told(path)}: {error}") from error
    return replace(polygon, name=path.stem)


def read_shape(
    path: str | os.PathLike[str], component: int | None = None, samples: int | None = None
) -> Mesh | Polygon:
    """The mesh or the polygon in a file, told by its suffix; see `read_mesh` and `read_polygon`.

    Args:
        path: of the file.
        component: which of a mesh's components to take, 1 for the largest.
        samples: how many points to take along a polygon's boundary.

    Raises:
        ShapeError: a MeshError or a PolygonError.

    >>> from idviewer.core import sample_path
    >>> read_shape(sample_path("star")).dimension, read_shape(sample_path("cat_2k")).dimension
    (2, 3)
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix in POLYGON_SUFFIXES:
        if component is not None:
            raise PolygonError(f"{told(path)}: a polygon has no components; leave the component out")
        return read_polygon(path, samples)
    if samples is not None:
        raise ShapeError(
            f"{told(path)}: only polygons are sampled along their boundary; leave the samples out"
        )
    if suffix not in READABLE_SUFFIXES and path.is_file():
        every = (*READABLE_SUFFIXES, *POLYGON_SUFFIXES)
        raise ShapeError(f"{told(path)}: {wrong_suffix(path, 'cannot be read', every)}")
    return read_mesh(path, component)


def write_polygon(polygon: PolygonLike, path: str | os.PathLike[str]) -> None:
    """Write a polygon as CSV or JSON, told by the suffix, with every digit.

    It is written beside the file and then renamed, so that the file is there as a whole or not at all.

    Raises:
        PolygonError: another suffix.
        OSError: the file cannot be written.
    """
    polygon, path = as_polygon(polygon), Path(path)
    if path.suffix.lower() not in (".csv", ".json"):
        raise PolygonError(f"{told(path)}: polygons are written as .csv or .json; choose one of these")
    loops = [polygon.vertices[loop].tolist() for loop in polygon.loops]
    if path.suffix.lower() == ".json":
        text = json.dumps({"outer": loops[0], "holes": loops[1:]}) + "\n"
    else:
        text = "x,y\n" + "\n".join("".join(f"{x!r},{y!r}\n" for x, y in loop) for loop in loops)
    with atomic_path(path) as part:
        part.write_text(text, encoding="utf-8")


def _loops(path: Path, element: str | None) -> list[Floats]:
    """What the file holds, unchecked."""
    suffix = path.suffix.lower()
    try:
        data = bytes_of(path, "polygon", "hold no polygon", POLYGON_SUFFIXES)
    except UnreadableError as error:
        raise PolygonError(str(error)) from error
    if element is not None and suffix != ".svg":
        raise PolygonError("only SVG drawings have elements; leave the element out")
    return _parsed(suffix, data, element)


def _parsed(suffix: str, data: bytes, element: str | None) -> list[Floats]:
    kind = {".geojson": "GeoJSON"}.get(suffix, suffix[1:].upper())
    try:
        if suffix == ".svg":
            from idviewer.core.io.svg import read_svg  # its library takes a while to load

            return read_svg(data, element)
        return read_csv(data) if suffix == ".csv" else read_json(data)
    except UnreadableError as error:
        raise PolygonError(f"not a polygon as {kind}: {told(error)}; correct the file") from error
    except Exception as error:  # rubbish can make a parser raise anything; out of this door comes one line
        cause = told(f"{type(error).__name__}: {error}")[:100]
        raise PolygonError(f"not a readable {kind} file ({cause}); export it again") from error
