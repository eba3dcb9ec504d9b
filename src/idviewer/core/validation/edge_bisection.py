"""Edge bisection: edges cut in two at their middles, with the faces at them, which keeps the surface."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from idviewer.core.arrays import Bools, Floats, Ints
from idviewer.core.validation.topology import Topology

_SPLITS = {
    (False, False, False): [[0, 1, 2]],
    (True, False, False): [[0, 3, 2], [3, 1, 2]],
    (True, True, False): [[0, 3, 2], [3, 4, 2], [3, 1, 4]],
    (True, True, True): [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
}
"""Faces that a face is cut into, by which sides are; corners 3, 4, 5 are the middles of sides 0, 1, 2."""


class Bisected(NamedTuple):
    """A surface with some of its edges cut in two.

    Attributes:
        vertices: those there were, and the middles.
        faces: the pieces of each face together, in the order of the faces.
        parents: for each of them, the face that it was part of.
    """

    vertices: Floats
    faces: Ints
    parents: Ints


def bisected(vertices: Floats, faces: Ints, chosen: Bools) -> Bisected:
    """Cut edges in two at their middles.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
        chosen: (e,) which edges, in the order of `Topology.ends`.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> bisected(corners, np.array([[0, 1, 2]]), np.array([True, False, False])).faces.tolist()
    [[0, 3, 2], [3, 1, 2]]
    """
    topology = Topology(faces, len(vertices))
    of_half_edge = np.empty(faces.size, np.int64)
    of_half_edge[topology.half_edges_by_edge] = np.repeat(np.arange(len(chosen)), topology.face_counts)
    middle = np.where(chosen, len(vertices) + np.cumsum(chosen) - 1, -1)[of_half_edge].reshape(faces.shape)
    made, parents = [], []
    for turn in range(3):
        # A face is turned so that its cut sides come first.
        order = (np.arange(3) + turn) % 3
        corners = np.column_stack([faces[:, order], middle[:, order]])
        cut = middle[:, order] >= 0
        for sides, pieces in _SPLITS.items():
            if turn and all(sides) == any(sides):
                continue
            rows = np.flatnonzero((cut == np.array(sides)).all(axis=1))
            made.append(corners[rows][:, pieces].reshape(-1, 3))
            parents.append(np.repeat(rows, len(pieces)))
    parent = np.concatenate(parents)
    kept = np.argsort(parent, kind="stable")
    middles = vertices[topology.ends[chosen]].mean(axis=1)
    return Bisected(np.concatenate([vertices, middles]), np.concatenate(made)[kept], parent[kept])
