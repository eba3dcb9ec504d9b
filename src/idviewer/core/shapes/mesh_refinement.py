"""Meshes with shorter edges: the same surface, its edges cut until none is longer than asked.

Edges between faces that meet at an angle are cut into equal parts, since what varies along them has no other
place. Inside a flat part of the surface edges may also be exchanged, which moves nothing: there the
triangulation is kept Delaunay, and midpoints of its longest edges are inserted where none is near. So a fan
of slivers costs as many vertices as its area needs, and not one row for each of its spokes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from idviewer.core.arrays import Bools, Floats, Ints
from idviewer.core.shapes.face_cuts import EdgesOfFaces, cut_faces


@dataclass(frozen=True)
class MeshRefinementSettings:
    """Settings of the refinement of flat parts.

    Attributes:
        flatness: in units of the diagonal, how far off a plane faces may lie that count as flat: what single
            precision, as STL files have it, leaves of flat faces.
        digits: of lengths and cotangents that count: rounding must not choose between what is equal, or a
            mesh would be refined otherwise when it is moved.
        delaunay_slack: by which the cotangents opposite an edge may add up to less than 0.
        band: edges shorter than the longest by more than this factor wait for a later round.
        spacing: of midpoints inserted at a time in one flat part, in units of the edges' length.
        well_shaped: triangles of this quality (1 is equilateral) are cut into similar ones.
        ridge_share: of the length asked for; a ridge's parts are no longer, so that the diagonals between
            two ridges that run close together are not too long either.
        flip_passes: at most, after each round; the next goes on with what is left.
        vertices_per_area: about, in units of the edge length squared, of flat parts.
    """

    flatness: float = 2.0**-22
    digits: int = 7
    delaunay_slack: float = 1e-7
    band: float = 0.7
    spacing: float = 0.45
    well_shaped: float = 0.6
    ridge_share: float = 0.95
    flip_passes: int = 200
    vertices_per_area: float = 2.4


MESH_REFINEMENT = MeshRefinementSettings()


def refined_arrays(
    vertices: Floats, faces: Ints, edge_length: float, exchanging: bool = True
) -> tuple[Floats, Ints]:
    """Vertices and faces of the same closed surface without edges longer than asked.

    The vertices that are there come first; those that are new lie on the surface.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
        edge_length: in the vertices' unit.
        exchanging: whether edges inside flat parts may be exchanged; else all edges are cut into equal parts.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> finer, pieces = refined_arrays(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]), 0.75)
    >>> finer.shape, pieces.shape
    ((10, 3), (16, 3))
    """
    surface = _Surface(vertices, faces)
    if not exchanging:
        surface.cut_edges(edge_length, everything=True)
        return surface.vertices, surface.faces
    surface.flip(np.arange(len(surface.vertices)))
    surface.cut_edges(edge_length)
    surface.flip(np.arange(len(surface.vertices)))
    while len(added := surface.insert_midpoints(edge_length)):
        surface.flip(added)
    return surface.vertices, surface.faces


def refined_count(vertices: Floats, faces: Ints, edge_length: float) -> float:
    """About how many vertices the surface would have, refined; within some thirty percent.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
        edge_length: in the vertices' unit.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> made = len(refined_arrays(corners, triangles, 0.02)[0])
    >>> bool(0.7 < refined_count(corners, triangles, 0.02) / made < 1.3)
    True
    """
    return _Surface(vertices, faces).count(edge_length)


class _Surface:
    """A closed surface while it is being refined.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
    """

    def __init__(self, vertices: Floats, faces: Ints) -> None:
        self.vertices, self.faces = vertices, faces
        self._flatness = MESH_REFINEMENT.flatness * float(np.linalg.norm(np.ptp(vertices, axis=0)))
        edges = EdgesOfFaces.of(faces, len(vertices))
        joined = edges.faces[self._flat(edges)]
        graph = coo_array((np.ones(len(joined)), joined.T), shape=(len(faces), len(faces)))
        self._parts = connected_components(graph, directed=False)[1]
        """The number of the flat part that each face belongs to."""

    def count(self, edge_length: float) -> float:
        """About how many vertices it will have without edges longer than that."""
        edges = EdgesOfFaces.of(self.faces, len(self.vertices))
        lengths = self._lengths(edges.ends)
        too_long = lengths > edge_length
        cut = np.unique(edges.faces[too_long])
        a, b, c = (self.vertices[self.faces[cut, corner]] for corner in range(3))
        area = 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
        ridges = float(lengths[too_long & ~self._flat(edges)].sum())
        settings = MESH_REFINEMENT
        return (
            len(self.vertices)
            + settings.vertices_per_area * area / edge_length**2
            + ridges / (settings.ridge_share * edge_length)
        )

    def cut_edges(self, edge_length: float, everything: bool = False) -> None:
        """Cut the edges between flat parts, and in these those of well-shaped triangles, into equal parts."""
        while True:
            edges = EdgesOfFaces.of(self.faces, len(self.vertices))
            lengths = self._lengths(edges.ends) / edge_length
            ridges = ~self._flat(edges) | (self._parts[edges.faces[:, 0]] != self._parts[edges.faces[:, 1]])
            share = np.where(ridges, MESH_REFINEMENT.ridge_share, 1.0)
            parts = np.ceil((lengths / share).round(MESH_REFINEMENT.digits))
            long = parts > 1.0
            if not everything:
                long &= ridges | self._well_shaped()[edges.faces].all(axis=1)
            if not long.any():
                return
            self._split(edges, np.flatnonzero(long), (parts[long] // 2.0) / parts[long])

    def _well_shaped(self) -> Bools:
        """Which faces can be cut into similar ones."""
        sides = self.vertices[self.faces[:, [1, 2, 0]]] - self.vertices[self.faces]
        double_areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
        squares = np.einsum("mij,mij->m", sides, sides)
        return 2.0 * math.sqrt(3.0) * double_areas >= MESH_REFINEMENT.well_shaped * squares

    def insert_midpoints(self, edge_length: float) -> Ints:
        """Insert midpoints of the longest edges that are too long, some way apart.

        Returns:
            Vertices of the faces that are new; none when no edge is left that is too long.
        """
        edges = EdgesOfFaces.of(self.faces, len(self.vertices))
        lengths = (self._lengths(edges.ends) / edge_length).round(MESH_REFINEMENT.digits)
        longest = np.zeros(len(self.faces))
        for side in edges.faces.T:
            np.maximum.at(longest, side, lengths)
        # The longest of both faces, so that no vertex comes near another.
        long = np.flatnonzero((lengths >= longest[edges.faces].max(axis=1)) & (lengths > 1.0))
        if len(long) == 0:
            return long
        band = max(1.0, MESH_REFINEMENT.band * lengths[long].max())
        long = long[lengths[long] >= band]
        long = long[np.argsort(-lengths[long], kind="stable")]
        middles = self.vertices[edges.ends[long]].mean(axis=1)
        radius = MESH_REFINEMENT.spacing * band * edge_length
        places = np.column_stack([middles, 2.0 * radius * self._parts[edges.faces[long, 0]]])
        chosen = _apart(places, edges.faces[long], radius)
        first = len(self.vertices)
        self._split(edges, long[chosen], np.full(len(chosen), 0.5))
        return np.unique(self.faces[(self.faces >= first).any(axis=1)])

    def flip(self, changed: Ints) -> None:
        """Exchange edges of flat parts until these are Delaunay, beginning at vertices of new faces."""
        for _ in range(MESH_REFINEMENT.flip_passes):
            marked = np.zeros(len(self.vertices), dtype=np.bool_)
            marked[changed] = True
            nearby = np.flatnonzero(marked[self.faces].any(axis=1))
            edges = EdgesOfFaces.of(self.faces[nearby], len(self.vertices))
            excess = -self._cotangent_sums(edges).round(MESH_REFINEMENT.digits)
            wanted = np.flatnonzero(excess > MESH_REFINEMENT.delaunay_slack)
            parts = self._parts[nearby[edges.faces[wanted]]]
            wanted = wanted[self._flat(edges, wanted) & (parts[:, 0] == parts[:, 1])]
            wanted = wanted[_best_of_faces(edges.faces[wanted], excess[wanted], len(nearby))]
            if len(wanted) == 0:
                return
            (a, b), (c, d) = edges.ends[wanted].T, edges.opposite[wanted].T
            first, second = nearby[edges.faces[wanted].T]
            self.faces = self.faces.copy()
            self.faces[first] = np.stack([a, d, c], axis=1)
            self.faces[second] = np.stack([d, b, c], axis=1)
            changed = np.concatenate([a, b, c, d])

    def _lengths(self, ends: Ints) -> Floats:
        return np.asarray(np.linalg.norm(self.vertices[ends[:, 0]] - self.vertices[ends[:, 1]], axis=1))

    def _flat(self, edges: EdgesOfFaces, some: Ints | None = None) -> Bools:
        """Whether the faces beside each edge lie in one plane, and not one upon the other."""
        ends, opposite = edges.ends, edges.opposite
        if some is not None:
            ends, opposite = ends[some], opposite[some]
        a = self.vertices[ends[:, 0]]
        along, to_c, to_d = (self.vertices[i] - a for i in (ends[:, 1], opposite[:, 0], opposite[:, 1]))
        left, right = np.cross(along, to_c), np.cross(to_d, along)
        larger = np.sqrt(np.maximum(*(np.einsum("ij,ij->i", n, n) for n in (left, right))))
        volume = np.abs(np.einsum("ij,ij->i", left, to_d))
        return (np.einsum("ij,ij->i", left, right) > 0.0) & (volume <= self._flatness * larger)

    def _cotangent_sums(self, edges: EdgesOfFaces) -> Floats:
        """Sum of the cotangents opposite each edge; below 0 where it is not Delaunay."""
        total = np.zeros(len(edges.ends))
        for tip in edges.opposite.T:
            to_a = self.vertices[edges.ends[:, 0]] - self.vertices[tip]
            to_b = self.vertices[edges.ends[:, 1]] - self.vertices[tip]
            across = np.cross(to_a, to_b)
            total += np.einsum("ij,ij->i", to_a, to_b) / np.sqrt(np.einsum("ij,ij->i", across, across))
        return total

    def _split(self, edges: EdgesOfFaces, cut: Ints, shares: Floats) -> None:
        """Cut edges, each at a share of the way from one end."""
        low = edges.ends[cut, 0] < edges.ends[cut, 1]  # the same share whichever face came first
        shares = np.where(low, shares, 1.0 - shares)[:, None]
        points = (1.0 - shares) * self.vertices[edges.ends[cut, 0]] + shares * self.vertices[
            edges.ends[cut, 1]
        ]
        added = np.arange(len(cut)) + len(self.vertices)
        self.vertices = np.concatenate([self.vertices, points])
        middles = np.full(self.faces.shape, -1)
        for side in range(2):
            middles[edges.faces[cut, side], edges.corners[cut, side]] = added
        self.faces, parents = cut_faces(self.vertices, self.faces, middles)
        self._parts = self._parts[parents]


def _apart(points: Floats, faces: Ints, radius: float) -> Ints:
    """Numbers of points of which no two are nearer than a radius, nor in one face; earlier ones go before."""
    free = np.ones(len(points), dtype=np.bool_)
    taken: set[int] = set()
    neighbours = cKDTree(points).query_ball_point(points, radius, return_sorted=False)
    chosen = []
    for number, nearby in enumerate(neighbours):
        if free[number] and taken.isdisjoint(beside := faces[number].tolist()):
            chosen.append(number)
            taken.update(beside)
            free[nearby] = False
    return np.array(chosen, dtype=np.int64)


def _best_of_faces(faces: Ints, gain: Floats, count: int) -> Bools:
    """Which edges gain more than all others of both of their faces (e, 2), of count faces."""
    order = np.argsort(gain, kind="stable")
    rank = np.empty(len(gain), dtype=np.int64)
    rank[order] = np.arange(len(gain))
    best = np.full(count, -1)
    for side in faces.T:
        np.maximum.at(best, side, rank)
    return (best[faces] == rank[:, None]).all(axis=1)
