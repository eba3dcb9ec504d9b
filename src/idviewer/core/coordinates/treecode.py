"""Mean value interpolation within a tolerance: far faces act together, near ones one by one."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from idviewer.core._kernels import LANES, thread_count
from idviewer.core._kernels.treecode.bisection import bisection_order
from idviewer.core._kernels.treecode.clusters import RECORD, Nodes, records_of, sum_level, sum_subtrees
from idviewer.core._kernels.treecode.expansion import COEFFICIENTS, ORDER, TABLES
from idviewer.core._kernels.treecode.leaf import leaves_of
from idviewer.core._kernels.treecode.low_rank_factors import Factors, Plan, factor_workspaces
from idviewer.core._kernels.treecode.moments import Source
from idviewer.core._kernels.treecode.normalize import FIRST_VALUE, POSITION, Target
from idviewer.core._kernels.treecode.point_lists import LEAST_WEIGHT_SUM
from idviewer.core._kernels.treecode.traversal import Accuracy, Tree, opening_radii, traverse
from idviewer.core._kernels.treecode.workspace import aligned, workspaces
from idviewer.core.arrays import Floats, Ints


@dataclass(frozen=True)
class TreecodeSettings:
    """Settings of a treecode; all but two fields change its speed alone.

    Attributes:
        factor_share: share of a node's error that left out factors may cause.
        error_safety: errors of values are at most about so many times those of positions, which are known.
        subtree_levels: levels of the subtrees that are built side by side.
        subtrees_per_step: subtrees between two checkpoints.
        factors_per_node: space for factors, on average over a subtree; nodes that find none leave their work
            to their children.
        rows_per_step: rows of a table that are copied between two checkpoints.
        points_per_step: points between two checkpoints: about 10 ms on two cores.
        largest_chunk: most points that traverse the tree together.
        least_chunk: points; smaller chunks cost more than an idle worker.
        chunks_per_share: a worker takes one part in so many of its even share of the points that are left.
    """

    factor_share: float = 0.08
    error_safety: float = 3.0
    subtree_levels: int = 7
    subtrees_per_step: int = 4
    factors_per_node: int = 8
    rows_per_step: int = 2**11
    points_per_step: int = 2048
    largest_chunk: int = 1024
    least_chunk: int = 64
    chunks_per_share: float = 1.5


TREECODE_SETTINGS = TreecodeSettings()


class Treecode:
    """Values at the vertices of a mesh, ready to be carried inside by mean value coordinates.

    Use `build_steps`. Source: docs/treecode.md.

    Args:
        tree: what traversals need.
        nodes: of the tree.
        surface_distance: how near the surface a point counts as lying on it.
        settings: how it is evaluated.
    """

    def __init__(
        self,
        tree: Tree,
        nodes: Nodes,
        surface_distance: float,
        settings: TreecodeSettings = TREECODE_SETTINGS,
    ) -> None:
        self._tree, self._surface_distance, self._settings = tree, surface_distance, settings
        self.nodes = nodes
        self._workers = thread_count()
        self._workspaces = workspaces(
            tree.leaves, tree.values.shape[1], settings.largest_chunk, self._workers
        )

    @classmethod
    def build_steps(
        cls,
        mesh: tuple[Floats, Ints],
        values: Floats,
        weights: Floats,
        tolerance: float,
        surface_distance: float,
        settings: TreecodeSettings = TREECODE_SETTINGS,
    ) -> Generator[float, None, Treecode]:
        """Build a tree; yields the share done every few milliseconds.

        Args:
            mesh: positions (n, 3) in units of the bounding box's diagonal, about its centre; faces (m, 3).
            values: (n, k).
            weights: (k,) errors of values are measured as |weights * error|.
            tolerance: the smallest error that will be asked for.
            surface_distance: how near the surface a point counts as lying on it, in that unit.
            settings: how it is built and evaluated.

        Returns:
            The treecode of columns 1, x, y, z and the values.
        """
        positions, faces = mesh
        depth = max(0, math.ceil(math.log2(len(faces) / LANES)))
        ordered = faces[bisection_order(positions[faces].mean(axis=1), depth)]
        yield 0.1
        first_face = (len(faces) * np.arange((1 << depth) + 1)) >> depth
        leaves = leaves_of(positions, ordered, first_face)
        yield 0.2
        columns = FIRST_VALUE + values.shape[1]
        rows = aligned((len(leaves.vertices), -(-columns // LANES) * LANES))
        for start in range(0, len(rows), settings.rows_per_step):
            part = slice(start, start + settings.rows_per_step)
            vertices = leaves.vertices[part]
            rows[part, 0], rows[part, POSITION:FIRST_VALUE] = 1.0, positions[vertices]
            rows[part, FIRST_VALUE:columns] = values[vertices]
            yield 0.2 + 0.1 * start / len(rows)
        counts = np.zeros(rows.shape[1])
        counts[:FIRST_VALUE], counts[FIRST_VALUE:columns] = 1.0, weights
        source = Source(*leaves[1:], rows, counts, depth)
        plan = Plan(tolerance * LEAST_WEIGHT_SUM, settings.factor_share, TABLES)
        nodes, factors = yield from _summed(source, plan, settings)
        records = aligned((2 << depth, RECORD))
        records[:] = records_of(nodes)
        return cls(Tree(depth, records, factors, leaves, rows), nodes, surface_distance, settings)

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
        order = bisection_order(points, max(0, math.ceil(math.log2(max(len(points), 1) / LANES))))
        settings = self._settings
        accuracy = Accuracy(
            tolerance,
            settings.factor_share,
            self._surface_distance,
            opening_radii(tolerance),
            settings.error_safety,
            bound,
        )
        for start in range(0, len(points), settings.points_per_step):
            places = order[start : start + settings.points_per_step]
            chunks, queue = chunks_of(len(places), self._workers, settings), np.zeros(1, dtype=np.int64)
            traverse(points[places], chunks, places, *self._tree, accuracy, self._workspaces, queue, target)
            yield (start + len(places)) / len(points)


def chunks_of(count: int, workers: int, settings: TreecodeSettings) -> Ints:
    """Split points into chunks for workers; they shrink, so that workers finish together.

    Args:
        count: of points.
        workers: threads.
        settings: bounds of the chunks' sizes.

    Returns:
        (c + 1,) where each chunk begins, and the end.

    >>> chunks_of(500, 2, TreecodeSettings(least_chunk=64)).tolist()
    [0, 160, 272, 336, 400, 464, 500]
    """
    cuts = [0]
    while cuts[-1] < count:
        left = count - cuts[-1]
        fair = int(left / (settings.chunks_per_share * workers)) // LANES * LANES
        size = min(settings.largest_chunk, max(settings.least_chunk, fair))
        cuts.append(min(count, cuts[-1] + size))
    return np.array(cuts)


def _summed(
    source: Source, plan: Plan, settings: TreecodeSettings
) -> Generator[float, None, tuple[Nodes, Factors]]:
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
    level = min(source.depth, max(1, source.depth - settings.subtree_levels))
    at_once = min(settings.subtrees_per_step, 1 << level)
    kept = np.empty((1 << level, COEFFICIENTS, width))
    space = _empty_factors(settings.factors_per_node * (2 << (source.depth - level)), width, at_once)
    largest = int(np.diff(source.first_row).max())
    factor_space = factor_workspaces(width, largest, source.depth - level + 1, at_once)
    used, parts, total = np.empty(at_once, dtype=np.int64), [], 0
    for first in range(1 << level, 2 << level, at_once):
        sum_subtrees(source, first, level, *plan, nodes, space, factor_space, used, kept)
        for i in range(at_once):
            for rise in range(source.depth - level + 1):
                nodes.first[(first + i) << rise : (first + i + 1) << rise] += total
            parts.append(Factors(*(array[i, : used[i]].copy() for array in space)))
            total += int(used[i])
        yield 0.3 + 0.6 * (first + at_once - (1 << level)) / (1 << level)
    top, used_by_top = _empty_factors(settings.factors_per_node << level, width, 1), 0
    for above in range(level - 1, -1, -1):
        used_by_top = sum_level(source, above, *plan, nodes, top, factor_space, kept, used_by_top)
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


def _empty_factors(factors: int, width: int, subtrees: int) -> Factors:
    return Factors(
        np.empty((subtrees, factors, COEFFICIENTS), dtype=np.float32),
        np.empty((subtrees, factors, width), dtype=np.float32),
        np.empty((subtrees, factors), dtype=np.float32),
    )
