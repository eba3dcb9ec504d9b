"""A mesh cut into small patches that fit into the processor's cache while points look at them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.mean_value.angle_ratio import DISTANT_LIMIT
from idviewer.core.arrays import Floats, Ints

Int32s = NDArray[np.int32]

FACES_IN_A_PATCH = 128

SLENDER = 64.0
"""A face whose longest edge is that many times its height is a needle."""

GRAZING_FROM_AFAR = 1e-4
"""Sine of the angle between a face and the view from x below which the fast formula loses digits."""

CONSTANTS = 16


class Surface(NamedTuple):
    """Patches of faces that lie together; a patch has its own copies of its vertices, called rows.

    Rows and edges of faces and ends of edges are counted from the first of their patch. Positions are
    relative to the centre of their patch, so that rounding is relative to the patch too.

    Attributes:
        vertices: (r,) vertex of each row.
        positions: (r, 3) of each row.
        ends: (e, 2) int32 rows of each edge.
        squares: (e,) squared length of each edge.
        faces: (m, 6) int32 rows and edges of each face, the edge opposite to the first corner first.
        constants: (m, CONSTANTS) of each face; see `_constants`.
        first_row, first_edge, first_face: (patches + 1,) where a patch's rows, edges and faces begin.
        balls: (patches, 4) centre of a ball around each patch, and the square of the distance from it beyond
            which every edge is seen under a distant angle.
        copies: (r,) the rows in the order of their vertices.
        first_copy: (n + 1,) where a vertex's copies begin.
    """

    vertices: Ints
    positions: Floats
    ends: Int32s
    squares: Floats
    faces: Int32s
    constants: Floats
    first_row: Ints
    first_edge: Ints
    first_face: Ints
    balls: Floats
    copies: Ints
    first_copy: Ints


def patched(positions: Floats, faces: Ints) -> Surface:
    """Cut a mesh, (n, 3) positions and (m, 3) faces, into patches of faces that lie together."""
    order = patch_order(positions[faces].mean(axis=1), FACES_IN_A_PATCH)
    return surface_of(
        positions, faces[order], np.append(np.arange(0, len(faces), FACES_IN_A_PATCH), len(faces))
    )


def surface_of(positions: Floats, faces: Ints, first_face: Ints) -> Surface:
    """A mesh, (n, 3) positions and (m, 3) faces, whose patches begin at first_face (patches + 1,)."""
    vertices, first_row, ends, first_edge, local = _numbered(faces, first_face)
    starts = first_face[:-1]
    centres = np.add.reduceat(positions[faces].mean(axis=1), starts) / np.diff(first_face)[:, None]
    own = positions[vertices] - np.repeat(centres, np.diff(first_row), axis=0)
    tails, heads = (ends + np.repeat(first_row[:-1], np.diff(first_edge))[:, None]).T
    squares = ((own[heads] - own[tails]) ** 2).sum(axis=1)
    corners = own[local[:, :3] + np.repeat(first_row[:-1], np.diff(first_face))[:, None]]
    constants = _constants(corners)
    needles = np.logical_or.reduceat(constants[:, -1] < 0.0, starts)
    radii = np.sqrt(np.maximum.reduceat((own**2).sum(axis=1), first_row[:-1]))
    longest = np.sqrt(np.maximum.reduceat(squares, first_edge[:-1]))
    reaches = np.where(needles, np.inf, (radii + longest / (2.0 * np.sqrt(DISTANT_LIMIT))) ** 2)
    return Surface(
        vertices=vertices,
        positions=own,
        ends=ends,
        squares=squares,
        faces=local,
        constants=constants,
        first_row=first_row,
        first_edge=first_edge,
        first_face=first_face,
        balls=np.hstack([centres, reaches[:, None]]),
        copies=np.argsort(vertices, kind="stable"),
        first_copy=np.searchsorted(np.sort(vertices), np.arange(len(positions) + 1)),
    )


def _numbered(faces: Ints, first_face: Ints) -> tuple[Ints, Ints, Int32s, Ints, Int32s]:
    """Rows and edges of patches: the vertices, where rows begin, the ends, where edges begin, the faces."""
    patches = len(first_face) - 1
    patch = np.repeat(np.arange(patches), np.diff(first_face))[:, None]
    count = int(faces.max()) + 1
    rows, corners = np.unique(patch * count + faces, return_inverse=True)
    first_row = np.searchsorted(rows, np.arange(patches + 1) * count)
    corners = corners.reshape(-1, 3) - first_row[patch]
    most = int(np.diff(first_row).max())
    sides = np.sort(corners[:, [[1, 2], [2, 0], [0, 1]]], axis=2)
    edges, of_face = np.unique(patch * most**2 + sides @ [most, 1], return_inverse=True)
    first_edge = np.searchsorted(edges, np.arange(patches + 1) * most**2)
    ends = np.stack(np.divmod(edges % most**2, most), axis=1).astype(np.int32)
    local = np.hstack([corners, of_face.reshape(-1, 3) - first_edge[patch]]).astype(np.int32)
    return rows % count, first_row, ends, first_edge, local


def _constants(corners: Floats) -> Floats:
    """What the fast formula needs of each face, (m, CONSTANTS).

    Of a face with area vector N (length: twice the area) and edges e_i, opposite to corner i: the affine
    functions of x eta = 2 h / |N|, beta_1 and beta_2 (three factors and a constant each), e_1.e_2 / 4,
    e_2.e_3 / 4, e_3.e_1 / 4, and the bound for eta^2 / (d_2 d_3) below which the view is grazing: negative
    for needles, for which the formula is of no use.
    """
    first, second, third = corners.transpose(1, 0, 2)
    e_1, e_2, e_3 = third - second, first - third, second - first
    area_vector = np.cross(e_1, e_2)
    squares = (area_vector**2).sum(axis=1)
    longest = np.max([(edge**2).sum(axis=1) for edge in (e_1, e_2, e_3)], axis=0)
    needles = ~(np.sqrt(squares) * SLENDER > longest)
    squares[needles] = 1.0
    normals = area_vector / squares[:, None]
    result = np.empty((len(corners), CONSTANTS))
    gradients = (-2.0 * normals, np.cross(normals, e_1), np.cross(normals, e_2))
    for start, gradient, zero in zip((0, 4, 8), gradients, (first, second, third), strict=True):
        result[:, start : start + 3] = gradient
        result[:, start + 3] = -(gradient * zero).sum(axis=1)
    for place, (a, b) in enumerate(((e_1, e_2), (e_2, e_3), (e_3, e_1)), start=12):
        result[:, place] = 0.25 * (a * b).sum(axis=1)
    result[:, 15] = np.where(needles, -1.0, 4.0 * GRAZING_FROM_AFAR**2 / squares)
    return result


def patch_order(points: Floats, size: int) -> Ints:
    """Order of (p, 3) points whose runs of a size lie together: they are halved across the longest extent."""

    def halved(chosen: Ints) -> list[Ints]:
        if len(chosen) <= size:
            return [chosen]
        axis = np.ptp(points[chosen], axis=0).argmax()
        middle = -(-len(chosen) // (2 * size)) * size
        order = np.argpartition(points[chosen, axis], middle)
        return [*halved(chosen[order[:middle]]), *halved(chosen[order[middle:]])]

    return np.concatenate(halved(np.arange(len(points))))
