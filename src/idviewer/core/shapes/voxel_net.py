"""The faces between voxels inside and outside, as a closed manifold surface that is still to be smoothed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from idviewer.core.arrays import Bools, Floats, Ints


@dataclass(frozen=True)
class NetSettings:
    """Settings of how far vertices may move.

    Attributes:
        reach: in voxels, how far a vertex moves along each axis at most; under a half, so that the two sides
            of one voxel never meet.
        gap: in voxels, how far at least each of two sheets keeps from the place in which they meet.
    """

    reach: float = 0.45
    gap: float = 0.05


NET = NetSettings()


@dataclass(frozen=True)
class VoxelNet:
    """The faces of voxels before they are smoothed.

    Attributes:
        places: (n, 3) lattice points of the vertices.
        quads: (m, 4) vertex numbers, counter-clockwise from outside; a triangle repeats its last one.
        low: (n, 3) how far each vertex may move down along each axis.
        high: likewise up.
    """

    places: Floats
    quads: Ints
    low: Floats
    high: Floats


def voxel_net(voxels: Bools) -> VoxelNet:
    """Find the faces between inside and outside, parted where voxels meet in an edge or a corner alone.

    Args:
        voxels: (p, q, r), True inside; the outermost ones are not, and some is.

    >>> net = voxel_net(np.pad(np.ones((1, 1, 1), bool), 1))
    >>> len(net.places), len(net.quads)
    (8, 6)
    """
    corners, inside = _faces(voxels)
    lattice = np.array(voxels.shape) + 1
    points, numbers = np.unique(corners.ravel(), return_inverse=True)
    pairs, meeting = _paired_edges(numbers.reshape(-1, 4), inside, len(points))
    vertex = _parted(numbers.ravel(), pairs, meeting)
    first = np.empty(int(vertex.max()) + 1, np.int64)
    first[vertex] = numbers.ravel()
    places = np.stack(np.unravel_index(points[first], lattice), axis=1).astype(np.float64)
    own = np.stack(np.unravel_index(inside, lattice), axis=1).astype(np.float64) + 0.5
    reach = np.full_like(places, NET.reach)
    net = VoxelNet(places, vertex.reshape(-1, 4), -reach, reach)
    shared = np.bincount(first, minlength=len(points))[first] > 1
    _keep_to_their_side(net, shared, vertex, np.repeat(own, 4, axis=0))
    return _without_double_edges(net, pairs, own)


def _keep_to_their_side(net: VoxelNet, shared: Bools, vertex: Ints, own: Floats) -> None:
    """Have vertices in one place, of sheets that meet there, move to the side of their own voxels alone.

    Args:
        net: whose bounds are changed.
        shared: (n,) which vertices have another in their place.
        vertex: (s,) numbers of vertices.
        own: (s, 3) middle of a voxel of each.
    """
    slots = np.flatnonzero(shared[vertex])
    sides = own[slots] - net.places[vertex[slots]]
    for side, bound in ((1.0, net.low), (-1.0, net.high)):
        elsewhere = np.zeros(bound.shape, dtype=bool)
        for axis in range(3):
            elsewhere[vertex[slots[side * sides[:, axis] <= 0.0]], axis] = True
        bound[shared[:, None] & ~elsewhere] = side * NET.gap


def _without_double_edges(net: VoxelNet, pairs: Ints, own: Floats) -> VoxelNet:
    """Cut edges that have the same two vertices as another: each gets a vertex in its middle.

    Where a sheet of the surface passes an edge of four faces and comes back to its other side, both ends of
    the edge are the same vertices on both sides. The faces beside such an edge are fans around their middles.
    """
    places, quads = net.places, net.quads
    ends = np.sort(quads.ravel()[pairs[:, :2]], axis=1)
    _, edge, counts = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    double = pairs[counts[edge.ravel()] > 1]
    if not len(double):
        return net
    middles = len(places) + np.arange(len(double))
    split = np.full(quads.size, -1, np.int64)
    split[double[:, 0]] = split[double[:, 3]] = middles  # the slots at which the edge starts, in either face
    faces = np.flatnonzero((split.reshape(-1, 4) >= 0).any(axis=1))
    centres = len(places) + len(double) + np.arange(len(faces))
    fans = []
    for face, centre in zip(faces.tolist(), centres.tolist(), strict=True):
        ring = [
            n for slot in range(4 * face, 4 * face + 4) for n in (quads.flat[slot], split[slot]) if n >= 0
        ]
        fans += [(n, after, centre, centre) for n, after in zip(ring, ring[1:] + ring[:1], strict=True)]
    mids = places[quads.ravel()[double[:, :2]]].mean(axis=1)
    added = np.concatenate([mids, places[quads[faces]].mean(axis=1)])
    reach = np.full_like(added, NET.reach)
    cut = VoxelNet(
        np.concatenate([places, added]),
        np.concatenate([np.delete(quads, faces, axis=0), np.array(fans)]),
        np.concatenate([net.low, -reach]),
        np.concatenate([net.high, reach]),
    )
    shared = np.zeros(len(cut.places), dtype=bool)
    shared[middles] = True
    _keep_to_their_side(cut, shared, middles, own[double[:, 0] // 4])
    return cut


def _faces(voxels: Bools) -> tuple[Ints, Ints]:
    """Corners (m, 4) of each face between in and out, counter-clockwise from outside, and its voxel (m,)."""
    lattice = np.array(voxels.shape) + 1
    strides = np.array([lattice[1] * lattice[2], lattice[2], 1])
    values = voxels.view(np.int8)
    corners, inside = [], []
    for axis in range(3):
        steps = np.diff(values, axis=axis)
        low = np.stack(np.nonzero(steps), axis=1)
        leaving = steps[tuple(low.T)] < 0
        high = low.copy()
        high[:, axis] += 1
        base = high @ strides
        u, v = strides[(axis + 1) % 3], strides[(axis + 2) % 3]
        around = np.stack([base, base + u, base + u + v, base + v], axis=1)
        around[~leaving] = around[~leaving][:, ::-1]
        corners.append(around)
        inside.append(np.where(leaving[:, None], low, high) @ strides)
    return np.concatenate(corners), np.concatenate(inside)


def _paired_edges(quads: Ints, inside: Ints, count: int) -> tuple[Ints, Bools]:
    """Slots of the edges at which two faces are joined, and which points lie on an edge of four faces.

    A slot is a face's number times four plus its corner's. The faces at an edge of four are joined in pairs
    that have one voxel: so voxels that meet in the edge alone are parted.

    Args:
        quads: (m, 4) point numbers.
        inside: number of each face's voxel.
        count: of the points.

    Returns:
        (e, 4): the slots of the two ends in one face, and of the same two ends in the other; and (count,).
    """
    starts = quads.ravel()
    slots = np.arange(len(starts))
    ends_slots = slots - slots % 4 + (slots + 1) % 4
    stops = starts[ends_slots]
    keys = np.minimum(starts, stops) * count + np.maximum(starts, stops)
    order = np.lexsort((np.repeat(inside, 4), keys))
    one, other = order[::2], order[1::2]
    # The neighbour runs along the edge the other way.
    pairs = np.stack([one, ends_slots[one], ends_slots[other], other], axis=1)
    meeting = np.zeros(count, dtype=bool)
    sorted_keys = keys[order]
    four = np.flatnonzero(sorted_keys[:-2] == sorted_keys[2:])
    meeting[starts[order[four]]] = meeting[stops[order[four]]] = True
    return pairs, meeting


def _parted(points: Ints, pairs: Ints, meeting: Bools) -> Ints:
    """The vertex of each slot: one a point, but one for each fan of faces where several meet in the point."""
    degrees = np.bincount(points, minlength=len(meeting))
    doubtful = (meeting | (degrees > 5))[points]  # fewer faces make no two fans
    if not doubtful.any():
        return points
    slots = np.flatnonzero(doubtful)
    short = np.full(len(points), -1, np.int64)
    short[slots] = np.arange(len(slots))
    links = np.concatenate([pairs[:, [0, 2]], pairs[:, [1, 3]]])
    links = short[links[doubtful[links[:, 0]]]]
    graph = sp.coo_array((np.ones(len(links), bool), tuple(links.T)), shape=(len(slots),) * 2)
    _, fans = sp.csgraph.connected_components(graph, directed=False)
    labels = points.copy()
    labels[slots] = len(meeting) + fans
    return np.unique(labels, return_inverse=True)[1]
