"""OFF files (Geomview's object file format) as text: OFF, COFF, NOFF, STOFF and their combinations."""

from __future__ import annotations

import re

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.io.text import UnreadableError, floats, integers, missing, text_lines
from idviewer.core.validation.polygon_soup import PolygonSoup

_HEADER = re.compile(rb"\s*(ST)?(C)?(N)?(4)?(n)?OFF\b\s*(BINARY\b)?(.*)", re.DOTALL)


def read_off(data: bytes) -> PolygonSoup:
    r"""Read the polygons of an OFF file. Normals, colours and texture coordinates are passed over.

    Args:
        data: of the file.

    Raises:
        UnreadableError: its header is not OFF's, or it does not hold what its header promises.

    >>> read_off(b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").corners.tolist()
    [0, 1, 2]
    """
    lines = _without_header(data)
    counts = integers(lines[0].split()[:3])
    if len(counts) < 2 or np.any(counts < 0):
        raise UnreadableError("the line after OFF does not give the numbers of vertices and faces")
    points, faces = int(counts[0]), int(counts[1])
    lines = lines[1:]
    if len(lines) < points:
        raise missing("vertices", points, len(lines))
    if len(lines) != points + faces:
        raise missing("faces", faces, len(lines) - points)
    return PolygonSoup(_points(lines[:points]), *_polygons(lines[points:]))


def _points(lines: list[bytes]) -> Floats:
    """The first three numbers of each line; normals, colours and texture coordinates may follow."""
    widths = {len(line.split()) for line in lines}
    if min(widths, default=3) < 3:
        raise UnreadableError("a vertex has fewer than three coordinates")
    if widths == {3}:
        return floats(b" ".join(lines).split()).reshape(-1, 3)
    return floats([token for line in lines for token in line.split(None, 3)[:3]]).reshape(-1, 3)


def _without_header(data: bytes) -> list[bytes]:
    """The lines from the counts on."""
    if data.lstrip()[:40].find(b"BINARY") > 0:
        raise UnreadableError("binary OFF is not supported; save it as text")
    lines = text_lines(data)
    match = _HEADER.fullmatch(lines[0]) if lines else None
    if match is None:
        raise UnreadableError("it does not begin with OFF")
    if match[4] or match[5]:
        raise UnreadableError("only OFF in three dimensions is supported")
    lines = lines[1:] if not match[7].strip() else [match[7], *lines[1:]]
    if not lines:
        raise UnreadableError("truncated: nothing follows OFF")
    return lines


def _polygons(lines: list[bytes]) -> tuple[Ints, Ints]:
    """Corners and sizes of the faces; what follows a face's corners is its colour."""
    sizes = integers([line.split(None, 1)[0] for line in lines])
    widths = np.array([len(line.split()) for line in lines], dtype=np.int64)
    if np.any(sizes < 0) or np.any(widths <= sizes):
        raise UnreadableError("truncated: a face has fewer corners than it announces")
    if np.all(widths == sizes + 1):
        values = integers(b" ".join(lines).split())
        return np.delete(values, np.cumsum(widths) - widths), sizes
    counted = zip(lines, sizes.tolist(), strict=True)
    return integers([token for line, size in counted for token in line.split()[1 : size + 1]]), sizes
