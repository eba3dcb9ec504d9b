"""Repairs of triangle soups as functions of plain arrays. Every tolerance is relative to the mesh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from idviewer.core.arrays import Bools, Floats, Ints
from idviewer.core.validation.tolerances import TOLERANCES
from idviewer.core.validation.topology import component_labels, first_of_each


def first_coincident(vertices: Floats) -> Ints:
    """For each vertex, the first one with exactly the same coordinates, (n,).

    >>> first_coincident(np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 0]])).tolist()
    [0, 1, 0]
    """
    order = np.lexsort(vertices.T)
    ranked = vertices[order]
    fresh = np.ones(len(vertices), bool)
    fresh[1:] = np.any(ranked[1:] != ranked[:-1], axis=1)
    groups = np.cumsum(fresh) - 1
    first = np.minimum.reduceat(order, np.flatnonzero(fresh))
    result = np.empty(len(vertices), np.int64)
    result[order] = first[groups]
    return result


def first_within(vertices: Floats, chosen: Ints, distance: float) -> Ints:
    """For each vertex, the first of the chosen ones joined to it by steps of at most a distance, (n,).

    Args:
        vertices: (n, 3).
        chosen: (c,) their numbers; all others stand for themselves.
        distance: longest step, in the mesh's unit.

    >>> first_within(np.array([[0.0, 0, 0], [1, 0, 0], [1e-3, 0, 0]]), np.arange(3), 0.01).tolist()
    [0, 1, 0]
    """
    pairs = cKDTree(vertices[chosen]).query_pairs(distance, output_type="ndarray")
    number, labels = component_labels(len(chosen), pairs[:, 0], pairs[:, 1])
    result = np.arange(len(vertices))
    result[chosen] = chosen[first_of_each(labels, number)][labels]
    return result


def repeating_a_vertex(faces: Ints) -> Bools:
    """Tell which faces have the same vertex twice, (m,).

    >>> repeating_a_vertex(np.array([[0, 1, 2], [0, 1, 1]])).tolist()
    [False, True]
    """
    a, b, c = faces.T
    return (a == b) | (b == c) | (c == a)


def duplicates_of_earlier(faces: Ints, either_winding: bool) -> Bools:
    """Tell which faces have the vertices of an earlier one, with the same winding or with either, (m,).

    >>> duplicates_of_earlier(np.array([[0, 1, 2], [1, 2, 0], [2, 1, 0]]), either_winding=False).tolist()
    [False, True, False]
    """
    turns = np.argmin(faces, axis=1)[:, None] + np.arange(3)
    keys = np.take_along_axis(faces, turns % 3, axis=1)
    if either_winding:
        keys = np.sort(keys, axis=1)
    order = np.lexsort(keys.T)
    same = np.all(keys[order][1:] == keys[order][:-1], axis=1)
    copies = np.zeros(len(faces), bool)
    copies[order[1:][same]] = True  # lexsort is stable: the first of equals is the earliest
    return copies


def net_windings(faces: Ints) -> Ints:
    """How often each face is there with its winding, less how often with the opposite one, (m,).

    >>> net_windings(np.array([[0, 1, 2], [1, 2, 0], [2, 1, 0], [0, 1, 3]])).tolist()
    [1, 1, -1, 1]
    """
    turns = np.argmin(faces, axis=1)[:, None] + np.arange(3)
    turned = np.take_along_axis(faces, turns % 3, axis=1)
    signs = np.where(turned[:, 1] < turned[:, 2], 1, -1)
    _, groups = np.unique(np.sort(faces, axis=1), axis=0, return_inverse=True)
    groups = groups.ravel()
    return signs * np.bincount(groups, signs).astype(np.int64)[groups]


def numbers_of_used(corners: Ints, count: int) -> Ints:
    """The new number of each vertex once those without a face are dropped, (count,); -1 for these.

    Args:
        corners: vertices of the faces, in any shape.
        count: of the vertices.

    >>> numbers_of_used(np.array([[0, 1, 3]]), 4).tolist()
    [0, 1, -1, 2]
    """
    used = np.zeros(count, bool)
    used[corners] = True
    return np.where(used, np.cumsum(used) - 1, -1)


def without_unused_vertices(vertices: Floats, faces: Ints) -> tuple[Floats, Ints]:
    """Without the vertices that no face uses; the order stays.

    >>> vertices, faces = without_unused_vertices(np.eye(4)[:, :3], np.array([[0, 1, 3]]))
    >>> len(vertices), faces.tolist()
    (3, [[0, 1, 2]])
    """
    became = numbers_of_used(faces, len(vertices))
    return vertices[became >= 0], became[faces]


def side_vectors(vertices: Floats, faces: Ints) -> tuple[Floats, Floats, Floats]:
    """Vectors (m, 3) along the sides opposite to the first, second and third corner.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
    """
    a, b, c = (np.ascontiguousarray(vertices[faces[:, corner]]) for corner in range(3))
    return c - b, a - c, b - a


def zero_area_faces(vertices: Floats, faces: Ints) -> Bools:
    """Tell which faces have no area, (m,).

    Args:
        vertices: (n, 3).
        faces: (m, 3).

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]])
    >>> zero_area_faces(corners, np.array([[0, 1, 2], [0, 1, 3]])).tolist()
    [True, False]
    """
    sides = side_vectors(vertices, faces)
    longest = np.maximum.reduce([np.einsum("ij,ij->i", side, side) for side in sides])
    normals = np.cross(sides[1], sides[2])
    # Twice the area is height times longest side; squares are compared as a ratio, so that nothing
    # underflows.
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = np.sqrt(np.einsum("ij,ij->i", normals, normals)) / longest
    return ~(ratio > TOLERANCES.face_height)


def first_along_short_edges(vertices: Floats, faces: Ints) -> Ints:
    """For each vertex, the first one joined to it by sides without length of faces without area, (n,).

    Args:
        vertices: (n, 3).
        faces: (m, 3).
    """
    degenerate = faces[zero_area_faces(vertices, faces)]
    lengths = np.column_stack([np.linalg.norm(side, axis=1) for side in side_vectors(vertices, degenerate)])
    row, corner = np.nonzero(lengths <= TOLERANCES.face_height * lengths.max(axis=1, keepdims=True))
    a, b = degenerate[row, (corner + 1) % 3], degenerate[row, (corner + 2) % 3]
    number, labels = component_labels(len(vertices), a, b)
    return first_of_each(labels, number)[labels]


def with_edges_flipped(vertices: Floats, faces: Ints) -> Ints:
    """Remove faces without area from a closed surface by flips of the side facing the obtuse corner.

    The corner lies on that side, so the flip keeps the shape. Faces that cannot be removed so stay as they
    are.

    Args:
        vertices: (n, 3).
        faces: (m, 3); not changed.

    Returns:
        (m, 3) the faces after the flips.
    """
    faces = faces.copy()
    across = {pair: index // 3 for index, pair in enumerate(_half_edges(faces))}
    waiting = np.flatnonzero(zero_area_faces(vertices, faces)).tolist()
    budget = 10 * len(waiting) + 100
    while waiting and budget:
        budget -= 1
        face = waiting.pop()
        if not zero_area_faces(vertices, faces[face : face + 1])[0]:
            continue
        a, b, c = _longest_side_first(vertices, faces[face])
        other = across[b, a]
        d = int(faces[other].sum()) - a - b
        if d == c or (c, d) in across or (d, c) in across:
            continue
        del across[a, b], across[b, a]
        for index, corners in ((face, (a, d, c)), (other, (d, b, c))):
            faces[index] = corners
            across.update(dict.fromkeys(_half_edges(faces[index : index + 1]), index))
            waiting.insert(0, index)  # a neighbour may have lost its area; it is looked at after the others
    return faces


def _half_edges(faces: Ints) -> list[tuple[int, int]]:
    return list(zip(faces.ravel().tolist(), faces[:, [1, 2, 0]].ravel().tolist(), strict=True))


def _longest_side_first(vertices: Floats, face: Ints) -> tuple[int, int, int]:
    """The face's corners, turned so that its longest side comes first."""
    lengths = np.linalg.norm(vertices[np.roll(face, -1)] - vertices[face], axis=1)
    a, b, c = np.roll(face, -int(np.argmax(lengths))).tolist()
    return a, b, c


class Merged(NamedTuple):
    """Vertices and faces of which some were merged.

    Attributes:
        vertices: (n, 3) those left that have a face.
        faces: (m, 3) those left with three different corners.
        gone: how many vertices were merged into another.
        became: for each vertex before, its number now; -1 where no face is left to it.
    """

    vertices: Floats
    faces: Ints
    gone: int
    became: Ints


def merged_vertices(vertices: Floats, faces: Ints, first: Ints) -> Merged:
    """Replace each vertex by its first.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
        first: (n,) for each vertex the one that it becomes.

    >>> merged = merged_vertices(np.eye(4)[:, :3], np.array([[0, 1, 3], [0, 1, 2]]), np.array([0, 1, 0, 3]))
    >>> merged.faces.tolist(), merged.became.tolist()
    ([[0, 1, 2]], [0, 1, 0, 2])
    """
    gone = int(np.count_nonzero(first != np.arange(len(first))))
    together = first[faces]
    together = together[~repeating_a_vertex(together)]
    became = numbers_of_used(together, len(vertices))
    return Merged(vertices[became >= 0], became[together], gone, became[first])


def volume_and_area(vertices: Floats, faces: Ints) -> tuple[float, float]:
    """Signed volume (of a closed surface; positive if its faces wind outward) and area.

    Args:
        vertices: (n, 3).
        faces: (m, 3).

    >>> corners = np.array([[0.0, 0, 0], [6, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> round(volume_and_area(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))[0], 12)
    1.0
    """
    centred = vertices - (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    a, b, c = (np.ascontiguousarray(centred[faces[:, corner]]) for corner in range(3))
    normals = np.cross(b - a, c - a)
    volume = float(np.einsum("ij,ij->", a, normals)) / 6
    return volume, float(np.linalg.norm(normals, axis=1).sum()) / 2
