"""Blocks of points against all patches of a surface, in parallel over the blocks."""

from __future__ import annotations

import math

import numba
import numpy as np

from idviewer.core._angle_ratio import SLIGHT_LIMIT
from idviewer.core._kernels.faces import (
    FAST,
    INVERSE,
    LANES,
    WEIGHT,
    add_far_shares,
    add_near_shares,
    look_from,
    total,
)
from idviewer.core._kernels.grazing import grazing_shares, row

OUTSIDE, INSIDE, ON_SURFACE = 0, 1, 2

SLIGHT_CHORD = 2.0 * math.sqrt(SLIGHT_LIMIT)


@numba.njit(fastmath=FAST, error_model="numpy", cache=True)
def _sees_slight_angles(x, ball, longest):  # type: ignore[no-untyped-def]
    """Whether every edge of a patch is short as seen from every point of a block."""
    least = np.inf
    for lane in range(LANES):
        dx, dy, dz = x[0, lane] - ball[0], x[1, lane] - ball[1], x[2, lane] - ball[2]
        least = min(least, dx * dx + dy * dy + dz * dz)
    return longest < SLIGHT_CHORD * (math.sqrt(least) - ball[3])


@numba.njit(fastmath=FAST, error_model="numpy", cache=True)
def _find_closest(view, closest):  # type: ignore[no-untyped-def]
    """The largest inverse distance of each row to any point of the block."""
    for i in range(closest.shape[0]):
        for lane in range(LANES):
            closest[i] = max(closest[i], view[i, INVERSE + lane])


@numba.njit(fastmath=FAST, error_model="numpy", cache=True)
def _land_on_vertices(view, count, first_row, tolerance, landing):  # type: ignore[no-untyped-def]
    """Note which points lie on a vertex."""
    touched, rows, shares = landing
    for i in range(count):
        for lane in range(LANES):
            if view[i, INVERSE + lane] * tolerance >= 1.0:
                touched[lane] = 2
                rows[lane] = first_row + i
                shares[lane] = (1.0, 0.0, 0.0)


@numba.njit(fastmath=FAST, error_model="numpy", cache=True)
def _weigh_patch(x, surface, patch, tolerance, scratch, landing, totals):  # type: ignore[no-untyped-def]
    """Weights of a patch's rows, not normalised, for a block of points x (3, LANES).

    They are left in the second part of scratch and added to totals (LANES,). Points that lie on the
    surface are noted in landing: touched (LANES,), rows (LANES, 3) and shares (LANES, 3) of the linear
    interpolation there.
    """
    view, weights = scratch
    first_row, end_row = surface.first_row[patch], surface.first_row[patch + 1]
    positions = surface.positions[first_row:end_row]
    look_from(x, positions, view)
    slight = _sees_slight_angles(x, surface.balls[patch], surface.longest[patch])
    closest = np.zeros(end_row - first_row)
    if not slight:
        _land_on_vertices(view, end_row - first_row, first_row, tolerance, landing)
        _find_closest(view, closest)
    grazing = np.empty(LANES)
    for f in range(surface.first_face[patch], surface.first_face[patch + 1]):
        i, j, k = row(surface.faces, f)
        if slight or surface.edges[f] * max(closest[i], closest[j], closest[k]) < SLIGHT_CHORD:
            add_far_shares(view[i], view[j], view[k], grazing)
        else:
            add_near_shares(view[i], view[j], view[k], grazing)
        if total(grazing) > 0.0:
            _add_grazing(x, positions, (i, j, k), first_row, tolerance, grazing, view, landing)
    for i in range(end_row - first_row):
        for lane in range(LANES):
            weight = view[i, WEIGHT + lane]
            weights[i, lane] = weight
            totals[lane] += weight


@numba.njit(fastmath=FAST, error_model="numpy", cache=True)
def _add_grazing(x, positions, face, first_row, tolerance, marks, view, landing):  # type: ignore[no-untyped-def]
    """The shares of a face for those points of a block that see it edge-on or lie on it."""
    i, j, k = face
    touched, rows, shares = landing
    for lane in range(LANES):
        if marks[lane] == 0.0:
            continue
        at = (x[0, lane], x[1, lane], x[2, lane])
        w_i, w_j, w_k, touches = grazing_shares(
            at, row(positions, i), row(positions, j), row(positions, k), tolerance
        )
        if not touches:
            view[i, WEIGHT + lane] += w_i
            view[j, WEIGHT + lane] += w_j
            view[k, WEIGHT + lane] += w_k
        elif touched[lane] == 0:
            touched[lane] = 1
            rows[lane] = (first_row + i, first_row + j, first_row + k)
            shares[lane] = (w_i, w_j, w_k)


@numba.njit(fastmath=FAST, error_model="numpy", cache=True)
def _no_landing():  # type: ignore[no-untyped-def]
    return np.zeros(LANES, dtype=np.int8), np.zeros((LANES, 3), dtype=np.int64), np.zeros((LANES, 3))


@numba.njit(fastmath=FAST, error_model="numpy", cache=True)
def warm_up(x, surface, tolerance, scratch):  # type: ignore[no-untyped-def]
    """Weigh one patch, so that all it needs is compiled."""
    _weigh_patch(x, surface, 0, tolerance, scratch, _no_landing(), np.zeros(LANES))


@numba.njit(fastmath=FAST, error_model="numpy", cache=True)
def _sides(totals, touched, states):  # type: ignore[no-untyped-def]
    """Tell each point's side by the sign of its total (docs/mean_value.md)."""
    for lane in range(LANES):
        states[lane] = ON_SURFACE if touched[lane] else (INSIDE if totals[lane] > 0.0 else OUTSIDE)


@numba.njit(fastmath=FAST, error_model="numpy", cache=True)
def _add_product(weights, count, values, first, result):  # type: ignore[no-untyped-def]
    """result (LANES, k) += weights[:count].T @ values[first : first + count].

    Four rows at a time, so that the result is read and written once for four of them. The matrices are
    small: a BLAS costs more here in calls, and its threads would fight with ours.
    """
    for i in range(0, count, 4):
        # Rows past the end have weight 0.
        j1, j2, j3 = min(i + 1, count - 1), min(i + 2, count - 1), min(i + 3, count - 1)
        b0, b1, b2, b3 = values[first + i], values[first + j1], values[first + j2], values[first + j3]
        for lane in range(LANES):
            w0 = weights[i, lane]
            w1 = weights[j1, lane] if i + 1 < count else 0.0
            w2 = weights[j2, lane] if i + 2 < count else 0.0
            w3 = weights[j3, lane] if i + 3 < count else 0.0
            row_of_result = result[lane]
            for c in range(values.shape[1]):
                row_of_result[c] += w0 * b0[c] + w1 * b1[c] + w2 * b2[c] + w3 * b3[c]


@numba.njit(fastmath=FAST, error_model="numpy", cache=True)
def _write_weights(weights, totals, landing, vertices, places, result):  # type: ignore[no-untyped-def]
    """Normalise a block's weights (n, LANES) into the rows of result at places; NaN for points outside."""
    touched, rows, shares = landing
    for lane in range(LANES):
        if places[lane] < 0:
            continue
        row_of_result = result[places[lane]]
        scale = 0.0 if touched[lane] else (1.0 / totals[lane] if totals[lane] > 0.0 else np.nan)
        for i in range(weights.shape[0]):
            row_of_result[i] = scale * weights[i, lane]
        if touched[lane]:
            for corner in range(3):
                row_of_result[vertices[rows[lane, corner]]] += shares[lane, corner]


@numba.njit(parallel=True, fastmath=FAST, error_model="numpy", cache=True)
def mean_value_weights(points, surface, tolerance, scratch, places, result):  # type: ignore[no-untyped-def]
    """Exact mean value weights of many points; Ju, Schaefer and Warren 2005, vectorised over points.

    Args:
        points: (blocks, 3, LANES).
        surface: a `Surface`.
        tolerance: how near the surface a point counts as lying on it.
        scratch: view (threads, r, 5 LANES) and weights (threads, r, LANES), r the rows of the largest patch.
        places: (blocks, LANES) row of the result for each point, -1 for none.
        result: (p, n) output; rows that add up to 1, NaN for points outside.
    """
    view, patch_weights = scratch
    for worker in numba.prange(view.shape[0]):
        weights = np.empty((result.shape[1], LANES))
        for block in range(worker, points.shape[0], view.shape[0]):
            landing = _no_landing()
            totals = np.zeros(LANES)
            weights[:] = 0.0
            own = (view[worker], patch_weights[worker])
            for patch in range(surface.longest.shape[0]):
                _weigh_patch(points[block], surface, patch, tolerance, own, landing, totals)
                first = surface.first_row[patch]
                for i in range(surface.first_row[patch + 1] - first):
                    vertex = surface.vertices[first + i]
                    for lane in range(LANES):
                        weights[vertex, lane] += own[1][i, lane]
            _write_weights(weights, totals, landing, surface.vertices, places[block], result)


@numba.njit(parallel=True, fastmath=FAST, error_model="numpy", cache=True)
def interpolate(points, surface, tolerance, scratch, values, result, states):  # type: ignore[no-untyped-def]
    """Vertex values carried to many points by mean value weights, which are not kept.

    Args:
        points: (blocks, 3, LANES).
        surface: a `Surface`.
        tolerance: how near the surface a point counts as lying on it.
        scratch: as for `mean_value_weights`.
        values: (rows of the surface, k).
        result: (blocks, LANES, k) output.
        states: (blocks, LANES) int8 output; OUTSIDE, INSIDE or ON_SURFACE.
    """
    view, patch_weights = scratch
    for worker in numba.prange(view.shape[0]):
        for block in range(worker, points.shape[0], view.shape[0]):
            landing = _no_landing()
            totals = np.zeros(LANES)
            result[block] = 0.0
            own = (view[worker], patch_weights[worker])
            for patch in range(surface.longest.shape[0]):
                _weigh_patch(points[block], surface, patch, tolerance, own, landing, totals)
                first = surface.first_row[patch]
                _add_product(own[1], surface.first_row[patch + 1] - first, values, first, result[block])
            _sides(totals, landing[0], states[block])
            for lane in range(LANES):
                result[block, lane] /= totals[lane]
                if landing[0][lane]:
                    result[block, lane] = 0.0
                    for corner in range(3):
                        result[block, lane] += landing[2][lane, corner] * values[landing[1][lane, corner]]


def thread_count() -> int:
    """How many threads the kernels use."""
    return int(numba.get_num_threads())
