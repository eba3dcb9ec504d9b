"""Moments of a cluster as the product of few shapes and profiles, and how far they reach."""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.simd.lanes import LANES, load, splat, store, total
from idviewer.core._kernels.simd.options import ALLOCATION_FREE
from idviewer.core._kernels.treecode.expansion import COEFFICIENTS, ORDER, TABLES, Tables
from idviewer.core.arrays import Floats

Floats32 = NDArray[np.float32]

RANK = 24
"""Most profiles that a node keeps."""


class Factors(NamedTuple):
    """Moments of nodes, one behind the other: each a product of few shapes and profiles.

    Attributes:
        shapes: (f, COEFFICIENTS).
        profiles: (f, k).
        rests: (f,) the error left by the node's factors before each one.
    """

    shapes: Floats32
    profiles: Floats32
    rests: Floats32


class Plan(NamedTuple):
    """What to be accurate for.

    Attributes:
        tolerance: error allowed to a node, in the weights' unit.
        share: of that error which the factors may cause.
        tables: the multi-indices.
    """

    tolerance: float
    share: float
    tables: Tables


class FactorWorkspace(NamedTuple):
    """Room for intermediate results, with one more axis in front for as many subtrees.

    Attributes:
        of_faces: (3, COEFFICIENTS, LANES) moments of a leaf's faces' hat functions.
        powers_of_faces: (COEFFICIENTS + 1, LANES) monomials at a point of each.
        hats: (rows of the largest leaf, COEFFICIENTS) moments of its vertices.
        powers: (COEFFICIENTS + 1,) monomials, and shift_factors: (s,) these times binomials.
        scaled: (COEFFICIENTS, k) moments, with scales: (COEFFICIENTS,) and squares: (k,) of their columns.
        direction: (COEFFICIENTS,) of a shape.
        profile: (k,).
        joined: (COEFFICIENTS, k) moments of a node.
        waiting: (levels, COEFFICIENTS, k) moments of left children.
    """

    of_faces: Floats
    powers_of_faces: Floats
    hats: Floats
    powers: Floats
    shift_factors: Floats
    scaled: Floats
    scales: Floats
    squares: Floats
    direction: Floats
    profile: Floats
    joined: Floats
    waiting: Floats


def factor_workspaces(width: int, rows: int, levels: int, subtrees: int) -> FactorWorkspace:
    """Room for so many subtrees of so many levels, with so many rows in the largest leaf."""
    one = (subtrees, COEFFICIENTS)
    return FactorWorkspace(
        np.empty((subtrees, 3, COEFFICIENTS, LANES)),
        np.empty((subtrees, COEFFICIENTS + 1, LANES)),
        np.empty((subtrees, rows, COEFFICIENTS)),
        np.empty((subtrees, COEFFICIENTS + 1)),
        np.empty((subtrees, len(TABLES.shifts))),
        np.empty((*one, width)),
        np.empty(one),
        np.empty((subtrees, width)),
        np.empty(one),
        np.empty((subtrees, width)),
        np.empty((*one, width)),
        np.empty((subtrees, levels, COEFFICIENTS, width)),
    )


@numba.njit(**ALLOCATION_FREE)
def factor_workspace_of(desks, i):  # type: ignore[no-untyped-def]
    """One subtree's."""
    return FactorWorkspace(
        desks.of_faces[i],
        desks.powers_of_faces[i],
        desks.hats[i],
        desks.powers[i],
        desks.shift_factors[i],
        desks.scaled[i],
        desks.scales[i],
        desks.squares[i],
        desks.direction[i],
        desks.profile[i],
        desks.joined[i],
        desks.waiting[i],
    )


@numba.njit(**ALLOCATION_FREE)
def bound_errors(moments, weights, radius, tables, bounds):  # type: ignore[no-untyped-def]
    """From which distances each degree suffices, by the size of the first degree that is left out.

    Terms of degree n add up to no more than (n + 1) |moments of degree n| / distance^(n + 2).
    """
    t, size, width = 0, 0.0, moments.shape[1]
    for degree in range(1, ORDER + 2):
        if degree <= ORDER:
            squares = splat(0.0)
            while t < COEFFICIENTS and tables.degrees[t] == degree:
                for column in range(0, width, LANES):
                    part = tables.norms[t] * load(weights, column) * load(moments, t * width + column)
                    squares = squares + part * part
                t += 1
            size = math.sqrt(total(squares))
        else:
            size *= radius
        if degree > 1:
            bounds[degree - 1] = ((degree + 1) * size) ** (1.0 / (degree + 2))


@numba.njit(**ALLOCATION_FREE)
def _project_out(direction, moments, profile):  # type: ignore[no-untyped-def]
    """Take the part along a unit direction (COEFFICIENTS,) from all columns; profile (k,) is that part."""
    width = moments.shape[1]
    for column in range(0, width, LANES):
        part = splat(0.0)
        for t in range(COEFFICIENTS):
            part = part + direction[t] * load(moments, t * width + column)
        for t in range(COEFFICIENTS):
            place = t * width + column
            store(moments, place, load(moments, place) - direction[t] * part)
        store(profile, column, part)


@numba.njit(**ALLOCATION_FREE)
def _scale(moments, weights, distance, tables, desk):  # type: ignore[no-untyped-def]
    """Moments by their errors as seen from a distance; leaves them and their columns' squares on the desk."""
    width, scaled, scales, squares = moments.shape[1], desk.scaled, desk.scales, desk.squares
    for t in range(COEFFICIENTS):
        degree = tables.degrees[t]
        scales[t] = tables.norms[t] * (degree + 1) / distance ** (degree + 2)
    for column in range(0, width, LANES):
        weight, sum_ = load(weights, column), splat(0.0)
        for t in range(COEFFICIENTS):
            part = scales[t] * weight * load(moments, t * width + column)
            store(scaled, t * width + column, part)
            sum_ = sum_ + part * part
        store(squares, column, sum_)


@numba.njit(**ALLOCATION_FREE)
def _turn_to_largest(scaled, squares, direction):  # type: ignore[no-untyped-def]
    """Unit direction of the largest column; returns the root of all squares."""
    largest, sum_, length = 0, 0.0, 0.0
    for column in range(squares.shape[0]):
        sum_ += squares[column]
        if squares[column] > squares[largest]:
            largest = column
    for t in range(COEFFICIENTS):
        length += scaled[t, largest] ** 2
    over = 1.0 / math.sqrt(length) if length > 0.0 else 0.0
    for t in range(COEFFICIENTS):
        direction[t] = scaled[t, largest] * over
    return math.sqrt(sum_)


@numba.njit(**ALLOCATION_FREE)
def factor(moments, weights, distance, plan, factors, first, desk):  # type: ignore[no-untyped-def]
    """Moments as a product of few shapes and profiles, by Gram-Schmidt with pivoting; returns how many.

    Errors are measured as seen from distance. Where the room for factors ends there are none.
    """
    shapes, profiles, rests = factors
    scaled, scales, squares, direction, profile = (
        desk.scaled,
        desk.scales,
        desk.squares,
        desk.direction,
        desk.profile,
    )
    _scale(moments, weights, distance, plan.tables, desk)
    row, end = first, min(first + RANK, rests.shape[0])
    while True:
        rest = _turn_to_largest(scaled, squares, direction)
        if rest <= plan.share * plan.tolerance:
            return row - first
        if row == end:
            return row - first if row == first + RANK else 0
        rests[row] = rest
        _project_out(direction, scaled, profile)
        for t in range(COEFFICIENTS):
            shapes[row, t] = direction[t] / scales[t]
        for column in range(moments.shape[1]):
            squares[column] = max(squares[column] - profile[column] ** 2, 0.0)
            divisor = weights[column] if weights[column] > 0.0 else 1.0
            profiles[row, column] = profile[column] / divisor
        row += 1
