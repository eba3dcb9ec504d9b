"""One mesh in several poses: every point follows the part it lies on, then returns to the body's surface."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from contour import Faces
from field import Array, Body
from numpy.typing import NDArray
from remesh import adjacency, relax
from scipy.sparse import csr_matrix, diags_array

REACH = 1.5  # over how many radii of a limb a bend spreads; the inside of a narrower bend would fold


def carry(bodies: list[Body], points: Array, faces: Faces, far: float) -> Array:
    """Points of the first body, taken through those between to the last."""
    owner = nearest_samples(bodies[0], points)
    mixing, rounds = mixer(points, faces, bodies[0].packed[0][owner, 3:5].mean(axis=1))
    for body, following in pairwise(bodies):
        motion = motions(body, following)[owner]
        for _ in range(rounds):
            motion = mixing @ motion
        points = np.einsum("nij,nj->ni", motion[:, :9].reshape(-1, 3, 3), points) + motion[:, 9:]
        points = relax(following, points, faces, far, folded=True)
    return points


def nearest_samples(body: Body, points: Array) -> NDArray[np.int64]:
    """For each point the sample whose ellipsoid has to grow least to reach it."""
    samples = body.packed[0]
    best, owner = np.full(len(points), np.inf), np.zeros(len(points), dtype=np.int64)
    for index, row in enumerate(samples):
        local = (points - row[:3]) @ row[6:15].reshape(3, 3).T / row[3:6]
        size = (local**2).sum(axis=1)
        closer = size < best
        best[closer], owner[closer] = size[closer], index
    return owner


def motions(body: Body, following: Body) -> Array:
    """(m, 12) rotation (row by row) and shift of each sample from one body to the next."""
    old, new = body.packed[0], following.packed[0]
    turns = np.einsum("nki,nkj->nij", new[:, 6:15].reshape(-1, 3, 3), old[:, 6:15].reshape(-1, 3, 3))
    return np.hstack([turns.reshape(-1, 9), new[:, :3] - np.einsum("nij,nj->ni", turns, old[:, :3])])


def mixer(points: Array, faces: Faces, radius: Array) -> tuple[csr_matrix, int]:
    """A matrix that averages over neighbours, and how often to apply it to spread bends over REACH."""
    edge = np.linalg.norm(points[faces] - points[np.roll(faces, 1, axis=1)], axis=2).mean()
    rate = (radius / radius.max()) ** 2 / 2
    mixing = diags_array(1 - rate) + diags_array(rate) @ adjacency(points, faces)
    return csr_matrix(mixing), int(np.ceil((REACH * radius.max() / edge) ** 2))
