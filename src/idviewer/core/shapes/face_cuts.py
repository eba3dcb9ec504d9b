"""Edges with the faces beside them, and faces cut at points of their sides."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from idviewer.core.arrays import Floats, Ints


@dataclass(frozen=True)
class EdgesOfFaces:
    """Edges between two faces each.

    Attributes:
        faces: (e, 2) the faces beside each.
        corners: (e, 2) the corner of each that lies opposite.
        ends: (e, 2) vertices, in the order in which the first face goes round.
        opposite: (e, 2) vertices.

    >>> EdgesOfFaces.of(np.array([[0, 1, 2], [1, 0, 3]]), 4).opposite.tolist()
    [[2, 3]]
    """

    faces: Ints
    corners: Ints
    ends: Ints
    opposite: Ints

    @classmethod
    def of(cls, faces: Ints, count: int) -> EdgesOfFaces:
        """Those of faces (m, 3) of count vertices; an edge that only one of them has is left out."""
        tails, heads = faces[:, [1, 2, 0]].ravel(), faces[:, [2, 0, 1]].ravel()
        keys = np.minimum(tails, heads) * count + np.maximum(tails, heads)
        order = np.argsort(keys, kind="stable")
        same = np.flatnonzero(keys[order][1:] == keys[order][:-1])
        halves = np.stack([order[same], order[same + 1]], axis=1)
        beside, corners = np.divmod(halves, 3)
        ends = np.stack([tails[halves[:, 0]], heads[halves[:, 0]]], axis=1)
        return cls(beside, corners, ends, faces[beside, corners])


def cut_faces(vertices: Floats, faces: Ints, middles: Ints) -> tuple[Ints, Ints]:
    """Faces cut at points of their sides, and the number of the face that each comes from.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
        middles: (m, 3) the vertex inside of the side opposite each corner, -1 where there is none.

    >>> corners = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [1, 1, 0]])
    >>> cut_faces(corners, np.array([[0, 1, 2]]), np.array([[3, -1, -1]]))[0].tolist()
    [[0, 1, 3], [0, 3, 2]]
    """
    there = middles >= 0
    count = there.sum(axis=1)
    whole = np.flatnonzero(count == 0)
    made, parents = [faces[whole]], [whole]
    for number in (1, 2, 3):
        chosen = np.flatnonzero(count == number)
        # The one side that is cut, or that is not, comes to lie opposite the first corner.
        odd = there[chosen] if number == 1 else ~there[chosen]
        turn = (np.argmax(odd, axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(faces[chosen], turn, axis=1).T
        p, q, r = np.take_along_axis(middles[chosen], turn, axis=1).T
        if number == 1:
            parts = [(a, b, p), (a, p, c)]
        elif number == 3:
            parts = [(a, r, q), (r, b, p), (q, p, c), (p, q, r)]
        else:
            down, up = vertices[r] - vertices[c], vertices[b] - vertices[q]
            shorter = np.einsum("ij,ij->i", down, down) <= np.einsum("ij,ij->i", up, up)
            parts = [(a, r, q), (r, b, np.where(shorter, c, q)), (np.where(shorter, r, b), c, q)]
        made += [np.stack(part, axis=1) for part in parts]
        parents += [chosen] * len(parts)
    return np.concatenate(made), np.concatenate(parents)
