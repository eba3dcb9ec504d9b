"""What mesh files look like in the wild, format by format."""

from __future__ import annotations

import json
import struct
import warnings

import numpy as np
import pytest
import trimesh
from tests.core import meshfiles, shapes

from idviewer.core._polygons import Polygons, triangulated
from idviewer.core._readers import UnreadableError
from idviewer.core._readers.gltf import read_glb, read_gltf
from idviewer.core._readers.obj import read_obj
from idviewer.core._readers.off import read_off
from idviewer.core._readers.ply import read_ply
from idviewer.core._readers.stl import read_stl
from idviewer.core.io import read_mesh
from idviewer.core.mesh import Mesh
from idviewer.core.repair import repair

TETRAHEDRON = shapes.tetrahedron()
POINTS = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
FACES = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"


def is_tetrahedron(polygons: Polygons) -> bool:
    vertices, faces = TETRAHEDRON
    same = np.array_equal(polygons.vertices, vertices) and np.array_equal(polygons.sizes, [3] * 4)
    return same and np.array_equal(polygons.corners.reshape(-1, 3), faces)


# --- OFF

OFF_VARIANTS = {
    "plain": f"OFF\n4 4 6\n{POINTS}{FACES}",
    "counts beside OFF": f"OFF 4 4 6\n{POINTS}{FACES}",
    "two counts": f"OFF\n4 4\n{POINTS}{FACES}",
    "comments": f"# made by hand\n\nOFF # text\n# sizes\n4 4 0 # all\n\n{POINTS}\n# faces\n{FACES}\n# end",
    "colours": f"COFF\n4 4 0\n{POINTS.replace(chr(10), ' 255 0 0 255' + chr(10))}{FACES}",
    "normals": f"NOFF\n4 4 0\n{POINTS.replace(chr(10), ' 0.1 0.2 0.3' + chr(10))}{FACES}",
    "all of them": f"STCNOFF\n4 4 0\n{POINTS.replace(chr(10), ' 1 2 3 4 5 6 7 8 9' + chr(10))}{FACES}",
    "coloured faces": f"OFF\n4 4 0\n{POINTS}3 0 2 1 0.5 0.5 0.5\n3 0 1 3 7\n3 0 3 2\n3 1 2 3 1 0 0 1\n",
    "Windows": f"OFF\n4 4 0\n{POINTS}{FACES}".replace("\n", "\r\n"),
    "old Mac": f"OFF\n4 4 0\n{POINTS}{FACES}".replace("\n", "\r"),
    "byte order mark": f"\ufeffOFF\n4 4 0\n{POINTS}{FACES}",
    "indented": f"  OFF\n 4   4\t0\n{POINTS}{FACES}".replace("\n", " \n\t"),
}


@pytest.mark.parametrize("text", OFF_VARIANTS.values(), ids=list(OFF_VARIANTS))
def test_off_variants(text):
    assert is_tetrahedron(read_off(text.encode()))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"OFF BINARY\n4 4 0\n{POINTS}{FACES}", "binary OFF is not supported"),
        (f"4OFF\n4 4 0\n{POINTS}{FACES}", "three dimensions"),
        (f"nOFF\n3\n4 4 0\n{POINTS}{FACES}", "three dimensions"),
        (f"OFX\n4 4 0\n{POINTS}{FACES}", "does not begin with OFF"),
        ("OFF\n", "nothing follows OFF"),
        (f"OFF\n4\n{POINTS}{FACES}", "numbers of vertices and faces"),
        (f"OFF\n4 -4 0\n{POINTS}{FACES}", "numbers of vertices and faces"),
        (f"OFF\n99 4 0\n{POINTS}{FACES}", "truncated: it announces 99 vertices and holds 8"),
        (f"OFF\n4 5 0\n{POINTS}{FACES}", "truncated: it announces 5 faces and holds 4"),
        (f"OFF\n4 3 0\n{POINTS}{FACES}", "wrong counts: it announces 3 faces and holds more"),
        (f"OFF\n4 4 0\n{POINTS}{FACES}".replace("3 1 2 3", "4 1 2 3"), "fewer corners than it announces"),
        (f"OFF\n4 4 0\n{POINTS}{FACES}".replace("3 1 2 3", "3 1 2 x"), "'x' stands where a vertex number"),
        (f"OFF\n4 4 0\n{POINTS}{FACES}".replace("1 0 0", "1 0 O"), "'O' stands where a number"),
        (f"OFF\n4 4 0\n{POINTS}{FACES}".replace("1 0 0", "1 0"), "fewer than three coordinates"),
        (f"OFF\n4 4 0\n{POINTS}{FACES}".replace("3 1 2 3", "3 1 2 99999999999999999999"), "vertex number"),
    ],
)
def test_off_refusals(text, message):
    with pytest.raises(UnreadableError, match=message):
        read_off(text.encode())


# --- OBJ

OBJ_POINTS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
OBJ_FACES = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
EXTRAS = "vt 0 0\nvt 1 1\nvn 0 0 1\n"

OBJ_VARIANTS = {
    "plain": OBJ_POINTS + OBJ_FACES,
    "no last newline": (OBJ_POINTS + OBJ_FACES)[:-1],
    "materials, groups, smoothing": "mtllib nowhere.mtl\no thing\n"
    + OBJ_POINTS
    + "usemtl red\ng a b\ns 1\n"
    + OBJ_FACES,
    "texture indices": OBJ_POINTS + EXTRAS + "f 1/1 3/2 2/1\nf 1/2 2/2 4/1\nf 1/1 4/1 3/1\nf 2/1 3/2 4/2\n",
    "normal indices": OBJ_POINTS
    + EXTRAS
    + "f 1//1 3//1 2//1\nf 1//1 2//1 4//1\nf 1//1 4//1 3//1\nf 2//1 3//1 4//1\n",
    "all indices": OBJ_POINTS
    + EXTRAS
    + "f 1/1/1 3/2/1 2/1/1\nf 1/1/1 2/1/1 4/1/1\nf 1/1/1 4/1/1 3/1/1\nf 2/1/1 3/1/1 4/2/1\n",
    "mixed indices": OBJ_POINTS + EXTRAS + "f 1/1/1 3//1 2/1\nf 1 2 4\nf 1/ 4/ 3/\nf 2/1/ 3 4\n",
    "negative indices": OBJ_POINTS + "f -4 -2 -3\nf -4 -3 -1\nf -4 -1 -2\nf -3 -2 -1\n",
    "indices counting back": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -1 -2\nv 0 0 1\nf 1 2 -1\nf 1 4 -2\nf 2 3 4\n",
    "faces first": OBJ_FACES + OBJ_POINTS,
    "objects": OBJ_POINTS + "o one\nf 1 3 2\nf 1 2 4\no two\nf 1 4 3\ng three\nf 2 3 4\n",
    "colours": OBJ_POINTS.replace("\n", " 0.5 0.5 0.5\n") + OBJ_FACES,
    "some colours": OBJ_POINTS.replace("v 1 0 0", "v 1 0 0 0.5 0.5 0.5") + OBJ_FACES,
    "weights": OBJ_POINTS.replace("\n", " 1.0\n") + OBJ_FACES,
    "comments": "# v 9 9 9\n" + OBJ_POINTS.replace("\n", " # a vertex\n") + "#f 1 2 3\n" + OBJ_FACES,
    "a comment in another alphabet": "# \u00c5 \u2026\x85f 1 2 3\n" + OBJ_POINTS + OBJ_FACES,
    "continued lines": OBJ_POINTS.replace("v 1 0 0", "v 1 \\\n 0 0")
    + OBJ_FACES.replace("f 1 4 3", "f 1 \\\n 4 \\\n 3"),
    "Windows": (OBJ_POINTS + OBJ_FACES).replace("\n", "\r\n"),
    "tabs and spaces": (" " + OBJ_POINTS + OBJ_FACES)
    .replace("v ", "v\t ")
    .replace("f ", "f\t")
    .replace("\n", " \n  "),
    "lines and points too": OBJ_POINTS + "l 1 2 3\np 4\n" + OBJ_FACES,
    "curves too": OBJ_POINTS + "vp 0.1 0.2\ncstype bezier\ndeg 3\n" + OBJ_FACES,
    "exponents": OBJ_POINTS.replace("1", "+1.0E+00") + OBJ_FACES,
}


@pytest.mark.parametrize("text", OBJ_VARIANTS.values(), ids=list(OBJ_VARIANTS))
def test_obj_variants(text):
    assert is_tetrahedron(read_obj(text.encode()))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("f 1 2 3\n", "it holds no vertices"),
        (OBJ_POINTS.replace("v 1 0 0", "v 1 0") + OBJ_FACES, "fewer than three coordinates"),
        (OBJ_POINTS.replace("v 1 0 0", "v 1 0 zero") + OBJ_FACES, "'zero' stands where a number"),
        (OBJ_POINTS + OBJ_FACES.replace("f 1 4 3", "f 1 4 c"), "'c' stands where a vertex number"),
        (OBJ_POINTS + OBJ_FACES.replace("f 1 4 3", "f 1 4 3.5"), "'3.5' stands where a vertex number"),
        (OBJ_POINTS + OBJ_FACES.replace("f 1 4 3", "f 1 4 /3"), "'' stands where a vertex number"),
        (OBJ_FACES + OBJ_POINTS[:-1], "ends in the middle of a vertex"),
        (OBJ_POINTS + "\0" + OBJ_FACES, "binary data"),
    ],
)
def test_obj_refusals(text, message):
    with pytest.raises(UnreadableError, match=message):
        read_obj(text.encode())


@pytest.mark.parametrize("index", ["0", "5", "-5", "-99"])
def test_obj_indices_out_of_range_stay_out_of_range(index):
    polygons = read_obj((OBJ_POINTS + OBJ_FACES.replace("f 1 4 3", f"f 1 4 {index}")).encode())
    assert np.count_nonzero((polygons.corners < 0) | (polygons.corners >= 4)) == 1


def test_obj_with_polygons_of_every_size():
    vertices, polygons = shapes.extruded(shapes.L_OUTLINE)
    mixed = [*polygons[:5], polygons[5][:3], [polygons[5][0], *polygons[5][2:]], *polygons[6:]]
    mesh = repair(*_parts(read_obj(meshfiles.obj(vertices, mixed))))
    assert mesh.volume == pytest.approx(3.0)


def _parts(polygons: Polygons):
    return polygons.vertices, np.split(polygons.corners, np.cumsum(polygons.sizes)[:-1])


# --- PLY


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
    assert is_tetrahedron(read_ply(data))


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("length", ["uchar", "ushort", "int"])
def test_binary_ply_with_polygons_of_several_sizes(order, length):
    vertices, polygons = shapes.extruded(shapes.L_OUTLINE)
    read = read_ply(meshfiles.ply_binary(vertices, polygons, order, length))
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
    read = read_ply(ply("", *header, form="binary_little_endian") + body)
    assert np.array_equal(read.vertices, TETRAHEDRON[0])
    assert read.sizes.tolist() == [3, 3, 4]
    assert read.corners.tolist() == [0, 2, 1, 0, 1, 3, 1, 2, 3, 0]


def test_ply_triangle_strips():
    strips = "9 0 1 2 3 -1 0 3 1 2\n"
    read = read_ply(
        ply(POINTS + strips, *VERTEX, "element tristrips 1", "property list int int vertex_indices")
    )
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
        (ply(POINTS + FACES + "1\n", *VERTEX, *FACE), "more follows than its header announces"),
        (ply(FACES + POINTS[:-1], *FACE, *VERTEX), "ends in the middle of a vertex"),
        (ply(POINTS + FACES.replace("3 2\n", "3 2.5\n"), *VERTEX, *FACE), "no whole number"),
        (ply(POINTS + FACES.replace("3 2\n", "3 two\n"), *VERTEX, *FACE), "'two' stands where a number"),
        (ply(POINTS + FACES.replace("3 1", "-3 1"), *VERTEX, *FACE), "truncated"),
        (ply(POINTS + FACES.replace("3 1", "nan 1"), *VERTEX, *FACE), "truncated"),
        (ply(POINTS + FACES, "element vertex 4000000000000", *VERTEX[1:], *FACE), "truncated"),
        (ply(POINTS, *VERTEX, "element face 4000000000000", FACE[1]), "truncated"),
        (meshfiles.ply_binary(*TETRAHEDRON) + b"x", "more follows than its header announces"),
    ],
)
def test_ply_refusals(data, message):
    with pytest.raises(UnreadableError, match=message):
        read_ply(data)


# --- STL


def test_stl_text_variants():
    plain = meshfiles.stl_text(*TETRAHEDRON)
    whole = read_stl(plain).vertices
    assert np.array_equal(whole, TETRAHEDRON[0][TETRAHEDRON[1]].reshape(-1, 3))
    facets = plain.split(b"endfacet")
    two = (
        b"endfacet".join(facets[:2])
        + b"endfacet\nendsolid\n\nsolid two facet\n"
        + b"endfacet".join(facets[2:])
    )
    for variant in (
        plain.upper(),
        plain.replace(b"\n", b"\r\n"),
        plain.replace(b"\n", b"\r"),
        b" \n" + plain,
        two,
    ):
        assert np.array_equal(read_stl(variant).vertices, whole)


def test_stl_binary_may_begin_with_solid():
    data = meshfiles.stl(*TETRAHEDRON)
    assert data.startswith(b"solid")
    assert np.array_equal(read_stl(data).vertices, TETRAHEDRON[0][TETRAHEDRON[1]].reshape(-1, 3))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (meshfiles.stl(*TETRAHEDRON)[:60], "a facet is not|shorter than the header|solids begin"),
        (meshfiles.stl(*TETRAHEDRON)[:-50], "truncated: it announces 4 triangles and holds 3"),
        (meshfiles.stl(*TETRAHEDRON)[:-1], "truncated: it announces 4 triangles and holds 3"),
        (meshfiles.stl(*TETRAHEDRON) + b"xyz", "wrong counts: it announces 4 triangles and holds more"),
        (meshfiles.stl_text(*TETRAHEDRON).replace(b"endsolid", b""), "1 solids begin, 0 end"),
        (meshfiles.stl_text(*TETRAHEDRON).replace(b"vertex 0", b"vertex", 1), "a facet is not"),
        (meshfiles.stl_text(*TETRAHEDRON).replace(b"vertex 0.0", b"vertex zero", 1), "'zero' stands where"),
    ],
)
def test_stl_refusals(data, message):
    with pytest.raises(UnreadableError, match=message):
        read_stl(data)


# --- glTF


def glb_mesh(tree: dict, buffer: bytes) -> Mesh:
    return repair(*_parts(read_glb(meshfiles.glb_of(tree, buffer))))


def test_gltf_transformations_are_applied():
    angle = np.pi / 6
    turn = [0.0, 0.0, float(np.sin(angle)), float(np.cos(angle))]
    tree, buffer = meshfiles.gltf_tree(*TETRAHEDRON, translation=[1, 2, 3], rotation=turn, scale=[2, 3, 4])
    tree["nodes"] += [{"children": [0], "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 0, 0, 1]}]
    tree["scenes"] = [{"nodes": [1]}]
    mesh = glb_mesh(tree, buffer)
    c, s = np.cos(2 * angle), np.sin(2 * angle)
    inner = TETRAHEDRON[0] * [2, 3, 4] @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T + [1, 2, 3]
    assert np.allclose(mesh.vertices, 2 * inner + [5, 0, 0], rtol=0, atol=1e-12)
    assert mesh.volume == pytest.approx(8 * 24 / 6)


def test_gltf_mirrored_nodes_keep_their_outside():
    mesh = glb_mesh(*meshfiles.gltf_tree(*TETRAHEDRON, scale=[-1, 1, 1]))
    assert mesh.notes == ()
    assert mesh.bounds.tolist() == [[-1, 0, 0], [0, 1, 1]]


def test_gltf_instances_primitives_and_other_scenes():
    tree, buffer = meshfiles.gltf_tree(*shapes.cube())
    corners = tree["accessors"][1]
    # Two primitives share the points; each holds half of the faces.
    # The mesh hangs in three nodes, two in the scene.
    tree["accessors"][1:] = [{**corners, "count": 18}, {**corners, "count": 18, "byteOffset": 36}]
    attributes = {"POSITION": 0}
    tree["meshes"][0]["primitives"] = [{"attributes": attributes, "indices": i} for i in (1, 2)]
    tree["meshes"][0]["primitives"].append({"attributes": attributes, "mode": 1})
    tree["nodes"] = [
        {"mesh": 0, "translation": [5, 0, 0]},
        {"mesh": 0},
        {"mesh": 0, "translation": [9, 0, 0]},
    ]
    tree |= {"scenes": [{"nodes": [1]}, {"nodes": [0, 2]}], "scene": 1}
    polygons = read_glb(meshfiles.glb_of(tree, buffer))
    mesh = repair(*_parts(polygons), component=1)
    assert mesh.volume == pytest.approx(1.0)
    assert mesh.bounds[0, 0] == 5
    assert mesh.notes[-1] == "Component 1 of 2 (12 of 24 faces) was taken."
    assert not any("isolated" in note for note in mesh.notes)


@pytest.mark.parametrize(
    ("mode", "corners", "expected"),
    [
        (5, [0, 1, 2, 3], [[0, 1, 2], [2, 1, 3]]),
        (6, [0, 1, 2, 3], [[0, 1, 2], [0, 2, 3]]),
        (4, [0, 2, 1, 0, 1, 3], [[0, 2, 1], [0, 1, 3]]),
        (1, [0, 1, 2, 3], []),
    ],
)
def test_gltf_strips_fans_and_lines(mode, corners, expected):
    tree, buffer = meshfiles.gltf_tree(TETRAHEDRON[0], [corners])
    tree["meshes"][0]["primitives"][0]["mode"] = mode
    assert read_glb(meshfiles.glb_of(tree, buffer)).corners.reshape(-1, 3).tolist() == expected


def test_gltf_without_indices_takes_the_points_in_their_order():
    tree, buffer = meshfiles.gltf_tree(*shapes.soup(TETRAHEDRON))
    del tree["meshes"][0]["primitives"][0]["indices"]
    assert glb_mesh(tree, buffer).volume == pytest.approx(1 / 6)


def test_gltf_strided_normalised_and_sparse_values():
    vertices, faces = shapes.cube()
    tree, buffer = meshfiles.gltf_tree(vertices, faces)
    # 16-bit normalised points, eight bytes apart; one of them is wrong and put right by a sparse value.
    points = np.zeros((8, 4), "<i2")
    points[:, :3] = vertices * 32767
    points[7, :3] = 0
    tree["accessors"][0] = {
        **{"bufferView": 2, "componentType": 5122, "normalized": True, "count": 8, "type": "VEC3"},
        "sparse": {
            "count": 1,
            "indices": {"bufferView": 3, "componentType": 5121},
            "values": {"bufferView": 3, "byteOffset": 2},
        },
    }
    start = len(buffer)
    buffer += points.tobytes() + b"\7\0" + np.full(3, 32767, "<i2").tobytes()
    tree["bufferViews"] += [
        {"buffer": 0, "byteOffset": start, "byteLength": 64, "byteStride": 8},
        {"buffer": 0, "byteOffset": start + 64, "byteLength": 8},
    ]
    tree["buffers"][0]["byteLength"] = len(buffer)
    tree["extensionsRequired"] = ["KHR_mesh_quantization"]
    mesh = glb_mesh(tree, buffer)
    assert np.array_equal(mesh.vertices, vertices)


def test_gltf_with_its_data_in_a_file_beside_it(tmp_path):
    tree, buffer = meshfiles.gltf_tree(*shapes.cube())
    (tmp_path / "the data").mkdir()
    (tmp_path / "the data" / "cube.bin").write_bytes(buffer)
    tree["buffers"][0]["uri"] = "the%20data/cube.bin"
    path = tmp_path / "cube.gltf"
    path.write_text(json.dumps(tree))
    assert read_mesh(path).volume == pytest.approx(1.0)
    for uri in ("../cube.bin", "/etc/passwd", "https://nowhere.invalid/cube.bin", "file:cube.bin"):
        tree["buffers"][0]["uri"] = uri
        with pytest.raises(UnreadableError, match="keeps its data elsewhere"):
            read_gltf(json.dumps(tree).encode(), tmp_path)
    tree["buffers"][0]["uri"] = "gone.bin"
    with pytest.raises(UnreadableError, match=r"the file gone\.bin with its data is missing"):
        read_gltf(json.dumps(tree).encode(), tmp_path)


def _damaged_trees():
    def tree(change):
        document, buffer = meshfiles.gltf_tree(*TETRAHEDRON)
        change(document)
        return document, buffer

    yield (
        tree(lambda t: t.update(extensionsRequired=["KHR_draco_mesh_compression"])),
        "KHR_draco_mesh_compression",
    )
    yield tree(lambda t: t["asset"].update(version="1.0")), "only version 2"
    yield tree(lambda t: t.pop("asset")), "no glTF document"
    yield tree(lambda t: t["nodes"][0].update(children=[0])), "hangs in two places"
    yield tree(lambda t: t["accessors"][0].pop("bufferView")), "compressed by an extension"
    yield tree(lambda t: t["accessors"][0].update(count=99)), "data that is not there"
    yield tree(lambda t: t["accessors"][0].update(byteOffset=-4)), "data that is not there"
    yield tree(lambda t: t["bufferViews"][1].update(byteLength=999)), "data that is not there"
    yield tree(lambda t: t["buffers"][0].update(byteLength=999)), "a buffer is shorter"
    yield tree(lambda t: t["accessors"][0].update(type="VEC2")), "three coordinates"
    yield tree(lambda t: t["accessors"][1].update(count=11)), "fewer than three corners"


@pytest.mark.parametrize(("arguments", "message"), list(_damaged_trees()))
def test_gltf_refusals(arguments, message):
    with pytest.raises(UnreadableError, match=message):
        read_glb(meshfiles.glb_of(*arguments))


# --- what trimesh writes, and reads as we do


@pytest.mark.parametrize(
    ("suffix", "how"),
    [
        ("off", {}),
        ("obj", {}),
        ("ply", {}),
        ("ply", {"encoding": "ascii"}),
        ("stl", {}),
        ("stl_ascii", {}),
        ("glb", {}),
    ],
)
def test_files_written_by_trimesh(tmp_path, suffix, how):
    vertices, faces = shapes.torus()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        data = trimesh.Trimesh(vertices, faces, process=False).export(file_type=suffix, **how)
    path = tmp_path / f"ring.{suffix[:3]}"
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    mesh = read_mesh(path)
    assert mesh.volume == pytest.approx(Mesh(vertices, faces).volume, rel=1e-6)
    assert len(mesh.faces) == len(faces)


def test_a_scene_written_by_trimesh_comes_out_where_trimesh_puts_it():
    rng = np.random.default_rng(2)
    scene = trimesh.Scene()
    parent = None
    for index in range(3):
        matrix = trimesh.transformations.random_rotation_matrix(rng.random(3))
        matrix[:3, :3] *= 1 + index
        matrix[:3, 3] = rng.standard_normal(3)
        part = trimesh.Trimesh(*shapes.l_shape(), process=False)
        parent = scene.add_geometry(
            part, transform=matrix, parent_node_name=parent, node_name=f"part {index}"
        )
    data = scene.export(file_type="glb")
    expected = scene.to_mesh()
    polygons = read_glb(data)
    assert len(polygons.sizes) == len(expected.faces)
    points, faces = polygons.vertices, triangulated(polygons)
    middles, others = points[faces].mean(axis=1), expected.triangles.mean(axis=1)
    assert np.allclose(middles[np.lexsort(middles.T)], others[np.lexsort(others.T)], atol=1e-5)
