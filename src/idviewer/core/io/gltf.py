"""glTF 2.0 files, binary (GLB) and text: all triangles of the default scene, in the pose that is stored.

Nodes place their meshes; those with a skin are placed by its joints instead. Morph targets have their default
weights. Materials, images and animations are not looked at.
"""

from __future__ import annotations

import json
import re
import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints
from idviewer.core.errors import Part
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.gltf_data import GltfData, normalised
from idviewer.core.io.gltf_pose import joint_matrices, morphed, places_of, skinned
from idviewer.core.io.libraries import arrays_by
from idviewer.core.io.text import UnreadableError
from idviewer.core.validation.polygon_soup import PolygonSoup, strips
from idviewer.core.validation.soup_repairs import without_unused_vertices

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_DRACO = "KHR_draco_mesh_compression"
_UNDERSTOOD = ("KHR_mesh_quantization", "EXT_meshopt_compression", "KHR_meshopt_compression", _DRACO)
_HARMLESS = re.compile(
    r"[A-Z0-9]+_(materials|textures?|lights?|image|xmp|animation|audio|techniques|structural_metadata"
    r"|feature_metadata|mesh_features|instance_features)(_\w+|$)|VRMC?(_\w+|$)"
)
"""Extensions that tell how a shape looks, moves or is annotated, and not where it is."""

_METRES = "m"


def read_glb(source: FileSource) -> Contents[PolygonSoup]:
    """Read the polygons of a GLB file, of all its nodes together or of a chosen one.

    Args:
        source: the file.

    Raises:
        UnreadableError: it is no whole, consistent GLB file of version 2, or needs what is not supported.
        PartError: it has no such node.
    """
    data = source.data
    if data[:4] != b"glTF" or len(data) < 12:
        raise UnreadableError("it does not begin with glTF")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise UnreadableError(f"only version 2 is supported, not {version}")
    if length > len(data):
        raise UnreadableError(f"truncated: {length:,} bytes are announced, {len(data):,} are there")
    chunks, padded = _chunks(data[:length])
    notes = [f"{len(data) - length:,} bytes after its end were passed over."] if length < len(data) else []
    if padded:
        notes.append("Padding bytes between its chunks, or behind them, were passed over.")
    if b"JSON" not in chunks:
        raise UnreadableError("it holds no scene")
    tree = _json(chunks[b"JSON"].rstrip(b"\0 "))
    return _contents(tree, GltfData(tree, chunks.get(b"BIN\0"), None, len(data)), source, notes)


def read_gltf(source: FileSource) -> Contents[PolygonSoup]:
    """Read the polygons of a glTF file, of all its nodes together or of a chosen one.

    Args:
        source: the file; its buffers are looked for in its folder and below, nowhere else.

    Raises:
        UnreadableError: it is no whole, consistent glTF file of version 2, or needs what is not supported.
        PartError: it has no such node.
    """
    tree = _json(source.data)
    return _contents(tree, GltfData(tree, None, source.path.parent, len(source.data)), source, [])


def _chunks(data: bytes) -> tuple[dict[bytes, bytes], bool]:
    """The first chunk of every kind, and whether padding was met that no length counts."""
    chunks: dict[bytes, bytes] = {}
    place, padded = 12, False
    while place < len(data):
        rest = data[place:]
        gap = -place % 4
        if not rest.strip(b"\0 ") and len(rest) < 8:
            return chunks, True
        if gap and not rest[:gap].strip(b"\0 ") and rest[4:8] not in (b"JSON", b"BIN\0"):
            place, padded = place + gap, True
        if place + 8 > len(data):
            raise UnreadableError("truncated: a chunk is cut off")
        size, kind = struct.unpack_from("<I4s", data, place)
        place += 8 + size
        if place > len(data):
            raise UnreadableError("truncated: a chunk is cut off")
        chunks.setdefault(kind, data[place - size : place])
    return chunks, padded


def _json(data: bytes) -> Any:
    try:
        tree = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise UnreadableError(f"truncated or no JSON ({error})") from error
    if not isinstance(tree, dict) or "asset" not in tree:
        raise UnreadableError("it is no glTF document")
    if not str(tree["asset"].get("version", "")).startswith("2"):
        raise UnreadableError("only version 2 is supported")
    for extension in map(str, tree.get("extensionsRequired", [])):
        if extension not in _UNDERSTOOD and not _HARMLESS.match(extension):
            raise UnreadableError(f"it needs the extension {extension}, which is not supported")
    return tree


def _contents(
    tree: dict[str, Any], data: GltfData, source: FileSource, notes: list[str]
) -> Contents[PolygonSoup]:
    scene = _Scene(tree, data)
    nodes = scene.with_meshes()
    parts = tuple(Part(scene.name(node)) for node in nodes)
    if source.part is not None:
        chosen = source.chosen(parts, "nodes")
        nodes = nodes if chosen is None else [nodes[chosen]]
    soup = PolygonSoup.joined([piece for node in nodes for piece in scene.polygons(node)])
    return Contents(soup, (*notes, *scene.notes), _METRES, parts)


@dataclass
class _Scene:
    """The nodes of the scene that is shown first; of all root nodes if there is no scene."""

    tree: dict[str, Any]
    data: GltfData
    notes: dict[str, None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.nodes: list[dict[str, Any]] = self.tree.get("nodes", [])
        self.places = places_of(self.nodes)

    def with_meshes(self) -> list[int]:
        """Numbers of the nodes that have meshes, each before those below it."""
        scenes = self.tree.get("scenes", [])
        if scenes:
            roots = scenes[self.tree.get("scene", 0)].get("nodes", [])
        else:
            children = {child for node in self.nodes for child in node.get("children", [])}
            roots = [index for index in range(len(self.nodes)) if index not in children]
        waiting, found, seen = list(reversed(roots)), [], set()
        while waiting:
            index = waiting.pop()
            if index in seen:
                raise UnreadableError("a node hangs in two places, or below itself")
            seen.add(index)
            if "mesh" in self.nodes[index]:
                found.append(index)
            waiting += reversed(self.nodes[index].get("children", []))
        return found

    def name(self, index: int) -> str:
        node = self.nodes[index]
        return str(node.get("name") or self.tree["meshes"][node["mesh"]].get("name") or f"node {index}")

    def polygons(self, index: int) -> list[PolygonSoup]:
        """Those of one node."""
        node = self.nodes[index]
        mesh = self.tree["meshes"][node["mesh"]]
        if "EXT_mesh_gpu_instancing" in node.get("extensions", {}):
            raise UnreadableError("it needs the extension EXT_mesh_gpu_instancing, which is not supported")
        primitives = [
            one for one in mesh["primitives"] if one.get("mode", _TRIANGLES) in (_TRIANGLES, _STRIP, _FAN)
        ]
        unpacked = self.unpacked(primitives)
        weights = node.get("weights", mesh.get("weights", []))
        pose = None
        if "skin" in node:
            pose = joint_matrices(self.data, self.tree["skins"][node["skin"]], self.places)
            self.notes["Its skin is posed by its joints as they are stored."] = None
        pieces = []
        for number, primitive in enumerate(primitives):
            values = _Attributes(self.data, primitive, number, unpacked)
            points = values("POSITION").astype(np.float64)
            if points.shape[1:] != (3,):
                raise UnreadableError("its points do not have three coordinates")
            if any(weights) and primitive.get("targets"):
                points = morphed(self.data, points, primitive, weights)
                self.notes["Its morph targets have their default weights."] = None
            triangles = _triangles(values.corners(len(points)), primitive.get("mode", _TRIANGLES))
            pieces.append(self.placed(points, triangles, self.places[index], pose, values))
        return pieces

    def placed(
        self,
        points: Floats,
        triangles: Ints,
        place: Floats,
        pose: Floats | None,
        values: _Attributes,
    ) -> PolygonSoup:
        """One primitive where its joints, or else its node, put it."""
        self.data.take(points.nbytes + triangles.size * 4)
        if pose is not None and "JOINTS_0" in values:
            points = skinned(points, *values.joints(), pose)
            turned = np.mean(np.linalg.det(pose[:, :3, :3]) < 0) > 0.5
        else:
            points = points @ place[:3, :3].T + place[:3, 3]
            turned = np.linalg.det(place[:3, :3]) < 0
        if turned:  # a mirror turns the winding round
            triangles = triangles[:, ::-1]
        if triangles.size and triangles.min() >= 0 and triangles.max() < len(points):
            # Primitives share one set of points; those of the others are none of this one's.
            points, triangles = without_unused_vertices(points, triangles)
        return PolygonSoup(points, triangles.ravel(), np.full(len(triangles), 3))

    def unpacked(self, primitives: list[dict[str, Any]]) -> dict[str, NDArray]:
        """What Draco has compressed, of all primitives that have no plain data."""
        packed = {
            number: one["extensions"][_DRACO]
            for number, one in enumerate(primitives)
            if _DRACO in one.get("extensions", {}) and not self.is_plain(one["attributes"]["POSITION"])
        }
        if not packed:
            return {}
        blobs = [self.data.view_bytes(one["bufferView"]) for one in packed.values()]
        attributes = [list(one["attributes"].values()) for one in packed.values()]
        reason = "its meshes are compressed by Draco"
        made = arrays_by("DracoPy", "draco", blobs, attributes=attributes, reason=reason)
        self.data.take(sum(values.nbytes for values in made.values()))
        numbers = list(packed)
        renamed = {}
        for order, one in enumerate(packed.values()):
            renamed[f"{numbers[order]} corners"] = made[f"faces_{order}"].ravel()
            for name, identity in one["attributes"].items():
                renamed[f"{numbers[order]} {name}"] = made[f"{order}_{identity}"]
        return renamed

    def is_plain(self, index: int) -> bool:
        return bool({"bufferView", "sparse"} & self.tree["accessors"][index].keys())


@dataclass
class _Attributes:
    """The values of one primitive's vertices, plain or unpacked."""

    data: GltfData
    primitive: dict[str, Any]
    number: int
    unpacked: dict[str, NDArray]

    def __contains__(self, name: str) -> bool:
        return name in self.primitive["attributes"]

    def __call__(self, name: str) -> NDArray:
        index = self.primitive["attributes"][name]
        found = self.unpacked.get(f"{self.number} {name}")
        if found is None:
            return self.data.accessor(index)
        accessor = self.data.tree["accessors"][index]
        if len(found) != accessor["count"]:
            raise UnreadableError("its compressed data do not hold what is announced")
        return normalised(found.reshape(len(found), -1), bool(accessor.get("normalized")))

    def corners(self, points: int) -> Ints:
        """Vertex numbers of the triangles, strip or fan."""
        if f"{self.number} corners" in self.unpacked:
            return self.unpacked[f"{self.number} corners"].astype(np.int64)
        if "indices" in self.primitive:
            return self.data.accessor(self.primitive["indices"]).astype(np.int64).ravel()
        return np.arange(points)

    def joints(self) -> tuple[Ints, Floats]:
        """The joints (n, k) that move each vertex, and their weights."""
        sets = [number for number in range(len(self.primitive["attributes"])) if f"JOINTS_{number}" in self]
        joints = np.concatenate([self(f"JOINTS_{number}").astype(np.int64) for number in sets], axis=1)
        weights = np.concatenate([self(f"WEIGHTS_{number}").astype(np.float64) for number in sets], axis=1)
        return joints, weights


def _triangles(corners: Ints, mode: int) -> Ints:
    if mode == _STRIP:
        return strips(corners)
    if mode == _FAN:
        return np.column_stack([np.full(max(len(corners) - 2, 0), corners[:1]), corners[1:-1], corners[2:]])
    if len(corners) % 3:
        raise UnreadableError("truncated: a triangle has fewer than three corners")
    return corners.reshape(-1, 3)
