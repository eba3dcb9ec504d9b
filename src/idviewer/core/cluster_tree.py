"""Mean value interpolation within a tolerance: far faces act together, near ones one by one."""

from __future__ import annotations

import math
from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels import LANES, thread_count
from idviewer.core._kernels.clusters import RECORD, Nodes, records_of, sum_level, sum_subtrees
from idviewer.core._kernels.descent import Tree, descend, nearness_of
from idviewer.core._kernels.expansion import COEFFICIENTS, ORDER, TABLES
from idviewer.core._kernels.factors import Factors, Plan, desks_for
from idviewer.core._kernels.halving import halved
from idviewer.core._kernels.leaf import leaves_of
from idviewer.core._kernels.moments import Source
from idviewer.core._kernels.point_lists import LEAST_TOTAL
from idviewer.core._kernels.room import aligned, rooms

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LEVELS_OF_A_SUBTREE = 7
SUBTREES_AT_ONCE = 4
FACTORS_OF_A_NODE = 8
"""Room for factors, on average over a subtree; nodes that find none leave their work to their children."""

CHUNK = 1024
"""Most points that go down the tree together."""

CHUNKS_OF_A_WORKER = 2
"""Between two checkpoints; few points are cut into so many chunks too, so that all workers have some."""

SHARE = 0.08
"""Part of a node's error that left out factors may cause."""

DOUBT = 3.0
"""Errors of values are at most about so many times those of the positions, which are known."""


class ClusterTree:
    """Values at the vertices of a mesh, ready to be carried inside by mean value coordinates.

    Use `build_steps`. Source: docs/cluster_tree.md.
    """

    def __init__(self, tree: Tree, nodes: Nodes, columns: int, on_surface: float) -> None:
        self._tree, self._columns, self._on_surface = tree, columns, on_surface
        self.nodes = nodes
        self._workers = thread_count()
        self._room = rooms(tree.leaves, CHUNK, self._workers)

    @classmethod
    def build_steps(
        cls,
        mesh: tuple[Floats, Ints],
        values: Floats,
        weights: Floats,
        tolerance: float,
        on_surface: float,
    ) -> Generator[float, None, ClusterTree]:
        """Build a tree; yields the share done every few milliseconds.

        Args:
            mesh: positions (n, 3) in units of the bounding box's diagonal, about its centre; faces (m, 3).
            values: (n, k).
            weights: (k,) errors of values are measured as |weights * error|.
            tolerance: the smallest error that will be asked for.
            on_surface: how near the surface a point counts as lying on it.
        """
        positions, faces = mesh
        depth = max(0, math.ceil(math.log2(len(faces) / LANES)))
        ordered = faces[halved(positions[faces].mean(axis=1), depth)]
        yield 0.1
        columns = 4 + values.shape[1]
        table = np.zeros((len(positions), -(-columns // LANES) * LANES))
        table[:, 0], table[:, 1:4], table[:, 4:columns] = 1.0, positions, values
        counts = np.zeros(table.shape[1])
        counts[:4], counts[4:columns] = 1.0, weights
        plan = Plan(tolerance * LEAST_TOTAL, SHARE, TABLES)
        source = Source(positions, ordered, table, counts, depth)
        nodes, factors = yield from _summed(source, plan)
        first_face = (len(faces) * np.arange((1 << depth) + 1)) >> depth
        leaves = leaves_of(positions, ordered, first_face)
        yield 0.95
        rows = aligned((len(leaves.vertices), table.shape[1]))
        rows[:] = table[leaves.vertices]
        records = aligned((2 << depth, RECORD))
        records[:] = records_of(nodes)
        return cls(Tree(depth, records, factors, leaves, rows), nodes, columns, on_surface)

    def interpolate_steps(
        self, points: Floats, tolerance: float, bound: float
    ) -> Generator[float, None, tuple[Floats, NDArray[np.bool_]]]:
        """Values at points, and which of them are not certain to be within the tolerance.

        Args:
            points: (p, 3) in the unit of the positions.
            tolerance: error aimed at, as measured with the tree's weights.
            bound: error above which a point is uncertain.

        Returns:
            (p, k), NaN for points that are certainly outside, and (p,).
        """
        result = np.empty((len(points), self._columns))
        inside = np.empty(len(points), dtype=np.bool_)
        at_once = CHUNKS_OF_A_WORKER * self._workers
        size = min(CHUNK, max(LANES, -(-len(points) // at_once)))
        depth = max(0, math.ceil(math.log2(max(len(points), 1) / size)))
        levels_below = math.ceil(math.log2(size / LANES))
        order = halved(points, depth + levels_below)
        ends = (len(points) * np.arange((1 << depth) + 1)) >> depth
        for start in range(0, 1 << depth, at_once):
            some = ends[start : start + at_once + 1]
            places = order[some[0] : some[-1]]
            result[places], inside[places] = self._of_chunks(points[places], some - some[0], tolerance)
            yield some[-1] / max(len(points), 1)
        off = np.abs(result[:, 1:4] - points).max(axis=1)
        doubtful = ~(DOUBT * off <= bound)
        result[~inside & ~doubtful] = np.nan
        return result[:, 4:], doubtful

    def _of_chunks(self, points: Floats, chunks: Ints, tolerance: float) -> tuple[Floats, NDArray[np.bool_]]:
        """Values at points (p, 3), and which are inside."""
        sums = aligned((len(points), self._tree.values.shape[1]))
        touched = np.zeros(len(points), dtype=np.uint8)
        rows, linear = np.empty((len(points), 3), dtype=np.int64), np.empty((len(points), 3))
        descend(
            points,
            chunks,
            *self._tree,
            *(tolerance, SHARE, self._on_surface, nearness_of(tolerance)),
            *(self._room, touched, rows, linear, sums),
        )
        inside = sums[:, 0] > 0.0
        with np.errstate(invalid="ignore", divide="ignore"):
            values = sums[:, : self._columns].astype(np.float64) / sums[:, :1]
        on = touched != 0
        values[on] = np.einsum("pc,pck->pk", linear[on], self._tree.values[rows[on]][..., : self._columns])
        return values, inside | on


def _summed(source: Source, plan: Plan) -> Generator[float, None, tuple[Nodes, Factors]]:
    """Moments of all nodes, from the leaves upwards."""
    count, width = 2 << source.depth, source.values.shape[1]
    nodes = Nodes(
        np.zeros((count, 3)),
        np.zeros(count),
        np.zeros((count, 3)),
        np.zeros((count, ORDER + 1), dtype=np.float32),
        np.zeros(count, dtype=np.int64),
        np.zeros(count, dtype=np.int64),
    )
    level = min(source.depth, max(1, source.depth - LEVELS_OF_A_SUBTREE))
    at_once = min(SUBTREES_AT_ONCE, 1 << level)
    kept = np.empty((1 << level, COEFFICIENTS, width))
    room = _room_for(FACTORS_OF_A_NODE * (2 << (source.depth - level)), width, at_once)
    desks = desks_for(width, source.depth - level + 1, at_once)
    used, parts, total = np.empty(at_once, dtype=np.int64), [], 0
    for first in range(1 << level, 2 << level, at_once):
        sum_subtrees(source, first, level, *plan, nodes, room, desks, used, kept)
        for i in range(at_once):
            for rise in range(source.depth - level + 1):
                nodes.first[(first + i) << rise : (first + i + 1) << rise] += total
            parts.append(Factors(*(array[i, : used[i]].copy() for array in room)))
            total += int(used[i])
        yield 0.1 + 0.8 * (first + at_once - (1 << level)) / (1 << level)
    top, used_by_top = _room_for(FACTORS_OF_A_NODE << level, width, 1), 0
    for above in range(level - 1, -1, -1):
        used_by_top = sum_level(source, above, *plan, nodes, top, desks, kept, used_by_top)
    nodes.first[: 1 << level] += total
    parts.append(Factors(*(array[0, :used_by_top] for array in top)))
    return nodes, _packed(parts)


def _packed(parts: list[Factors]) -> Factors:
    result = []
    for arrays in zip(*parts, strict=True):
        whole = aligned((sum(map(len, arrays)), *arrays[0].shape[1:]))
        np.concatenate(arrays, out=whole)
        result.append(whole)
    return Factors(*result)


def _room_for(factors: int, width: int, subtrees: int) -> Factors:
    return Factors(
        np.empty((subtrees, factors, COEFFICIENTS), dtype=np.float32),
        np.empty((subtrees, factors, width), dtype=np.float32),
        np.empty((subtrees, factors), dtype=np.float32),
    )
