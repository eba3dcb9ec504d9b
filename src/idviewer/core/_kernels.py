"""Compiled loops: mean value weights of many points at once. The only file that knows numba.

Notation as in docs/mean_value.md: x a query point, u_i the unit vector from x to vertex i, d_i its
distance; for the triangle (1, 2, 3), s_jk = |u_j - u_k|^2 / 4 and c_jk = |u_j + u_k|^2 / 4 = 1 - s_jk.
Everything is in units of the bounding box's diagonal, about its centre.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from idviewer.core._angle_ratio import COEFFICIENTS as _Q

LANES = 16
"""Points worked on together; eight float64 fill the widest vector registers."""

GRAZING = 1e-3
"""Sine of the angle between a face and the view from x below which det(u_1, u_2, u_3) loses digits."""

TINY = 1e-300

OUTSIDE, INSIDE, ON_SURFACE = 0, 1, 2


_FAST = {"contract", "nsz"}  # never anything that lets NaN or infinity be assumed away


@numba.njit(inline="always", fastmath=_FAST, error_model="numpy")
def _angle_ratio_minus_one(s: float, c: float) -> float:
    """g - 1 with g = theta / sin(theta), from sin^2 and cos^2 of theta / 2, without trigonometry."""
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


@numba.njit(fastmath=_FAST, error_model="numpy", cache=True)
def _look_from(x, vertices, view, nearest):  # type: ignore[no-untyped-def]
    """Unit vectors and inverse distances from a block of points to all vertices, and the nearest one's."""
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
            nearest[0, lane] = i if over > nearest[1, lane] else nearest[0, lane]
            nearest[1, lane] = over if over > nearest[1, lane] else nearest[1, lane]


@numba.njit(fastmath=_FAST, error_model="numpy", cache=True)
def _face_shares(a, b, c, share):  # type: ignore[no-untyped-def]
    """One face's share of its corners' weights, for a block of points; grazing views get 0 and a mark."""
    for lane in range(LANES):
        ax, ay, az = a[0, lane], a[1, lane], a[2, lane]
        bx, by, bz = b[0, lane], b[1, lane], b[2, lane]
        cx, cy, cz = c[0, lane], c[1, lane], c[2, lane]
        abx, aby, abz = bx - ax, by - ay, bz - az
        acx, acy, acz = cx - ax, cy - ay, cz - az
        bcx, bcy, bcz = cx - bx, cy - by, cz - bz
        sx, sy, sz = ax + bx, ay + by, az + bz
        g_ab = _angle_ratio_minus_one(
            0.25 * (abx * abx + aby * aby + abz * abz), 0.25 * (sx * sx + sy * sy + sz * sz)
        )
        sx, sy, sz = bx + cx, by + cy, bz + cz
        g_bc = _angle_ratio_minus_one(
            0.25 * (bcx * bcx + bcy * bcy + bcz * bcz), 0.25 * (sx * sx + sy * sy + sz * sz)
        )
        sx, sy, sz = cx + ax, cy + ay, cz + az
        g_ca = _angle_ratio_minus_one(
            0.25 * (acx * acx + acy * acy + acz * acz), 0.25 * (sx * sx + sy * sy + sz * sz)
        )
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


@numba.njit(fastmath=_FAST | {"reassoc"}, error_model="numpy", cache=True)
def _accumulate(w_a, w_b, w_c, share):  # type: ignore[no-untyped-def]
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


@numba.njit(inline="always", fastmath=_FAST, error_model="numpy")
def _cross(a, b):  # type: ignore[no-untyped-def]
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@numba.njit(inline="always", fastmath=_FAST, error_model="numpy")
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@numba.njit(inline="always", fastmath=_FAST, error_model="numpy")
def _minus(a, b):  # type: ignore[no-untyped-def]
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@numba.njit(inline="always", fastmath=_FAST, error_model="numpy")
def _along(a, t, b):  # type: ignore[no-untyped-def]
    """a + t b."""
    return a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]


@numba.njit(fastmath=_FAST, error_model="numpy", cache=True)
def _edge_vector(a, b):  # type: ignore[no-untyped-def]
    """theta / sin(theta) * (u_a x u_b) of two directions given by vectors of any length, halved."""
    a = _along((0.0, 0.0, 0.0), 1.0 / math.sqrt(_dot(a, a) + TINY), a)
    b = _along((0.0, 0.0, 0.0), 1.0 / math.sqrt(_dot(b, b) + TINY), b)
    chord, twice_mean = _minus(b, a), _along(a, 1.0, b)
    ratio = 1.0 + _angle_ratio_minus_one(0.25 * _dot(chord, chord), 0.25 * _dot(twice_mean, twice_mean))
    return _along((0.0, 0.0, 0.0), 0.5 * ratio, _cross(a, chord))


@numba.njit(fastmath=_FAST, error_model="numpy", cache=True)
def _edge_flux(p, q, normal, h):  # type: ignore[no-untyped-def]
    """An edge's term in the closed form of W = integral of h / rho^4 over the face (docs/mean_value.md).

    p, q: in-plane vectors from the projection of x to the edge's ends. The sum over the three edges, plus
    pi / h where the projection falls into the face, is W. Every difference that would cancel as h goes
    to 0 is written out, so the term keeps its digits down to h = 0.
    """
    edge = _minus(q, p)
    length2 = _dot(edge, edge)
    signed = _dot(normal, _cross(p, q))
    area, inner = abs(signed), _dot(p, q)
    offset = area / math.sqrt(length2 + TINY)
    reach = math.sqrt(offset * offset + h * h)
    if reach <= TINY:
        return 0.0
    spatial = math.sqrt(area * area + h * h * length2)
    angle = math.atan2(spatial, inner + h * h)
    bend = math.atan2(
        h * h * (length2 * inner / (spatial + area + TINY) - area),
        (inner + h * h) * inner + spatial * area,
    )
    flux = bend / h - angle * h / (reach * (reach + offset))
    return 0.5 * flux if signed >= 0.0 else -0.5 * flux


@numba.njit(fastmath=_FAST, error_model="numpy", cache=True)
def _touches_edge(p, q, h, tolerance):  # type: ignore[no-untyped-def]
    """Whether the point at height h over the origin lies on the segment p q, within tolerance."""
    edge = _minus(q, p)
    along = -_dot(p, edge) / (_dot(edge, edge) + TINY)
    foot = _along(p, min(max(along, 0.0), 1.0), edge)
    return _dot(foot, foot) + h * h <= tolerance * tolerance


@numba.njit(fastmath=_FAST, error_model="numpy", cache=True)
def _grazing_shares(x, a, b, c, tolerance):  # type: ignore[no-untyped-def]
    """A face's shares where x lies in its plane or nearly so, and whether x lies on the face itself.

    Here the 3x3 solve is ill-conditioned, though its solution is not. With r = sum w_i (v_i - x) and W =
    sum w_i, the shares are w_i = W beta_i + grad(beta_i) . r, beta the barycentric coordinates of x's
    projection; r needs no division, and W has a closed form that does not cancel.
    """
    a, b, c = _minus(a, x), _minus(b, x), _minus(c, x)
    normal = _cross(_minus(b, a), _minus(c, a))
    double_area = math.sqrt(_dot(normal, normal))
    if double_area <= TINY:
        return 0.0, 0.0, 0.0, False
    normal = _along((0.0, 0.0, 0.0), 1.0 / double_area, normal)
    h = (_dot(normal, a) + _dot(normal, b) + _dot(normal, c)) / 3.0
    pa, pb, pc = _along(a, -h, normal), _along(b, -h, normal), _along(c, -h, normal)
    beta_a = _dot(normal, _cross(pb, pc)) / double_area
    beta_b = _dot(normal, _cross(pc, pa)) / double_area
    beta_c = _dot(normal, _cross(pa, pb)) / double_area
    over = beta_a >= 0.0 and beta_b >= 0.0 and beta_c >= 0.0
    if (
        (over and abs(h) <= tolerance)
        or _touches_edge(pa, pb, h, tolerance)
        or _touches_edge(pb, pc, h, tolerance)
        or _touches_edge(pc, pa, h, tolerance)
    ):
        return beta_a, beta_b, beta_c, True
    total = 0.0
    if h != 0.0:
        total = _edge_flux(pa, pb, normal, h) + _edge_flux(pb, pc, normal, h) + _edge_flux(pc, pa, normal, h)
        if over:
            total += math.pi / h
    r = _along(_along(_edge_vector(a, b), 1.0, _edge_vector(b, c)), 1.0, _edge_vector(c, a))
    r = _along((0.0, 0.0, 0.0), 1.0 / double_area, r)
    w_a = total * beta_a + _dot(_cross(normal, _minus(c, b)), r)
    w_b = total * beta_b + _dot(_cross(normal, _minus(a, c)), r)
    w_c = total * beta_c + _dot(_cross(normal, _minus(b, a)), r)
    return w_a, w_b, w_c, False


@numba.njit(fastmath=_FAST, error_model="numpy", cache=True)
def _row(array, i):  # type: ignore[no-untyped-def]
    return array[i, 0], array[i, 1], array[i, 2]


@numba.njit(fastmath=_FAST, error_model="numpy", cache=True)
def _settle(weights, touched, corners, shares, nearest, tolerance):  # type: ignore[no-untyped-def]
    """Normalise a block's weights; on the surface they become the linear interpolation. Returns states."""
    states = np.empty(LANES, dtype=np.int8)
    totals = np.zeros(LANES)
    for i in range(weights.shape[0]):
        for lane in range(LANES):
            totals[lane] += weights[i, lane]
    for lane in range(LANES):
        at_vertex = nearest[1, lane] * tolerance >= 1.0
        states[lane] = INSIDE if totals[lane] > 0.0 else OUTSIDE
        if at_vertex or touched[lane]:
            states[lane] = ON_SURFACE
            weights[:, lane] = 0.0
            totals[lane] = 1.0
        if at_vertex:
            weights[int(nearest[0, lane]), lane] = 1.0
        elif touched[lane]:
            for corner in range(3):
                weights[corners[lane, corner], lane] = shares[lane, corner]
        totals[lane] = 1.0 / totals[lane]
    for i in range(weights.shape[0]):
        for lane in range(LANES):
            weights[i, lane] *= totals[lane]
    return states


@numba.njit(fastmath=_FAST, error_model="numpy", cache=True)
def _weigh_block(x, vertices, faces, tolerance, view, weights):  # type: ignore[no-untyped-def]
    """Mean value weights of one block of points x (3, LANES), into weights (n, LANES)."""
    nearest = np.zeros((2, LANES))
    share = np.empty((4, LANES))
    touched = np.zeros(LANES, dtype=np.bool_)
    corners = np.zeros((LANES, 3), dtype=np.int64)
    shares = np.zeros((LANES, 3))
    weights[:] = 0.0
    _look_from(x, vertices, view, nearest)
    for f in range(faces.shape[0]):
        i, j, k = _row(faces, f)
        _face_shares(view[i], view[j], view[k], share)
        if _accumulate(weights[i], weights[j], weights[k], share) == 0.0:
            continue
        for lane in range(LANES):
            if share[3, lane] == 0.0:
                continue
            at = (x[0, lane], x[1, lane], x[2, lane])
            w_i, w_j, w_k, touches = _grazing_shares(
                at, _row(vertices, i), _row(vertices, j), _row(vertices, k), tolerance
            )
            if touches:
                touched[lane] = True
                corners[lane] = (i, j, k)
                shares[lane] = (w_i, w_j, w_k)
            else:
                weights[i, lane] += w_i
                weights[j, lane] += w_j
                weights[k, lane] += w_k
    return _settle(weights, touched, corners, shares, nearest, tolerance)


@numba.njit(parallel=True, fastmath=_FAST, error_model="numpy", cache=True)
def mean_value_weights(points, vertices, faces, tolerance, view, weights, states):  # type: ignore[no-untyped-def]
    """Exact mean value weights of many points; Ju, Schaefer and Warren 2005, vectorised over points.

    Args:
        points: (blocks, 3, LANES).
        vertices: (n, 3).
        faces: (m, 3) int32.
        tolerance: how near the surface a point counts as lying on it.
        view: (threads, n, 4, LANES) scratch.
        weights: (blocks, n, LANES) output; they add up to 1 over the vertices.
        states: (blocks, LANES) int8 output; OUTSIDE, INSIDE or ON_SURFACE. The sum of the weights before
            they are normalised is the integral over all directions of 1/r_1 - 1/r_2 + 1/r_3 - ... with r_i
            the crossings of the surface; the signs are the opposite outside, so its sign tells the side.
    """
    for worker in numba.prange(view.shape[0]):
        for block in range(worker, points.shape[0], view.shape[0]):
            states[block] = _weigh_block(
                points[block], vertices, faces, tolerance, view[worker], weights[block]
            )


@numba.njit(parallel=True, fastmath=_FAST, error_model="numpy", cache=True)
def interpolate(points, vertices, faces, tolerance, scratch, values, result, states):  # type: ignore[no-untyped-def]
    """Vertex values carried to many points by mean value weights, which are not kept.

    Args:
        points: (blocks, 3, LANES).
        vertices: (n, 3).
        faces: (m, 3) int32.
        tolerance: how near the surface a point counts as lying on it.
        scratch: view (threads, n, 4, LANES) and weights (threads, n, LANES).
        values: (n, k).
        result: (blocks, LANES, k) output.
        states: (blocks, LANES) int8 output, as `mean_value_weights`.
    """
    view, weights = scratch
    for worker in numba.prange(view.shape[0]):
        for block in range(worker, points.shape[0], view.shape[0]):
            states[block] = _weigh_block(
                points[block], vertices, faces, tolerance, view[worker], weights[worker]
            )
            result[block] = np.dot(weights[worker].T, values)


def thread_count() -> int:
    """How many threads the kernels use."""
    return int(numba.get_num_threads())
