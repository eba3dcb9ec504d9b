"""glTF files whose meshes are posed by joints and morph targets: where they are shown, by a slow twin."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.core import meshfiles, shapes

from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.gltf import read_glb
from idviewer.core.io.text import UnreadableError

BODY = shapes.l_shape()


def contents(tree: dict, buffer: bytes) -> Contents:
    return read_glb(FileSource(meshfiles.glb_of(tree, buffer), Path("a.glb")))


def with_values(
    tree: dict, buffer: bytes, values: np.ndarray, kind: str, **more: object
) -> tuple[int, bytes]:
    """One more accessor."""
    code = {"f4": 5126, "u1": 5121, "u2": 5123, "i2": 5122}[values.dtype.str[1:]]
    buffer += bytes(-len(buffer) % 4)
    tree["bufferViews"].append({"buffer": 0, "byteOffset": len(buffer), "byteLength": values.nbytes})
    view = len(tree["bufferViews"]) - 1
    tree["accessors"].append(
        {"bufferView": view, "componentType": code, "count": len(values), "type": kind, **more}
    )
    buffer += values.tobytes()
    tree["buffers"][0]["byteLength"] = len(buffer)
    return len(tree["accessors"]) - 1, buffer


def turned(axis: int, angle: float) -> list[float]:
    return [*(np.eye(3)[axis] * np.sin(angle / 2)).tolist(), float(np.cos(angle / 2))]


def skeleton(rng, weight_type: str, sets: int = 1, inverse: bool = True):
    """The body on a chain of three joints under a moved root, hanging in a node that is moved, too."""
    tree, buffer = meshfiles.gltf_tree(*BODY, translation=[7, 8, 9], scale=[3, 3, 3], skin=0)
    tree["nodes"] += [
        {"name": "root", "translation": [1, 2, 3], "rotation": turned(2, 0.4), "children": [0, 2]},
        {"translation": [0.5, 0, 0], "rotation": turned(0, 0.7), "scale": [1, 2, 1], "children": [3]},
        {"translation": [0, 0.5, 0], "rotation": turned(1, -0.3), "children": [4]},
        {"translation": [0, 0, 0.5]},
    ]
    tree["scenes"] = [{"nodes": [1]}]
    count = len(BODY[0])
    attributes = tree["meshes"][0]["primitives"][0]["attributes"]
    joints = rng.integers(0, 3, (count, 4 * sets))
    weights = rng.random((count, 4 * sets))
    weights /= weights.sum(axis=1, keepdims=True)
    if weight_type != "f4":
        weights = np.rint(weights * np.iinfo(weight_type).max)
    for number in range(sets):
        four = slice(4 * number, 4 * number + 4)
        place, buffer = with_values(tree, buffer, joints[:, four].astype("u1"), "VEC4")
        attributes[f"JOINTS_{number}"] = place
        share = {"normalized": True} if weight_type != "f4" else {}
        place, buffer = with_values(tree, buffer, weights[:, four].astype(weight_type), "VEC4", **share)
        attributes[f"WEIGHTS_{number}"] = place
    tree["skins"] = [{"joints": [2, 3, 4]}]
    bind = np.tile(np.eye(4), (3, 1, 1))
    if inverse:
        bind[:, :3] += 0.2 * rng.standard_normal((3, 3, 4))
        columns = bind.transpose(0, 2, 1).reshape(3, 16).astype("<f4")
        bind = columns.astype(float).reshape(3, 4, 4).transpose(0, 2, 1)
        tree["skins"][0]["inverseBindMatrices"], buffer = with_values(tree, buffer, columns, "MAT4")
    return tree, buffer, joints, weights, bind


def slow_place(tree: dict, index: int) -> np.ndarray:
    """A node's place by going up, with rotations by quaternion products."""
    node = tree["nodes"][index]
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])

    def moved(point):
        scaled = np.array(point) * node.get("scale", [1, 1, 1])
        vector = np.array([x, y, z])
        half = 2 * np.cross(vector, scaled)
        return scaled + w * half + np.cross(vector, half) + node.get("translation", [0, 0, 0])

    matrix = np.eye(4)
    matrix[:3, 3] = moved([0, 0, 0])
    for axis in range(3):
        matrix[:3, axis] = moved(np.eye(3)[axis]) - matrix[:3, 3]
    for parent, other in enumerate(tree["nodes"]):
        if index in other.get("children", []):
            return slow_place(tree, parent) @ matrix
    return matrix


@pytest.mark.parametrize(("weight_type", "sets"), [("f4", 1), ("u1", 1), ("u2", 2)])
@pytest.mark.parametrize("inverse", [True, False])
def test_joints_pose_a_skinned_mesh_and_its_node_does_not(rng, weight_type, sets, inverse):
    tree, buffer, joints, weights, bind = skeleton(rng, weight_type, sets, inverse)
    read = contents(tree, buffer)
    expected = []
    for point, on, shares in zip(BODY[0], joints, weights, strict=True):
        blended = np.zeros((4, 4))
        for joint, share in zip(on, shares, strict=True):
            blended += (
                share / shares.sum() * slow_place(tree, tree["skins"][0]["joints"][joint]) @ bind[joint]
            )
        expected.append((blended @ [*point, 1.0])[:3])
    assert np.allclose(read.geometry.vertices, expected, rtol=0, atol=1e-6)
    assert np.array_equal(read.geometry.corners.reshape(-1, 3), BODY[1])
    assert read.notes == ("Its skin is posed by its joints as they are stored.",)
    assert read.unit == "m"


def test_a_mirroring_skeleton_turns_faces_and_no_weights_mean_the_first_joint(rng):
    tree, buffer, joints, _weights, _bind = skeleton(rng, "f4", 1, inverse=False)
    tree["nodes"][1]["scale"] = [-1, 1, 1]
    place = tree["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"]
    start = tree["bufferViews"][tree["accessors"][place]["bufferView"]]["byteOffset"]
    count = len(BODY[0])
    read = contents(tree, buffer[:start] + bytes(16 * count) + buffer[start + 16 * count :])
    assert np.array_equal(read.geometry.corners.reshape(-1, 3), BODY[1][:, ::-1])
    expected = [
        (slow_place(tree, 2 + on[0]) @ [*point, 1.0])[:3] for point, on in zip(BODY[0], joints, strict=True)
    ]
    assert np.allclose(read.geometry.vertices, expected, rtol=0, atol=1e-6)


def test_morph_targets_have_the_weights_of_the_node_or_else_of_the_mesh(rng):
    tree, buffer = meshfiles.gltf_tree(*BODY, translation=[1, 0, 0])
    moves = [rng.standard_normal(BODY[0].shape).astype("<f4") for _ in range(3)]
    targets = []
    for move in moves:
        place, buffer = with_values(tree, buffer, move, "VEC3")
        targets.append({"POSITION": place})
    targets[1] = {"NORMAL": targets[1]["POSITION"]}
    tree["meshes"][0]["primitives"][0]["targets"] = targets
    tree["meshes"][0]["weights"] = [0.5, 1.0, 0.0]
    read = contents(tree, buffer)
    assert np.allclose(read.geometry.vertices, BODY[0] + 0.5 * moves[0] + [1, 0, 0], rtol=0, atol=1e-6)
    assert read.notes == ("Its morph targets have their default weights.",)
    tree["nodes"][0]["weights"] = [0.0, 0.0, -1.0]
    moved = contents(tree, buffer).geometry.vertices
    assert np.allclose(moved, BODY[0] - moves[2] + [1, 0, 0], rtol=0, atol=1e-6)
    tree["nodes"][0]["weights"] = [0.0, 0.0, 0.0]
    assert contents(tree, buffer).notes == ()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t["skins"][0].update(joints=[2, 3]), "joint that is not there"),
        (lambda t: t["skins"][0].update(joints=[2, 3, 4, 0]), "fewer matrices than joints"),
        (lambda t: t["skins"][0].update(inverseBindMatrices=0), "fewer matrices than joints"),
        (lambda t: t["accessors"][2].update(count=3), "joints and weights"),
        (lambda t: t["nodes"][4].update(children=[2]), "hangs in two places"),
    ],
)
def test_damaged_skins_are_refused(rng, change, message):
    tree, buffer, *_ = skeleton(rng, "f4")
    change(tree)
    with pytest.raises(UnreadableError, match=message):
        contents(tree, buffer)
