"""A mesh cut into small patches that fit into the processor's cache while points look at them."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FACES_IN_A_PATCH = 256


class Surface(NamedTuple):
    """Patches of faces that lie together; a patch has its own copies of its vertices, called rows.

    Attributes:
        vertices: (r,) vertex of each row.
        positions: (r, 3) of each row.
        first_row: (patches + 1,) where a patch's rows begin.
        faces: (m, 3) int32 rows of each face, counted from its patch's first.
        first_face: (patches + 1,) where a patch's faces begin.
        balls: (patches, 4) centre and radius of a ball around a patch.
        edges: (m,) longest edge of each face.
        longest: (patches,) longest edge of a patch.
    """

    vertices: Ints
    positions: Floats
    first_row: Ints
    faces: NDArray[np.int32]
    first_face: Ints
    balls: Floats
    edges: Floats
    longest: Floats


def patched(positions: Floats, faces: Ints) -> Surface:
    """Cut a mesh, (n, 3) positions and (m, 3) faces, into patches along a space-filling curve."""
    faces = faces[curve_order(positions[faces].mean(axis=1))]
    first_face = np.append(np.arange(0, len(faces), FACES_IN_A_PATCH), len(faces))
    corners = positions[faces]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    vertices, local, balls = [], np.empty(faces.shape, dtype=np.int32), []
    for start, end in pairwise(first_face.tolist()):
        rows, index = np.unique(faces[start:end], return_inverse=True)
        centre = positions[rows].mean(axis=0)
        vertices.append(rows)
        local[start:end] = index.reshape(-1, 3)
        balls.append([*centre, np.linalg.norm(positions[rows] - centre, axis=1).max()])
    first_row = np.append(0, np.cumsum([len(rows) for rows in vertices]))
    ids = np.concatenate(vertices)
    longest = np.maximum.reduceat(edges, first_face[:-1])
    return Surface(ids, positions[ids], first_row, local, first_face, np.array(balls), edges, longest)


def curve_order(points: Floats) -> Ints:
    """Order of (p, 3) points along a Morton curve of 2^10 cells a side."""
    if len(points) == 0:
        return np.empty(0, dtype=np.int64)
    low = points.min(axis=0)
    size = max(float(np.ptp(points, axis=0).max()), np.finfo(float).tiny)
    cells = ((points - low) / size * 1023.0).astype(np.int64)
    code = np.zeros(len(points), dtype=np.int64)
    for bit in range(10):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return np.argsort(code, kind="stable")
