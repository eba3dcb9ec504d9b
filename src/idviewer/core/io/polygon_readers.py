"""Readers of polygon files: bytes in, loops of points out. They check the file, not the polygon."""

from __future__ import annotations

import json
import math
import re
from typing import Any

import numpy as np
import shapely

from idviewer.core.arrays import Floats
from idviewer.core.io.text import UnreadableError

_HEADING = re.compile(r"(?!(nan|inf|infinity)$)[^\W\d]|\"", re.IGNORECASE)


def read_csv(data: bytes) -> list[Floats]:
    r"""Read the loops of a CSV file: x,y a line; loops apart by blank lines or nan; a header is passed over.

    Args:
        data: of the file.

    Returns:
        (k, 2) points of each loop.

    Raises:
        UnreadableError: a line does not hold two finite numbers, or there are no points.

    >>> [loop.tolist() for loop in read_csv(b"x,y\n0,0\n1,0\n0,1\n")]
    [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]]
    """
    loops: list[list[tuple[float, float]]] = [[]]
    lines = _text(data).splitlines()
    start = 1 if lines and _is_header(lines[0]) else 0
    for number, line in enumerate(lines[start:], start + 1):
        numbers, comment, _ = line.partition("#")
        if numbers.strip(",; \t") == "":
            if not comment:
                loops.append([])
            continue
        x, y = _numbers(numbers.strip(), number)
        if math.isnan(x) and math.isnan(y):
            loops.append([])
        elif not (math.isfinite(x) and math.isfinite(y)):
            raise UnreadableError(f"line {number}: {line[:30]!a} is not finite")
        else:
            loops[-1].append((x, y))
    return _some([np.array(loop) for loop in loops if loop])


def read_json(data: bytes) -> list[Floats]:
    """Read the loops of JSON: [[x, y], ...], {"outer": ..., "holes": [...]}, or GeoJSON with a Polygon.

    Args:
        data: of the file.

    Returns:
        (k, 2) points of each loop.

    Raises:
        UnreadableError: it is no JSON, or holds none of these.

    >>> [len(loop) for loop in read_json(b'{"outer": [[0, 0], [1, 0], [0, 1]], "holes": []}')]
    [3]
    """
    try:
        content = json.loads(_text(data))
    except json.JSONDecodeError as error:
        raise UnreadableError(f"line {error.lineno}: {error.msg[:1].lower()}{error.msg[1:]}") from error
    except RecursionError:
        raise UnreadableError("its lists are nested too deeply") from None
    return _some([_loop(points, where) for points, where in _rings(content)])


def read_wkt(data: bytes) -> list[Floats]:
    """Read the loops of well-known text: a POLYGON, or a MULTIPOLYGON of one part, without heights.

    Args:
        data: of the file.

    Returns:
        (k, 2) points of each loop.

    Raises:
        UnreadableError: it is no well-known text, or no single polygon.

    >>> [loop.tolist() for loop in read_wkt(b"POLYGON ((0 0, 1 0, 0 1, 0 0))")]
    [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]]
    """
    try:
        with np.errstate(over="ignore"):  # infinite coordinates are refused later
            geometry = shapely.from_wkt(_text(data))
    except shapely.errors.ShapelyError as error:
        raise UnreadableError(str(error).rpartition("Exception: ")[2]) from None
    parts = shapely.get_parts(geometry)
    if len(parts) != 1 or parts[0].geom_type != "Polygon":
        raise UnreadableError(f"a {geometry.geom_type.upper()} of {len(parts)} parts is no single POLYGON")
    return _some([shapely.get_coordinates(ring) for ring in shapely.get_rings(parts[0])])


def _rings(content: Any) -> list[tuple[Any, str]]:
    """The lists of points of a JSON file, and where in the file each one is."""
    if isinstance(content, list):
        return [(content, "the list")]
    if isinstance(content, dict):
        if "outer" in content:
            holes = content.get("holes", [])
            if not isinstance(holes, list):
                raise UnreadableError('"holes" is not a list of loops')
            return [(content["outer"], "outer"), *((hole, f"holes[{i}]") for i, hole in enumerate(holes))]
        if "type" in content:
            return _geojson(content)
    raise UnreadableError('it holds neither a list of [x, y], nor "outer" and "holes", nor a GeoJSON Polygon')


def _geojson(content: dict[str, Any]) -> list[tuple[Any, str]]:
    kind = content["type"]
    if kind == "FeatureCollection" and isinstance(content.get("features"), list) and content["features"]:
        # The first, as with the paths of a drawing.
        content = content["features"][0]
        kind = content.get("type") if isinstance(content, dict) else None
    if kind == "Feature" and isinstance(content.get("geometry"), dict):
        content = content["geometry"]
        kind = content.get("type")
    if kind == "MultiPolygon" and len(content.get("coordinates", [])) == 1:
        content, kind = {"coordinates": content["coordinates"][0]}, "Polygon"
    if kind != "Polygon" or not isinstance(content.get("coordinates"), list):
        raise UnreadableError(f"GeoJSON of the type {str(kind)[:30]!a} holds no single Polygon")
    return [(ring, f"coordinates[{i}]") for i, ring in enumerate(content["coordinates"])]


def _loop(points: Any, where: str) -> Floats:
    if not isinstance(points, list):
        raise UnreadableError(f"{where} is not a list of [x, y]")
    for i, point in enumerate(points):
        # GeoJSON allows a height as third number.
        if not (isinstance(point, list) and len(point) in (2, 3) and all(map(_is_number, point))):
            raise UnreadableError(f"{where}[{i}] is {json.dumps(point)[:30]}, not [x, y]")
    return np.array([point[:2] for point in points], dtype=np.float64).reshape(-1, 2)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e300


def _some(loops: list[Floats]) -> list[Floats]:
    """The loops, of which there must be one."""
    if not loops:
        raise UnreadableError("it holds no points")
    return loops


def _numbers(line: str, number: int) -> tuple[float, float]:
    separator = next((mark for mark in ",;\t" if mark in line), None)
    words = [word.strip() for word in line.split(separator)]
    if len(words) != 2:
        raise UnreadableError(f"line {number}: {line[:30]!a} is not x,y")
    try:
        return float(words[0]), float(words[1])
    except ValueError:
        raise UnreadableError(f"line {number}: {line[:30]!a} stands where two numbers belong") from None


def _is_header(line: str) -> bool:
    """Whether a line names columns: two words, none of them a number."""
    words = line.replace(";", ",").replace("\t", ",").split(",")
    return len(words) == 2 and all(_HEADING.match(word.strip()) for word in words)


def _text(data: bytes) -> str:
    if b"\0" in data:
        raise UnreadableError("it holds binary data, not text")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise UnreadableError(f"line {line}: not UTF-8 text") from None
