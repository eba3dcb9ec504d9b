"""A mesh cut into cache blocks: their vertices fit into the processor's cache while points look at them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.mean_value.angle_ratio import LIMIT_TO_10_DEGREES
from idviewer.core.arrays import Floats, Ints

Int32s = NDArray[np.int32]

FACES_PER_BLOCK = 128

NEEDLE_ASPECT = 64.0
"""A face whose longest edge is that many times its height is a needle."""

FAR_EDGE_ON_SINE = 1e-4
"""Sine of the angle between a face and the view from x below which the fast formula loses digits."""

CONSTANTS = 16


class Surface(NamedTuple):
    """Cache blocks of faces that lie together; each has its own copies of its vertices, the local vertices.

    Vertices and edges of faces and ends of edges are counted from the first of their block. Positions are
    relative to the centre of their block, so that rounding is relative to the block too.

    Attributes:
        vertices: (r,) the mesh's vertex of each local one.
        positions: (r, 3) of the local vertices.
        ends: (e, 2) int32 local vertices of each edge.
        squares: (e,) squared length of each edge.
        faces: (m, 6) int32 vertices and edges of each face, the edge opposite to the first corner first.
        constants: (m, CONSTANTS) of each face; see `_constants`.
        first_vertex, first_edge, first_face: (blocks + 1,) where a block's vertices, edges and faces begin.
        balls: (blocks, 4) centre of a ball around each block, and the square of the distance from it beyond
            which every edge is seen under less than 10 degrees.
        copies: (r,) the local vertices in the order of the mesh's.
        first_copy: (n + 1,) where a vertex's copies begin.
    """

    vertices: Ints
    positions: Floats
    ends: Int32s
    squares: Floats
    faces: Int32s
    constants: Floats
    first_vertex: Ints
    first_edge: Ints
    first_face: Ints
    balls: Floats
    copies: Ints
    first_copy: Ints


def surface_in_blocks(positions: Floats, faces: Ints) -> Surface:
    """Cut a mesh, (n, 3) positions and (m, 3) faces, into blocks of faces that lie together."""
    order = block_order(positions[faces].mean(axis=1), FACES_PER_BLOCK)
    return surface_of(
        positions, faces[order], np.append(np.arange(0, len(faces), FACES_PER_BLOCK), len(faces))
    )


def surface_of(positions: Floats, faces: Ints, first_face: Ints) -> Surface:
    """A mesh, (n, 3) positions and (m, 3) faces, whose blocks begin at first_face (blocks + 1,)."""
    vertices, first_vertex, ends, first_edge, local = _numbered(faces, first_face)
    starts = first_face[:-1]
    centres = np.add.reduceat(positions[faces].mean(axis=1), starts) / np.diff(first_face)[:, None]
    own = positions[vertices] - np.repeat(centres, np.diff(first_vertex), axis=0)
    tails, heads = (ends + np.repeat(first_vertex[:-1], np.diff(first_edge))[:, None]).T
    squares = ((own[heads] - own[tails]) ** 2).sum(axis=1)
    corners = own[local[:, :3] + np.repeat(first_vertex[:-1], np.diff(first_face))[:, None]]
    constants = _constants(corners)
    needles = np.logical_or.reduceat(constants[:, -1] < 0.0, starts)
    radii = np.sqrt(np.maximum.reduceat((own**2).sum(axis=1), first_vertex[:-1]))
    longest = np.sqrt(np.maximum.reduceat(squares, first_edge[:-1]))
    reaches = np.where(needles, np.inf, (radii + longest / (2.0 * np.sqrt(LIMIT_TO_10_DEGREES))) ** 2)
    return Surface(
        vertices=vertices,
        positions=own,
        ends=ends,
        squares=squares,
        faces=local,
        constants=constants,
        first_vertex=first_vertex,
        first_edge=first_edge,
        first_face=first_face,
        balls=np.hstack([centres, reaches[:, None]]),
        copies=np.argsort(vertices, kind="stable"),
        first_copy=np.searchsorted(np.sort(vertices), np.arange(len(positions) + 1)),
    )


def _numbered(faces: Ints, first_face: Ints) -> tuple[Ints, Ints, Int32s, Ints, Int32s]:
    """Vertices and edges of blocks: vertices, where they begin, ends, where edges begin, and faces."""
    blocks = len(first_face) - 1
    block = np.repeat(np.arange(blocks), np.diff(first_face))[:, None]
    count = int(faces.max()) + 1
    local_vertices, corners = np.unique(block * count + faces, return_inverse=True)
    first_vertex = np.searchsorted(local_vertices, np.arange(blocks + 1) * count)
    corners = corners.reshape(-1, 3) - first_vertex[block]
    most = int(np.diff(first_vertex).max())
    sides = np.sort(corners[:, [[1, 2], [2, 0], [0, 1]]], axis=2)
    edges, of_face = np.unique(block * most**2 + sides @ [most, 1], return_inverse=True)
    first_edge = np.searchsorted(edges, np.arange(blocks + 1) * most**2)
    ends = np.stack(np.divmod(edges % most**2, most), axis=1).astype(np.int32)
    local = np.hstack([corners, of_face.reshape(-1, 3) - first_edge[block]]).astype(np.int32)
    return local_vertices % count, first_vertex, ends, first_edge, local


def _constants(corners: Floats) -> Floats:
    """Constants of each face for the fast formula, (m, CONSTANTS).

    Of a face with area vector N (length: twice the area) and edges e_i, opposite to corner i: the affine
    functions of x eta = 2 h / |N|, beta_1 and beta_2 (three factors and a constant each), e_1.e_2 / 4,
    e_2.e_3 / 4, e_3.e_1 / 4, and the bound for eta^2 / (d_2 d_3) below which the view is edge-on: negative
    for needles, for which the formula is of no use.
    """
    first, second, third = corners.transpose(1, 0, 2)
    e_1, e_2, e_3 = third - second, first - third, second - first
    area_vector = np.cross(e_1, e_2)
    squares = (area_vector**2).sum(axis=1)
    longest = np.max([(edge**2).sum(axis=1) for edge in (e_1, e_2, e_3)], axis=0)
    needles = ~(np.sqrt(squares) * NEEDLE_ASPECT > longest)
    squares[needles] = 1.0
    normals = area_vector / squares[:, None]
    result = np.empty((len(corners), CONSTANTS))
    gradients = (-2.0 * normals, np.cross(normals, e_1), np.cross(normals, e_2))
    for start, gradient, zero in zip((0, 4, 8), gradients, (first, second, third), strict=True):
        result[:, start : start + 3] = gradient
        result[:, start + 3] = -(gradient * zero).sum(axis=1)
    for place, (a, b) in enumerate(((e_1, e_2), (e_2, e_3), (e_3, e_1)), start=12):
        result[:, place] = 0.25 * (a * b).sum(axis=1)
    result[:, 15] = np.where(needles, -1.0, 4.0 * FAR_EDGE_ON_SINE**2 / squares)
    return result


def block_order(points: Floats, size: int) -> Ints:
    """Order of (p, 3) points whose runs of a size lie together: they are halved across the longest extent."""

    def halved(chosen: Ints) -> list[Ints]:
        if len(chosen) <= size:
            return [chosen]
        axis = np.ptp(points[chosen], axis=0).argmax()
        middle = -(-len(chosen) // (2 * size)) * size
        order = np.argpartition(points[chosen, axis], middle)
        return [*halved(chosen[order[:middle]]), *halved(chosen[order[middle:]])]

    return np.concatenate(halved(np.arange(len(points))))
