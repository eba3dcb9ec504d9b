"""Wavefront OBJ files: vertices and faces; materials, normals and textures are passed over."""

from __future__ import annotations

import re

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.errors import Part
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.text import UnreadableError, as_text, integers, text_lines
from idviewer.core.io.written_numbers import numbers
from idviewer.core.validation.polygon_soup import PolygonSoup

_VERTEX = (b"v ", b"v\t")
_FACE = (b"f ", b"f\t")
_OBJECT, _GROUP = (b"o ", b"o\t"), (b"g ", b"g\t")
_OLD_FACE = (b"fo ", b"fo\t")
_OF_NO_SURFACE = b"l p curv curv2 surf call csh bzp bsp cdc res".split()
"""Statements whose content is passed over: lines, points, free forms, other files, programs."""


def read_obj(source: FileSource) -> Contents[PolygonSoup]:
    r"""Read the polygons of an OBJ file, of all its objects and groups together or of a chosen one.

    Args:
        source: the file; its part may be an object, or a group where there are no objects.

    Raises:
        UnreadableError: it holds no vertices, one of fewer than three coordinates, or half a line.
        PartError: it has no such object.

    >>> from pathlib import Path
    >>> data = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    >>> read_obj(FileSource(data, Path("a.obj"))).geometry.corners.tolist()
    [0, 1, 2]
    """
    data = as_text(source.data)
    if b"\\" in data:
        data = re.sub(rb"\\[ \t]*(?:\r\n|\n|\r)", b" ", data)
    lines = [line.lstrip() for line in text_lines(data)]
    if any(line.startswith(_OLD_FACE) for line in lines):
        lines = [b"f " + line[3:] if line.startswith(_OLD_FACE) else line for line in lines]
    points = [line for line in lines if line.startswith(_VERTEX)]
    faces = [line for line in lines if line.startswith(_FACE)]
    if not points:
        raise UnreadableError("it holds no vertices")
    if lines[-1].startswith(_VERTEX) and faces and data[-1:] not in (b"\n", b"\r"):
        raise UnreadableError("truncated: it ends in the middle of a vertex")
    vertices, notes = _points(points)
    corners, sizes = _corners(faces)
    if len(corners) and corners.min() < 0:
        corners = _absolute(corners, sizes, lines)
    soup = PolygonSoup(vertices, corners - 1, sizes)
    notes += _passed_over(lines)
    owners, parts = _parts(lines)
    if source.part is not None:
        chosen = owners == source.chosen(parts, "objects")
        soup = PolygonSoup(vertices, soup.corners[np.repeat(chosen, sizes)], sizes[chosen])
    return Contents(soup, notes, parts=parts)


def _points(lines: list[bytes]) -> tuple[Floats, tuple[str, ...]]:
    """The first three numbers of each line; a weight or a colour may follow."""
    tokens = b" ".join(lines).split()
    width = len(tokens) // len(lines)
    if width < 4 or width * len(lines) != len(tokens) or tokens[::width].count(b"v") != len(lines):
        rows = [line.split() for line in lines]
        if any(len(row) < 4 for row in rows):
            raise UnreadableError("a vertex has fewer than three coordinates")
        tokens, width = [token for row in rows for token in row[:4]], 4
    coordinates = [token for column in (1, 2, 3) for token in tokens[column::width]]
    values, notes = numbers(coordinates)
    weights = tokens[4::5] if width == 5 else []
    if any(token not in (b"1", b"1.0") for token in weights) and np.any(numbers(weights)[0] != 1.0):
        notes += ("The weights of its vertices were passed over.",)
    return np.ascontiguousarray(values.reshape(3, -1).T), notes


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


def _passed_over(lines: list[bytes]) -> tuple[str, ...]:
    """A note on statements that hold no surface, and neither vertices nor what belongs to them."""
    met = {line.split(None, 1)[0] for line in lines if not line.startswith((b"v", b"f"))}
    names = ", ".join(name.decode() for name in _OF_NO_SURFACE if name in met)
    return (f"Lines that hold no faces were passed over: {names}.",) if names else ()


def _parts(lines: list[bytes]) -> tuple[Ints, tuple[Part, ...]]:
    """The number of each face's object, and the objects that have faces; groups where there are none."""
    keyword = _OBJECT if any(line.startswith(_OBJECT) for line in lines) else _GROUP
    headings = [place for place, line in enumerate(lines) if line.startswith(keyword)]
    faces = [place for place, line in enumerate(lines) if line.startswith(_FACE)]
    names = ["default", *(lines[place][2:].strip().decode("utf-8", "replace") for place in headings)]
    under = np.searchsorted(headings, faces)
    met: dict[str, int] = {}
    for number in np.unique(under).tolist():
        met.setdefault(names[number], len(met))
    owners = np.array([met.get(name, -1) for name in names], dtype=np.int64)[under]
    counts = np.bincount(owners, minlength=len(met)).tolist()
    named = zip(met, counts, strict=True)
    return owners, tuple(Part(name, f"{count:,} faces") for name, count in named)
