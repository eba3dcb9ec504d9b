"""OFF files (Geomview's object file format) as text: OFF, COFF, NOFF, STOFF and their combinations.

The format is a stream of numbers, of which mostly each line holds one vertex or one face; only the colour of
a face ends with its line.
"""

from __future__ import annotations

import re
from itertools import chain

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.io.contents import Contents
from idviewer.core.io.text import UnreadableError, integers, missing, text_lines
from idviewer.core.io.written_numbers import numbers
from idviewer.core.validation.polygon_soup import PolygonSoup

_KEYWORD = re.compile(rb"\s*(?:((?:ST|C|N)*)(4?n?)OFF|((?:st|c|n)*)(4?)off)\b\s*(.*)", re.DOTALL)
_COUNTS = re.compile(rb"\s*\d+(\s+\d+){0,2}\s*")
_PREFIXES = {"ST": 2, "C": 4, "N": 3}
"""How many numbers texture coordinates, colours and normals add to a vertex."""

Lines = list[bytes]
Corners = tuple[Ints, Ints]
"""Corners of all faces one after the other, and how many each has."""


def read_off(data: bytes) -> Contents[PolygonSoup]:
    r"""Read the polygons of an OFF file. Normals, colours and texture coordinates are passed over.

    Args:
        data: of the file.

    Raises:
        UnreadableError: its header is not OFF's, or it does not hold what its header promises.

    >>> read_off(b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").geometry.corners.tolist()
    [0, 1, 2]
    """
    lines, width, notes = _without_header(data)
    points, faces, lines = _counts(lines)
    try:
        (vertices, more), behind = _points_by_lines(lines, points)
        polygons, rest = _faces(behind, faces)
    except UnreadableError:
        try:
            (vertices, more), behind = _points_by_tokens(lines, points, width)
            polygons, rest = _faces(behind, faces)
            understood = _are_plausible(polygons, points)
        except UnreadableError:
            understood = False
        if not understood:  # what is wrong shows best in the usual layout
            raise
    if rest and all(_is_face(line, points) for line in rest):
        raise missing("faces", faces, faces + len(rest))
    if rest:
        notes.append(f"What follows its last face was passed over, beginning with {_shown(rest[0])}.")
    return Contents(PolygonSoup(vertices, *polygons), (*notes, *more))


def _without_header(data: bytes) -> tuple[Lines, int, list[str]]:
    """The lines from the counts on, how many numbers a vertex has by the keyword, and notes."""
    if data.lstrip()[:40].find(b"BINARY") > 0:
        raise UnreadableError("binary OFF is not supported; save it as text")
    lines = text_lines(data)
    match = _KEYWORD.fullmatch(lines[0]) if lines else None
    if match is None:
        if lines and _COUNTS.fullmatch(lines[0]):
            return lines, 3, ["The keyword OFF is missing in its first line."]
        raise UnreadableError("it does not begin with OFF")
    if match[2] or match[4]:
        raise UnreadableError("only OFF in three dimensions is supported")
    prefixes = re.findall("ST|C|N", (match[1] or match[3] or b"").decode().upper())
    lines = lines[1:] if not match[5].strip() else [match[5], *lines[1:]]
    if not lines:
        raise UnreadableError("truncated: nothing follows OFF")
    return lines, 3 + sum(_PREFIXES[prefix] for prefix in prefixes), []


def _counts(lines: Lines) -> tuple[int, int, Lines]:
    """The numbers of vertices and faces, and the lines behind them; that of edges may be missing."""
    tokens = lines[0].split(None, 3)
    lines = [*tokens[3:], *lines[1:]]
    while len(tokens) < 3 and lines and len(lines[0].split()) == 1:  # each on a line of its own
        tokens.append(lines.pop(0).strip())
    counts = integers(tokens[:3])
    if len(counts) < 2 or np.any(counts < 0):
        raise UnreadableError("the line after OFF does not give the numbers of vertices and faces")
    return int(counts[0]), int(counts[1]), lines


def _points_by_lines(lines: Lines, count: int) -> tuple[tuple[Floats, tuple[str, ...]], Lines]:
    """The first three numbers of each line, which normals, colours, ... may follow; and the lines behind."""
    if len(lines) < count:
        raise missing("vertices", count, len(lines))
    own = lines[:count]
    widths = {len(line.split()) for line in own}
    if min(widths, default=3) < 3:
        raise UnreadableError("a vertex has fewer than three coordinates")
    if widths <= {3}:
        values, notes = numbers(b" ".join(own).split())
    else:
        values, notes = numbers([token for line in own for token in line.split(None, 3)[:3]])
    return (values.reshape(-1, 3), notes), lines[count:]


def _points_by_tokens(lines: Lines, count: int, width: int) -> tuple[tuple[Floats, tuple[str, ...]], Lines]:
    """The first three of each `width` numbers, wherever lines end; and the lines behind."""
    tokens: Lines = []
    used = 0
    while len(tokens) < count * width and used < len(lines):
        tokens += lines[used].split()
        used += 1
    if len(tokens) < count * width:
        raise missing("vertices", count, len(tokens) // width)
    behind = [b" ".join(tokens[count * width :])] if len(tokens) > count * width else []
    columns = [tokens[axis : count * width : width] for axis in range(3)]
    values, notes = numbers(list(chain.from_iterable(zip(*columns, strict=True))))
    return (values.reshape(-1, 3), notes), [*behind, *lines[used:]]


def _faces(lines: Lines, count: int) -> tuple[Corners, Lines]:
    """Corners and sizes of the faces, and what follows them: one a line, or else a stream."""
    try:
        return _faces_by_lines(lines, count)
    except UnreadableError:
        found = _faces_by_tokens(lines, count)
        if found is None:
            raise
        return found


def _faces_by_lines(lines: Lines, count: int) -> tuple[Corners, Lines]:
    """What follows a face's corners is its colour."""
    if len(lines) < count:
        raise missing("faces", count, len(lines))
    own, rest = lines[:count], lines[count:]
    sizes = integers([line.split(None, 1)[0] for line in own])
    widths = np.array([len(line.split()) for line in own], dtype=np.int64)
    if np.any(sizes < 0) or np.any(widths <= sizes):
        raise UnreadableError("truncated: a face has fewer corners than it announces")
    if np.all(widths == sizes + 1):
        values = integers(b" ".join(own).split())
        return (np.delete(values, np.cumsum(widths) - widths), sizes), rest
    counted = zip(own, sizes.tolist(), strict=True)
    corners = integers([token for line, size in counted for token in line.split()[1 : size + 1]])
    return (corners, sizes), rest


def _faces_by_tokens(lines: Lines, count: int) -> tuple[Corners, Lines] | None:
    """The same of a stream without colours; None if it does not hold so many faces."""
    tokens = b" ".join(lines).split()
    starts: list[int] = []
    place = 0
    for _ in range(count):
        if place >= len(tokens) or not tokens[place].isdigit():
            return None
        starts.append(place)
        place += 1 + int(tokens[place])
    if place > len(tokens):
        return None
    try:
        values = integers(tokens[:place])
    except UnreadableError:
        return None
    rest = [b" ".join(tokens[place:])] if place < len(tokens) else []
    return (np.delete(values, starts), values[starts]), rest


def _are_plausible(polygons: Corners, points: int) -> bool:
    """Whether what a stream was cut into are faces; a number too few would shift all that follow."""
    corners, sizes = polygons
    return bool(sizes.min(initial=3) >= 3 and corners.min(initial=0) >= 0 and corners.max(initial=0) < points)


def _is_face(line: bytes, points: int) -> bool:
    """Whether a line reads as one more face."""
    tokens = line.split()
    if not all(token.isdigit() for token in tokens):
        return False
    size, corners = int(tokens[0]), [int(token) for token in tokens[1:]]
    return 3 <= size <= len(corners) and all(corner < points for corner in corners[:size])


def _shown(line: bytes) -> str:
    return ascii(line.strip()[:20].decode("latin-1"))
