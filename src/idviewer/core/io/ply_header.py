"""Headers of PLY files: which elements follow, with which properties."""

from __future__ import annotations

import codecs
import re
from dataclasses import dataclass, field

from idviewer.core.io.text import UnreadableError, as_text

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
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


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


@dataclass(frozen=True)
class Header:
    """The header of a file, and what follows it.

    Attributes:
        order: of a value's bytes, "<" or ">"; "" for text.
        elements: in their order in the data.
        body: the data.
        notes: what was passed over.
    """

    order: str
    elements: list[Element]
    body: bytes
    notes: tuple[str, ...]


def read_header(data: bytes) -> Header:
    r"""Read the header of a PLY file; a line that begins with no keyword is passed over.

    Args:
        data: of the file.

    Raises:
        UnreadableError: it does not end, or a line of it is damaged.

    >>> read_header(b"ply\nformat ascii 1.0\nelement vertex 3\nend_header\n").elements[0].count
    3
    """
    data = data.removeprefix(codecs.BOM_UTF8)
    if data[:3].lower() != b"ply":
        data = _decoded(data).lstrip()
    if not re.match(rb"ply[ \t]*[\r\n]", data, re.IGNORECASE):
        raise UnreadableError("it does not begin with ply")
    end = re.search(rb"[\r\n]end_header[ \t]*(\r\n|\n|\r)", data)
    if end is None:
        raise UnreadableError("truncated: its header does not end")
    order: str | None = None
    elements: list[Element] = []
    unknown: list[str] = []
    for line in data[: end.start()].decode("latin-1").splitlines()[1:]:
        match line.split():
            case ["format", name, "1.0"] if name in _ORDERS:
                order = _ORDERS[name]
            case ["element", name, count] if count.isascii() and count.isdecimal():
                elements.append(Element(name.lower(), int(count)))
            case ["property", "list", length, values, name] if elements:
                elements[-1].properties.append(Property(name.lower(), _type(values), _type(length)))
            case ["property", values, name] if elements:
                elements[-1].properties.append(Property(name.lower(), _type(values)))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case ["format" | "element" | "property", *_]:
                raise UnreadableError(f"its header has a line that means nothing: {line.strip()[:40]!a}")
            case _:
                unknown.append(ascii(line.strip()[:40]))
    if order is None:
        raise UnreadableError("its header names no format")
    notes = (f"Unknown lines of its header were passed over: {', '.join(unknown[:3])}.",) if unknown else ()
    return Header(order, elements, data[end.end() :], notes)


def _decoded(data: bytes) -> bytes:
    try:
        return as_text(data)
    except UnreadableError:
        return data


def _type(name: str) -> str:
    if name.lower() not in _PROPERTY_TYPES:
        raise UnreadableError(f"its header has a type that means nothing: {name[:20]!a}")
    return _PROPERTY_TYPES[name.lower()]
