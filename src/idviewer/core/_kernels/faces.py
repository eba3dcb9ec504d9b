"""A face's shares of the mean value weights, for a block of points: no branches, no trigonometry."""

from __future__ import annotations

import math

import numba

from idviewer.core._angle_ratio import NEAR as _Q
from idviewer.core._angle_ratio import SLIGHT as _S

LANES = 16
"""Points worked on together: two of the widest vector registers of float64."""

GRAZING = 1e-3
"""Sine of the angle between a face and the view from x below which det(u_1, u_2, u_3) loses digits."""

TINY = 1e-300

FAST = {"contract", "nsz"}  # never anything that lets NaN or infinity be assumed away


@numba.njit(inline="always", fastmath=FAST, error_model="numpy")
def bend(s: float, c: float) -> float:
    """g - 1 with g = theta / sin(theta), from sin^2 and cos^2 of theta / 2."""
    small = s if s < c else c
    q = ((_Q[20] * small + _Q[19]) * small + _Q[18]) * small + _Q[17]
    q = (((q * small + _Q[16]) * small + _Q[15]) * small + _Q[14]) * small + _Q[13]
    q = (((q * small + _Q[12]) * small + _Q[11]) * small + _Q[10]) * small + _Q[9]
    q = (((q * small + _Q[8]) * small + _Q[7]) * small + _Q[6]) * small + _Q[5]
    q = ((((q * small + _Q[4]) * small + _Q[3]) * small + _Q[2]) * small + _Q[1]) * small + _Q[0]
    near = small * q
    # Past a right angle: theta = pi - (the angle of the swapped halves).
    far = 0.5 * math.pi / math.sqrt(s * c + TINY) - near - 2.0
    return near if s <= c else far


@numba.njit(inline="always", fastmath=FAST, error_model="numpy")
def _slight_bend(s: float, c: float) -> float:
    """As `bend`, for s up to SLIGHT_LIMIT; what the caller computes c from is left out by the compiler."""
    q = ((_S[7] * s + _S[6]) * s + _S[5]) * s + _S[4]
    return s * ((((q * s + _S[3]) * s + _S[2]) * s + _S[1]) * s + _S[0])


@numba.njit(fastmath=FAST, error_model="numpy", cache=True)
def look_from(x, vertices, view):  # type: ignore[no-untyped-def]
    """Unit vectors (rows 0 to 2 of view) and inverse distances (row 3) from a block of points to vertices."""
    for i in range(vertices.shape[0]):
        vx, vy, vz = vertices[i, 0], vertices[i, 1], vertices[i, 2]
        seen = view[i]
        for lane in range(LANES):
            dx, dy, dz = vx - x[0, lane], vy - x[1, lane], vz - x[2, lane]
            over = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz + TINY)
            seen[0, lane] = dx * over
            seen[1, lane] = dy * over
            seen[2, lane] = dz * over
            seen[3, lane] = over


def _shares_with(bend_of):  # type: ignore[no-untyped-def]
    @numba.njit(fastmath=FAST, error_model="numpy", cache=True)
    def shares(a, b, c, share):  # type: ignore[no-untyped-def]
        """One face's shares of its corners' weights; grazing views get 0 and a mark."""
        for lane in range(LANES):
            ax, ay, az = a[0, lane], a[1, lane], a[2, lane]
            bx, by, bz = b[0, lane], b[1, lane], b[2, lane]
            cx, cy, cz = c[0, lane], c[1, lane], c[2, lane]
            abx, aby, abz = bx - ax, by - ay, bz - az
            acx, acy, acz = cx - ax, cy - ay, cz - az
            bcx, bcy, bcz = cx - bx, cy - by, cz - bz
            sx, sy, sz = ax + bx, ay + by, az + bz
            g_ab = bend_of(0.25 * (abx * abx + aby * aby + abz * abz), 0.25 * (sx * sx + sy * sy + sz * sz))
            sx, sy, sz = bx + cx, by + cy, bz + cz
            g_bc = bend_of(0.25 * (bcx * bcx + bcy * bcy + bcz * bcz), 0.25 * (sx * sx + sy * sy + sz * sz))
            sx, sy, sz = cx + ax, cy + ay, cz + az
            g_ca = bend_of(0.25 * (acx * acx + acy * acy + acz * acz), 0.25 * (sx * sx + sy * sy + sz * sz))
            # Cross products through the chords, which keep their digits on small far faces.
            tx, ty, tz = aby * acz - abz * acy, abz * acx - abx * acz, abx * acy - aby * acx
            ab_x, ab_y, ab_z = ay * abz - az * aby, az * abx - ax * abz, ax * aby - ay * abx
            bc_x, bc_y, bc_z = by * bcz - bz * bcy, bz * bcx - bx * bcz, bx * bcy - by * bcx
            ca_x, ca_y, ca_z = acy * az - acz * ay, acz * ax - acx * az, acx * ay - acy * ax
            rx = tx + g_ab * ab_x + g_bc * bc_x + g_ca * ca_x
            ry = ty + g_ab * ab_y + g_bc * bc_y + g_ca * ca_y
            rz = tz + g_ab * ab_z + g_bc * bc_z + g_ca * ca_z
            det = ax * tx + ay * ty + az * tz
            grazing = det * det <= GRAZING * GRAZING * (tx * tx + ty * ty + tz * tz)
            scale = 0.0 if grazing else 0.5 / det
            share[0, lane] = scale * a[3, lane] * (rx * bc_x + ry * bc_y + rz * bc_z)
            share[1, lane] = scale * b[3, lane] * (rx * ca_x + ry * ca_y + rz * ca_z)
            share[2, lane] = scale * c[3, lane] * (rx * ab_x + ry * ab_y + rz * ab_z)
            share[3, lane] = 1.0 if grazing else 0.0

    return shares


near_shares = _shares_with(bend)
far_shares = _shares_with(_slight_bend)
"""For faces seen under small angles: shorter polynomials, and one division in all."""


@numba.njit(fastmath=FAST | {"reassoc"}, error_model="numpy", cache=True)
def accumulate(w_a, w_b, w_c, share):  # type: ignore[no-untyped-def]
    """Add the shares to the weights; return how many of the views are grazing."""
    count = 0.0
    for lane in range(LANES):
        w_a[lane] += share[0, lane]
    for lane in range(LANES):
        w_b[lane] += share[1, lane]
    for lane in range(LANES):
        w_c[lane] += share[2, lane]
        count += share[3, lane]
    return count
