"""Faces' shares of the mean value weights, for LANES points at once: no branches, no trigonometry.

A view holds two vectors a row (inverse distances and distances), kappas one an edge, weights one a row.
"""

from __future__ import annotations

import math

import numba

from idviewer.core._kernels.mean_value.angle_ratio import DISTANT, NEAR, SLIGHT, SLIGHT_LIMIT
from idviewer.core._kernels.mean_value.surface import CONSTANTS
from idviewer.core._kernels.simd.lanes import (
    LANES,
    any_of,
    at,
    bits,
    choose,
    load,
    root,
    smaller,
    splat,
    store,
)
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS, TINY

GRAZING = 1e-3
"""Sine of the angle between a face and the view from x below which det(u_1, u_2, u_3) loses digits."""

_Q = NEAR
_S = tuple(value / 4.0 ** (power + 1) for power, value in enumerate(SLIGHT))
_D = tuple(value / 4.0 ** (power + 1) for power, value in enumerate(DISTANT))


@numba.njit(inline="always", **OPTIONS)
def near_bend(small):  # type: ignore[no-untyped-def]
    """theta / sin(theta) - 1 from sin^2(theta / 2), up to a right angle; numbers or vectors."""
    q = ((_Q[20] * small + _Q[19]) * small + _Q[18]) * small + _Q[17]
    q = (((q * small + _Q[16]) * small + _Q[15]) * small + _Q[14]) * small + _Q[13]
    q = (((q * small + _Q[12]) * small + _Q[11]) * small + _Q[10]) * small + _Q[9]
    q = (((q * small + _Q[8]) * small + _Q[7]) * small + _Q[6]) * small + _Q[5]
    q = ((((q * small + _Q[4]) * small + _Q[3]) * small + _Q[2]) * small + _Q[1]) * small + _Q[0]
    return q * small


@numba.njit(inline="always", **ALLOCATION_FREE)
def _slight_bend(s):  # type: ignore[no-untyped-def]
    """theta / sin(theta) - 1 from s = 4 sin^2(theta / 2) up to 4 SLIGHT_LIMIT."""
    q = (((_S[8] * s + _S[7]) * s + _S[6]) * s + _S[5]) * s + _S[4]
    return ((((q * s + _S[3]) * s + _S[2]) * s + _S[1]) * s + _S[0]) * s


@numba.njit(**ALLOCATION_FREE)
def _bends(s, c):  # type: ignore[no-untyped-def]
    """theta / sin(theta) - 1 from sin^2 and cos^2 of theta / 2."""
    if not any_of(s > SLIGHT_LIMIT):
        return _slight_bend(4.0 * s)
    near = near_bend(smaller(s, c))
    # Past a right angle: theta = pi - (the angle of the swapped halves).
    return choose(s <= c, near, 0.5 * math.pi / root(s * c + TINY) - near - 2.0)


@numba.njit(**ALLOCATION_FREE)
def look_from(x, positions, start, end, view):  # type: ignore[no-untyped-def]
    """Points x (3, LANES) look at rows; the view holds inverse distances and distances."""
    x_0, x_1, x_2 = load(x, 0), load(x, LANES), load(x, 2 * LANES)
    place = 0
    for i in range(3 * start, 3 * end, 3):
        d_0, d_1, d_2 = at(positions, i) - x_0, at(positions, i + 1) - x_1, at(positions, i + 2) - x_2
        square = d_0 * d_0 + d_1 * d_1 + d_2 * d_2 + TINY
        inverse = 1.0 / root(square)
        store(view, place, inverse)
        store(view, place + LANES, square * inverse)
        place += 2 * LANES


@numba.njit(inline="always", **OPTIONS)
def _edge(view, ends, squares, e):  # type: ignore[no-untyped-def]
    """1 / (d_j d_k) of an edge and 4 sin^2(theta / 2) = (|e|^2 - (d_j - d_k)^2) / (d_j d_k)."""
    j, k = 2 * LANES * at(ends, 2 * e), 2 * LANES * at(ends, 2 * e + 1)
    product, step = load(view, j) * load(view, k), load(view, j + LANES) - load(view, k + LANES)
    return product, (at(squares, e) - step * step) * product


@numba.njit(**ALLOCATION_FREE)
def find_distant_kappas(view, ends, squares, start, end, kappas):  # type: ignore[no-untyped-def]
    """kappa = theta / sin(theta) / (d_j d_k) of edges, all of which are seen under distant angles."""
    for e in range(start, end):
        product, s = _edge(view, ends, squares, e)
        bend = ((((_D[4] * s + _D[3]) * s + _D[2]) * s + _D[1]) * s + _D[0]) * s
        store(kappas, (e - start) * LANES, product * bend + product)


@numba.njit(**ALLOCATION_FREE)
def find_kappas(view, ends, squares, start, end, kappas, near):  # type: ignore[no-untyped-def]
    """kappa of edges; those that some point sees under no slight angle get a mark instead."""
    for e in range(start, end):
        product, s = _edge(view, ends, squares, e)
        near[e - start] = any_of(s > 4.0 * SLIGHT_LIMIT)
        store(kappas, (e - start) * LANES, product * _slight_bend(s) + product)


@numba.njit(inline="always", **OPTIONS)
def _add(weights, place, shares):  # type: ignore[no-untyped-def]
    store(weights, place, load(weights, place) + shares)


@numba.njit(inline="always", **OPTIONS)
def _affine(constants, c, x_0, x_1, x_2):  # type: ignore[no-untyped-def]
    sum_0 = at(constants, c) * x_0 + at(constants, c + 3)
    return at(constants, c + 2) * x_2 + (at(constants, c + 1) * x_1 + sum_0)


@numba.njit(**ALLOCATION_FREE)
def note(grazed, count, face, lanes):  # type: ignore[no-untyped-def]
    """Add a face and the lanes of grazing views, as bits, to a list of count; returns the new count."""
    if lanes:
        grazed[count, 0], grazed[count, 1] = face, lanes
        count += 1
    return count


@numba.njit(**ALLOCATION_FREE)
def add_far_shares(x, faces, constants, start, end, kappas, weights, grazed, count):  # type: ignore[no-untyped-def]
    """Add the shares of faces seen under slight angles, by the fast formula of docs/mean_value.md.

    Grazing views get none and go to the list of grazed faces, whose new count is returned.
    """
    x_0, x_1, x_2 = load(x, 0), load(x, LANES), load(x, 2 * LANES)
    for f in range(start, end):
        c, i = CONSTANTS * f, 6 * f
        kappa_1, kappa_2 = load(kappas, LANES * at(faces, i + 3)), load(kappas, LANES * at(faces, i + 4))
        kappa_3 = load(kappas, LANES * at(faces, i + 5))
        d_12, d_23, d_31 = kappa_2 - kappa_1, kappa_3 - kappa_2, kappa_1 - kappa_3
        eta = _affine(constants, c, x_0, x_1, x_2)
        beta_1, beta_2 = _affine(constants, c + 4, x_0, x_1, x_2), _affine(constants, c + 8, x_0, x_1, x_2)
        total = (kappa_3 + d_31 * beta_1 - d_23 * beta_2) / eta
        grazing = eta * eta * kappa_1 < at(constants, c + 15)
        if any_of(grazing):
            total, eta = choose(grazing, 0.0, total), choose(grazing, 0.0, eta)
            count = note(grazed, count, f, bits(grazing))
        p = at(constants, c + 12) * d_12
        w_1 = total * beta_1 + eta * (p - at(constants, c + 14) * d_31)
        w_2 = total * beta_2 + eta * (at(constants, c + 13) * d_23 - p)
        _add(weights, LANES * at(faces, i), w_1)
        _add(weights, LANES * at(faces, i + 1), w_2)
        _add(weights, LANES * at(faces, i + 2), total - w_1 - w_2)
    return count


@numba.njit(inline="always", **OPTIONS)
def _unit(x, positions, i, inverse):  # type: ignore[no-untyped-def]
    return (
        (at(positions, 3 * i) - load(x, 0)) * inverse,
        (at(positions, 3 * i + 1) - load(x, LANES)) * inverse,
        (at(positions, 3 * i + 2) - load(x, 2 * LANES)) * inverse,
    )


@numba.njit(inline="always", **OPTIONS)
def _minus(a, b):  # type: ignore[no-untyped-def]
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@numba.njit(inline="always", **OPTIONS)
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@numba.njit(inline="always", **OPTIONS)
def _cross(a, b):  # type: ignore[no-untyped-def]
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@numba.njit(**ALLOCATION_FREE)
def _bend_between(a, b):  # type: ignore[no-untyped-def]
    """theta / sin(theta) - 1 of the angle between unit vectors."""
    chord = _minus(b, a)
    mean = a[0] + b[0], a[1] + b[1], a[2] + b[2]
    return _bends(0.25 * _dot(chord, chord), 0.25 * _dot(mean, mean))


@numba.njit(inline="always", **ALLOCATION_FREE)
def near_shares(a, b, c):  # type: ignore[no-untyped-def]
    """Shares of a face's corners times their distances by the robust formula, and which views are grazing.

    a, b, c: unit vectors from x to the corners. Grazing views get 0.
    """
    # Cross products through the chords, which keep their digits on small far faces.
    ab, bc, ca = _cross(a, _minus(b, a)), _cross(b, _minus(c, b)), _cross(c, _minus(a, c))
    twice = _cross(_minus(b, a), _minus(c, a))
    g_ab, g_bc, g_ca = _bend_between(a, b), _bend_between(b, c), _bend_between(c, a)
    r = (
        twice[0] + g_ab * ab[0] + g_bc * bc[0] + g_ca * ca[0],
        twice[1] + g_ab * ab[1] + g_bc * bc[1] + g_ca * ca[1],
        twice[2] + g_ab * ab[2] + g_bc * bc[2] + g_ca * ca[2],
    )
    det = _dot(a, twice)
    flat = det * det <= GRAZING * GRAZING * _dot(twice, twice)
    scale = choose(flat, 0.0, 0.5 / det)
    return scale * _dot(r, bc), scale * _dot(r, ca), scale * _dot(r, ab), flat


@numba.njit(**ALLOCATION_FREE)
def add_near_shares(x, positions, first_row, faces, f, view, weights):  # type: ignore[no-untyped-def]
    """Add one face's shares by the robust formula; returns the lanes of grazing views, which get none."""
    i, j, k = at(faces, 6 * f), at(faces, 6 * f + 1), at(faces, 6 * f + 2)
    over_a, over_b = load(view, 2 * LANES * i), load(view, 2 * LANES * j)
    over_c = load(view, 2 * LANES * k)
    a, b = _unit(x, positions, first_row + i, over_a), _unit(x, positions, first_row + j, over_b)
    c = _unit(x, positions, first_row + k, over_c)
    w_a, w_b, w_c, flat = near_shares(a, b, c)
    _add(weights, LANES * i, w_a * over_a)
    _add(weights, LANES * j, w_b * over_b)
    _add(weights, LANES * k, w_c * over_c)
    return bits(flat)


@numba.njit(**ALLOCATION_FREE)
def clear(weights, count):  # type: ignore[no-untyped-def]
    """Set count vectors to 0."""
    for place in range(0, count * LANES, LANES):
        store(weights, place, splat(0.0))


@numba.njit(**ALLOCATION_FREE)
def sum_of(weights, count):  # type: ignore[no-untyped-def]
    """Sum of count vectors."""
    result = splat(0.0)
    for place in range(0, count * LANES, LANES):
        result = result + load(weights, place)
    return result
