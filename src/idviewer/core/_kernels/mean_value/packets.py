"""Packets of points against all blocks of a surface, in parallel."""

from __future__ import annotations

import numba
import numpy as np

from idviewer.core._kernels.mean_value.cache_blocks import boundary_hits_of, weigh_block, workspace_of
from idviewer.core._kernels.simd.lanes import LANES, at, choose, load, splat, store, transpose
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS


@numba.njit(**ALLOCATION_FREE)
def _write_weights(kept, totals, surface, places, tile, result):  # type: ignore[no-untyped-def]
    """Normalise a packet's weights kept (r, LANES) into rows of result at places; NaN for points outside."""
    vertices, firsts, copies = result.shape[1], surface.first_copy, surface.copies
    scale = choose(load(totals, 0) > 0.0, 1.0 / load(totals, 0), np.nan)
    for start in range(0, vertices, LANES):
        count = min(LANES, vertices - start)
        for i in range(count):
            weight = splat(0.0)
            for copy in range(at(firsts, start + i), at(firsts, start + i + 1)):
                weight = weight + load(kept, at(copies, copy) * LANES)
            store(tile, i * LANES, weight * scale)
        transpose(tile, 0)
        for lane in range(LANES):
            if places[lane] >= 0 and count == LANES:
                store(result, places[lane] * vertices + start, load(tile, lane * LANES))
            elif places[lane] >= 0:
                for i in range(count):
                    result[places[lane], start + i] = tile[lane, i]


@numba.njit(**ALLOCATION_FREE)
def _add_product(weights, values, first, end, sums):  # type: ignore[no-untyped-def]
    """sums (lanes, k) += weights[: end - first, :lanes].T @ values, from its rows first to end.

    Four points and LANES columns at a time, which stay in registers. The matrices are small: a BLAS costs
    more here in calls, and its threads would fight with ours.
    """
    rows, width = values.shape[1], values.shape[0] * LANES
    for place in range(0, sums.size // 4, LANES):
        lane, column = place // width * 4, place % width
        spot = lane * width + column
        a, b = load(sums, spot), load(sums, spot + width)
        c, d = load(sums, spot + 2 * width), load(sums, spot + 3 * width)
        for row in range(first, end):
            value = load(values, (column // LANES * rows + row) * LANES)
            i = (row - first) * LANES + lane
            a, b = a + at(weights, i) * value, b + at(weights, i + 1) * value
            c, d = c + at(weights, i + 2) * value, d + at(weights, i + 3) * value
        store(sums, spot, a)
        store(sums, spot + width, b)
        store(sums, spot + 2 * width, c)
        store(sums, spot + 3 * width, d)


@numba.njit(**ALLOCATION_FREE)
def _weigh_part(x, surface, part, tolerance, workspace, hits, totals, kept, values, sums):  # type: ignore[no-untyped-def]
    """A range of blocks against a packet; see `weigh`."""
    total = splat(0.0)
    for block in range(part[0], part[1]):
        first, end = surface.first_vertex[block], surface.first_vertex[block + 1]
        weights = kept if len(values) else kept[first:]
        total = total + weigh_block(x, surface, block, tolerance, workspace, weights, hits)
        if len(values):
            _add_product(weights, values, first, end, sums)
    store(totals, 0, total)


@numba.njit(parallel=True, cache=True, **OPTIONS)
def weigh(points, surface, tolerance, workspace, hits, totals, kept, product, weights):  # type: ignore[no-untyped-def]
    """Exact mean value weights of many points; Ju, Schaefer and Warren 2005, vectorised over points.

    They are multiplied by values at the vertices and not kept, or written out if there are no values. The
    surface may be cut into parts that are worked on in parallel, so that few points occupy all workers.

    Args:
        points: (packets, 3, LANES).
        surface: a `Surface`.
        tolerance: how near the surface a point counts as lying on it.
        workspace: see `workspaces_for`.
        hits: output, see `no_boundary_hits`; of the packets times parts.
        totals: (packets, parts, LANES) output; sums of the weights, not positive for points outside.
        kept: (workers, v, LANES) workspace for the weights of a block, of the surface if they are written.
        product: values (k / LANES, r, LANES) at the surface's local vertices, and sums (packets, parts,
            lanes, k), 0 at first, output; values times weights, not normalised. Only the first lanes are
            multiplied, a multiple of 4.
        weights: places (packets, LANES), the row of the result for each point, -1 for none, and result
            (p, n), output; normalised rows, NaN for points outside. There must be one part.
    """
    parts, blocks = totals.shape[1], len(surface.balls)
    values, sums = product
    places, result = weights
    for worker in numba.prange(kept.shape[0]):
        own = workspace_of(workspace, worker)
        for unit in range(worker, points.shape[0] * parts, kept.shape[0]):
            packet, part = unit // parts, unit % parts
            _weigh_part(
                points[packet],
                surface,
                (part * blocks // parts, (part + 1) * blocks // parts),
                tolerance,
                own,
                boundary_hits_of(hits, unit),
                totals[packet, part],
                kept[worker],
                values,
                sums[packet, part],
            )
            if len(values) == 0:
                _write_weights(kept[worker], totals[packet, part], surface, places[packet], own.tile, result)


def thread_count() -> int:
    """The number of threads that kernels use."""
    return int(numba.get_num_threads())
