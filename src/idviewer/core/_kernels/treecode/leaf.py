"""One leaf's faces as seen by one point: the lanes are faces."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from idviewer.core._kernels.mean_value.edge_on import edge_on_shares
from idviewer.core._kernels.mean_value.faces import near_shares
from idviewer.core._kernels.simd.lanes import LANES, bits, load, root, store
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, TINY
from idviewer.core.arrays import Floats, Ints

CORNER_NUMBERS = 9 * LANES


class Leaves(NamedTuple):
    """Runs of at most LANES faces; each has its own copies of its vertices, called rows.

    Attributes:
        vertices: (r,) vertex of each row.
        first_row: (leaves + 1,) where a leaf's rows begin.
        counts: (leaves,) how many faces each has.
        centres: (leaves, 3).
        corners: (leaves, 3, 3, LANES) corner, axis and face, relative to the leaf's centre; the last face is
            repeated where a leaf has fewer.
        rows: (leaves, 3, LANES) the corners' rows, counted from the leaf's first.
    """

    vertices: Ints
    first_row: Ints
    counts: Ints
    centres: Floats
    corners: Floats
    rows: Ints


def leaves_of(positions: Floats, faces: Ints, first_face: Ints) -> Leaves:
    """Leaves of (m, 3) faces that are in order, the i-th from first_face[i] to first_face[i + 1] - 1."""
    counts, leaves = np.diff(first_face), len(first_face) - 1
    padded = faces[first_face[:-1, None] + np.minimum(np.arange(LANES), counts[:, None] - 1)]
    vertices, rows = np.empty(3 * len(faces), dtype=np.int64), np.empty((leaves, 3, LANES), dtype=np.int64)
    first_row = np.zeros(leaves + 1, dtype=np.int64)
    _number_rows(padded, vertices, rows, first_row)
    centres = positions[padded].mean(axis=(1, 2))
    relative = positions[padded] - centres[:, None, None]
    return Leaves(
        vertices[: first_row[-1]].copy(),
        first_row,
        counts,
        centres,
        np.ascontiguousarray(relative.transpose(0, 2, 3, 1)),
        rows,
    )


@numba.njit(cache=True, **ALLOCATION_FREE)
def _number_rows(padded, vertices, rows, first_row):  # type: ignore[no-untyped-def]
    """Give each leaf's vertices rows of their own, in the order of its faces (leaves, LANES, 3)."""
    for leaf in range(padded.shape[0]):
        first = end = first_row[leaf]
        for face in range(padded.shape[1]):
            for corner in range(3):
                row = first
                while row < end and vertices[row] != padded[leaf, face, corner]:
                    row += 1
                if row == end:
                    vertices[row] = padded[leaf, face, corner]
                    end += 1
                rows[leaf, corner, face] = row - first
        first_row[leaf + 1] = end


@numba.njit(inline="always", **ALLOCATION_FREE)
def _corner(corners, place, x, y, z):  # type: ignore[no-untyped-def]
    return (
        load(corners, place) - x,
        load(corners, place + LANES) - y,
        load(corners, place + 2 * LANES) - z,
    )


@numba.njit(inline="always", **ALLOCATION_FREE)
def _unit(vector):  # type: ignore[no-untyped-def]
    """Unit vectors, and one over the lengths."""
    square = vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2] + TINY
    over = 1.0 / root(square)
    return (vector[0] * over, vector[1] * over, vector[2] * over), over


@numba.njit(inline="always", **ALLOCATION_FREE)
def _place(corners, leaf, corner, face):  # type: ignore[no-untyped-def]
    return corners[leaf, corner, 0, face], corners[leaf, corner, 1, face], corners[leaf, corner, 2, face]


@numba.njit(**ALLOCATION_FREE)
def weigh_leaf(x, y, z, corners, leaf, count, tolerance, shares):  # type: ignore[no-untyped-def]
    """Shares (3, LANES) of each face's corners, not normalised, for a point relative to the leaf's centre.

    Returns the face that the point lies on, whose shares are then those of the linear interpolation; -1
    where it lies on none.
    """
    place = leaf * CORNER_NUMBERS
    a, over_a = _unit(_corner(corners, place, x, y, z))
    b, over_b = _unit(_corner(corners, place + 3 * LANES, x, y, z))
    c, over_c = _unit(_corner(corners, place + 6 * LANES, x, y, z))
    w_a, w_b, w_c, edge_on = near_shares(a, b, c)
    store(shares, 0, w_a * over_a)
    store(shares, LANES, w_b * over_b)
    store(shares, 2 * LANES, w_c * over_c)
    doubtful = bits(edge_on)
    for over in (over_a, over_b, over_c):
        doubtful |= bits(over * tolerance >= 1.0)
    if doubtful:
        for face in range(count):
            if (doubtful >> face) & 1:
                w_a, w_b, w_c, touches = edge_on_shares(
                    (x, y, z),
                    _place(corners, leaf, 0, face),
                    _place(corners, leaf, 1, face),
                    _place(corners, leaf, 2, face),
                    tolerance,
                )
                shares[0, face], shares[1, face], shares[2, face] = w_a, w_b, w_c
                if touches:
                    return face
    return -1
