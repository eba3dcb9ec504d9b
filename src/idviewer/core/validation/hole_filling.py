"""Hole filling: rims of an open surface, and the lids that close them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.validation.polygon_soup import PolygonSoup, triangulated
from idviewer.core.validation.topology import Topology


class Filled(NamedTuple):
    """A surface with lids.

    Attributes:
        vertices: (n, 3) those before, and behind them the middles of lids that needed one.
        faces: (m, 3) those before, all wound alike, and behind them the lids.
        sizes: edges of each hole that was filled.
        left: edges of each hole that was not.
    """

    vertices: Floats
    faces: Ints
    sizes: tuple[int, ...]
    left: tuple[int, ...]


def holes(faces: Ints, count: int) -> list[Ints]:
    """The rims of an open surface, each as its vertices in the order in which a lid runs around it.

    A rim that meets itself in a vertex is taken apart there; one that has no end, as beside edges of three
    faces, is left out.

    Args:
        faces: (m, 3), wound alike.
        count: of the vertices.

    >>> [hole.tolist() for hole in holes(np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2]]), 4)]
    [[1, 2, 3]]
    """
    topology = Topology(faces, count)
    low, high = topology.ends[topology.boundary].T
    rim = np.isin(
        np.minimum(topology.tails, topology.heads) * count + np.maximum(topology.tails, topology.heads),
        low * count + high,
    )
    following: dict[int, list[int]] = {}
    # A lid runs against the faces that it joins.
    for tail, head in zip(topology.heads[rim].tolist(), topology.tails[rim].tolist(), strict=True):
        following.setdefault(tail, []).append(head)
    found: list[Ints] = []
    for start in sorted(following):
        while following.get(start):
            found += _loops_from(start, following)
    return found


def fill_holes(vertices: Floats, faces: Ints, most_edges: int) -> Filled:
    """Close the holes of an open surface that have few edges.

    A hole becomes a polygon, cut into triangles in the plane that fits it best. Where a side of these is
    there already, the lid is a fan about its middle.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
        most_edges: of a hole that is filled.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> fill_holes(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2]]), 3).faces[-1].tolist()
    [1, 2, 3]
    """
    flipped = Topology(faces, len(vertices)).faces_to_flip()
    if flipped is not None and flipped.any():
        faces = np.where(flipped[:, None], faces[:, ::-1], faces)
    rims = holes(faces, len(vertices))
    small = [rim for rim in rims if len(rim) <= most_edges]
    sides = np.sort(np.concatenate([faces, faces[:, [1, 2, 0]]], axis=0).reshape(2, -1).T, axis=1)
    known = set(map(tuple, sides.tolist())) if small else set()
    lids, middles = [faces], [vertices]
    for rim in small:
        lid = triangulated(PolygonSoup(vertices, rim, np.array([len(rim)])))
        inner = _inner_sides(lid, rim)
        if not known.isdisjoint(inner):
            middle = np.full(len(rim), len(vertices) + len(middles) - 1)
            lid = np.column_stack([rim, np.roll(rim, -1), middle])
            middles.append(vertices[rim].mean(axis=0, keepdims=True))
            inner = set()
        known |= inner
        lids.append(lid)
    left = tuple(len(rim) for rim in rims if len(rim) > most_edges)
    return Filled(np.concatenate(middles), np.concatenate(lids), tuple(len(rim) for rim in small), left)


def _inner_sides(lid: Ints, rim: Ints) -> set[tuple[int, ...]]:
    """The sides of a lid that are not on its rim, the lower vertex first."""
    sides = np.sort(np.stack([lid, lid[:, [1, 2, 0]]], axis=-1).reshape(-1, 2), axis=1)
    around = np.sort(np.column_stack([rim, np.roll(rim, -1)]), axis=1)
    return set(map(tuple, sides.tolist())) - set(map(tuple, around.tolist()))


def _loops_from(start: int, following: dict[int, list[int]]) -> list[Ints]:
    """Walk along the rim until it ends, and take off a loop each time it comes back to where it was."""
    path, place = [start], {start: 0}
    loops: list[Ints] = []
    while following.get(path[-1]):
        vertex = following[path[-1]].pop()
        if vertex not in place:
            place[vertex] = len(path)
            path.append(vertex)
            continue
        loop = path[place[vertex] :]
        if len(loop) > 2:
            loops.append(np.array(loop))
        for gone in loop[1:]:
            del place[gone]
        path = path[: place[vertex] + 1]
    return loops
