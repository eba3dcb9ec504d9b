"""PLY files as they are found in the wild, and as they must not be."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from tests.core import meshfiles, shapes

from idviewer.core.io.ply import read_ply
from idviewer.core.io.text import UnreadableError

TETRAHEDRON = shapes.tetrahedron()
POINTS = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
FACES = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"


def ply(body: str, *header: str, form: str = "ascii") -> bytes:
    return ("\n".join(["ply", f"format {form} 1.0", *header, "end_header"]) + "\n" + body).encode("latin-1")


VERTEX = ("element vertex 4", "property float x", "property float y", "property float z")
FACE = ("element face 4", "property list uchar int vertex_indices")


PLY_VARIANTS = {
    "plain": ply(POINTS + FACES, *VERTEX, *FACE),
    "the other name": ply(
        POINTS + FACES, *VERTEX, "element face 4", "property list uint8 uint32 vertex_index"
    ),
    "faces first": ply(FACES + POINTS, *FACE, *VERTEX),
    "comments and more": ply(
        POINTS + FACES, "comment TextureFile nowhere.png", "obj_info none", *VERTEX, *FACE
    ),
    "other properties of vertices": ply(
        POINTS.replace("\n", " 7 8\n") + FACES,
        *VERTEX,
        "property uchar red",
        "property double quality",
        *FACE,
    ),
    "coordinates in another order": ply(
        "9 0 0 0\n9 0 0 1\n9 0 1 0\n9 1 0 0\n" + FACES,
        "element vertex 4",
        *("property float w", "property float z", "property double y", "property short x"),
        *FACE,
    ),
    "other properties of faces": ply(
        POINTS + "1 3 0 2 1 5\n2 3 0 1 3 5\n3 3 0 3 2 5\n4 3 1 2 3 5\n",
        *(*VERTEX, "element face 4", "property int flags", FACE[1], "property uchar red"),
    ),
    "texture coordinates of faces, some without": ply(
        POINTS + "3 0 2 1 6 1 2 3 4 5 6\n3 0 1 3 0\n3 0 3 2 6 1 2 3 4 5 6\n3 1 2 3 0\n",
        *(*VERTEX, *FACE, "property list uchar float texcoord"),
    ),
    "edges and unknown elements": ply(
        POINTS + "0 1\n1 2\n" + FACES + "5\n6\n",
        *(*VERTEX, "element edge 2", "property int vertex1", "property int vertex2", *FACE),
        *("element thing 2", "property float size", "element nothing 0", "property float size"),
    ),
    "Windows": ply(POINTS + FACES, *VERTEX, *FACE).replace(b"\n", b"\r\n"),
    "old Mac": ply(POINTS + FACES, *VERTEX, *FACE).replace(b"\n", b"\r"),
    "one long line": ply((POINTS + FACES).replace("\n", " ") + "\n", *VERTEX, *FACE),
    "binary, bytes and shorts": meshfiles.ply_binary(*TETRAHEDRON, length="ushort"),
    "binary, big-endian": meshfiles.ply_binary(*TETRAHEDRON, order=">"),
    "binary, big-endian, shorts": meshfiles.ply_binary(*TETRAHEDRON, order=">", length="ushort"),
    "binary, Windows": meshfiles.ply_binary(*TETRAHEDRON).replace(b"\n", b"\r\n"),
    "binary, a newline at the end": meshfiles.ply_binary(*TETRAHEDRON) + b"\r\n",
}


@pytest.mark.parametrize("data", PLY_VARIANTS.values(), ids=list(PLY_VARIANTS))
def test_ply_variants(data):
    assert meshfiles.is_tetrahedron(read_ply(data).geometry)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("length", ["uchar", "ushort", "int"])
def test_binary_ply_with_polygons_of_several_sizes(order, length):
    vertices, polygons = shapes.extruded(shapes.L_OUTLINE)
    read = read_ply(meshfiles.ply_binary(vertices, polygons, order, length)).geometry
    assert np.array_equal(read.vertices, vertices)
    assert read.sizes.tolist() == [6, 6, 4, 4, 4, 4, 4, 4]
    assert read.corners.tolist() == [corner for polygon in polygons for corner in polygon]


def test_binary_ply_with_scalars_around_lists_of_several_sizes():
    header = (
        *VERTEX,
        "element face 3",
        "property uchar red",
        FACE[1],
        "property list int short more",
        "property double q",
    )
    body = struct.pack("<12f", *TETRAHEDRON[0].ravel())
    for corners, more in (([0, 2, 1], []), ([0, 1, 3], [7, 8]), ([1, 2, 3, 0], [9])):
        body += struct.pack(f"<BB{len(corners)}i", 200, len(corners), *corners)
        body += struct.pack(f"<i{len(more)}hd", len(more), *more, 0.5)
    read = read_ply(ply("", *header, form="binary_little_endian") + body).geometry
    assert np.array_equal(read.vertices, TETRAHEDRON[0])
    assert read.sizes.tolist() == [3, 3, 4]
    assert read.corners.tolist() == [0, 2, 1, 0, 1, 3, 1, 2, 3, 0]


def test_ply_triangle_strips():
    strips = "9 0 1 2 3 -1 0 3 1 2\n"
    read = read_ply(
        ply(POINTS + strips, *VERTEX, "element tristrips 1", "property list int int vertex_indices")
    ).geometry
    assert read.corners.reshape(-1, 3).tolist() == [[0, 1, 2], [2, 1, 3], [0, 3, 1], [1, 3, 2]]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"plyx\n", "does not begin with ply"),
        (ply("", *VERTEX, *FACE)[:-4], "header does not end"),
        (ply("", "element vertex x"), "a line that means nothing: 'element vertex x'"),
        (ply("", "property float x"), "a line that means nothing"),
        (ply("", "element vertex 1", "property quad x"), "a type that means nothing: 'quad'"),
        (ply("", *VERTEX, form="binary_middle_endian"), "a line that means nothing"),
        (b"ply\nelement vertex 0\nend_header\n", "names no format"),
        (ply("", "element point 0", "property float x"), "no vertices with x, y and z"),
        (ply(POINTS + FACES[:-2] + "\n", *VERTEX, *FACE), "it announces 4 records 'face' and holds 3"),
        (ply(POINTS[:-4] + "\n", *VERTEX, "element face 0"), "it announces 4 records 'vertex' and holds 3"),
        (ply(POINTS + FACES + "3 0 1 2\n", *VERTEX, *FACE), "it holds more faces than its header"),
        (ply(FACES + POINTS[:-1], *FACE, *VERTEX), "ends in the middle of a vertex"),
        (ply(POINTS + FACES.replace("3 2\n", "3 2.5\n"), *VERTEX, *FACE), "no whole number"),
        (ply(POINTS + FACES.replace("3 2\n", "3 two\n"), *VERTEX, *FACE), "'two' stands where a number"),
        (ply(POINTS + FACES.replace("3 1", "-3 1"), *VERTEX, *FACE), "truncated"),
        (ply(POINTS + FACES.replace("3 1", "nan 1"), *VERTEX, *FACE), "truncated"),
        (ply(POINTS + FACES, "element vertex 4000000000000", *VERTEX[1:], *FACE), "truncated"),
        (ply(POINTS, *VERTEX, "element face 4000000000000", FACE[1]), "truncated"),
        (meshfiles.ply_binary(*TETRAHEDRON) + struct.pack("<B3i", 3, 0, 1, 2), "it holds more faces than"),
    ],
)
def test_ply_refusals(data, message):
    with pytest.raises(UnreadableError, match=message):
        read_ply(data)
