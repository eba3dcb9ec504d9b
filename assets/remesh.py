"""Well-shaped triangles on a body: edge flips, and points that slide along the surface."""

from __future__ import annotations

import numpy as np
from contour import Faces
from field import Array, Body, evaluate, gradient
from numpy.typing import NDArray
from scipy.sparse import csr_matrix


def adjacency(points: Array, faces: Faces) -> csr_matrix:
    """(n, n) matrix that averages over neighbours."""
    i, j = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).T
    valence = np.bincount(i, minlength=len(points))
    return csr_matrix((1 / valence[i], (i, j)), shape=(len(points),) * 2)


def onto(body: Body, points: Array, normals: Array, far: float) -> Array:
    """One secant step along the normals to the body's surface."""
    value, probe = evaluate(body, points, far), far / 400
    slope = (evaluate(body, points + probe * normals, far) - value) / probe
    step = np.clip(-value / np.maximum(np.abs(slope), 0.3), -far / 8, far / 8)
    return points + step[:, None] * normals


def relax(body: Body, points: Array, faces: Faces, far: float, folded: bool = False) -> Array:
    """Move points halfway to the middle of their neighbours, along the surface only.

    Where a mesh may be `folded`, the field's normals stand in for the mesh's, which are smoother elsewhere.
    """
    normals = point_normals(points, faces)
    if folded:
        slope = unit(gradient(body, points, far))
        normals = np.where((normals * slope).sum(axis=1, keepdims=True) > 0.5, normals, slope)
    move = adjacency(points, faces) @ points - points
    move -= (move * normals).sum(axis=1, keepdims=True) * normals
    return onto(body, points + move / 2, normals, far)


def point_normals(points: Array, faces: Faces) -> Array:
    """Unit normals, each the sum of its triangles' normals weighted by their angles."""
    total = np.zeros_like(points)
    a, b, c = (points[faces[:, i]] for i in range(3))
    normals = unit(np.cross(b - a, c - a))
    for i, corner in enumerate((angle(c, a, b), angle(a, b, c), angle(b, c, a))):
        np.add.at(total, faces[:, i], corner[:, None] * normals)
    return unit(total)


def even_out(
    bodies: list[Body], poses: list[Array], faces: Faces, far: float, rounds: int
) -> tuple[list[Array], Faces]:
    """Turn simplified triangles into well-shaped ones on the bodies, the same triangles in each pose."""
    for _ in range(rounds):
        for _ in range(3):
            faces = flip_edges(poses, faces)
        poses = [
            relax(body, points, faces, far, len(poses) > 1)
            for body, points in zip(bodies, poses, strict=True)
        ]
    for _ in range(2):
        poses = [
            onto(body, points, point_normals(points, faces), far)
            for body, points in zip(bodies, poses, strict=True)
        ]
    return poses, faces


def flip_edges(poses: list[Array], faces: Faces) -> Faces:
    """Flip edges whose opposite angles sum to over 180 degrees, as many as do not touch one another.

    With several poses, the worst of them decides.
    """
    edges, opposite, owners = diamonds(faces)
    measured = [flip_gain(points, edges, opposite) for points in poses]
    excess = np.max([gain for gain, _ in measured], axis=0) + np.min([gain for gain, _ in measured], axis=0)
    flat = np.min([flatness for _, flatness in measured], axis=0)
    size = int(faces.max()) + 1
    taken = np.isin(
        opposite.min(axis=1) * size + opposite.max(axis=1), edges.min(axis=1) * size + edges.max(axis=1)
    )
    valence = np.bincount(faces.ravel(), minlength=size)
    wanted = np.flatnonzero((excess > 1e-3) & (flat > 0.5) & ~taken & (valence[edges] > 3).all(axis=1))
    wanted = wanted[np.argsort(-excess[wanted], kind="stable")]
    chosen = wanted[independent(np.hstack([edges, opposite])[wanted], size)]
    faces = faces.copy()
    (u, v), (p, q) = edges[chosen].T, opposite[chosen].T
    faces[owners[chosen, 0]] = np.stack([q, v, p], axis=1)
    faces[owners[chosen, 1]] = np.stack([p, u, q], axis=1)
    return faces


def flip_gain(points: Array, edges: Faces, opposite: Faces) -> tuple[Array, Array]:
    """The excess of each edge's opposite angles over 180 degrees, and how flat its two triangles lie."""
    a, b = points[edges].transpose(1, 0, 2)
    c, d = points[opposite].transpose(1, 0, 2)
    before = unit(np.cross(b - a, c - a)), unit(np.cross(a - b, d - b))
    after = unit(np.cross(d - c, b - c)), unit(np.cross(c - d, a - d))
    flatness = np.minimum.reduce([(x * y).sum(axis=1) for x in after for y in (*before, after[0])])
    return angle(a, c, b) + angle(b, d, a) - np.pi, flatness


def diamonds(faces: Faces) -> tuple[Faces, Faces, Faces]:
    """Each edge a-b once: its ends, the points c, d of its triangles (a, b, c), (b, a, d), and these two."""
    directed = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    apex, owner = np.roll(faces, 1, axis=1).ravel(), np.repeat(np.arange(len(faces)), 3)
    order = np.lexsort((directed[:, 0] > directed[:, 1], directed.max(axis=1), directed.min(axis=1)))
    first, second = order[::2], order[1::2]
    return (
        directed[first],
        np.stack([apex[first], apex[second]], 1),
        np.stack([owner[first], owner[second]], 1),
    )


def independent(groups: Faces, size: int) -> NDArray[np.bool_]:
    """Rows, best first, that are the best one at each of the points they name."""
    rank = np.full(size, len(groups))
    np.minimum.at(rank, groups, np.arange(len(groups))[:, None])
    return (rank[groups] == np.arange(len(groups))[:, None]).all(axis=1)


def unit(vectors: Array) -> Array:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30)


def angle(a: Array, at: Array, b: Array) -> Array:
    """The angle at `at` in radians."""
    return np.arctan2(np.linalg.norm(np.cross(a - at, b - at), axis=1), ((a - at) * (b - at)).sum(axis=1))
