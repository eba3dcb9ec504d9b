"""PLY files (Stanford polygon format): text and binary in both byte orders, polygons and triangle strips."""

from __future__ import annotations

import re
import struct
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints
from idviewer.core.io.contents import Contents
from idviewer.core.io.ply_header import Element, Property, read_header
from idviewer.core.io.text import Tokens, UnreadableError, floats, missing
from idviewer.core.io.written_numbers import numbers
from idviewer.core.validation.polygon_soup import PolygonSoup, concatenated, strips

_CODES = {
    "i1": "b",
    "u1": "B",
    "i2": "h",
    "u2": "H",
    "i4": "i",
    "u4": "I",
    "i8": "q",
    "u8": "Q",
    "f4": "f",
    "f8": "d",
}
_INDICES = ("vertex_indices", "vertex_index")

Column = tuple[NDArray, Ints]
"""All values of a property, and how many of them each record has (one, unless the property is a list)."""


def read_ply(data: bytes) -> Contents[PolygonSoup]:
    """Read the polygons of a PLY file: its elements vertex, face and tristrips.

    Other elements and properties are passed over, as are header lines that mean nothing.

    Args:
        data: of the file, text or binary in either byte order.

    Raises:
        UnreadableError: its header means nothing, or what follows is not what its header announces.
    """
    header = read_header(data)
    elements, body, notes = header.elements, header.body, list(header.notes)
    ends = len(body)
    if header.order == "":
        body, ends, more = _as_binary(elements, body)
        notes += more
    columns, place = {}, 0
    for element in elements:
        columns[element.name], place = _records(element, body, place, header.order or "=")
    vertices = _vertices(columns.get("vertex", {}))
    if place < ends and (header.order == "" or body[place:].strip()):
        if _another_face(elements, body, place, header.order or "=", len(vertices)):
            raise UnreadableError("wrong counts: it holds more faces than its header announces")
        notes.append("What follows its last element was passed over.")
    faces = _indices(columns.get("face", {}))
    triangles = [_strips(*column) for column in _indices(columns.get("tristrips", {}))]
    corners, sizes = zip((np.empty(0, np.int64),) * 2, *faces, *triangles, strict=True)
    return Contents(PolygonSoup(vertices, concatenated(corners), concatenated(sizes)), tuple(notes))


def _as_binary(elements: list[Element], text: bytes) -> tuple[bytes, int, tuple[str, ...]]:
    """Text as binary data in which every value is a double; the elements' types are changed to match.

    Returns:
        the data up to what is no number, the length that all of it would have, and notes.
    """
    if elements and elements[-1].name == "vertex" and text[-1:] not in (b"\n", b"\r"):
        raise UnreadableError("truncated: it ends in the middle of a vertex")
    told = re.search(rb"(?m)^[ \t]*(comment|obj_info)\b", text)
    if told:
        text = re.sub(rb"(?m)^[ \t]*(?:comment|obj_info)\b.*$", b"", text.replace(b"\r", b"\n"))
    tokens = text.split()
    total = len(tokens)
    try:
        values, notes = numbers(tokens)
    except UnreadableError:
        fractions = _places_of_fractions(elements, tokens)
        if fractions is None:
            raise
        tokens = tokens[: len(fractions)]
        which = np.flatnonzero(fractions).tolist()
        values = np.empty(len(tokens))
        values[fractions], notes = numbers([tokens[place] for place in which])
        whole = np.flatnonzero(~fractions).tolist()
        values[~fractions] = floats([tokens[place] for place in whole])
    for element in elements:
        element.properties[:] = [Property(p.name, "f8", p.length and "f8") for p in element.properties]
    notes = (*notes, "Remarks among its data were passed over.") if told else notes
    return values.tobytes(), 8 * total, notes


def _places_of_fractions(elements: list[Element], tokens: Tokens) -> NDArray[np.bool_] | None:
    """Which of the elements' tokens may be fractions by their types; None if there are too few."""
    kinds: list[bool] = []
    for element in elements:
        record = [(one.values[0] == "f", bool(one.length)) for one in element.properties]
        for _ in range(element.count if record else 0):
            for fraction, is_list in record:
                place = len(kinds)
                if place >= len(tokens) or (is_list and not tokens[place].isdigit()):
                    return None
                if not is_list:
                    kinds.append(fraction)
                    continue
                size = int(tokens[place])
                if size > len(tokens) - place:
                    return None
                kinds += [False, *[fraction] * size]
    return np.array(kinds, dtype=np.bool_) if len(kinds) <= len(tokens) else None


def _another_face(elements: list[Element], body: bytes, place: int, order: str, vertices: int) -> bool:
    """Whether what follows the last element reads as one more face."""
    faces = [element for element in elements if element.count]
    if not faces or faces[-1].name != "face":
        return False
    try:
        columns, end = _records(replace(faces[-1], count=1), body, place, order)
        corners, sizes = _indices(columns)[0]
    except (UnreadableError, IndexError):
        return False
    inside = corners.min(initial=0) >= 0 and corners.max(initial=0) < vertices
    return bool(end <= len(body) and sizes[0] >= 3 and inside and len(set(corners.tolist())) == sizes[0])


def _vertices(columns: dict[str, Column]) -> Floats:
    if any(axis not in columns for axis in "xyz"):
        raise UnreadableError("it has no vertices with x, y and z")
    return np.column_stack([columns[axis][0].astype(np.float64) for axis in "xyz"])


def _indices(columns: dict[str, Column]) -> list[Column]:
    """The list of vertex indices, under one of its two names, if there is one."""
    found = [columns[name] for name in _INDICES if name in columns][:1]
    if any(not np.all((values == np.rint(values)) & (np.abs(values) < 2.0**62)) for values, _ in found):
        raise UnreadableError("a face has a corner that is no whole number")
    return [(values.astype(np.int64), sizes) for values, sizes in found]


def _strips(values: Ints, sizes: Ints) -> Column:
    """Triangles of strips; -1 begins a new one."""
    pieces = [
        piece for strip in np.split(values, np.cumsum(sizes)) for piece in np.split(strip, _breaks(strip))
    ]
    triangles = concatenated([strips(piece[piece != -1]).ravel() for piece in pieces])
    return triangles, np.full(len(triangles) // 3, 3)


def _breaks(strip: Ints) -> Ints:
    return np.flatnonzero(strip == -1)


def _records(element: Element, body: bytes, place: int, order: str) -> tuple[dict[str, Column], int]:
    """The properties of an element whose records begin at `place`, and the place behind them."""
    if element.count == 0 or not element.properties:
        return {}, place
    starts, sizes, end = _walk(element, body, place, order, 1)
    stride = end - place
    # Mostly all records are alike: then the first tells where everything is.
    alike = place + element.count * stride <= len(body)
    steps = stride * np.arange(element.count if alike else 1)
    for index, known in enumerate(element.properties):
        if alike and known.length:
            width = np.dtype(known.length).itemsize
            lengths = _gathered(body, starts[index][0] - width + steps, order + known.length)
            alike = bool(np.all(lengths == sizes[index][0]))
    columns = {}
    if alike:
        for known, start, size in zip(element.properties, starts, sizes, strict=True):
            dtype = np.dtype(order + known.values)
            shape = element.count, int(size[0])
            values = np.ndarray(shape, dtype, body, int(start[0]), (stride, dtype.itemsize)).ravel()
            columns[known.name] = values, np.repeat(size, element.count)
        return columns, place + element.count * stride
    starts, sizes, end = _walk(element, body, place, order, element.count)
    for known, start, size in zip(element.properties, starts, sizes, strict=True):
        columns[known.name] = _gathered(body, _runs(start, size, known.values), order + known.values), size
    return columns, end


def _walk(
    element: Element, body: bytes, place: int, order: str, count: int
) -> tuple[list[Ints], list[Ints], int]:
    """Offsets and counts of the values of every property in `count` records; and where these end."""
    kinds = [
        (np.dtype(p.values).itemsize, struct.Struct(order + _CODES[p.length]) if p.length else None)
        for p in element.properties
    ]
    found: list[int] = []
    try:
        for _ in range(count):
            for width, length in kinds:
                size = 1
                if length is not None:
                    size = int(length.unpack_from(body, place)[0])
                    place += length.size
                if size < 0 or place + size * width > len(body):
                    raise ValueError
                found += (place, size)
                place += size * width
    except (struct.error, ValueError, OverflowError):
        raise missing(f"records '{element.name}'", element.count, len(found) // (2 * len(kinds))) from None
    table = np.array(found, dtype=np.int64).reshape(count, len(kinds), 2)
    return list(table[..., 0].T), list(table[..., 1].T), place


def _runs(starts: Ints, sizes: Ints, kind: str) -> Ints:
    """The place of every value of lists that begin at `starts`."""
    if np.all(sizes == 1):
        return starts
    within = np.arange(int(sizes.sum())) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    return np.repeat(starts, sizes) + within * np.dtype(kind).itemsize


def _gathered(body: bytes, places: Ints, kind: str) -> NDArray:
    """The values at the given places."""
    dtype = np.dtype(kind)
    content = np.frombuffer(body, np.uint8)
    return content[places[:, None] + np.arange(dtype.itemsize)].view(dtype)[:, 0]
