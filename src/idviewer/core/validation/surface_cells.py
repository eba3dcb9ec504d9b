"""Surface cells: the regions of space that a surface bounds, and which of its faces bound a solid.

Where more than two faces meet in an edge, their angles about it say which sides of which faces look at the
same region. Regions follow by connected components, and which of them are solid from the winding. Source:
Zhou, Grinspun, Zorin and Jacobson 2016, "Mesh arrangements for solid geometry", section 3.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

import numpy as np

from idviewer.core.arrays import Bools, Floats, Ints
from idviewer.core.validation.topology import Topology, component_labels, first_of_each

LEAST_ANGLE = 1e-9
"""Faces at one edge with a smaller angle between them, in radians, have no order about it."""


class Sectors(NamedTuple):
    """Neighbours about every edge: which side of a half-edge's face looks at which side of the next one's.

    Attributes:
        half_edges: (h,) all half-edges, sorted by edge, and about an edge by angle.
        following: (h,) the place among them of the next one about the same edge.
        upward: (h,) whether each runs from its lower vertex to its higher one.
        unclear: (h,) whether the order about its edge cannot be told.
    """

    half_edges: Ints
    following: Ints
    upward: Bools
    unclear: Bools


def sectors_of(vertices: Floats, topology: Topology) -> Sectors:
    """Order the faces about every edge, counter-clockwise seen against its direction from low to high.

    Args:
        vertices: (n, 3).
        topology: of the faces.
    """
    counts = topology.face_counts
    half_edges = topology.half_edges_by_edge.copy()
    edge = np.repeat(np.arange(len(counts)), counts)
    unclear = np.zeros(len(half_edges), bool)
    many = np.flatnonzero(counts[edge] > 2)
    if len(many):
        angles = _angles(vertices, topology, half_edges[many], edge[many])
        order = np.lexsort((angles, edge[many]))
        half_edges[many], angles = half_edges[many[order]], angles[order]
        close = (np.diff(angles) < LEAST_ANGLE) & (np.diff(edge[many]) == 0)
        vague = np.unique(edge[many][:-1][close])
        unclear = np.isin(edge, vague)
    starts = np.cumsum(counts) - counts
    following = np.arange(1, len(half_edges) + 1)
    following[starts + counts - 1] = starts
    upward = topology.tails[half_edges] < topology.heads[half_edges]
    return Sectors(half_edges, following, upward, unclear)


def _angles(vertices: Floats, topology: Topology, half_edges: Ints, edge: Ints) -> Floats:
    """Angles of half-edges' faces about their edges, from 0 for the first one of each."""
    low, high = topology.ends[edge].T
    along = vertices[high] - vertices[low]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    opposite = topology.tails[half_edges - half_edges % 3 + (half_edges + 2) % 3]
    out = vertices[opposite] - vertices[low]
    out -= np.einsum("ij,ij->i", out, along)[:, None] * along
    _, first, group = np.unique(edge, return_index=True, return_inverse=True)
    zero = out[first][group]
    across = np.cross(along, zero)
    angles = np.arctan2(np.einsum("ij,ij->i", out, across), np.einsum("ij,ij->i", out, zero))
    angles[angles < -LEAST_ANGLE] += 2.0 * np.pi
    return np.asarray(angles)


class SurfaceCells(NamedTuple):
    """What each face separates.

    Attributes:
        solid_behind: (m,) whether there is solid on the side away from the face's normal.
        solid_before: (m,) whether there is solid on the side of the face's normal.
        known: (m,) whether that can be told: not of faces joined to an open rim or an unclear edge.
    """

    solid_behind: Bools
    solid_before: Bools
    known: Bools

    @property
    def walls(self) -> Bools:
        """Tell which faces have solid on both sides, (m,)."""
        return self.known & self.solid_behind & self.solid_before

    @property
    def fins(self) -> Bools:
        """Tell which faces have solid on neither side, (m,)."""
        return self.known & ~self.solid_behind & ~self.solid_before


def surface_cells(vertices: Floats, faces: Ints, windings: Ints) -> SurfaceCells:
    """Find out on which sides of its faces a surface has solid.

    Where windings agree, solid is what they wind around. Else, where every edge has an even number of faces,
    solid and empty take turns; and else all that is enclosed is solid.

    Args:
        vertices: (n, 3).
        faces: (m, 3), no two with the same vertices.
        windings: (m,) how often each is given as it is, less how often from behind.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> surface_cells(corners, faces, np.ones(4, np.int64)).solid_behind.tolist()
    [True, True, True, True]
    """
    count = len(faces)
    topology = Topology(faces, len(vertices))
    sectors = sectors_of(vertices, topology)
    face = sectors.half_edges // 3
    after = np.where(sectors.upward, face, face + count)  # the side that looks at the sector after the face
    before = np.where(sectors.upward, face + count, face)
    number, labels = component_labels(2 * count, after, before[sectors.following])
    parts, part = component_labels(number, labels[:count], labels[count:])
    volumes = _signed_volumes(vertices, faces, labels, number)
    solid = np.zeros(number, bool)
    part_of_face = part[labels[:count]]
    # A face whose sides look at the same region ends in a rim somewhere. A few such may hang from a body.
    hanging = labels[:count] == labels[count:]
    known = 2 * np.bincount(part_of_face[hanging], minlength=parts) < np.bincount(
        part_of_face, minlength=parts
    )
    known[part_of_face[face[sectors.unclear]]] = False
    odd_edges = np.zeros(parts, bool)
    of_edge = topology.half_edges_by_edge[np.cumsum(topology.face_counts) - topology.face_counts] // 3
    odd_edges[part_of_face[of_edge[topology.face_counts % 2 == 1]]] = True
    by_part = np.argsort(part, kind="stable")
    ends = np.append(np.searchsorted(part[by_part], np.arange(parts)), number)
    links = np.unique(np.column_stack([labels[:count], labels[count:], windings])[~hanging], axis=0)
    link_part = part[links[:, 0]]
    links = links[np.argsort(link_part, kind="stable")]
    link_ends = np.append(np.searchsorted(np.sort(link_part), np.arange(parts)), len(links))
    for one in np.flatnonzero(known):
        cells = by_part[ends[one] : ends[one + 1]]
        outside = int(cells[np.argmin(volumes[cells])])
        some = links[link_ends[one] : link_ends[one + 1]].tolist()
        solid[cells] = _solid(cells, outside, some, bool(odd_edges[one]))
    return SurfaceCells(solid[labels[count:]], solid[labels[:count]], known[part_of_face])


def _solid(cells: Ints, outside: int, links: list[list[int]], odd_edges: bool) -> Bools:
    """Tell which cells of one part are solid; links are rows of the cells before and behind, and winding."""
    wound = _levels(outside, [(before, behind, w) for before, behind, w in links])
    if wound is not None and any(wound.values()):
        return np.array([wound[cell] != 0 for cell in cells.tolist()])
    turns = None if odd_edges else _levels(outside, [(a, b, 1) for a, b, _ in links], modulus=2)
    if turns is not None:
        return np.array([turns[cell] == 1 for cell in cells.tolist()])
    return cells != outside


def _levels(start: int, links: list[tuple[int, int, int]], modulus: int = 0) -> dict[int, int] | None:
    """Number of each cell, 0 at the start and w higher behind a link of winding w; None if they disagree."""
    neighbours: dict[int, list[tuple[int, int]]] = {}
    for before, behind, step in links:
        neighbours.setdefault(before, []).append((behind, step))
        neighbours.setdefault(behind, []).append((before, -step))
    found, waiting = {start: 0}, deque([start])
    while waiting:
        cell = waiting.popleft()
        for other, step in neighbours.get(cell, []):
            level = (found[cell] + step) % modulus if modulus else found[cell] + step
            if other not in found:
                found[other] = level
                waiting.append(other)
            elif found[other] != level:
                return None
    return found


def _signed_volumes(vertices: Floats, faces: Ints, labels: Ints, number: int) -> Floats:
    """Volume (number,) of each cell, negative for what lies around a body."""
    centred = vertices - (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    a, b, c = (centred[faces[:, corner]] for corner in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c))
    return np.asarray(np.bincount(labels, np.concatenate([-volumes, volumes]), number), np.float64)


def cut_corners(vertices: Floats, faces: Ints, sure: Bools) -> Ints:
    """For each corner of each face, (m, 3), the number of the copy of its vertex that it belongs to.

    Faces are wound around the solid. About an edge of more than two faces, those belong together that have
    solid between them, so the surface is cut where it only touches itself. Copy 0 of a vertex is that of its
    first corner.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
        sure: (m,) which faces may be cut apart from others.
    """
    topology = Topology(faces, len(vertices))
    sectors = sectors_of(vertices, topology)
    half, further = sectors.half_edges, sectors.half_edges[sectors.following]
    # Solid is behind the faces, and so after those whose half-edges run downward.
    joined = ~sectors.upward & sectors.upward[sectors.following] & (half != further)
    one, other = half[joined], further[joined]
    corners = np.arange(faces.size)
    same_end = _following_corner(other)
    links = [np.column_stack([one, same_end]), np.column_stack([_following_corner(one), other])]
    unsure = corners[np.repeat(~sure, 3)]
    if len(unsure):
        vertex = faces.ravel()[unsure]
        first = np.full(len(vertices), -1)
        first[vertex[::-1]] = unsure[::-1]
        links.append(np.column_stack([unsure, first[vertex]]))
    pairs = np.concatenate(links)
    number, labels = component_labels(faces.size, pairs[:, 0], pairs[:, 1])
    firsts = first_of_each(labels, number)
    order = np.lexsort((firsts, faces.ravel()[firsts]))
    vertex = faces.ravel()[firsts[order]]
    start = np.r_[True, vertex[1:] != vertex[:-1]]
    places = np.arange(number)
    rank = np.empty(number, np.int64)
    rank[order] = places - np.maximum.accumulate(np.where(start, places, 0))
    return rank[labels].reshape(faces.shape)


def _following_corner(half_edges: Ints) -> Ints:
    return half_edges - half_edges % 3 + (half_edges + 1) % 3
