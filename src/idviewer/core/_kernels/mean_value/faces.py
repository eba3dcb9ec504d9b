"""Faces' shares of the mean value weights, for LANES points at once: no branches, no trigonometry.

Of a local vertex `distances` holds two vectors (one over its distance, and the distance) and `weights` one;
`edge_weights` holds one for each edge.
"""

from __future__ import annotations

import math

import numba

from idviewer.core._kernels.mean_value.angle_ratio import (
    LIMIT_TO_29_DEGREES,
    RATIO_TO_10_DEGREES,
    RATIO_TO_29_DEGREES,
    RATIO_TO_90_DEGREES,
)
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

EDGE_ON_SINE = 1e-3
"""Sine of the angle between a face and the view from x below which det(u_1, u_2, u_3) loses digits."""

_N = RATIO_TO_90_DEGREES
_S = tuple(value / 4.0 ** (power + 1) for power, value in enumerate(RATIO_TO_29_DEGREES))
_D = tuple(value / 4.0 ** (power + 1) for power, value in enumerate(RATIO_TO_10_DEGREES))


@numba.njit(inline="always", **OPTIONS)
def near_ratio_less_1(small):  # type: ignore[no-untyped-def]
    """theta / sin(theta) - 1 from sin^2(theta / 2), up to a right angle; numbers or vectors."""
    q = ((_N[20] * small + _N[19]) * small + _N[18]) * small + _N[17]
    q = (((q * small + _N[16]) * small + _N[15]) * small + _N[14]) * small + _N[13]
    q = (((q * small + _N[12]) * small + _N[11]) * small + _N[10]) * small + _N[9]
    q = (((q * small + _N[8]) * small + _N[7]) * small + _N[6]) * small + _N[5]
    q = ((((q * small + _N[4]) * small + _N[3]) * small + _N[2]) * small + _N[1]) * small + _N[0]
    return q * small


@numba.njit(inline="always", **ALLOCATION_FREE)
def _slight_ratio_less_1(s):  # type: ignore[no-untyped-def]
    """theta / sin(theta) - 1 from s = 4 sin^2(theta / 2) up to 4 LIMIT_TO_29_DEGREES."""
    q = (((_S[8] * s + _S[7]) * s + _S[6]) * s + _S[5]) * s + _S[4]
    return ((((q * s + _S[3]) * s + _S[2]) * s + _S[1]) * s + _S[0]) * s


@numba.njit(**ALLOCATION_FREE)
def _ratios_less_1(s, c):  # type: ignore[no-untyped-def]
    """theta / sin(theta) - 1 from sin^2 and cos^2 of theta / 2."""
    if not any_of(s > LIMIT_TO_29_DEGREES):
        return _slight_ratio_less_1(4.0 * s)
    near = near_ratio_less_1(smaller(s, c))
    # Past a right angle: theta = pi - (the angle of the swapped halves).
    return choose(s <= c, near, 0.5 * math.pi / root(s * c + TINY) - near - 2.0)


@numba.njit(**ALLOCATION_FREE)
def find_distances(x, positions, start, end, distances):  # type: ignore[no-untyped-def]
    """Fill in one over the distances, and the distances, of points x (3, LANES) from local vertices."""
    x_0, x_1, x_2 = load(x, 0), load(x, LANES), load(x, 2 * LANES)
    place = 0
    for i in range(3 * start, 3 * end, 3):
        d_0, d_1, d_2 = at(positions, i) - x_0, at(positions, i + 1) - x_1, at(positions, i + 2) - x_2
        square = d_0 * d_0 + d_1 * d_1 + d_2 * d_2 + TINY
        inverse = 1.0 / root(square)
        store(distances, place, inverse)
        store(distances, place + LANES, square * inverse)
        place += 2 * LANES


@numba.njit(inline="always", **OPTIONS)
def _edge(distances, ends, squares, e):  # type: ignore[no-untyped-def]
    """1 / (d_j d_k) of an edge and 4 sin^2(theta / 2) = (|e|^2 - (d_j - d_k)^2) / (d_j d_k)."""
    j, k = 2 * LANES * at(ends, 2 * e), 2 * LANES * at(ends, 2 * e + 1)
    product, step = (
        load(distances, j) * load(distances, k),
        load(distances, j + LANES) - load(distances, k + LANES),
    )
    return product, (at(squares, e) - step * step) * product


@numba.njit(**ALLOCATION_FREE)
def find_far_edge_weights(distances, ends, squares, start, end, edge_weights):  # type: ignore[no-untyped-def]
    """kappa = theta / sin(theta) / (d_j d_k) of edges, all of which are seen under less than 10 degrees."""
    for e in range(start, end):
        product, s = _edge(distances, ends, squares, e)
        ratio_less_1 = ((((_D[4] * s + _D[3]) * s + _D[2]) * s + _D[1]) * s + _D[0]) * s
        store(edge_weights, (e - start) * LANES, product * ratio_less_1 + product)


@numba.njit(**ALLOCATION_FREE)
def find_edge_weights(distances, ends, squares, start, end, edge_weights, near):  # type: ignore[no-untyped-def]
    """kappa of edges; those that some point sees under more than 29 degrees get a mark instead."""
    for e in range(start, end):
        product, s = _edge(distances, ends, squares, e)
        near[e - start] = any_of(s > 4.0 * LIMIT_TO_29_DEGREES)
        store(edge_weights, (e - start) * LANES, product * _slight_ratio_less_1(s) + product)


@numba.njit(inline="always", **OPTIONS)
def _add(weights, place, shares):  # type: ignore[no-untyped-def]
    store(weights, place, load(weights, place) + shares)


@numba.njit(inline="always", **OPTIONS)
def _affine(constants, c, x_0, x_1, x_2):  # type: ignore[no-untyped-def]
    sum_0 = at(constants, c) * x_0 + at(constants, c + 3)
    return at(constants, c + 2) * x_2 + (at(constants, c + 1) * x_1 + sum_0)


@numba.njit(**ALLOCATION_FREE)
def note(edge_on, count, face, lanes):  # type: ignore[no-untyped-def]
    """Add a face and the lanes that see it edge-on, as bits, to a list of count; returns the new count."""
    if lanes:
        edge_on[count, 0], edge_on[count, 1] = face, lanes
        count += 1
    return count


@numba.njit(**ALLOCATION_FREE)
def add_far_shares(x, faces, constants, start, end, edge_weights, weights, edge_on, count):  # type: ignore[no-untyped-def]
    """Add the shares of faces seen under less than 29 degrees, by the fast formula of docs/mean_value.md.

    Edge-on views get none and go to the list of edge-on faces, whose new count is returned.
    """
    x_0, x_1, x_2 = load(x, 0), load(x, LANES), load(x, 2 * LANES)
    for f in range(start, end):
        c, i = CONSTANTS * f, 6 * f
        kappa_1, kappa_2 = (
            load(edge_weights, LANES * at(faces, i + 3)),
            load(edge_weights, LANES * at(faces, i + 4)),
        )
        kappa_3 = load(edge_weights, LANES * at(faces, i + 5))
        d_12, d_23, d_31 = kappa_2 - kappa_1, kappa_3 - kappa_2, kappa_1 - kappa_3
        eta = _affine(constants, c, x_0, x_1, x_2)
        beta_1, beta_2 = _affine(constants, c + 4, x_0, x_1, x_2), _affine(constants, c + 8, x_0, x_1, x_2)
        total = (kappa_3 + d_31 * beta_1 - d_23 * beta_2) / eta
        lanes = eta * eta * kappa_1 < at(constants, c + 15)
        if any_of(lanes):
            total, eta = choose(lanes, 0.0, total), choose(lanes, 0.0, eta)
            count = note(edge_on, count, f, bits(lanes))
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
def _ratio_less_1_between(a, b):  # type: ignore[no-untyped-def]
    """theta / sin(theta) - 1 of the angle between unit vectors."""
    chord = _minus(b, a)
    mean = a[0] + b[0], a[1] + b[1], a[2] + b[2]
    return _ratios_less_1(0.25 * _dot(chord, chord), 0.25 * _dot(mean, mean))


@numba.njit(inline="always", **ALLOCATION_FREE)
def near_shares(a, b, c):  # type: ignore[no-untyped-def]
    """Shares of a face's corners times their distances by the robust formula, and which views are edge-on.

    a, b, c: unit vectors from x to the corners. Edge-on views get 0.
    """
    # Cross products through the chords, which keep their digits on small far faces.
    ab, bc, ca = _cross(a, _minus(b, a)), _cross(b, _minus(c, b)), _cross(c, _minus(a, c))
    twice = _cross(_minus(b, a), _minus(c, a))
    g_ab, g_bc, g_ca = _ratio_less_1_between(a, b), _ratio_less_1_between(b, c), _ratio_less_1_between(c, a)
    r = (
        twice[0] + g_ab * ab[0] + g_bc * bc[0] + g_ca * ca[0],
        twice[1] + g_ab * ab[1] + g_bc * bc[1] + g_ca * ca[1],
        twice[2] + g_ab * ab[2] + g_bc * bc[2] + g_ca * ca[2],
    )
    det = _dot(a, twice)
    edge_on = det * det <= EDGE_ON_SINE * EDGE_ON_SINE * _dot(twice, twice)
    scale = choose(edge_on, 0.0, 0.5 / det)
    return scale * _dot(r, bc), scale * _dot(r, ca), scale * _dot(r, ab), edge_on


@numba.njit(**ALLOCATION_FREE)
def add_near_shares(x, positions, first_row, faces, f, distances, weights):  # type: ignore[no-untyped-def]
    """Add one face's shares by the robust formula; returns the lanes of edge-on views, which get none."""
    i, j, k = at(faces, 6 * f), at(faces, 6 * f + 1), at(faces, 6 * f + 2)
    over_a, over_b = load(distances, 2 * LANES * i), load(distances, 2 * LANES * j)
    over_c = load(distances, 2 * LANES * k)
    a, b = _unit(x, positions, first_row + i, over_a), _unit(x, positions, first_row + j, over_b)
    c = _unit(x, positions, first_row + k, over_c)
    w_a, w_b, w_c, edge_on = near_shares(a, b, c)
    _add(weights, LANES * i, w_a * over_a)
    _add(weights, LANES * j, w_b * over_b)
    _add(weights, LANES * k, w_c * over_c)
    return bits(edge_on)


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
