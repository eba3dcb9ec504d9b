"""The numbers of a glTF document: buffers, buffer views and accessors, plain or compressed by meshopt."""

from __future__ import annotations

import base64
import urllib.parse
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from idviewer.core.io.libraries import library
from idviewer.core.io.memory_bound import MEMORY_BOUND
from idviewer.core.io.text import UnreadableError

_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")


@dataclass
class GltfData:
    """What the accessors of a document stand for.

    Attributes:
        tree: the document.
        chunk: the binary chunk it came with, if any.
        folder: buffers in files are looked for there and below, nowhere else; None where there is none.
        size: of all files in bytes.
        spent: bytes that its values have taken so far.
    """

    tree: dict[str, Any]
    chunk: bytes | None
    folder: Path | None
    size: int
    spent: int = 0
    _buffers: dict[int, bytes] = field(default_factory=dict)
    _views: dict[int, bytes] = field(default_factory=dict)

    def take(self, needed: int) -> None:
        """Count memory that values will take.

        Args:
            needed: bytes.

        Raises:
            UnreadableError: with what was taken before they are more than the bound.
        """
        self.spent += needed
        MEMORY_BOUND.check(self.spent, self.size, "what it describes")

    def accessor(self, index: int) -> NDArray:
        """(count, width) values; sparse ones filled in, normalised integers as numbers of -1 .. 1.

        Args:
            index: of the accessor.

        Raises:
            UnreadableError: they are not there, or compressed in an unknown way.
        """
        accessor = self.tree["accessors"][index]
        dtype, width = np.dtype(_TYPES[accessor["componentType"]]), _WIDTHS[accessor["type"]]
        count = accessor["count"]
        self.take(max(count, 0) * width * dtype.itemsize)
        if "bufferView" in accessor:
            values = self.view(accessor, dtype, count, width)
        elif "sparse" in accessor:
            values = np.zeros((count, width), dtype)
        else:
            raise UnreadableError(
                "a part of it has no data, or is compressed by an extension that is not supported"
            )
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            indices = np.dtype(_TYPES[sparse["indices"]["componentType"]])
            values = values.copy()
            where = self.view(sparse["indices"], indices, sparse["count"], 1).ravel()
            values[where] = self.view(sparse["values"], dtype, sparse["count"], width)
        return normalised(values, bool(accessor.get("normalized")))

    def view(self, source: dict[str, Any], dtype: np.dtype, count: int, width: int) -> NDArray:
        """(count, width) values from a buffer view.

        Args:
            source: the accessor, or the part of a sparse one, that names the view.
            dtype: of the values.
            count: how many rows.
            width: how many values in a row.

        Raises:
            UnreadableError: the view or its buffer is too short.
        """
        view = self.tree["bufferViews"][source["bufferView"]]
        content = self.view_bytes(source["bufferView"])
        offset = source.get("byteOffset", 0)
        stride = view.get("byteStride") or dtype.itemsize * width
        needed = offset + (count - 1) * stride + width * dtype.itemsize if count else 0
        if min(count, offset, stride) < 0 or needed > len(content):
            raise UnreadableError("truncated: it refers to data that is not there")
        return np.ndarray((count, width), dtype, content, offset, (stride, dtype.itemsize))

    def view_bytes(self, index: int) -> bytes:
        """The bytes of a buffer view, decompressed where they are compressed.

        Args:
            index: of the view.

        Raises:
            UnreadableError: its buffer is too short, or what is compressed is damaged.
        """
        if index not in self._views:
            view = self.tree["bufferViews"][index]
            packed = [view["extensions"][name] for name in _MESHOPT if name in view.get("extensions", {})]
            if packed and not self._has_data(view["buffer"]):
                self._views[index] = self._unpacked(packed[0])
            else:
                self._views[index] = self._slice(view)
        return self._views[index]

    def _slice(self, view: dict[str, Any]) -> bytes:
        buffer, start, length = self._buffer(view["buffer"]), view.get("byteOffset", 0), view["byteLength"]
        if min(start, length) < 0 or start + length > len(buffer):
            raise UnreadableError("truncated: it refers to data that is not there")
        return buffer[start : start + length]

    def _unpacked(self, packed: dict[str, Any]) -> bytes:
        meshopt = library("meshopt", "its data are compressed by meshopt")
        count, stride = packed["count"], packed["byteStride"]
        if min(count, stride) < 0:
            raise UnreadableError("it announces fewer values than none")
        self.take(count * stride)
        how = packed["mode"], packed.get("filter", "NONE")
        try:
            return meshopt.decode_gltf_buffer(self._slice(packed), count, stride, *how).tobytes()
        except (ValueError, RuntimeError) as error:
            raise UnreadableError(f"truncated or damaged: its compressed data ({error})") from error

    def _has_data(self, index: int) -> bool:
        """Whether a buffer holds bytes, and does not only tell the size of what is compressed elsewhere."""
        return "uri" in self.tree["buffers"][index] or (index == 0 and self.chunk is not None)

    def _buffer(self, index: int) -> bytes:
        """A buffer's bytes: the binary chunk, a data URI, or a file beside the document."""
        if index not in self._buffers:
            buffer = self.tree["buffers"][index]
            length = buffer["byteLength"]
            own = self.chunk if index == 0 else None
            data = self._fetched(buffer["uri"], length) if "uri" in buffer else own
            if data is None or len(data) < length:
                raise UnreadableError("truncated: a buffer is shorter than it announces")
            self._buffers[index] = data
        return self._buffers[index]

    def _fetched(self, uri: str, length: int) -> bytes:
        if uri.startswith("data:"):
            head, _, content = uri.partition(",")
            return (
                base64.b64decode(content)
                if head.endswith(";base64")
                else urllib.parse.unquote_to_bytes(content)
            )
        name = Path(urllib.parse.unquote(uri))
        if self.folder is None or name.is_absolute() or ".." in name.parts or ":" in name.parts[0]:
            raise UnreadableError(f"it keeps its data elsewhere ({uri[:60]})")
        path = self.folder / name
        if not path.is_file():
            raise UnreadableError(f"the file {name} with its data is missing")
        self.size += path.stat().st_size
        with path.open("rb") as stream:
            return stream.read(max(0, min(length, path.stat().st_size)))


def normalised(values: NDArray, are_shares: bool) -> NDArray:
    """Integers that stand for shares of their largest one as numbers of -1 .. 1; other values as they are.

    Args:
        values: of any shape.
        are_shares: whether they do.

    >>> normalised(np.array([127, -128], np.int8), True).tolist()
    [1.0, -1.0]
    """
    if are_shares and values.dtype.kind in "iu":
        return np.maximum(values / np.iinfo(values.dtype).max, -1.0)
    return values
