"""VTK XML PolyData files (.vtp): polygons and triangle strips, in every encoding but LZ4 compression.

The core knows no VTK, and the format is small: an array is text, or base64, or a range of the appended data;
the latter two begin with a header of unsigned integers. Without compression that is the number of bytes; with
it, the number of blocks, the size of a block, that of the last one (0 if it is full), and every block's
compressed size.
"""

from __future__ import annotations

import base64
import lzma
import re
import xml.etree.ElementTree as ET
import zlib
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Ints
from idviewer.core.io.text import UnreadableError, floats, missing
from idviewer.core.validation.polygon_soup import PolygonSoup, concatenated, strips

_TYPES = {
    f"{kind}{bits}": f"{code}{bits // 8}"
    for kind, code in (("Int", "i"), ("UInt", "u"))
    for bits in (8, 16, 32, 64)
}
_TYPES |= {"Float32": "f4", "Float64": "f8"}
_DECOMPRESSORS: dict[str, Callable[[bytes], bytes]] = {
    "vtkZLibDataCompressor": zlib.decompress,
    "vtkLZMADataCompressor": lzma.decompress,
}


def read_vtp(data: bytes) -> PolygonSoup:
    """Polygons of a .vtp file, of all its pieces together; points and lines are passed over."""
    file = _File(data)
    return PolygonSoup.joined([_piece(file, piece) for piece in file.root.iterfind("PolyData/Piece")])


def _piece(file: _File, piece: ET.Element) -> PolygonSoup:
    element = piece.find("Points/DataArray")
    points = np.empty(0) if element is None else file.values(element)
    announced = int(piece.get("NumberOfPoints", 0))
    if len(points) != 3 * announced:
        raise missing("coordinates", 3 * announced, len(points))
    corners, sizes = _cells(file, piece, "Polys")
    triangles = [strips(strip).ravel() for strip in np.split(*_ends(_cells(file, piece, "Strips")))]
    turned = concatenated(triangles)
    return PolygonSoup(
        np.array(points, dtype=np.float64).reshape(-1, 3),
        concatenated([corners, turned]),
        concatenated([sizes, np.full(len(turned) // 3, 3)]),
    )


def _ends(cells: tuple[Ints, Ints]) -> tuple[Ints, Ints]:
    corners, sizes = cells
    return corners, np.cumsum(sizes)


def _cells(file: _File, piece: ET.Element, kind: str) -> tuple[Ints, Ints]:
    """Corners and sizes of a piece's polygons or strips."""
    announced = int(piece.get(f"NumberOf{kind}", 0))
    if announced == 0:
        return np.empty(0, np.int64), np.empty(0, np.int64)
    arrays = {element.get("Name"): element for element in piece.iterfind(f"{kind}/DataArray")}
    if "connectivity" not in arrays or "offsets" not in arrays:
        raise missing(kind.lower(), announced, 0)
    corners, ends = (file.values(arrays[name]).astype(np.int64) for name in ("connectivity", "offsets"))
    if len(ends) != announced:
        raise missing(kind.lower(), announced, len(ends))
    sizes = np.diff(ends, prepend=0)
    if np.any(sizes < 0) or ends[-1] != len(corners):
        raise UnreadableError(f"its {kind.lower()} do not fit their offsets")
    return corners, sizes


class _File:
    """The XML tree, and how its arrays are stored."""

    def __init__(self, data: bytes) -> None:
        document, self.appended = _parted(data)
        try:
            self.root = ET.fromstring(document)
        except ET.ParseError as error:
            raise UnreadableError(f"truncated or no XML ({error})") from error
        get = self.root.get
        if self.root.tag != "VTKFile" or get("type") != "PolyData":
            raise UnreadableError(f"it holds {get('type', 'something')[:40]}, not PolyData")
        self.order = ">" if get("byte_order") == "BigEndian" else "<"
        self.header = np.dtype(self.order + _TYPES[get("header_type", "UInt32")])
        self.compressor = get("compressor")
        arrays = self.root.iter("DataArray")
        self.offsets = sorted(
            int(array.get("offset", 0)) for array in arrays if array.get("format") == "appended"
        )
        store = self.root.find("AppendedData")
        self.raw = store is not None and store.get("encoding") == "raw"

    def values(self, element: ET.Element) -> NDArray:
        """The values of a DataArray, flat."""
        dtype = np.dtype(self.order + _TYPES[element.get("type", "")])
        # Information keys may stand between an array's tags; only the text beside them is data.
        text = (element.text or "") + "".join(child.tail or "" for child in element)
        match element.get("format", "ascii"):
            case "ascii":
                return floats(text.encode().split())
            case "binary":
                stored = _from_base64(text.encode())
            case "appended":
                offset = int(element.get("offset", 0))
                after = next((other for other in self.offsets if other > offset), len(self.appended))
                stored = self.appended[offset:after]
                stored = stored if self.raw else _from_base64(stored)
            case other:
                raise UnreadableError(f"the array format {other[:40]} is not supported")
        content = self.unpacked(stored)
        if len(content) % dtype.itemsize:
            raise UnreadableError("truncated: an array ends in the middle of a value")
        return np.frombuffer(content, dtype)

    def unpacked(self, stored: bytes) -> bytes:
        """The bytes behind the header."""
        width = self.header.itemsize
        if self.compressor is None:
            (size,) = self.numbers(stored, 0, 1)
            content = stored[width : width + size]
            if len(content) < size:
                raise missing("bytes of an array", size, len(content))
            return content
        if self.compressor not in _DECOMPRESSORS:
            raise UnreadableError(f"compression by {self.compressor[:40]} is not supported; use ZLib or none")
        count, size, last = self.numbers(stored, 0, 3)
        packed = self.numbers(stored, 3, count)
        place, blocks = (3 + count) * width, []
        for index, length in enumerate(packed):
            blocks.append(_DECOMPRESSORS[self.compressor](stored[place : place + length]))
            if len(blocks[-1]) != (last if last and index == count - 1 else size):
                raise UnreadableError("damaged: a compressed block has the wrong size")
            place += length
        return b"".join(blocks)

    def numbers(self, stored: bytes, first: int, count: int) -> list[int]:
        """Some of the unsigned integers that the header consists of."""
        width = self.header.itemsize
        if len(stored) < (first + count) * width:
            raise UnreadableError("truncated: an array ends in its header")
        return np.frombuffer(stored, self.header, count, first * width).tolist()


def _parted(data: bytes) -> tuple[bytes, bytes]:
    """The XML without the appended data, which need not be text, and that data."""
    tag = data.find(b"<AppendedData")
    if tag < 0:
        return data, b""
    begin, end = data.find(b">", tag) + 1, data.rfind(b"</AppendedData>")
    mark = data.find(b"_", begin) + 1
    if not tag < begin < mark <= end:
        raise UnreadableError("truncated: the appended data do not end")
    return data[:begin] + data[end:], data[mark:end]


def _from_base64(text: bytes) -> bytes:
    """Decoded base64, also of several pieces in a row that each end in padding."""
    return b"".join(base64.b64decode(piece) for piece in re.findall(rb"[^=\s][^=]*=*", text))
