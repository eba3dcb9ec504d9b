"""Sums of the mean value weights and of their absolute values, each face's by the side that it shows.

All shares of a face have the sign of the side that a point sees of it, so a cluster whose faces all show the
same side adds as much to the one sum as to the other.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np

from idviewer.core._kernels.parallel.work_queue import take_work
from idviewer.core._kernels.simd.options import ALLOCATION_FREE, OPTIONS
from idviewer.core._kernels.treecode.leaf import weigh_leaf
from idviewer.core.arrays import Floats, Ints

POINTS_AT_ONCE = 64

CENTRE, RADIUS, AREA, SURFACE, TENSOR, AXIS, SINE, COSINE, NUMBERS = 0, 3, 4, 7, 8, 14, 17, 18, 19
"""Where a record of a cluster holds its centre (3), the radius of a ball around it, the sum of its faces'
area vectors (3), of their areas, and of n n^T times the area (xx, yy, zz, xy, xz, yz), the axis (3) of a cone
that holds all normals, and the sine and cosine of that cone's half-angle (a sine of 2 where it is a right one
or more)."""


class Openings(NamedTuple):
    """How far a cluster has to be, in its radii, to stand for its faces.

    Attributes:
        one_sided: where all its faces show the same side.
        two_sided: where they may show both; their absolute sum is then bounded by Cauchy and Schwarz.
    """

    one_sided: float
    two_sided: float


def cluster_records(positions: Floats, faces: Ints, first_face: Ints) -> Floats:
    """(2 leaves, NUMBERS) records of a binary tree over (m, 3) faces; node i has the children 2 i, 2 i + 1.

    Args:
        positions: (n, 3).
        faces: ordered, each leaf's one after the other.
        first_face: (leaves + 1,) where each leaf begins; leaves are a power of two.
    """
    corners, leaves = positions[faces], len(first_face) - 1
    vectors = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(vectors, axis=1)
    normals = vectors / np.maximum(areas, np.finfo(float).tiny)[:, None]
    products = [vectors[:, i] * normals[:, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    sums = np.column_stack([corners.mean(axis=1) * areas[:, None], vectors, areas, *products])
    records = np.zeros((2 * leaves, NUMBERS))
    level, starts = leaves, first_face[:-1]
    while level:
        of_face = np.repeat(np.arange(level), np.diff(np.append(starts, len(faces))))
        added, here = np.add.reduceat(sums, starts), records[level : 2 * level]
        here[:, CENTRE : CENTRE + 3] = added[:, :3] / np.maximum(added[:, 6:7], np.finfo(float).tiny)
        here[:, AREA:AXIS] = added[:, 3:]
        off = corners - here[of_face, None, CENTRE : CENTRE + 3]
        reach = np.maximum.reduceat((off**2).sum(axis=2).max(axis=1), starts)
        here[:, RADIUS] = np.sqrt(reach)
        length = np.linalg.norm(here[:, AREA : AREA + 3], axis=1, keepdims=True)
        here[:, AXIS : AXIS + 3] = here[:, AREA : AREA + 3] / np.maximum(length, np.finfo(float).tiny)
        along = (normals * here[of_face, AXIS : AXIS + 3]).sum(axis=1)
        along[areas == 0.0] = 1.0  # has no side
        least = np.minimum.reduceat(along, starts).clip(-1.0, 1.0)
        here[:, COSINE] = least
        here[:, SINE] = np.where(least > 0.0, np.sqrt(1.0 - least**2), 2.0)
        level, starts = level // 2, starts[::2]
    return records


@numba.njit(**ALLOCATION_FREE)
def _stands_for_faces(records, node, rx, ry, rz, distance, openings):  # type: ignore[no-untyped-def]
    """Whether a cluster at (rx, ry, rz) is far enough; 1 where it shows one side, 2 where perhaps both."""
    radius = records[node, RADIUS]
    if distance <= openings.one_sided * radius:
        return 0
    sine, cosine = records[node, SINE], records[node, COSINE]
    spread = radius / distance
    along = abs(records[node, AXIS] * rx + records[node, AXIS + 1] * ry + records[node, AXIS + 2] * rz)
    straight = math.sqrt(1.0 - spread * spread)
    # The angles of the cone and of the ball add up to less than what is left to a right angle.
    narrow = sine < 2.0 and cosine * straight > sine * spread
    if narrow and along > distance * (sine * straight + cosine * spread):
        return 1
    return 2 if distance > openings.two_sided * radius else 0


@numba.njit(**ALLOCATION_FREE)
def _absolute_flux(records, node, rx, ry, rz):  # type: ignore[no-untyped-def]
    """At least the sum of |n . r| times the area over a cluster's faces."""
    place = TENSOR
    square = (
        records[node, place] * rx * rx
        + records[node, place + 1] * ry * ry
        + records[node, place + 2] * rz * rz
        + 2.0 * records[node, place + 3] * rx * ry
        + 2.0 * records[node, place + 4] * rx * rz
        + 2.0 * records[node, place + 5] * ry * rz
    )
    return math.sqrt(max(records[node, SURFACE] * square, 0.0))


@numba.njit(**ALLOCATION_FREE)
def _sum_at(x, y, z, depth, records, leaves, tolerance, openings, stack, shares):  # type: ignore[no-untyped-def]
    """Both sums for one point, the absolute one second; (1, 1) on the surface."""
    sum_, absolute, top = 0.0, 0.0, 1
    stack[0] = 1
    while top:
        top -= 1
        node = stack[top]
        rx, ry, rz = records[node, 0] - x, records[node, 1] - y, records[node, 2] - z
        square = rx * rx + ry * ry + rz * rz
        sides = _stands_for_faces(records, node, rx, ry, rz, math.sqrt(square), openings)
        if sides:
            flux = records[node, AREA] * rx + records[node, AREA + 1] * ry + records[node, AREA + 2] * rz
            over = 1.0 / (square * square)
            sum_ += flux * over
            absolute += over * (abs(flux) if sides == 1 else _absolute_flux(records, node, rx, ry, rz))
        elif node < 1 << depth:
            stack[top], stack[top + 1] = 2 * node, 2 * node + 1
            top += 2
        else:
            leaf = node - (1 << depth)
            count = leaves.counts[leaf]
            a, b = x - leaves.centres[leaf, 0], y - leaves.centres[leaf, 1]
            c = z - leaves.centres[leaf, 2]
            if weigh_leaf(a, b, c, leaves.corners, leaf, count, tolerance, shares) >= 0:
                return 1.0, 1.0
            for face in range(count):
                share = shares[0, face] + shares[1, face] + shares[2, face]
                sum_ += share
                absolute += abs(share)
    return sum_, absolute


@numba.njit(parallel=True, cache=True, **OPTIONS)
def absolute_sums(points, depth, records, leaves, tolerance, openings, stacks, shares, queue, sums):  # type: ignore[no-untyped-def]
    """Sums of the weights of points, not normalised, and about the sums of their absolute values.

    Args:
        points: (p, 3).
        depth: level of the leaves.
        records: see `cluster_records`.
        leaves: a `Leaves`.
        tolerance: how near the surface a point counts as lying on it.
        openings: an `Openings`.
        stacks: (workers, depth + 2) int64, and shares: (workers, 3, LANES), workspaces.
        queue: (1,) 0, counts the parts that were begun.
        sums: (p, 2) output.
    """
    for worker in numba.prange(stacks.shape[0]):
        part = take_work(queue)
        while part * POINTS_AT_ONCE < points.shape[0]:
            for i in range(part * POINTS_AT_ONCE, min(points.shape[0], (part + 1) * POINTS_AT_ONCE)):
                sums[i, 0], sums[i, 1] = _sum_at(
                    points[i, 0],
                    points[i, 1],
                    points[i, 2],
                    depth,
                    records,
                    leaves,
                    tolerance,
                    openings,
                    stacks[worker],
                    shares[worker],
                )
            part = take_work(queue)
