"""Where a glTF document's nodes are, and where morph targets and joints put the points of its meshes."""

from __future__ import annotations

from typing import Any

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.io.gltf_data import GltfData
from idviewer.core.io.text import UnreadableError


def matrix_of(node: dict[str, Any]) -> Floats:
    """A node's transformation (4, 4): its matrix, or translation times rotation times scale.

    Args:
        node: of the document.

    >>> matrix_of({"scale": [2, 2, 2], "translation": [1, 0, 0]})[0].tolist()
    [2.0, 0.0, 0.0, 1.0]
    """
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


def places_of(nodes: list[dict[str, Any]]) -> list[Floats]:
    """Transformations (4, 4) of all nodes to the scene, those that no scene shows included.

    Args:
        nodes: of the document.

    Raises:
        UnreadableError: a node hangs in two places, or below itself.

    >>> nodes = [{"children": [1], "scale": [2, 2, 2]}, {"translation": [1, 0, 0]}]
    >>> places_of(nodes)[1][0].tolist()
    [2.0, 0.0, 0.0, 2.0]
    """
    children = [child for node in nodes for child in node.get("children", [])]
    if len(set(children)) != len(children):
        raise UnreadableError("a node hangs in two places, or below itself")
    places: dict[int, Floats] = {}
    waiting = [(root, np.eye(4)) for root in sorted(set(range(len(nodes))) - set(children))]
    while waiting:
        index, parent = waiting.pop()
        places[index] = parent @ matrix_of(nodes[index])
        waiting += [(child, places[index]) for child in nodes[index].get("children", [])]
    if len(places) != len(nodes):
        raise UnreadableError("a node hangs in two places, or below itself")
    return [places[index] for index in range(len(nodes))]


def morphed(data: GltfData, points: Floats, primitive: dict[str, Any], weights: list[float]) -> Floats:
    """Points (n, 3) of a primitive with its morph targets.

    Args:
        data: of the document.
        points: (n, 3) without targets.
        primitive: whose targets they are.
        weights: of the targets, one each.

    Raises:
        UnreadableError: a target has another number of points.
    """
    for target, weight in zip(primitive.get("targets", []), weights, strict=False):
        if weight and "POSITION" in target:
            moves = data.accessor(target["POSITION"])
            if moves.shape != points.shape:
                raise UnreadableError("a morph target does not have as many points as its mesh")
            points = points + float(weight) * moves
    return points


def joint_matrices(data: GltfData, skin: dict[str, Any], places: list[Floats]) -> Floats:
    """What each joint does to points (j, 4, 4): its place in the scene times its inverse bind matrix.

    Args:
        data: of the document.
        skin: of the document.
        places: of the document's nodes.

    Raises:
        UnreadableError: there are fewer inverse bind matrices than joints.
    """
    joints = np.stack([places[joint] for joint in skin["joints"]])
    if "inverseBindMatrices" not in skin:
        return joints
    inverse = data.accessor(skin["inverseBindMatrices"]).astype(np.float64)
    if inverse.shape[1:] != (16,) or len(inverse) < len(joints):
        raise UnreadableError("a skin has fewer matrices than joints")
    return joints @ inverse[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)


def skinned(points: Floats, joints: Ints, weights: Floats, matrices: Floats) -> Floats:
    """Points (n, 3) where their joints put them, blended linearly; weights are scaled to a sum of 1.

    Args:
        points: (n, 3) in the bind pose.
        joints: (n, k) that move each point; where no weight counts, the first does.
        weights: (n, k).
        matrices: (j, 4, 4) of `joint_matrices`.

    Raises:
        UnreadableError: a point has a joint that is not there.

    >>> lift = np.eye(4) + np.outer([0, 0, 1, 0], [0, 0, 0, 2])
    >>> skinned(np.zeros((1, 3)), np.array([[0, 1]]), np.full((1, 2), 0.5), np.stack([np.eye(4), lift]))
    array([[0., 0., 1.]])
    """
    if joints.shape != weights.shape or len(joints) != len(points):
        raise UnreadableError("its points do not all have joints and weights")
    if joints.size and (joints.min() < 0 or joints.max() >= len(matrices)):
        raise UnreadableError("a point hangs on a joint that is not there")
    totals = weights.sum(axis=1, keepdims=True)
    first = np.zeros_like(weights)
    first[:, :1] = 1.0
    shares = np.where(totals > 0.0, weights / np.where(totals > 0.0, totals, 1.0), first)
    moved = np.zeros_like(points)
    for column in range(joints.shape[1]):
        affine = matrices[joints[:, column], :3]
        posed = np.einsum("nij,nj->ni", affine[:, :, :3], points) + affine[:, :, 3]
        moved += shares[:, column, None] * posed
    return moved
