"""glTF 2.0 files, binary (GLB) and text: all triangles of the default scene, where its nodes place them.

Materials, images, skins and morph targets are not looked at: skinned meshes come in the pose they are stored
in.
"""

from __future__ import annotations

import base64
import json
import struct
import urllib.parse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints
from idviewer.core.io.text import UnreadableError
from idviewer.core.validation.polygon_soup import PolygonSoup, strips
from idviewer.core.validation.soup_repairs import without_unused_vertices

_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_HARMLESS = (
    "KHR_mesh_quantization",
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "KHR_lights_",
    "KHR_xmp",
)


def read_glb(data: bytes) -> PolygonSoup:
    """Read the polygons of a GLB file.

    Args:
        data: of the file.

    Raises:
        UnreadableError: it is no whole, consistent GLB file of version 2, or needs what is not supported.
    """
    if data[:4] != b"glTF" or len(data) < 12:
        raise UnreadableError("it does not begin with glTF")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise UnreadableError(f"only version 2 is supported, not {version}")
    if length != len(data):
        raise UnreadableError(f"truncated or padded: {length:,} bytes are announced, {len(data):,} are there")
    chunks: dict[bytes, bytes] = {}
    place = 12
    while place < length:
        size, kind = struct.unpack_from("<I4s", data, place)
        place += 8 + size
        if place > length:
            raise UnreadableError("truncated: a chunk is cut off")
        chunks.setdefault(kind, data[place - size : place])
    if b"JSON" not in chunks:
        raise UnreadableError("it holds no scene")
    return _Document(_json(chunks[b"JSON"]), chunks.get(b"BIN\0"), None).polygons()


def read_gltf(data: bytes, folder: Path | None = None) -> PolygonSoup:
    """Read the polygons of a glTF file.

    Args:
        data: of the file.
        folder: its buffers are looked for there and below, nowhere else; None where there is none.

    Raises:
        UnreadableError: it is no whole, consistent glTF file of version 2, or needs what is not supported.
    """
    return _Document(_json(data), None, folder).polygons()


def _json(data: bytes) -> Any:
    try:
        return json.loads(data)
    except ValueError as error:
        raise UnreadableError(f"truncated or no JSON ({error})") from error


@dataclass
class _Document:
    """A glTF document, the binary chunk it came with and the folder it lies in."""

    tree: dict[str, Any]
    chunk: bytes | None
    folder: Path | None

    def polygons(self) -> PolygonSoup:
        """All triangles of the scene that is shown first; of all root nodes if there is no scene."""
        if not isinstance(self.tree, dict) or "asset" not in self.tree:
            raise UnreadableError("it is no glTF document")
        if not str(self.tree["asset"].get("version", "")).startswith("2"):
            raise UnreadableError("only version 2 is supported")
        for extension in self.tree.get("extensionsRequired", []):
            if not str(extension).startswith(_HARMLESS):
                raise UnreadableError(f"it needs the extension {extension}, which is not supported")
        self.buffers = [self.buffer(index) for index in range(len(self.tree.get("buffers", [])))]
        self.parts: list[PolygonSoup] = []
        self.place(self.roots())
        return PolygonSoup.joined(self.parts)

    def roots(self) -> list[int]:
        scenes, nodes = self.tree.get("scenes", []), self.tree.get("nodes", [])
        if scenes:
            return scenes[self.tree.get("scene", 0)].get("nodes", [])
        children = {child for node in nodes for child in node.get("children", [])}
        return [index for index in range(len(nodes)) if index not in children]

    def place(self, roots: list[int]) -> None:
        """Add the triangles of the root nodes and of all nodes below them."""
        waiting = [(root, np.eye(4)) for root in reversed(roots)]
        seen: set[int] = set()
        while waiting:
            index, parent = waiting.pop()
            if index in seen:
                raise UnreadableError("a node hangs in two places, or below itself")
            seen.add(index)
            node = self.tree["nodes"][index]
            matrix = parent @ _matrix(node)
            if "mesh" in node:
                for primitive in self.tree["meshes"][node["mesh"]]["primitives"]:
                    self.parts += self.primitive(primitive, matrix)
            waiting += [(child, matrix) for child in reversed(node.get("children", []))]

    def primitive(self, primitive: dict[str, Any], matrix: Floats) -> list[PolygonSoup]:
        """One list, strip or fan of triangles; none for points and lines."""
        mode = primitive.get("mode", _TRIANGLES)
        if mode not in (_TRIANGLES, _STRIP, _FAN):
            return []
        points = self.accessor(primitive["attributes"]["POSITION"]).astype(np.float64)
        if points.shape[1:] != (3,):
            raise UnreadableError("its points do not have three coordinates")
        if "indices" in primitive:
            corners = self.accessor(primitive["indices"]).astype(np.int64).ravel()
        else:
            corners = np.arange(len(points))
        triangles = _triangles(corners, mode)
        if np.linalg.det(matrix[:3, :3]) < 0:  # a mirror turns the winding round
            triangles = triangles[:, ::-1]
        points = points @ matrix[:3, :3].T + matrix[:3, 3]
        if triangles.size and triangles.min() >= 0 and triangles.max() < len(points):
            # Primitives share one set of points; those of the others are none of this one's.
            points, triangles = without_unused_vertices(points, triangles)
        return [PolygonSoup(points, triangles.ravel(), np.full(len(triangles), 3))]

    def accessor(self, index: int) -> NDArray:
        """(count, width) values; sparse ones filled in, normalised integers as numbers of -1 .. 1."""
        accessor = self.tree["accessors"][index]
        dtype, width = np.dtype(_TYPES[accessor["componentType"]]), _WIDTHS[accessor["type"]]
        count = accessor["count"]
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
        if accessor.get("normalized") and dtype.kind in "iu":
            return np.maximum(values / np.iinfo(dtype).max, -1.0)
        return values

    def view(self, source: dict[str, Any], dtype: np.dtype, count: int, width: int) -> NDArray:
        """(count, width) values from a buffer view."""
        view = self.tree["bufferViews"][source["bufferView"]]
        buffer = self.buffers[view["buffer"]]
        offset = source.get("byteOffset", 0)
        stride = view.get("byteStride", dtype.itemsize * width)
        needed = offset + (count - 1) * stride + width * dtype.itemsize if count else 0
        start = view.get("byteOffset", 0)
        if (
            min(count, offset, start) < 0
            or needed > view["byteLength"]
            or start + view["byteLength"] > len(buffer)
        ):
            raise UnreadableError("truncated: it refers to data that is not there")
        return np.ndarray((count, width), dtype, buffer, start + offset, (stride, dtype.itemsize))

    def buffer(self, index: int) -> bytes:
        """A buffer's bytes: the binary chunk, a data URI, or a file beside the document."""
        buffer = self.tree["buffers"][index]
        own = self.chunk if index == 0 else None
        data = self.fetched(buffer["uri"]) if "uri" in buffer else own
        if data is None or len(data) < buffer["byteLength"]:
            raise UnreadableError("truncated: a buffer is shorter than it announces")
        return data

    def fetched(self, uri: str) -> bytes:
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
        try:
            return (self.folder / name).read_bytes()
        except OSError:
            raise UnreadableError(f"the file {name} with its data is missing") from None


def _triangles(corners: Ints, mode: int) -> Ints:
    if mode == _STRIP:
        return strips(corners)
    if mode == _FAN:
        return np.column_stack([np.full(max(len(corners) - 2, 0), corners[:1]), corners[1:-1], corners[2:]])
    if len(corners) % 3:
        raise UnreadableError("truncated: a triangle has fewer than three corners")
    return corners.reshape(-1, 3)


def _matrix(node: dict[str, Any]) -> Floats:
    """A node's transformation: its matrix, or translation times rotation times scale."""
    if "matrix" in node:
        return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    matrix = np.eye(4)
    x, y, z, w = np.array(node.get("rotation", (0, 0, 0, 1)), dtype=np.float64)
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix[:3, :3] = rotation * np.array(node.get("scale", (1, 1, 1)), dtype=np.float64)
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix
