"""One patch of a surface as seen by one block of points."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.mean_value.faces import (
    add_far_shares,
    add_near_shares,
    clear,
    find_distant_kappas,
    find_kappas,
    look_from,
    note,
    sum_of,
)
from idviewer.core._kernels.mean_value.grazing import grazing_shares
from idviewer.core._kernels.mean_value.surface import Surface
from idviewer.core._kernels.simd.lanes import LANES, any_of, bits, load, splat, store
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS
from idviewer.core.arrays import Floats, Ints


class Scratch(NamedTuple):
    """Room for one worker's intermediate results; the sizes are those of the largest patch.

    Attributes:
        local: (3, LANES) points relative to a patch's centre.
        seen: (rows, 2 LANES), the view.
        kappas: (edges, LANES).
        near: (edges,) bool, marks of `find_kappas`.
        grazed: (faces, 2) faces that some points see edge-on, and the lanes of these points as bits.
        tile: (LANES, LANES).
    """

    local: Floats
    seen: Floats
    kappas: Floats
    near: NDArray[np.bool_]
    grazed: Ints
    tile: Floats


class BoundaryHits(NamedTuple):
    """Which points lie on the surface: the weights there are the linear interpolation.

    Attributes:
        touched: (LANES,) uint8; 0 for points off the surface, 1 on a face or an edge, 2 on a vertex.
        rows: (LANES, 3) of the surface.
        shares: (LANES, 3) of these rows.
    """

    touched: NDArray[np.uint8]
    rows: Ints
    shares: Floats


def scratch_for(surface: Surface, workers: int) -> Scratch:
    """Room for workers: every array has one more axis, in front."""
    firsts = surface.first_row, surface.first_edge, surface.first_face
    rows, edges, faces = (int(np.diff(first).max()) for first in firsts)
    return Scratch(
        np.empty((workers, 3, LANES)),
        np.empty((workers, rows, 2 * LANES)),
        np.empty((workers, edges, LANES)),
        np.empty((workers, edges), dtype=np.bool_),
        np.empty((workers, faces, 2), dtype=np.int64),
        np.empty((workers, LANES, LANES)),
    )


def no_boundary_hits(count: int) -> BoundaryHits:
    """For count blocks: every array has one more axis, in front."""
    return BoundaryHits(
        np.zeros((count, LANES), dtype=np.uint8),
        np.zeros((count, LANES, 3), dtype=np.int64),
        np.zeros((count, LANES, 3)),
    )


@numba.njit(**ALLOCATION_FREE)
def own_scratch(scratch, worker):  # type: ignore[no-untyped-def]
    """One worker's part of scratch."""
    return Scratch(
        scratch.local[worker],
        scratch.seen[worker],
        scratch.kappas[worker],
        scratch.near[worker],
        scratch.grazed[worker],
        scratch.tile[worker],
    )


@numba.njit(**ALLOCATION_FREE)
def boundary_hits_of(landing, unit):  # type: ignore[no-untyped-def]
    """One unit of a landing."""
    return BoundaryHits(landing.touched[unit], landing.rows[unit], landing.shares[unit])


@numba.njit(**ALLOCATION_FREE)
def _sees_near(x, balls, patch, local):  # type: ignore[no-untyped-def]
    """Move points x (3, LANES) to a patch's centre; whether some are near it."""
    square = splat(0.0)
    for axis in range(3):
        offset = load(x, axis * LANES) - balls[patch, axis]
        store(local, axis * LANES, offset)
        square = square + offset * offset
    return any_of(square < balls[patch, 3])


@numba.njit(**ALLOCATION_FREE)
def _land(landing, lane, kind, rows, shares):  # type: ignore[no-untyped-def]
    """Note that a point lies on the surface, unless something as simple has been noted."""
    if landing.touched[lane] < kind:
        landing.touched[lane] = kind
        for corner in range(3):
            landing.rows[lane, corner] = rows[corner]
            landing.shares[lane, corner] = shares[corner]


@numba.njit(**ALLOCATION_FREE)
def _land_on_vertices(view, first_row, end_row, tolerance, landing):  # type: ignore[no-untyped-def]
    """Note which points lie on a vertex."""
    for row in range(first_row, end_row):
        touching = bits(load(view, 2 * LANES * (row - first_row)) * tolerance >= 1.0)
        if touching:
            for lane in range(LANES):
                if (touching >> lane) & 1:
                    _land(landing, lane, 2, (row, row, row), (1.0, 0.0, 0.0))


@numba.njit(**ALLOCATION_FREE)
def _add_mixed(surface, patch, scratch, weights):  # type: ignore[no-untyped-def]
    """The shares of a patch's faces, some of which are near or needles; returns how many were grazed."""
    local, view, kappas, near, grazed, _ = scratch
    faces, constants, first_row = surface.faces, surface.constants, surface.first_row[patch]
    start, end, count = surface.first_face[patch], surface.first_face[patch + 1], 0
    for f in range(start, end + 1):
        if f < end:
            needle = constants[f, -1] < 0.0
            if not (needle or near[faces[f, 3]] or near[faces[f, 4]] or near[faces[f, 5]]):
                continue
        # A run of far faces ends here.
        count = add_far_shares(local, faces, constants, start, f, kappas, weights, grazed, count)
        start = f + 1
        if f < end:
            flat = add_near_shares(local, surface.positions, first_row, faces, f, view, weights)
            count = note(grazed, count, f, flat)
    return count


@numba.njit(**ALLOCATION_FREE)
def _add_grazing(surface, first_row, scratch, count, tolerance, weights, landing):  # type: ignore[no-untyped-def]
    """The shares of faces for those points of a block that see them edge-on or lie on them."""
    x, grazed, positions = scratch.local, scratch.grazed, surface.positions
    for place in range(count * LANES):
        f, lane = grazed[place // LANES, 0], place % LANES
        if not (grazed[place // LANES, 1] >> lane) & 1:
            continue
        i, j, k = surface.faces[f, 0], surface.faces[f, 1], surface.faces[f, 2]
        rows = first_row + i, first_row + j, first_row + k
        a, b, c = _row(positions, rows[0]), _row(positions, rows[1]), _row(positions, rows[2])
        point = x[0, lane], x[1, lane], x[2, lane]
        share_i, share_j, share_k, touches = grazing_shares(point, a, b, c, tolerance)
        if touches:
            _land(landing, lane, 1, rows, (share_i, share_j, share_k))
        else:
            weights[i, lane] += share_i
            weights[j, lane] += share_j
            weights[k, lane] += share_k


@numba.njit(inline="always", **OPTIONS)
def _row(array, i):  # type: ignore[no-untyped-def]
    return array[i, 0], array[i, 1], array[i, 2]


@numba.njit(**ALLOCATION_FREE)
def weigh_patch(x, surface, patch, tolerance, scratch, weights, landing):  # type: ignore[no-untyped-def]
    """Weights (rows, LANES) of a patch's rows, not normalised, for a block of points x (3, LANES).

    Points that lie on the surface are noted in landing. Returns the sums of the weights.
    """
    first_row, end_row = surface.first_row[patch], surface.first_row[patch + 1]
    first_edge, end_edge = surface.first_edge[patch], surface.first_edge[patch + 1]
    start, end, ends, squares = (
        surface.first_face[patch],
        surface.first_face[patch + 1],
        surface.ends,
        surface.squares,
    )
    local, view, kappas, near, grazed, _ = scratch
    clear(weights, end_row - first_row)
    sees_near = _sees_near(x, surface.balls, patch, local)
    look_from(local, surface.positions, first_row, end_row, view)
    if sees_near:
        find_kappas(view, ends, squares, first_edge, end_edge, kappas, near)
        _land_on_vertices(view, first_row, end_row, tolerance, landing)
        count = _add_mixed(surface, patch, scratch, weights)
    else:
        faces, constants = surface.faces, surface.constants
        find_distant_kappas(view, ends, squares, first_edge, end_edge, kappas)
        count = add_far_shares(local, faces, constants, start, end, kappas, weights, grazed, 0)
    _add_grazing(surface, first_row, scratch, count, tolerance, weights, landing)
    return sum_of(weights, end_row - first_row)


@numba.njit(cache=True, **ALLOCATION_FREE)
def warm_up(points, surface, scratch, weights, landing):  # type: ignore[no-untyped-def]
    """Weigh one patch, so that all it needs is compiled."""
    weigh_patch(points[0], surface, 0, 0.0, own_scratch(scratch, 0), weights[0], boundary_hits_of(landing, 0))
