"""One cache block of a surface against one packet of points."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.mean_value.edge_on import edge_on_shares
from idviewer.core._kernels.mean_value.faces import (
    add_far_shares,
    add_near_shares,
    clear,
    find_distances,
    find_edge_weights,
    find_far_edge_weights,
    note,
    sum_of,
)
from idviewer.core._kernels.mean_value.surface import Surface
from idviewer.core._kernels.simd.lanes import LANES, any_of, bits, load, splat, store
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS
from idviewer.core.arrays import Floats, Ints


class Workspace(NamedTuple):
    """One worker's intermediate results; the sizes are those of the largest block.

    Attributes:
        local: (3, LANES) points relative to a block's centre.
        distances: (v, 2 LANES) inverse distances and distances of each local vertex; see `find_distances`.
        edge_weights: (edges, LANES) kappa of each edge.
        near: (edges,) bool, marks of `find_edge_weights`.
        edge_on: (faces, 2) faces that some points see edge-on, and the lanes of these points as bits.
        tile: (LANES, LANES).
    """

    local: Floats
    distances: Floats
    edge_weights: Floats
    near: NDArray[np.bool_]
    edge_on: Ints
    tile: Floats


class BoundaryHits(NamedTuple):
    """Points that lie on the surface: the weights there are the linear interpolation.

    Attributes:
        kinds: (LANES,) uint8; 0 for points off the surface, 1 on a face or an edge, 2 on a vertex.
        vertices: (LANES, 3) local vertices, counted over the whole surface.
        shares: (LANES, 3) of these vertices.
    """

    kinds: NDArray[np.uint8]
    vertices: Ints
    shares: Floats


def workspaces_for(surface: Surface, workers: int) -> Workspace:
    """For so many workers: every array has one more axis, in front."""
    firsts = surface.first_vertex, surface.first_edge, surface.first_face
    vertices, edges, faces = (int(np.diff(first).max()) for first in firsts)
    return Workspace(
        np.empty((workers, 3, LANES)),
        np.empty((workers, vertices, 2 * LANES)),
        np.empty((workers, edges, LANES)),
        np.empty((workers, edges), dtype=np.bool_),
        np.empty((workers, faces, 2), dtype=np.int64),
        np.empty((workers, LANES, LANES)),
    )


def no_boundary_hits(count: int) -> BoundaryHits:
    """None yet, for so many packets: every array has one more axis, in front."""
    return BoundaryHits(
        np.zeros((count, LANES), dtype=np.uint8),
        np.zeros((count, LANES, 3), dtype=np.int64),
        np.zeros((count, LANES, 3)),
    )


@numba.njit(**ALLOCATION_FREE)
def workspace_of(workspace, worker):  # type: ignore[no-untyped-def]
    """A workspace for one worker."""
    return Workspace(
        workspace.local[worker],
        workspace.distances[worker],
        workspace.edge_weights[worker],
        workspace.near[worker],
        workspace.edge_on[worker],
        workspace.tile[worker],
    )


@numba.njit(**ALLOCATION_FREE)
def boundary_hits_of(hits, unit):  # type: ignore[no-untyped-def]
    """Those of one unit of work."""
    return BoundaryHits(hits.kinds[unit], hits.vertices[unit], hits.shares[unit])


@numba.njit(**ALLOCATION_FREE)
def _sees_near(x, balls, block, local):  # type: ignore[no-untyped-def]
    """Move points x (3, LANES) to a block's centre; whether some are near it."""
    square = splat(0.0)
    for axis in range(3):
        offset = load(x, axis * LANES) - balls[block, axis]
        store(local, axis * LANES, offset)
        square = square + offset * offset
    return any_of(square < balls[block, 3])


@numba.njit(**ALLOCATION_FREE)
def _note_hit(hits, lane, kind, vertices, shares):  # type: ignore[no-untyped-def]
    """Note that a point lies on the surface, unless something as simple has been noted."""
    if hits.kinds[lane] < kind:
        hits.kinds[lane] = kind
        for corner in range(3):
            hits.vertices[lane, corner] = vertices[corner]
            hits.shares[lane, corner] = shares[corner]


@numba.njit(**ALLOCATION_FREE)
def _hit_vertices(distances, first_vertex, end_vertex, tolerance, hits):  # type: ignore[no-untyped-def]
    """Note which points lie on a vertex."""
    for vertex in range(first_vertex, end_vertex):
        touching = bits(load(distances, 2 * LANES * (vertex - first_vertex)) * tolerance >= 1.0)
        if touching:
            for lane in range(LANES):
                if (touching >> lane) & 1:
                    _note_hit(hits, lane, 2, (vertex, vertex, vertex), (1.0, 0.0, 0.0))


@numba.njit(**ALLOCATION_FREE)
def _add_mixed(surface, block, workspace, weights):  # type: ignore[no-untyped-def]
    """Add shares of a block's faces, some of which are near or needles; returns how many are seen edge-on."""
    local, distances, edge_weights, near, edge_on, _ = workspace
    faces, constants, first_vertex = surface.faces, surface.constants, surface.first_vertex[block]
    start, end, count = surface.first_face[block], surface.first_face[block + 1], 0
    for f in range(start, end + 1):
        if f < end:
            needle = constants[f, -1] < 0.0
            if not (needle or near[faces[f, 3]] or near[faces[f, 4]] or near[faces[f, 5]]):
                continue
        # A run of far faces ends here.
        count = add_far_shares(local, faces, constants, start, f, edge_weights, weights, edge_on, count)
        start = f + 1
        if f < end:
            lanes = add_near_shares(local, surface.positions, first_vertex, faces, f, distances, weights)
            count = note(edge_on, count, f, lanes)
    return count


@numba.njit(**ALLOCATION_FREE)
def _add_edge_on(surface, first_vertex, workspace, count, tolerance, weights, hits):  # type: ignore[no-untyped-def]
    """Add shares of faces for those points of a packet that see them edge-on or lie on them."""
    x, edge_on, positions = workspace.local, workspace.edge_on, surface.positions
    for place in range(count * LANES):
        f, lane = edge_on[place // LANES, 0], place % LANES
        if not (edge_on[place // LANES, 1] >> lane) & 1:
            continue
        i, j, k = surface.faces[f, 0], surface.faces[f, 1], surface.faces[f, 2]
        corners = first_vertex + i, first_vertex + j, first_vertex + k
        a, b, c = _row(positions, corners[0]), _row(positions, corners[1]), _row(positions, corners[2])
        point = x[0, lane], x[1, lane], x[2, lane]
        share_i, share_j, share_k, touches = edge_on_shares(point, a, b, c, tolerance)
        if touches:
            _note_hit(hits, lane, 1, corners, (share_i, share_j, share_k))
        else:
            weights[i, lane] += share_i
            weights[j, lane] += share_j
            weights[k, lane] += share_k


@numba.njit(inline="always", **OPTIONS)
def _row(array, i):  # type: ignore[no-untyped-def]
    return array[i, 0], array[i, 1], array[i, 2]


@numba.njit(**ALLOCATION_FREE)
def weigh_block(x, surface, block, tolerance, workspace, weights, hits):  # type: ignore[no-untyped-def]
    """Weights (v, LANES) of a block's vertices, not normalised, for a packet of points x (3, LANES).

    Points that lie on the surface are noted in hits. Returns the sums of the weights.
    """
    first_vertex, end_vertex = surface.first_vertex[block], surface.first_vertex[block + 1]
    first_edge, end_edge = surface.first_edge[block], surface.first_edge[block + 1]
    start, end, ends, squares = (
        surface.first_face[block],
        surface.first_face[block + 1],
        surface.ends,
        surface.squares,
    )
    local, distances, edge_weights, near, edge_on, _ = workspace
    clear(weights, end_vertex - first_vertex)
    sees_near = _sees_near(x, surface.balls, block, local)
    find_distances(local, surface.positions, first_vertex, end_vertex, distances)
    if sees_near:
        find_edge_weights(distances, ends, squares, first_edge, end_edge, edge_weights, near)
        _hit_vertices(distances, first_vertex, end_vertex, tolerance, hits)
        count = _add_mixed(surface, block, workspace, weights)
    else:
        faces, constants = surface.faces, surface.constants
        find_far_edge_weights(distances, ends, squares, first_edge, end_edge, edge_weights)
        count = add_far_shares(local, faces, constants, start, end, edge_weights, weights, edge_on, 0)
    _add_edge_on(surface, first_vertex, workspace, count, tolerance, weights, hits)
    return sum_of(weights, end_vertex - first_vertex)


@numba.njit(cache=True, **ALLOCATION_FREE)
def warm_up(points, surface, workspace, weights, hits):  # type: ignore[no-untyped-def]
    """Weigh one block, so that all it needs is compiled."""
    weigh_block(points[0], surface, 0, 0.0, workspace_of(workspace, 0), weights[0], boundary_hits_of(hits, 0))
