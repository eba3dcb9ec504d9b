"""Moments of faces for the expansion of the mean value kernel; see docs/cluster_tree.md."""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.expansion import COEFFICIENTS, monomials
from idviewer.core._kernels.faces import PLAIN
from idviewer.core._kernels.lanes import LANES, at, load, splat, store

Floats = NDArray[np.float64]

# A rule of degree 5 on the triangle: barycentric coordinates of its points, and their weights.
_NEAR, _FAR = (6.0 + math.sqrt(15.0)) / 21.0, (6.0 - math.sqrt(15.0)) / 21.0
_RULE = np.array(
    [[1.0 / 3.0] * 3]
    + [[1.0 - 2.0 * a if i == j else a for i in range(3)] for a in (_NEAR, _FAR) for j in range(3)]
)
_RULE_WEIGHTS = np.array(
    [0.225] + [(155.0 + math.sqrt(15.0)) / 1200.0] * 3 + [(155.0 - math.sqrt(15.0)) / 1200.0] * 3
)


class Source(NamedTuple):
    """A surface with what is given at its vertices, ordered for a tree.

    Attributes:
        positions: (n, 3).
        faces: (m, 3) in the order of the leaves.
        values: (n, k) at the vertices, k a multiple of LANES; column 0 is all ones.
        weights: (k,) what an error of each column counts.
        depth: level of the leaves.
    """

    positions: Floats
    faces: NDArray[np.int64]
    values: Floats
    weights: Floats
    depth: int


@numba.njit(**PLAIN)
def _corner(source, vertex, centre):  # type: ignore[no-untyped-def]
    return (
        source.positions[vertex, 0] - centre[0],
        source.positions[vertex, 1] - centre[1],
        source.positions[vertex, 2] - centre[2],
    )


@numba.njit(**PLAIN)
def _face_moments(a, b, c, tables, powers, moments):  # type: ignore[no-untyped-def]
    """Moments (3, COEFFICIENTS) of a face's three hat functions; returns its area vector.

    The moment of f for beta is -1/2 sum_i beta_i integral f n_i y^(beta - e_i) dA.
    """
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    area = 0.5 * (uy * vz - uz * vy), 0.5 * (uz * vx - ux * vz), 0.5 * (ux * vy - uy * vx)
    for k in range(COEFFICIENTS):
        moments[0, k] = moments[1, k] = moments[2, k] = 0.0
    for q in range(_RULE.shape[0]):
        s, t, r = _RULE[q, 0], _RULE[q, 1], _RULE[q, 2]
        monomials(
            s * a[0] + t * b[0] + r * c[0],
            s * a[1] + t * b[1] + r * c[1],
            s * a[2] + t * b[2] + r * c[2],
            powers,
        )
        for k in range(COEFFICIENTS):
            sum_ = 0.0
            for axis in range(3):
                sum_ += tables.exponents[k, axis] * area[axis] * powers[tables.lowered[k, axis]]
            sum_ *= -0.5 * _RULE_WEIGHTS[q]
            moments[0, k] += s * sum_
            moments[1, k] += t * sum_
            moments[2, k] += r * sum_
    return area


@numba.njit(**PLAIN)
def clear_moments(moments):  # type: ignore[no-untyped-def]
    for place in range(0, moments.size, LANES):
        store(moments, place, splat(0.0))


@numba.njit(**PLAIN)
def copy_moments(moments, result):  # type: ignore[no-untyped-def]
    for place in range(0, moments.size, LANES):
        store(result, place, load(moments, place))


@numba.njit(**PLAIN)
def leaf_moments(source, low, high, centre, tables, desk, moments, area):  # type: ignore[no-untyped-def]
    """Moments (COEFFICIENTS, k) of all columns over some faces, and their area vector (3,)."""
    width, hats, powers = source.values.shape[1], desk.hats, desk.powers
    clear_moments(moments)
    for axis in range(3):
        area[axis] = 0.0
    for f in range(low, high):
        i, j, k = source.faces[f, 0], source.faces[f, 1], source.faces[f, 2]
        a, b, c = _corner(source, i, centre), _corner(source, j, centre), _corner(source, k, centre)
        own = _face_moments(a, b, c, tables, powers, hats)
        for axis in range(3):
            area[axis] += own[axis]
        for column in range(0, width, LANES):
            at_i, at_j = load(source.values, i * width + column), load(source.values, j * width + column)
            at_k = load(source.values, k * width + column)
            for t in range(COEFFICIENTS):
                place = t * width + column
                share = at(hats, t) * at_i + at(hats, COEFFICIENTS + t) * at_j
                share = share + at(hats, 2 * COEFFICIENTS + t) * at_k
                store(moments, place, load(moments, place) + share)


@numba.njit(**PLAIN)
def add_shifted(moments, child, parent, centres, tables, powers, result):  # type: ignore[no-untyped-def]
    """Add a child's moments to its parent's, whose centre is another."""
    width = result.shape[1]
    monomials(
        centres[child, 0] - centres[parent, 0],
        centres[child, 1] - centres[parent, 1],
        centres[child, 2] - centres[parent, 2],
        powers,
    )
    for s in range(tables.shifts.shape[0]):
        factor = tables.binomials[s] * powers[tables.shifts[s, 2]]
        to, out_of = tables.shifts[s, 0] * width, tables.shifts[s, 1] * width
        for column in range(0, width, LANES):
            store(result, to + column, load(result, to + column) + factor * load(moments, out_of + column))
