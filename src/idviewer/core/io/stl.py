"""STL files, binary and text: three points for every triangle, nothing shared."""

from __future__ import annotations

import re

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.io.text import UnreadableError, floats, missing
from idviewer.core.validation.polygon_soup import PolygonSoup

_TRIANGLE = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])
_FACET = b"facet normal . . . outer loop vertex . . . vertex . . . vertex . . . endloop endfacet".split()
_KEYWORD_PLACES = [place for place, word in enumerate(_FACET) if word != b"."]
_NUMBER_PLACES = [place for place in range(7, 20) if _FACET[place] == b"."]


def read_stl(data: bytes) -> PolygonSoup:
    """Read the triangles of an STL file, text or binary, of all its solids together.

    Args:
        data: of the file.

    Raises:
        UnreadableError: it is truncated, or does not hold as many triangles as it announces.
    """
    announced = int.from_bytes(data[80:84], "little") if len(data) >= 84 else -1
    if len(data) == 84 + announced * _TRIANGLE.itemsize:
        points = np.frombuffer(data, _TRIANGLE, offset=84)["points"].astype(np.float64)
    elif _is_text(data):
        points = _text(data)
    elif len(data) < 84:
        raise UnreadableError("truncated: it is shorter than the header of a binary STL file")
    else:
        raise missing("triangles", announced, (len(data) - 84) // _TRIANGLE.itemsize)
    count = len(points)
    return PolygonSoup(points.reshape(-1, 3), np.arange(3 * count), np.full(count, 3))


def _is_text(data: bytes) -> bool:
    return b"\0" not in data and data.removeprefix(b"\xef\xbb\xbf").lstrip()[:5].lower() == b"solid"


def _text(data: bytes) -> Floats:
    """(t, 3, 3) points of the facets of every solid ... endsolid."""
    # Names may hold anything, so the lines that have one go first.
    rest = data.removeprefix(b"\xef\xbb\xbf").replace(b"\r", b"\n")
    rest, closed = re.subn(rb"(?im)^[ \t]*endsolid\b.*", b"", rest)
    rest, opened = re.subn(rb"(?im)^[ \t]*solid\b.*", b"", rest)
    if opened != closed:
        raise UnreadableError(f"truncated: {opened} solids begin, {closed} end")
    tokens = rest.lower().split()
    count, over = divmod(len(tokens), len(_FACET))
    if over or any(tokens[place :: len(_FACET)].count(_FACET[place]) != count for place in _KEYWORD_PLACES):
        raise UnreadableError("a facet is not 'facet normal, outer loop, three vertices, endloop, endfacet'")
    columns = [token for place in _NUMBER_PLACES for token in tokens[place :: len(_FACET)]]
    return floats(columns).reshape(9, count).T.reshape(count, 3, 3)
