"""PLY files (Stanford polygon format): text and binary in both byte orders, polygons and triangle strips."""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints
from idviewer.core.io.text import UnreadableError, floats, missing
from idviewer.core.validation.polygon_soup import PolygonSoup, concatenated, strips

_PROPERTY_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
    "int64": "i8",
    "uint64": "u8",
}
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
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_INDICES = ("vertex_indices", "vertex_index")

Column = tuple[NDArray, Ints]
"""All values of a property, and how many of them each record has (one, unless the property is a list)."""


@dataclass(frozen=True)
class Property:
    """A property: type of its values, and for a list the type of its length."""

    name: str
    values: str
    length: str = ""


@dataclass(frozen=True)
class Element:
    """One kind of record, and how many of them there are."""

    name: str
    count: int
    properties: list[Property] = field(default_factory=list)


def read_ply(data: bytes) -> PolygonSoup:
    """Read the polygons of a PLY file: its elements vertex, face and tristrips.

    Args:
        data: of the file, text or binary in either byte order.

    Raises:
        UnreadableError: its header means nothing, or what follows is not what its header announces.
    """
    order, elements, body = _header(data)
    if order == "":
        body = _as_binary(elements, body)
    columns, place = {}, 0
    for element in elements:
        columns[element.name], place = _records(element, body, place, order or "=")
    if place < len(body) and (order == "" or body[place:].strip()):
        raise UnreadableError("wrong counts: more follows than its header announces")
    vertices = _vertices(columns.get("vertex", {}))
    faces = _indices(columns.get("face", {}))
    triangles = [_strips(*column) for column in _indices(columns.get("tristrips", {}))]
    corners, sizes = zip((np.empty(0, np.int64),) * 2, *faces, *triangles, strict=True)
    return PolygonSoup(vertices, concatenated(corners), concatenated(sizes))


def _as_binary(elements: list[Element], text: bytes) -> bytes:
    """Text as binary data in which every value is a double; the elements' types are changed to match."""
    if elements and elements[-1].name == "vertex" and text[-1:] not in (b"\n", b"\r"):
        raise UnreadableError("truncated: it ends in the middle of a vertex")
    for element in elements:
        element.properties[:] = [Property(p.name, "f8", p.length and "f8") for p in element.properties]
    return floats(text.split()).tobytes()


def _vertices(columns: dict[str, Column]) -> Floats:
    if any(axis not in columns for axis in "xyz"):
        raise UnreadableError("it has no vertices with x, y and z")
    return np.column_stack([columns[axis][0].astype(np.float64) for axis in "xyz"])


def _indices(columns: dict[str, Column]) -> list[Column]:
    """The list of vertex indices, under one of its two names, if there is one."""
    found = [columns[name] for name in _INDICES if name in columns][:1]
    if any(np.any(values != np.rint(values)) for values, _ in found):
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


def _header(data: bytes) -> tuple[str, list[Element], bytes]:
    """Byte order ("" for text), elements, and the data behind the header."""
    if not re.match(rb"ply[ \t]*[\r\n]", data):
        raise UnreadableError("it does not begin with ply")
    end = re.search(rb"[\r\n]end_header[ \t]*(\r\n|\n|\r)", data)
    if end is None:
        raise UnreadableError("truncated: its header does not end")
    order: str | None = None
    elements: list[Element] = []
    for line in data[: end.start()].decode("latin-1").splitlines()[1:]:
        match line.split():
            case ["format", name, "1.0"] if name in _ORDERS:
                order = _ORDERS[name]
            case ["element", name, count] if count.isdecimal():
                elements.append(Element(name, int(count)))
            case ["property", "list", length, values, name] if elements:
                elements[-1].properties.append(Property(name, _type(values), _type(length)))
            case ["property", values, name] if elements:
                elements[-1].properties.append(Property(name, _type(values)))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                raise UnreadableError(f"its header has a line that means nothing: {line.strip()[:40]!a}")
    if order is None:
        raise UnreadableError("its header names no format")
    return order, elements, data[end.end() :]


def _type(name: str) -> str:
    if name not in _PROPERTY_TYPES:
        raise UnreadableError(f"its header has a type that means nothing: {name[:20]!a}")
    return _PROPERTY_TYPES[name]


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
