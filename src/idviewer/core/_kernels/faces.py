"""A face's shares of the mean value weights, for a block of points: no branches, no trigonometry."""

from __future__ import annotations

import math

import numba

from idviewer.core._angle_ratio import NEAR as _Q
from idviewer.core._angle_ratio import SLIGHT as _S

LANES = 16
"""Points worked on together: two of the widest vector registers of float64."""

INVERSE, WEIGHT = 3 * LANES, 4 * LANES
"""Where the inverse distances and the weights begin in a row of a view; see `look_from`."""

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
    """A block of points looks at vertices; each row of view then holds five runs of LANES numbers.

    They are the unit vectors' x, y and z, the inverse distances, and the weights, which start at 0. One
    flat row makes all offsets constants, without which the compiler would not vectorise the loops below.
    """
    for i in range(vertices.shape[0]):
        vx, vy, vz = vertices[i, 0], vertices[i, 1], vertices[i, 2]
        seen = view[i]
        for lane in range(LANES):
            dx, dy, dz = vx - x[0, lane], vy - x[1, lane], vz - x[2, lane]
            over = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz + TINY)
            seen[lane] = dx * over
            seen[LANES + lane] = dy * over
            seen[2 * LANES + lane] = dz * over
            seen[INVERSE + lane] = over
            seen[WEIGHT + lane] = 0.0


def _shares_with(bend_of):  # type: ignore[no-untyped-def]
    @numba.njit(fastmath=FAST, error_model="numpy", cache=True)
    def add_shares(a, b, c, grazing):  # type: ignore[no-untyped-def]
        """Add one face's shares to its corners' weights; grazing views get none and a mark."""
        for lane in range(LANES):
            ax, ay, az = a[lane], a[LANES + lane], a[2 * LANES + lane]
            bx, by, bz = b[lane], b[LANES + lane], b[2 * LANES + lane]
            cx, cy, cz = c[lane], c[LANES + lane], c[2 * LANES + lane]
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
            flat = det * det <= GRAZING * GRAZING * (tx * tx + ty * ty + tz * tz)
            scale = 0.0 if flat else 0.5 / det
            grazing[lane] = 1.0 if flat else 0.0
            a[WEIGHT + lane] += scale * a[INVERSE + lane] * (rx * bc_x + ry * bc_y + rz * bc_z)
            b[WEIGHT + lane] += scale * b[INVERSE + lane] * (rx * ca_x + ry * ca_y + rz * ca_z)
            c[WEIGHT + lane] += scale * c[INVERSE + lane] * (rx * ab_x + ry * ab_y + rz * ab_z)

    return add_shares


add_near_shares = _shares_with(bend)
add_far_shares = _shares_with(_slight_bend)
"""For faces seen under small angles: shorter polynomials, and one division in all."""


@numba.njit(fastmath=FAST | {"reassoc"}, error_model="numpy", cache=True)
def total(values):  # type: ignore[no-untyped-def]
    """Sum of LANES numbers."""
    result = 0.0
    for lane in range(LANES):
        result += values[lane]
    return result
