"""Wavefront OBJ files: vertices and faces; materials, groups, normals and textures are passed over."""

from __future__ import annotations

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.io.text import UnreadableError, floats, integers, text_lines
from idviewer.core.validation.polygon_soup import PolygonSoup

_VERTEX = (b"v ", b"v\t")
_FACE = (b"f ", b"f\t")


def read_obj(data: bytes) -> PolygonSoup:
    r"""Read the polygons of an OBJ file, of all its objects and groups together.

    Args:
        data: of the file.

    Raises:
        UnreadableError: it holds no vertices, one of fewer than three coordinates, or half a line.

    >>> read_obj(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").corners.tolist()
    [0, 1, 2]
    """
    if b"\\" in data:
        data = data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ")
    lines = [line.lstrip() for line in text_lines(data)]
    points = [line for line in lines if line.startswith(_VERTEX)]
    faces = [line for line in lines if line.startswith(_FACE)]
    if not points:
        raise UnreadableError("it holds no vertices")
    if lines[-1].startswith(_VERTEX) and faces and data[-1:] not in (b"\n", b"\r"):
        raise UnreadableError("truncated: it ends in the middle of a vertex")
    corners, sizes = _corners(faces)
    if len(corners) and corners.min() < 0:
        corners = _absolute(corners, sizes, lines)
    return PolygonSoup(_points(points), corners - 1, sizes)


def _points(lines: list[bytes]) -> Floats:
    """The first three numbers of each line; a weight or a colour may follow."""
    tokens = b" ".join(lines).split()
    width = len(tokens) // len(lines)
    if width < 4 or width * len(lines) != len(tokens) or tokens[::width].count(b"v") != len(lines):
        rows = [line.split() for line in lines]
        if any(len(row) < 4 for row in rows):
            raise UnreadableError("a vertex has fewer than three coordinates")
        tokens, width = [token for row in rows for token in row[:4]], 4
    coordinates = [token for column in (1, 2, 3) for token in tokens[column::width]]
    return np.ascontiguousarray(floats(coordinates).reshape(3, -1).T)


def _corners(lines: list[bytes]) -> tuple[Ints, Ints]:
    """Vertex numbers as they stand in the file, of all faces, and how many each face has."""
    if not lines:
        return np.empty(0, np.int64), np.empty(0, np.int64)
    text = b" ".join(lines)
    tokens = text.split()
    width = len(tokens) // len(lines)
    if width * len(lines) == len(tokens) and tokens[::width].count(b"f") == len(lines):
        sizes = np.full(len(lines), width - 1, dtype=np.int64)
    else:
        sizes = np.array([len(line.split()) - 1 for line in lines], dtype=np.int64)
    if b"/" in text:
        tokens = [token.split(b"/", 1)[0] for token in tokens]
    return integers([token for token in tokens if token != b"f"]), sizes


def _absolute(corners: Ints, sizes: Ints, lines: list[bytes]) -> Ints:
    """Negative numbers count back from the last vertex above their face; here they become ordinary ones."""
    above = np.cumsum([line.startswith(_VERTEX) for line in lines])
    at_face = above[[line.startswith(_FACE) for line in lines]]
    absolute = np.repeat(at_face, sizes) + 1 + corners
    # One that counts back too far must stay an error, and 0 is none that the format knows.
    return np.where(corners < 0, np.where(absolute > 0, absolute, corners), corners)
