"""Boundaries with every edge halved: flat as they are, or curved as the smooth body they may stand for.

The curved kind interpolates: vertices stay, and the middle of an edge is moved to where a cubic curve through
its ends has it. Across a smooth surface the curve is at right angles to the normals at its ends (it is the
side of a PN triangle); along a crease, and on a polygon, it follows the directions of the edges before and
behind. Where faces or edges meet at more than `SMOOTH_TURN`, they are taken for sharp. Source: Vlachos et al.
2001, "Curved PN triangles".
"""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from idviewer.core.arrays import Bools, Floats, Ints
from idviewer.core.shapes.face_cuts import EdgesOfFaces, cut_faces
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.polygon import Polygon
from idviewer.core.shapes.shape import Shape

SMOOTH_TURN = math.radians(42.0)
"""Up to which two faces, or two edges, are taken for parts of one smooth surface or curve."""

SAME_SIDE = 0.5
"""Cosine up to which a face counts for the normal at a vertex, as an edge beside it sees it."""

LEAST_BEND = 1e-6
"""In units of the diagonal; what is moved by less is flat."""


def subdivided(shape: Shape, curved: bool = False) -> Shape:
    """The boundary with every edge halved and every triangle cut into four; the vertices come first.

    Args:
        shape: a mesh or a polygon.
        curved: whether middles of edges are moved to where a smooth body would have them.

    Raises:
        ShapeError: the curved boundary is no valid one.

    >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> len(subdivided(square).vertices)
    8
    >>> disk = Polygon([[math.cos(k), math.sin(k)] for k in np.arange(12) * math.pi / 6])
    >>> round(subdivided(disk).area / math.pi, 3), round(subdivided(disk, curved=True).area / math.pi, 3)
    (0.955, 0.988)
    """
    if isinstance(shape, Polygon):
        return _halved(shape, _bends_of_polygon(shape) if curved else np.zeros_like(shape.vertices))
    mesh = cast(Mesh, shape)
    edges = EdgesOfFaces.of(mesh.faces, len(mesh.vertices))
    middles = mesh.vertices[edges.ends].mean(axis=1)
    if curved:
        middles += _bends_of_mesh(mesh, edges)
    vertices = np.concatenate([mesh.vertices, middles])
    of_sides = np.full(mesh.faces.shape, -1)
    for side in range(2):
        of_sides[edges.faces[:, side], edges.corners[:, side]] = len(mesh.vertices) + np.arange(len(middles))
    return Mesh(vertices, cut_faces(vertices, mesh.faces, of_sides)[0], mesh.name)


def bends(shape: Shape) -> bool:
    """Whether a boundary has parts that may stand for a smooth body.

    >>> bends(Polygon([[0, 0], [1, 0], [1, 1], [0, 1]]))
    False
    """
    if isinstance(shape, Polygon):
        moved = _bends_of_polygon(shape)
    else:
        mesh = cast(Mesh, shape)
        moved = _bends_of_mesh(mesh, EdgesOfFaces.of(mesh.faces, len(mesh.vertices)))
    return bool(np.abs(moved).max() > LEAST_BEND * shape.diagonal)


def _halved(polygon: Polygon, moved: Floats) -> Polygon:
    count = len(polygon.vertices)
    middles = polygon.vertices[polygon.edges].mean(axis=1) + moved
    loops = [np.column_stack([loop, loop + count]).ravel() for loop in polygon.loops]
    return Polygon(np.concatenate([polygon.vertices, middles]), loops, polygon.name)


def _bends_of_polygon(polygon: Polygon) -> Floats:
    """How far the middle of each edge (n, 2) is moved."""
    ends = polygon.edges
    along = (polygon.vertices[ends[:, 1]] - polygon.vertices[ends[:, 0]]) / polygon.lengths[:, None]
    return _along_curve(ends, along, polygon.lengths, len(polygon.vertices))


def _along_curve(ends: Ints, along: Floats, lengths: Floats, count: int) -> Floats:
    """How far middles of the edges of curves are moved, from the directions of edges before and behind.

    Args:
        ends: (e, 2) of count vertices.
        along: (e, d) unit vectors from the first to the second end.
        lengths: (e,).
        count: of the vertices.
    """
    touching = np.bincount(ends.ravel(), minlength=count)
    # At each vertex the sum of directions away from it: short where two edges go on straight.
    away = np.zeros((count, along.shape[1]))
    np.add.at(away, ends[:, 0], along)
    np.add.at(away, ends[:, 1], -along)
    smooth = (touching == 2) & (np.linalg.norm(away, axis=1) <= 2.0 * math.sin(0.5 * SMOOTH_TURN))
    moved = np.zeros_like(along)
    for end, sign in ((0, 1.0), (1, -1.0)):
        here = ends[:, end]
        # The other edge's direction, turned to go on with this one.
        other = sign * along - away[here]
        tangents = sign * along + other
        tangents /= np.linalg.norm(tangents, axis=1)[:, None]
        moved += np.where(smooth[here, None], lengths[:, None] / 8.0 * (tangents - sign * along), 0.0)
    return moved


def _bends_of_mesh(mesh: Mesh, edges: EdgesOfFaces) -> Floats:
    """How far the middle of each edge (e, 3) is moved."""
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    left, right = normals[edges.faces[:, 0]], normals[edges.faces[:, 1]]
    smooth = np.einsum("ij,ij->i", left, right) >= math.cos(SMOOTH_TURN)
    spans = mesh.vertices[edges.ends[:, 1]] - mesh.vertices[edges.ends[:, 0]]
    lengths = np.linalg.norm(spans, axis=1)
    moved = np.zeros_like(spans)
    creased = np.bincount(edges.ends[~smooth].ravel(), minlength=len(mesh.vertices)) > 0
    for end, sign in ((0, 1.0), (1, -1.0)):
        found = _normals_at(mesh, normals, edges.ends[smooth, end], (left + right)[smooth], creased)
        rise = np.einsum("ij,ij->i", sign * spans[smooth], found)
        moved[smooth] -= rise[:, None] * found / 8.0
    sharp = ~smooth
    if sharp.any():
        ends, along = edges.ends[sharp], spans[sharp] / lengths[sharp, None]
        moved[sharp] = _along_curve(ends, along, lengths[sharp], len(mesh.vertices))
    return moved


def _normals_at(mesh: Mesh, normals: Floats, vertices: Ints, seen_from: Floats, creased: Bools) -> Floats:
    """Unit normals at vertices, of the faces around each that look the same way as seen from an edge.

    Args:
        mesh: m faces.
        normals: (m, 3) of these.
        vertices: (q,) their numbers.
        seen_from: (q, 3) the normal of the edge, of any length. It is also that of the tip of a cone.
        creased: for each vertex of the mesh, whether sharp edges meet it.
    """
    order = np.argsort(mesh.faces.ravel(), kind="stable")
    around, first = order // 3, np.searchsorted(mesh.faces.ravel()[order], np.arange(len(mesh.vertices) + 1))
    counts = first[vertices + 1] - first[vertices]
    query = np.repeat(np.arange(len(vertices)), counts)
    places = (
        np.arange(counts.sum())
        - np.repeat(np.cumsum(counts) - counts, counts)
        + np.repeat(first[vertices], counts)
    )
    faces = around[places]
    angles = _angles(mesh)[faces, order[places] % 3]
    side = seen_from / np.linalg.norm(seen_from, axis=1)[:, None]
    same: Bools = np.einsum("ij,ij->i", normals[faces], side[query]) >= SAME_SIDE
    sums = np.zeros((len(vertices), 3))
    np.add.at(sums, query[same], angles[same, None] * normals[faces[same]])
    tips = (np.bincount(query[~same], minlength=len(vertices)) > 0) & ~creased[vertices]
    sums[tips] = side[tips]
    return sums / np.linalg.norm(sums, axis=1)[:, None]


def _angles(mesh: Mesh) -> Floats:
    """Angle (m, 3) at each corner of each face, in radians."""
    corners = mesh.vertices[mesh.faces]
    there, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    across = np.linalg.norm(np.cross(there, back), axis=2)
    return np.asarray(np.arctan2(across, np.einsum("mij,mij->mi", there, back)))
