"""Closest points on a triangle mesh, found by walking over it from a vertex nearby."""

from __future__ import annotations

import numba
import numpy as np

from idviewer.core._kernels.simd.options import SCALAR

MOST_STEPS = 64


@numba.njit(**SCALAR)
def _shares(vertices, corners, x, y, z, shares):  # type: ignore[no-untyped-def]
    """Fills the barycentric coordinates of a triangle's point closest to x, y, z; the square of its distance.

    Which corner, side or inside is closest is told by projections on the sides and signed areas (Ericson
    2005, section 5.1.5).
    """
    a, b, c = corners[0], corners[1], corners[2]
    a_x, a_y, a_z = vertices[a, 0], vertices[a, 1], vertices[a, 2]
    p_x, p_y, p_z = vertices[b, 0] - a_x, vertices[b, 1] - a_y, vertices[b, 2] - a_z
    q_x, q_y, q_z = vertices[c, 0] - a_x, vertices[c, 1] - a_y, vertices[c, 2] - a_z
    r_x, r_y, r_z = x - a_x, y - a_y, z - a_z
    pp, pq, qq = (
        p_x * p_x + p_y * p_y + p_z * p_z,
        p_x * q_x + p_y * q_y + p_z * q_z,
        q_x**2 + q_y**2 + q_z**2,
    )
    d_1, d_2 = p_x * r_x + p_y * r_y + p_z * r_z, q_x * r_x + q_y * r_y + q_z * r_z
    d_3, d_4, d_5, d_6 = d_1 - pp, d_2 - pq, d_1 - pq, d_2 - qq
    in_a, in_b, in_c = d_3 * d_6 - d_5 * d_4, d_5 * d_2 - d_1 * d_6, d_1 * d_4 - d_3 * d_2
    if d_1 <= 0.0 and d_2 <= 0.0:
        s, t = 0.0, 0.0
    elif d_3 >= 0.0 and d_4 <= d_3:
        s, t = 1.0, 0.0
    elif in_c <= 0.0 and d_1 >= 0.0 and d_3 <= 0.0:
        s, t = d_1 / (d_1 - d_3), 0.0
    elif d_6 >= 0.0 and d_5 <= d_6:
        s, t = 0.0, 1.0
    elif in_b <= 0.0 and d_2 >= 0.0 and d_6 <= 0.0:
        s, t = 0.0, d_2 / (d_2 - d_6)
    elif in_a <= 0.0 and d_4 - d_3 >= 0.0 and d_5 - d_6 >= 0.0:
        t = (d_4 - d_3) / ((d_4 - d_3) + (d_5 - d_6))
        s = 1.0 - t
    else:
        s, t = in_b / (in_a + in_b + in_c), in_c / (in_a + in_b + in_c)
    shares[0], shares[1], shares[2] = max(0.0, 1.0 - s - t), s, t
    off_x, off_y, off_z = r_x - s * p_x - t * q_x, r_y - s * p_y - t * q_y, r_z - s * p_z - t * q_z
    return off_x * off_x + off_y * off_y + off_z * off_z


@numba.njit(**SCALAR)
def project(points, starts, vertices, faces, first, around, found, shares):  # type: ignore[no-untyped-def]
    """Walk from a vertex, for each point, to where no face at the corners of the closest one is closer.

    Args:
        points: (p, 3).
        starts: (p,) vertices.
        vertices, faces: of the mesh, (n, 3) and (m, 3).
        first, around: (n + 1,) and (3 m,); the faces at vertex v are around[first[v] : first[v + 1]].
        found: (p,) filled with the faces.
        shares: (p, 3) filled with the barycentric coordinates of the closest points in them.
    """
    trial = np.empty(3)
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        best, face, seen = np.inf, -1, -1
        ring = np.full(3, starts[i])
        for _ in range(MOST_STEPS):
            for j in range(3):
                if j > 0 and ring[j] == ring[0]:
                    continue
                for at in range(first[ring[j]], first[ring[j] + 1]):
                    square = _shares(vertices, faces[around[at]], x, y, z, trial)
                    if square < best:
                        best, face = square, around[at]
                        shares[i] = trial
            if face == seen:
                break
            seen = face
            ring[:] = faces[face]
        found[i] = face
