"""glTF files: transformations, instances, and every way of storing points and corners."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from tests.core import meshfiles, shapes

from idviewer.core.io.contents import FileSource
from idviewer.core.io.gltf import read_glb, read_gltf
from idviewer.core.io.meshes import read_mesh
from idviewer.core.io.text import UnreadableError
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.mesh_repair import repair_mesh
from idviewer.core.validation.polygon_soup import PolygonSoup, triangulated

TETRAHEDRON = shapes.tetrahedron()


def glb(tree: dict, buffer: bytes) -> PolygonSoup:
    return read_glb(FileSource(meshfiles.glb_of(tree, buffer), Path("a.glb"))).geometry


def glb_mesh(tree: dict, buffer: bytes) -> Mesh:
    return repair_mesh(*meshfiles.parts(glb(tree, buffer)))


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
    polygons = glb(tree, buffer)
    mesh = repair_mesh(*meshfiles.parts(polygons), component=1)
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
    assert glb(tree, buffer).corners.reshape(-1, 3).tolist() == expected


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
            read_gltf(FileSource(json.dumps(tree).encode(), tmp_path / "a.gltf"))
    tree["buffers"][0]["uri"] = "gone.bin"
    with pytest.raises(UnreadableError, match=r"the file gone\.bin with its data is missing"):
        read_gltf(FileSource(json.dumps(tree).encode(), tmp_path / "a.gltf"))


def _damaged_trees():
    def tree(change):
        document, buffer = meshfiles.gltf_tree(*TETRAHEDRON)
        change(document)
        return document, buffer

    yield tree(lambda t: t.update(extensionsRequired=["KHR_implicit_shapes"])), "KHR_implicit_shapes"
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
        glb(*arguments)


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
    polygons = read_glb(FileSource(data, Path("a.glb"))).geometry
    assert len(polygons.sizes) == len(expected.faces)
    points, faces = polygons.vertices, triangulated(polygons)
    middles, others = points[faces].mean(axis=1), expected.triangles.mean(axis=1)
    assert np.allclose(middles[np.lexsort(middles.T)], others[np.lexsort(others.T)], atol=1e-5)
