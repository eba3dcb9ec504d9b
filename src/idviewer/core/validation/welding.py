"""Welding: gaps between open rims closed, and vertices that lie on the rim's edges joined to them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from idviewer.core.arrays import Floats, Ints
from idviewer.core.validation.soup_repairs import first_within, merged_vertices, numbers_of_used
from idviewer.core.validation.topology import Topology

MOST_ROUNDS = 100
"""Rounds of splitting: each splits one edge of a face, so that one face may be split again and again."""


class Welded(NamedTuple):
    """A welded surface.

    Attributes:
        vertices: (n, 3) those that are left.
        faces: (m, 3).
        became: for each vertex before, its number now; -1 where no face is left to it.
        merged: how many vertices went into another.
        joined: how many vertices were joined to an edge that they lay on.
        vanished: how many faces collapsed.
        moved: the largest distance of a vertex, or of an edge's point, to where it is now.
    """

    vertices: Floats
    faces: Ints
    became: Ints
    merged: int
    joined: int
    vanished: int
    moved: float


def weld(vertices: Floats, faces: Ints, width: float) -> Welded:
    """Close the gaps of an open surface.

    Vertices of the rim within the width of each other become one, and a vertex of the rim within the width of
    an edge of the rim splits that edge's face (a T-junction). Nothing away from the rim is touched.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
        width: of the widest gap, in the shape's unit.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1.001, 0, 0]])
    >>> found = weld(corners, np.array([[0, 2, 1], [0, 4, 3], [0, 3, 2], [1, 2, 3]]), 0.01)
    >>> found.merged, found.faces.tolist(), round(found.moved, 6)
    (1, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], 0.001)
    """
    rim = rim_vertices(faces, len(vertices))
    if len(rim) == 0:
        return Welded(vertices, faces, np.arange(len(vertices)), 0, 0, 0, 0.0)
    first = first_within(vertices, rim, width)
    moved = float(np.linalg.norm(vertices[first] - vertices, axis=1).max())
    merged = merged_vertices(vertices, faces, first)
    whole, joined, bent = _with_edges_split(merged.vertices, merged.faces, width)
    used = numbers_of_used(whole, len(merged.vertices))
    became = np.where(merged.became >= 0, np.append(used, -1)[merged.became], -1)
    vanished = len(faces) - len(merged.faces)
    return Welded(
        merged.vertices[used >= 0], used[whole], became, merged.gone, joined, vanished, max(moved, bent)
    )


def suggested_width(vertices: Floats, faces: Ints) -> float | None:
    """The width of gaps, as a round number, by which welding closes most; None where it closes nothing.

    Args:
        vertices: (n, 3).
        faces: (m, 3).

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1.00001, 0, 0]])
    >>> suggested_width(corners, np.array([[0, 2, 1], [0, 4, 3], [0, 3, 2], [1, 2, 3]]))
    0.0001
    """
    open_before = _rim_edges(faces, len(vertices))
    if open_before == 0:
        return None
    widths, best, fewest = _round_widths(vertices, faces), None, open_before
    for width in widths:  # no more than merging, which is most of it, and quick
        first = first_within(vertices, rim_vertices(faces, len(vertices)), width)
        merged = merged_vertices(vertices, faces, first)
        if len(merged.faces) == len(faces) and _rim_edges(merged.faces, len(merged.vertices)) == 0:
            return width
    for width in widths:
        welded = weld(vertices, faces, width)
        if len(welded.faces) == 0 or welded.vanished > len(faces) // 10:
            break
        left = _rim_edges(welded.faces, len(welded.vertices))
        if left < fewest:
            best, fewest = width, left
        if left == 0:
            break
    return best


def rim_vertices(faces: Ints, count: int) -> Ints:
    """Numbers of the vertices on the open rim, ascending.

    Args:
        faces: (m, 3).
        count: of the vertices.

    >>> rim_vertices(np.array([[0, 1, 2]]), 4).tolist()
    [0, 1, 2]
    """
    topology = Topology(faces, count)
    return np.unique(topology.ends[topology.boundary])


def _rim_edges(faces: Ints, count: int) -> int:
    return len(Topology(faces, count).boundary)


def _round_widths(vertices: Floats, faces: Ints) -> list[float]:
    """Powers of ten from the middle distance of neighbours on the rim, to a third of its edges' length."""
    topology = Topology(faces, len(vertices))
    ends = topology.ends[topology.boundary]
    edges = np.linalg.norm(vertices[ends[:, 0]] - vertices[ends[:, 1]], axis=1)
    rim = np.unique(ends)
    nearest = cKDTree(vertices[rim]).query(vertices[rim], k=2)[0][:, 1] if len(rim) > 1 else np.zeros(1)
    size = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    longest = float(np.median(edges)) / 3.0
    gaps = nearest[(nearest > 0.0) & (nearest < longest)]
    lowest = max(float(np.median(gaps)) if len(gaps) else 0.0, 1e-7 * size)
    powers = range(int(np.ceil(np.log10(lowest))), int(np.floor(np.log10(max(longest, lowest)))) + 1)
    return [float(f"1e{power}") for power in powers]


def _with_edges_split(vertices: Floats, faces: Ints, width: float) -> tuple[Ints, int, float]:
    """Faces split at the rim's vertices on their rim edges, how many were, and how far those lie off."""
    joined, bent = 0, 0.0
    for _ in range(MOST_ROUNDS):
        splits = _splits(vertices, faces, width)
        if splits is None:
            break
        face, side, vertex, far = splits
        start, end, apex = (faces[face, (side + turn) % 3] for turn in range(3))
        faces = np.concatenate([np.delete(faces, face, axis=0), np.column_stack([start, vertex, apex]),
                                np.column_stack([vertex, end, apex])])  # fmt: skip
        joined, bent = joined + len(face), max(bent, float(far.max()))
    return faces, joined, bent


def _splits(vertices: Floats, faces: Ints, width: float) -> tuple[Ints, Ints, Ints, Floats] | None:
    """One edge of each face to be split: face, side, vertex on it, and the distance of that from the edge."""
    topology = Topology(faces, len(vertices))
    half_edges = np.flatnonzero(np.isin(_keys(topology, topology.tails, topology.heads), _rim_keys(topology)))
    if len(half_edges) == 0:
        return None
    rim = np.unique(topology.tails[half_edges])
    rim = np.union1d(rim, topology.heads[half_edges])
    a, b = vertices[topology.tails[half_edges]], vertices[topology.heads[half_edges]]
    lengths = np.linalg.norm(b - a, axis=1)
    near = cKDTree(vertices[rim]).query_ball_point(0.5 * (a + b), 0.5 * lengths + width)
    owner = np.repeat(np.arange(len(half_edges)), [len(found) for found in near])
    vertex = rim[np.concatenate([np.asarray(found, np.int64) for found in near])]
    along = b[owner] - a[owner]
    offset = vertices[vertex] - a[owner]
    share = np.einsum("ij,ij->i", offset, along) / lengths[owner] ** 2
    far = np.linalg.norm(offset - share[:, None] * along, axis=1)
    inside = np.minimum(share, 1.0 - share) * lengths[owner] > width
    apex = topology.tails[half_edges - half_edges % 3 + (half_edges + 2) % 3][owner]
    good = np.flatnonzero(inside & (far <= width) & (vertex != apex))
    if len(good) == 0:
        return None
    face = half_edges[owner[good]] // 3
    good = good[np.lexsort((share[good], owner[good], face))]
    _, firsts = np.unique(half_edges[owner[good]] // 3, return_index=True)
    chosen = good[firsts]
    return half_edges[owner[chosen]] // 3, half_edges[owner[chosen]] % 3, vertex[chosen], far[chosen]


def _keys(topology: Topology, one: Ints, other: Ints) -> Ints:
    return np.minimum(one, other) * topology.vertex_count + np.maximum(one, other)


def _rim_keys(topology: Topology) -> Ints:
    low, high = topology.ends[topology.boundary].T
    return _keys(topology, low, high)
