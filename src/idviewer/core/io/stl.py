"""STL files, binary and text: three points for every triangle, nothing shared."""

from __future__ import annotations

import re

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.io.contents import Contents
from idviewer.core.io.text import UnreadableError, as_text, missing
from idviewer.core.io.written_numbers import numbers
from idviewer.core.validation.polygon_soup import PolygonSoup

_TRIANGLE = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])
_HEADER = 84
_UNCOUNTED = (0, 0xFFFFFFFF)
"""Counts of exporters that cannot go back to the header when they know."""

_FACET = b"facet normal . . . outer loop vertex . . . vertex . . . vertex . . . endloop endfacet".split()
_KEYWORD_PLACES = [place for place, word in enumerate(_FACET) if word != b"."]
_NUMBER_PLACES = [place for place in range(7, 20) if _FACET[place] == b"."]

# A solid's name may hold anything; it ends with its line, or where facets begin.
_OPENING = re.compile(rb"^[^\S\n]*solid\b(?:.*?(?=\bfacet\s+normal\b)|.*)", re.IGNORECASE | re.MULTILINE)
_CLOSING = re.compile(
    rb"\bend[^\S\n]?solid\b(?:.*?(?=\bsolid\b.*?\bfacet\s+normal\b)|.*)", re.IGNORECASE | re.MULTILINE
)
_COLOUR = re.compile(rb"\bcolou?r(?:\s+[+-]?[\d.,]+(?:e[+-]?\d+)?(?=\s)){1,4}", re.IGNORECASE)
_NORMAL = re.compile(rb"\bfacet\b(?:(?!\bfacet\b|\bvertex\b|\bendfacet\b).)*?\bouter\s+loop\b", re.DOTALL)


def read_stl(data: bytes) -> Contents[PolygonSoup]:
    """Read the triangles of an STL file, text or binary, of all its solids together.

    Args:
        data: of the file.

    Raises:
        UnreadableError: it is truncated, or does not hold as many triangles as it announces.
    """
    announced = int.from_bytes(data[80:84], "little") if len(data) >= _HEADER else -1
    notes: tuple[str, ...] = ()
    if len(data) == _HEADER + announced * _TRIANGLE.itemsize:
        points = _binary(data, _HEADER, announced)
    elif (text := _text_of(data)) is not None:
        points, notes = _text(text)
    elif len(data) < _HEADER:
        raise UnreadableError("truncated: it is shorter than the header of a binary STL file")
    else:
        points, notes = _miscounted(data, announced)
    count = len(points)
    return Contents(PolygonSoup(points.reshape(-1, 3), np.arange(3 * count), np.full(count, 3)), notes)


def _binary(data: bytes, start: int, count: int) -> Floats:
    return np.frombuffer(data, _TRIANGLE, count, start)["points"].astype(np.float64)


def _miscounted(data: bytes, announced: int) -> tuple[Floats, tuple[str, ...]]:
    """Facets of a file that is longer than its count of them says."""
    there, over = divmod(len(data) - _HEADER, _TRIANGLE.itemsize)
    if announced in _UNCOUNTED and there and not over:
        return _binary(data, _HEADER, there), (
            f"Its header does not count its facets; by the file's length they are {there:,}.",
        )
    if announced == _UNCOUNTED[1]:
        raise UnreadableError(
            "truncated or padded: its header does not count its facets, nor does its length"
        )
    if announced > there:
        raise missing("triangles", announced, there)
    solids, end = [_binary(data, _HEADER, announced)], _HEADER + announced * _TRIANGLE.itemsize
    if announced == 0 or (not over and not _is_solid(data, end)):
        raise missing("triangles", announced, there)
    while _is_solid(data, end):
        count = int.from_bytes(data[end + 80 : end + _HEADER], "little")
        solids.append(_binary(data, end + _HEADER, count))
        end += _HEADER + count * _TRIANGLE.itemsize
    notes = [f"{len(solids)} binary STL files one after the other were read."] if len(solids) > 1 else []
    if end < len(data):
        notes.append(f"{len(data) - end:,} bytes after its last facet were passed over.")
    return np.concatenate(solids), tuple(notes)


def _is_solid(data: bytes, start: int) -> bool:
    """Whether a whole binary STL file with facets begins there."""
    if start + _HEADER > len(data):
        return False
    count = int.from_bytes(data[start + 80 : start + _HEADER], "little")
    return 0 < count <= (len(data) - start - _HEADER) // _TRIANGLE.itemsize


def _text_of(data: bytes) -> bytes | None:
    """The text of a file in which a line begins with "solid", ended by newlines; None for others."""
    try:
        text = as_text(data)
    except UnreadableError:
        return None
    text = text.replace(b"\r", b"\n")
    return text if re.search(rb"^[^\S\n]*solid\b", text, re.IGNORECASE | re.MULTILINE) else None


def _text(text: bytes) -> tuple[Floats, tuple[str, ...]]:
    """(t, 3, 3) points of the facets of every solid ... endsolid, and notes."""
    before = re.search(rb"^[^\S\n]*solid\b", text, re.IGNORECASE | re.MULTILINE)
    assert before is not None
    notes = []
    if text[: before.start()].strip():
        notes.append("What stands before its first solid was passed over.")
    rest, closed = _CLOSING.subn(b"\n", text[before.start() :])
    rest, opened = _OPENING.subn(b"", rest)
    tokens = rest.lower().split()
    if not _are_facets(tokens):
        rest = _NORMAL.sub(b"facet normal 0 0 0 outer loop", _COLOUR.sub(b" ", rest.lower()))
        tokens = rest.split()
        if not _are_facets(tokens):
            raise UnreadableError(
                "truncated, or a facet is not 'facet normal, outer loop, three vertices, endloop, endfacet'"
            )
        notes.append("What stands in its facets beside their vertices was passed over.")
    count = len(tokens) // len(_FACET)
    if not count:
        raise UnreadableError(f"truncated: {opened} solids begin, and no facet follows")
    if opened != closed:
        notes.append(
            f"It ends without endsolid, after {count:,} whole facets."
            if closed < opened == 1
            else f"Its solids begin {opened:,} times and end {closed:,} times; all facets are whole."
        )
    columns = [token for place in _NUMBER_PLACES for token in tokens[place :: len(_FACET)]]
    values, more = numbers(columns)
    return values.reshape(9, count).T.reshape(count, 3, 3), (*notes, *more)


def _are_facets(tokens: list[bytes]) -> bool:
    count, over = divmod(len(tokens), len(_FACET))
    return not over and all(
        tokens[place :: len(_FACET)].count(_FACET[place]) == count for place in _KEYWORD_PLACES
    )
