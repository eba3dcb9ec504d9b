"""Sums of mean value weights and of their absolute values: how far the values at a point can be relied on."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from idviewer.core._kernels import LANES, thread_count
from idviewer.core._kernels.treecode.absolute_sums import Openings, absolute_sums, cluster_records
from idviewer.core._kernels.treecode.bisection import bisection_order
from idviewer.core._kernels.treecode.leaf import leaves_of
from idviewer.core.arrays import Floats, Ints


@dataclass(frozen=True)
class WeightSumSettings:
    """Settings of the sums of weights.

    Attributes:
        largest_absolute_sum: in a body that overlaps itself, values are given where the sum of |w_i| is at
            most this, twice what ordinary concave bodies reach; others have values everywhere inside.
        notable_negativity: negative weights that add up to more than this are told of.
        one_sided: a cluster whose faces all show a point the same side stands for them from so many of its
            radii on.
        two_sided: where they may show both sides.
    """

    largest_absolute_sum: float = 4.0
    notable_negativity: float = 0.5
    one_sided: float = 2.5
    two_sided: float = 6.0


WEIGHT_SUMS = WeightSumSettings()


class WeightSums:
    """Evaluates, at many points, the sum of a mesh's mean value weights and of their absolute values.

    A face's three shares have one sign, that of the side which it shows the point. Taken face by face the
    absolute sum is W_abs(p) = integral of |n . (x - p)| / |x - p|^4 over the surface, where the sum is
    W(p), the same without the bars. It does not depend on how finely the surface is cut, and W_abs / W is at
    least the sum of |w_i|. Source: docs/coordinates.md.

    Args:
        positions: (n, 3) vertices, in units of the bounding box's diagonal, about its centre.
        faces: (m, 3).
        surface_distance: how near the surface a point counts as lying on it.
        settings: see there.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) - 0.5
    >>> sums = WeightSums(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]), 1e-14)
    >>> inside, outside = sums.at(np.array([[-0.3, -0.3, -0.3], [1.0, 1.0, 1.0]]))
    >>> bool(inside[0] == inside[1] > 0.0), bool(outside[0] < 0.0 < outside[1])
    (True, True)
    """

    def __init__(
        self,
        positions: Floats,
        faces: Ints,
        surface_distance: float,
        settings: WeightSumSettings = WEIGHT_SUMS,
    ) -> None:
        self._depth = max(0, math.ceil(math.log2(len(faces) / LANES)))
        ordered = faces[bisection_order(positions[faces].mean(axis=1), self._depth)]
        first_face = (len(faces) * np.arange((1 << self._depth) + 1)) >> self._depth
        self._records = cluster_records(positions, ordered, first_face)
        self._leaves = leaves_of(positions, ordered, first_face)
        self._surface_distance = surface_distance
        self._openings = Openings(settings.one_sided, settings.two_sided)

    def at(self, points: Floats) -> Floats:
        """(p, 2) W and W_abs of points (p, 3), within some percent of W_abs; (1, 1) on the surface."""
        result, workers = np.empty((len(points), 2)), thread_count()
        absolute_sums(
            np.ascontiguousarray(points),
            self._depth,
            self._records,
            self._leaves,
            self._surface_distance,
            self._openings,
            np.empty((workers, self._depth + 2), dtype=np.int64),
            np.empty((workers, 3, LANES)),
            np.zeros(1, dtype=np.int64),
            result,
        )
        return result
