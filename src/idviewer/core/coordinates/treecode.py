"""Mean value interpolation within a tolerance: far faces act together, near ones one by one."""

from __future__ import annotations

import math
from collections.abc import Generator

import numpy as np

from idviewer.core._kernels import LANES, thread_count
from idviewer.core._kernels.treecode.clusters import RECORD, Nodes, records_of, sum_level, sum_subtrees
from idviewer.core._kernels.treecode.descent import Tree, descend, opening_radii
from idviewer.core._kernels.treecode.expansion import COEFFICIENTS, ORDER, TABLES
from idviewer.core._kernels.treecode.factors import Factors, Plan, factor_workspaces
from idviewer.core._kernels.treecode.halving import halved
from idviewer.core._kernels.treecode.leaf import leaves_of
from idviewer.core._kernels.treecode.moments import Source
from idviewer.core._kernels.treecode.normalize import FIRST_VALUE, POSITION, Target
from idviewer.core._kernels.treecode.point_lists import LEAST_TOTAL
from idviewer.core._kernels.treecode.workspace import aligned, rooms
from idviewer.core.arrays import Floats, Ints

LEVELS_OF_A_SUBTREE = 7
SUBTREES_AT_ONCE = 4
FACTORS_OF_A_NODE = 8
"""Room for factors, on average over a subtree; nodes that find none leave their work to their children."""

CHUNK = 1024
"""Most points that go down the tree together."""

LEAST_CHUNK = 64
"""Smaller chunks cost more than an idle worker."""

AT_ONCE = 2048
"""Points between two checkpoints: about 10 ms on two cores."""

EVEN = 1.5
"""A worker takes one part in so many of its even share of what is left."""

SHARE = 0.08
"""Part of a node's error that left out factors may cause."""

DOUBT = 3.0
"""Errors of values are at most about so many times those of the positions, which are known."""

ROWS = 2**11
"""Of a table, copied between two checkpoints."""


class Treecode:
    """Values at the vertices of a mesh, ready to be carried inside by mean value coordinates.

    Use `build_steps`. Source: docs/treecode.md.
    """

    def __init__(self, tree: Tree, nodes: Nodes, on_surface: float) -> None:
        self._tree, self._on_surface = tree, on_surface
        self.nodes = nodes
        self._workers = thread_count()
        self._room = rooms(tree.leaves, tree.values.shape[1], CHUNK, self._workers)

    @classmethod
    def build_steps(
        cls,
        mesh: tuple[Floats, Ints],
        values: Floats,
        weights: Floats,
        tolerance: float,
        on_surface: float,
    ) -> Generator[float, None, Treecode]:
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
        first_face = (len(faces) * np.arange((1 << depth) + 1)) >> depth
        leaves = leaves_of(positions, ordered, first_face)
        yield 0.2
        columns = FIRST_VALUE + values.shape[1]
        rows = aligned((len(leaves.vertices), -(-columns // LANES) * LANES))
        for start in range(0, len(rows), ROWS):
            part = slice(start, start + ROWS)
            vertices = leaves.vertices[part]
            rows[part, 0], rows[part, POSITION:FIRST_VALUE] = 1.0, positions[vertices]
            rows[part, FIRST_VALUE:columns] = values[vertices]
            yield 0.2 + 0.1 * start / len(rows)
        counts = np.zeros(rows.shape[1])
        counts[:FIRST_VALUE], counts[FIRST_VALUE:columns] = 1.0, weights
        source = Source(*leaves[1:], rows, counts, depth)
        nodes, factors = yield from _summed(source, Plan(tolerance * LEAST_TOTAL, SHARE, TABLES))
        records = aligned((2 << depth, RECORD))
        records[:] = records_of(nodes)
        return cls(Tree(depth, records, factors, leaves, rows), nodes, on_surface)

    def interpolate_steps(
        self, points: Floats, tolerance: float, bound: float, target: Target
    ) -> Generator[float, None, None]:
        """Carry the values to points; yields the share done.

        Args:
            points: (p, 3) in the unit of the positions.
            tolerance: error aimed at, as measured with the tree's weights.
            bound: error above which a point is doubtful.
            target: where the values go, NaN for points that are certainly outside.
        """
        order = halved(points, max(0, math.ceil(math.log2(max(len(points), 1) / LANES))))
        for start in range(0, len(points), AT_ONCE):
            places = order[start : start + AT_ONCE]
            descend(
                points[places],
                _cuts(len(places), self._workers),
                *self._tree,
                *(tolerance, SHARE, self._on_surface, opening_radii(tolerance), DOUBT, bound),
                *(self._room, np.zeros(1, dtype=np.int64), places, target),
            )
            yield (start + len(places)) / len(points)


def _cuts(count: int, workers: int) -> Ints:
    """Where chunks begin, and the end; they become smaller, so that workers finish together."""
    cuts = [0]
    while cuts[-1] < count:
        left = count - cuts[-1]
        size = min(CHUNK, max(LEAST_CHUNK, int(left / (EVEN * workers)) // LANES * LANES))
        cuts.append(min(count, cuts[-1] + size))
    return np.array(cuts)


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
    largest = int(np.diff(source.first_row).max())
    desks = factor_workspaces(width, largest, source.depth - level + 1, at_once)
    used, parts, total = np.empty(at_once, dtype=np.int64), [], 0
    for first in range(1 << level, 2 << level, at_once):
        sum_subtrees(source, first, level, *plan, nodes, room, desks, used, kept)
        for i in range(at_once):
            for rise in range(source.depth - level + 1):
                nodes.first[(first + i) << rise : (first + i + 1) << rise] += total
            parts.append(Factors(*(array[i, : used[i]].copy() for array in room)))
            total += int(used[i])
        yield 0.3 + 0.6 * (first + at_once - (1 << level)) / (1 << level)
    top, used_by_top = _room_for(FACTORS_OF_A_NODE << level, width, 1), 0
    for above in range(level - 1, -1, -1):
        used_by_top = sum_level(source, above, *plan, nodes, top, desks, kept, used_by_top)
        yield 0.9
    nodes.first[: 1 << level] += total
    parts.append(Factors(*(array[0, :used_by_top] for array in top)))
    return nodes, (yield from _packed(parts))


def _packed(parts: list[Factors]) -> Generator[float, None, Factors]:
    result = []
    kinds = list(zip(*parts, strict=True))
    parts.clear()  # so that each kind's parts are free once they are packed
    while kinds:
        arrays = kinds.pop(0)
        whole = aligned((sum(map(len, arrays)), *arrays[0].shape[1:]))
        filled = 0
        for some in arrays:
            whole[filled : filled + len(some)] = some
            filled += len(some)
            yield 0.92
        result.append(whole)
    return Factors(*result)


def _room_for(factors: int, width: int, subtrees: int) -> Factors:
    return Factors(
        np.empty((subtrees, factors, COEFFICIENTS), dtype=np.float32),
        np.empty((subtrees, factors, width), dtype=np.float32),
        np.empty((subtrees, factors), dtype=np.float32),
    )
