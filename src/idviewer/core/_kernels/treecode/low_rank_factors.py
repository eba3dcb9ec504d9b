"""Moments of a cluster as a product of low rank, and how far they reach."""

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

LARGEST_RANK = 24
"""Most factors that a node keeps."""


class Factors(NamedTuple):
    """Low-rank moments of nodes, one behind the other: those of a node are left.T @ right, of its rows.

    Attributes:
        left: (f, COEFFICIENTS) float32.
        right: (f, k) float32.
        residuals: (f,) float32 the error left by the node's factors before each one.
    """

    left: Floats32
    right: Floats32
    residuals: Floats32


class Plan(NamedTuple):
    """The accuracy that factors are made for.

    Attributes:
        tolerance: error allowed to a node, in the weights' unit.
        share: of that error which the factors may cause.
        tables: the multi-indices.
    """

    tolerance: float
    share: float
    tables: Tables


class FactorWorkspace(NamedTuple):
    """Intermediate results of a subtree; `factor_workspaces` adds one more axis, in front.

    Attributes:
        of_faces: (3, COEFFICIENTS, LANES) moments of a leaf's faces' hat functions.
        powers_of_faces: (COEFFICIENTS + 1, LANES) monomials at a point of each.
        hats: (rows of the largest leaf, COEFFICIENTS) moments of its vertices.
        powers: (COEFFICIENTS + 1,) monomials, and shift_factors: (s,) these times binomials.
        scaled: (COEFFICIENTS, k) moments, with scales: (COEFFICIENTS,) and squares: (k,) of their columns.
        direction: (COEFFICIENTS,) of a left factor, and part: (k,) of the columns along it.
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
    part: Floats
    joined: Floats
    waiting: Floats


def factor_workspaces(width: int, rows: int, levels: int, subtrees: int) -> FactorWorkspace:
    """For so many subtrees of so many levels, with so many rows in the largest leaf."""
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
def factor_workspace_of(workspaces, i):  # type: ignore[no-untyped-def]
    """A workspace for one subtree."""
    return FactorWorkspace(
        workspaces.of_faces[i],
        workspaces.powers_of_faces[i],
        workspaces.hats[i],
        workspaces.powers[i],
        workspaces.shift_factors[i],
        workspaces.scaled[i],
        workspaces.scales[i],
        workspaces.squares[i],
        workspaces.direction[i],
        workspaces.part[i],
        workspaces.joined[i],
        workspaces.waiting[i],
    )


@numba.njit(**ALLOCATION_FREE)
def bound_errors(moments, weights, radius, tables, bounds):  # type: ignore[no-untyped-def]
    """Distances from which each degree suffices, by the size of the first degree that is left out.

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
def _project_out(direction, moments, along):  # type: ignore[no-untyped-def]
    """Take the part along a unit direction (COEFFICIENTS,) from all columns; along (k,) is that part."""
    width = moments.shape[1]
    for column in range(0, width, LANES):
        part = splat(0.0)
        for t in range(COEFFICIENTS):
            part = part + direction[t] * load(moments, t * width + column)
        for t in range(COEFFICIENTS):
            place = t * width + column
            store(moments, place, load(moments, place) - direction[t] * part)
        store(along, column, part)


@numba.njit(**ALLOCATION_FREE)
def _scale(moments, weights, distance, tables, workspace):  # type: ignore[no-untyped-def]
    """Scale moments to their errors as seen from a distance; these and their squares go to workspace."""
    width, scaled, scales, squares = moments.shape[1], workspace.scaled, workspace.scales, workspace.squares
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
def _largest_direction(scaled, squares, direction):  # type: ignore[no-untyped-def]
    """Fill the unit direction of the largest column; returns the root of all squares."""
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
def factor(moments, weights, distance, plan, factors, first, workspace):  # type: ignore[no-untyped-def]
    """Moments as a product of low rank, by Gram-Schmidt with pivoting; returns the rank.

    Errors are measured as seen from distance. Where the space for factors ends there are none.
    """
    left, right, residuals = factors
    scaled, scales, squares, direction, part = (
        workspace.scaled,
        workspace.scales,
        workspace.squares,
        workspace.direction,
        workspace.part,
    )
    _scale(moments, weights, distance, plan.tables, workspace)
    row, end = first, min(first + LARGEST_RANK, residuals.shape[0])
    while True:
        residual = _largest_direction(scaled, squares, direction)
        if residual <= plan.share * plan.tolerance:
            return row - first
        if row == end:
            return row - first if row == first + LARGEST_RANK else 0
        residuals[row] = residual
        _project_out(direction, scaled, part)
        for t in range(COEFFICIENTS):
            left[row, t] = direction[t] / scales[t]
        for column in range(moments.shape[1]):
            squares[column] = max(squares[column] - part[column] ** 2, 0.0)
            divisor = weights[column] if weights[column] > 0.0 else 1.0
            right[row, column] = part[column] / divisor
        row += 1
