"""Moments of faces for the expansion of the mean value kernel; see docs/treecode.md."""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.simd.lanes import LANES, at, load, splat, store, widened
from idviewer.core._kernels.simd.options import ALLOCATION_FREE
from idviewer.core._kernels.treecode.expansion import COEFFICIENTS, monomials, vector_monomials
from idviewer.core._kernels.treecode.leaf import CORNER_NUMBERS
from idviewer.core.arrays import Floats, Ints

Floats32 = NDArray[np.float32]

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
        first_row, counts, centres, corners, rows: of its `Leaves`; compiled loops take no nested tuples.
        values: (rows of the leaves, k) float32, k a multiple of LANES; column 0 is all ones.
        weights: (k,) what an error of each column counts.
        depth: level of the leaves.
    """

    first_row: Ints
    counts: Ints
    centres: Floats
    corners: Floats
    rows: Ints
    values: Floats32
    weights: Floats
    depth: int


@numba.njit(inline="always", **ALLOCATION_FREE)
def _corner(corners, place, shift):  # type: ignore[no-untyped-def]
    return (
        load(corners, place) + shift[0],
        load(corners, place + LANES) + shift[1],
        load(corners, place + 2 * LANES) + shift[2],
    )


@numba.njit(**ALLOCATION_FREE)
def _face_moments(a, b, c, tables, powers, moments):  # type: ignore[no-untyped-def]
    """Moments (3, COEFFICIENTS, LANES) of the three hat functions of LANES faces.

    The moment of f for beta is -1/2 sum_i beta_i integral f n_i y^(beta - e_i) dA.
    """
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    area_x, area_y, area_z = 0.5 * (uy * vz - uz * vy), 0.5 * (uz * vx - ux * vz), 0.5 * (ux * vy - uy * vx)
    clear_moments(moments)
    hat = COEFFICIENTS * LANES
    for q in range(_RULE.shape[0]):
        s, t, r = _RULE[q, 0], _RULE[q, 1], _RULE[q, 2]
        vector_monomials(
            s * a[0] + t * b[0] + r * c[0],
            s * a[1] + t * b[1] + r * c[1],
            s * a[2] + t * b[2] + r * c[2],
            powers,
        )
        for k in range(COEFFICIENTS):
            sum_ = tables.exponents[k, 0] * area_x * load(powers, tables.lowered[k, 0] * LANES)
            sum_ = sum_ + tables.exponents[k, 1] * area_y * load(powers, tables.lowered[k, 1] * LANES)
            sum_ = sum_ + tables.exponents[k, 2] * area_z * load(powers, tables.lowered[k, 2] * LANES)
            sum_ = -0.5 * _RULE_WEIGHTS[q] * sum_
            place = k * LANES
            store(moments, place, load(moments, place) + s * sum_)
            store(moments, hat + place, load(moments, hat + place) + t * sum_)
            store(moments, 2 * hat + place, load(moments, 2 * hat + place) + r * sum_)


@numba.njit(**ALLOCATION_FREE)
def clear_moments(moments):  # type: ignore[no-untyped-def]
    """Set moments to 0."""
    for place in range(0, moments.size, LANES):
        store(moments, place, splat(0.0))


@numba.njit(**ALLOCATION_FREE)
def copy_moments(moments, result):  # type: ignore[no-untyped-def]
    """Copy moments."""
    for place in range(0, moments.size, LANES):
        store(result, place, load(moments, place))


@numba.njit(**ALLOCATION_FREE)
def _sum_hats(source, leaf, count, of_faces, hats):  # type: ignore[no-untyped-def]
    """Moments (rows, COEFFICIENTS) of a leaf's vertices from those of its faces' hat functions."""
    for row in range(count):
        for t in range(COEFFICIENTS):
            hats[row, t] = 0.0
    for corner in range(3):
        for face in range(source.counts[leaf]):
            row = source.rows[leaf, corner, face]
            for t in range(COEFFICIENTS):
                hats[row, t] += of_faces[corner, t, face]


@numba.njit(**ALLOCATION_FREE)
def leaf_moments(source, leaf, centre, tables, workspace, moments):  # type: ignore[no-untyped-def]
    """Moments (COEFFICIENTS, k) of all columns over a leaf's faces."""
    hats, corners, values, place = workspace.hats, source.corners, source.values, leaf * CORNER_NUMBERS
    shift = (
        source.centres[leaf, 0] - centre[0],
        source.centres[leaf, 1] - centre[1],
        source.centres[leaf, 2] - centre[2],
    )
    _face_moments(
        _corner(corners, place, shift),
        _corner(corners, place + 3 * LANES, shift),
        _corner(corners, place + 6 * LANES, shift),
        tables,
        workspace.powers_of_faces,
        workspace.of_faces,
    )
    first, width = source.first_row[leaf], values.shape[1]
    count = source.first_row[leaf + 1] - first
    _sum_hats(source, leaf, count, workspace.of_faces, hats)
    for column in range(0, width, LANES):
        for t in range(0, COEFFICIENTS, 5):
            a, b, c, d, e = splat(0.0), splat(0.0), splat(0.0), splat(0.0), splat(0.0)
            for row in range(count):
                value = widened(load(values, (first + row) * width + column))
                hat = row * COEFFICIENTS + t
                a, b = a + at(hats, hat) * value, b + at(hats, hat + 1) * value
                c, d = c + at(hats, hat + 2) * value, d + at(hats, hat + 3) * value
                e = e + at(hats, hat + 4) * value
            out = t * width + column
            store(moments, out, a)
            store(moments, out + width, b)
            store(moments, out + 2 * width, c)
            store(moments, out + 3 * width, d)
            store(moments, out + 4 * width, e)


@numba.njit(**ALLOCATION_FREE)
def add_shifted(moments, child, parent, centres, tables, workspace, result):  # type: ignore[no-untyped-def]
    """Add a child's moments to its parent's, whose centre is another."""
    width, powers, factors = result.shape[1], workspace.powers, workspace.shift_factors
    monomials(
        centres[child, 0] - centres[parent, 0],
        centres[child, 1] - centres[parent, 1],
        centres[child, 2] - centres[parent, 2],
        powers,
    )
    for s in range(tables.shifts.shape[0]):
        factors[s] = tables.binomials[s] * powers[tables.shifts[s, 2]]
    for column in range(0, width, LANES):
        s = 0
        for t in range(COEFFICIENTS):
            sum_ = load(result, t * width + column)
            while s < tables.shifts.shape[0] and tables.shifts[s, 0] == t:
                sum_ = sum_ + at(factors, s) * load(moments, tables.shifts[s, 1] * width + column)
                s += 1
            store(result, t * width + column, sum_)
