"""Writers of small mesh files for tests: (vertices, polygons) to bytes, one plain variant of every format."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.core import shapes

from idviewer.core.io.meshes import read_mesh
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.validation.polygon_soup import PolygonSoup

Vertices = NDArray[np.float64]
Faces = Iterable[Sequence[int]]


def _lines(rows: Iterable[Iterable[object]]) -> str:
    return "".join(" ".join(map(str, row)) + "\n" for row in rows)


def _numbers(vertices: Vertices) -> list[list[float]]:
    return np.asarray(vertices, dtype=np.float64).tolist()


def _faces(polygons: Faces) -> list[list[int]]:
    return [[int(corner) for corner in polygon] for polygon in polygons]


def off(vertices: Vertices, polygons: Faces) -> bytes:
    faces = _faces(polygons)
    head = f"OFF\n{len(vertices)} {len(faces)} 0\n"
    return (head + _lines(_numbers(vertices)) + _lines([len(face), *face] for face in faces)).encode()


def obj(vertices: Vertices, polygons: Faces) -> bytes:
    text = _lines(["v", *row] for row in _numbers(vertices))
    return (text + _lines(["f", *(corner + 1 for corner in face)] for face in _faces(polygons))).encode()


def _ply_header(form: str, vertices: int, faces: int, length: str = "uchar") -> bytes:
    return (
        f"ply\nformat {form} 1.0\ncomment made by a test\nelement vertex {vertices}\nproperty double x\n"
        f"property double y\nproperty double z\nelement face {faces}\n"
        f"property list {length} int vertex_indices\nend_header\n"
    ).encode()


def ply(vertices: Vertices, polygons: Faces) -> bytes:
    faces = _faces(polygons)
    text = _lines(_numbers(vertices)) + _lines([len(face), *face] for face in faces)
    return _ply_header("ascii", len(vertices), len(faces)) + text.encode()


def ply_binary(vertices: Vertices, polygons: Faces, order: str = "<", length: str = "uchar") -> bytes:
    faces = _faces(polygons)
    code = {"uchar": "B", "ushort": "H", "int": "i"}[length]
    body = [struct.pack(f"{order}3d", *row) for row in _numbers(vertices)]
    body += [struct.pack(f"{order}{code}{len(face)}i", len(face), *face) for face in faces]
    form = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    return _ply_header(form, len(vertices), len(faces), length) + b"".join(body)


def stl_text(vertices: Vertices, polygons: Faces) -> bytes:
    points = _numbers(vertices)
    facets = ""
    for face in _faces(polygons):
        corners = "".join(f"      vertex {_lines([points[corner]])}" for corner in face)
        facets += f"  facet normal 0 0 0\n    outer loop\n{corners}    endloop\n  endfacet\n"
    return f"solid facet of a test\n{facets}endsolid facet of a test\n".encode()


def stl(vertices: Vertices, polygons: Faces) -> bytes:
    faces = _faces(polygons)
    triangles = [struct.pack("<12fH", 0, 0, 0, *vertices[face].ravel(), 0) for face in faces]
    header = b"solid is how even binary ones may begin".ljust(80)
    return header + struct.pack("<I", len(faces)) + b"".join(triangles)


def gltf_tree(vertices: Vertices, polygons: Faces, **node: object) -> tuple[dict, bytes]:
    """A glTF document with one node, and its buffer: float32 points, uint16 indices."""
    points = np.asarray(vertices, dtype="<f4").tobytes()
    corners = np.array(_faces(polygons), dtype="<u2").ravel()
    buffer = points + corners.tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, **node}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}],
        "images": [{"uri": "https://nowhere.invalid/image.png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": len(corners), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": 2 * len(corners)},
        ],
        "buffers": [{"byteLength": len(buffer)}],
    }
    return tree, buffer


def glb_of(tree: dict, buffer: bytes) -> bytes:
    scene = json.dumps(tree).encode()
    scene += b" " * (-len(scene) % 4)
    buffer += b"\0" * (-len(buffer) % 4)
    chunks = (
        struct.pack("<I4s", len(scene), b"JSON") + scene + struct.pack("<I4s", len(buffer), b"BIN\0") + buffer
    )
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def glb(vertices: Vertices, polygons: Faces) -> bytes:
    return glb_of(*gltf_tree(vertices, polygons))


def gltf(vertices: Vertices, polygons: Faces) -> bytes:
    tree, buffer = gltf_tree(vertices, polygons)
    tree["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()
    return json.dumps(tree).encode()


def vtp(vertices: Vertices, polygons: Faces) -> bytes:
    faces = _faces(polygons)
    ends = np.cumsum([len(face) for face in faces]).tolist()
    return (
        '<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian">\n'
        "<PolyData>\n"
        f'<Piece NumberOfPoints="{len(vertices)}" NumberOfPolys="{len(faces)}">\n<Points>\n'
        '<DataArray type="Float64" NumberOfComponents="3" format="ascii">\n'
        f"{_lines(_numbers(vertices))}</DataArray>\n</Points>\n<Polys>\n"
        f'<DataArray type="Int64" Name="connectivity" format="ascii">\n{_lines(faces)}</DataArray>\n'
        f'<DataArray type="Int64" Name="offsets" format="ascii">\n{_lines([ends])}</DataArray>\n'
        "</Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n"
    ).encode()


WRITERS: dict[str, tuple[str, Callable[[Vertices, Faces], bytes]]] = {
    "off": (".off", off),
    "obj": (".obj", obj),
    "ply": (".ply", ply),
    "ply_binary": (".ply", ply_binary),
    "stl": (".stl", stl),
    "stl_text": (".stl", stl_text),
    "glb": (".glb", glb),
    "gltf": (".gltf", gltf),
}
"""Name of a variant -> suffix of its files, and the function that writes one."""


def outcome(path: Path) -> tuple[Mesh, None] | tuple[None, str]:
    """The mesh in a file, or the message of the error, which must name the file."""
    try:
        return read_mesh(path), None
    except MeshError as error:
        message = str(error)
    assert message.startswith(f"{path}: ")
    return None, message


def parts(polygons: PolygonSoup) -> tuple[Vertices, list[NDArray[np.int64]]]:
    """Vertices, and the corners of each polygon."""
    return polygons.vertices, np.split(polygons.corners, np.cumsum(polygons.sizes)[:-1])


def is_tetrahedron(polygons: PolygonSoup) -> bool:
    """Whether a reader has read `shapes.tetrahedron()` to the last bit."""
    vertices, faces = shapes.tetrahedron()
    same = np.array_equal(polygons.vertices, vertices) and np.array_equal(polygons.sizes, [3] * 4)
    return same and np.array_equal(polygons.corners.reshape(-1, 3), faces)


def write(folder: Path, suffix: str, data: bytes, stem: str = "thing") -> Path:
    """A file of these bytes."""
    path = folder / f"{stem}{suffix}"
    path.write_bytes(data)
    return path


def refusal(path: Path, **how: int) -> str:
    """The message of the error, which must be one line that begins with the path."""
    with pytest.raises(MeshError) as caught:
        read_mesh(path, **how)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    assert "\r" not in message
    assert message.isprintable()
    assert len(message) < len(str(path)) + 300
    return message.removeprefix(f"{path}: ")
