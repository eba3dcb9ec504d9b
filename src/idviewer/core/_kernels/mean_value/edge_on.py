"""A face's shares where it is seen edge-on or touched: one point at a time, nothing cancels."""

from __future__ import annotations

import math

import numba

from idviewer.core._kernels.mean_value.faces import near_ratio_less_1
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS, TINY


@numba.njit(inline="always", **OPTIONS)
def _cross(a, b):  # type: ignore[no-untyped-def]
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@numba.njit(inline="always", **OPTIONS)
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@numba.njit(inline="always", **OPTIONS)
def _minus(a, b):  # type: ignore[no-untyped-def]
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@numba.njit(inline="always", **OPTIONS)
def _along(a, t, b):  # type: ignore[no-untyped-def]
    """a + t b."""
    return a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]


@numba.njit(**ALLOCATION_FREE)
def _ratio_less_1(s, c):  # type: ignore[no-untyped-def]
    """theta / sin(theta) - 1 from sin^2 and cos^2 of theta / 2."""
    if s <= c:
        return near_ratio_less_1(s)
    # Past a right angle: theta = pi - (the angle of the swapped halves).
    return 0.5 * math.pi / math.sqrt(s * c + TINY) - near_ratio_less_1(c) - 2.0


@numba.njit(**ALLOCATION_FREE)
def _edge_vector(a, b):  # type: ignore[no-untyped-def]
    """theta / sin(theta) * (u_a x u_b) of two directions given by vectors of any length, halved."""
    a = _along((0.0, 0.0, 0.0), 1.0 / math.sqrt(_dot(a, a) + TINY), a)
    b = _along((0.0, 0.0, 0.0), 1.0 / math.sqrt(_dot(b, b) + TINY), b)
    chord, twice_mean = _minus(b, a), _along(a, 1.0, b)
    ratio = 1.0 + _ratio_less_1(0.25 * _dot(chord, chord), 0.25 * _dot(twice_mean, twice_mean))
    return _along((0.0, 0.0, 0.0), 0.5 * ratio, _cross(a, chord))


@numba.njit(**ALLOCATION_FREE)
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
    difference = math.atan2(
        h * h * (length2 * inner / (spatial + area + TINY) - area),
        (inner + h * h) * inner + spatial * area,
    )
    flux = difference / h - angle * h / (reach * (reach + offset))
    return 0.5 * flux if signed >= 0.0 else -0.5 * flux


@numba.njit(**ALLOCATION_FREE)
def _touches_edge(p, q, h, tolerance):  # type: ignore[no-untyped-def]
    """Whether the point at height h over the origin lies on the segment p q, within tolerance."""
    edge = _minus(q, p)
    along = -_dot(p, edge) / (_dot(edge, edge) + TINY)
    foot = _along(p, min(max(along, 0.0), 1.0), edge)
    return _dot(foot, foot) + h * h <= tolerance * tolerance


@numba.njit(**ALLOCATION_FREE)
def edge_on_shares(x, a, b, c, tolerance):  # type: ignore[no-untyped-def]
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


@numba.njit(**ALLOCATION_FREE)
def row(array, i):  # type: ignore[no-untyped-def]
    return array[i, 0], array[i, 1], array[i, 2]
