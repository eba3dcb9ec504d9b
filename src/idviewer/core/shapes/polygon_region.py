"""The region that a polygon's loops bound, as shapely knows it, and which points lie in it."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints
from idviewer.core.validation.polygon_crossings import region_of

ON_EDGE_ROUNDING = 4.0 * float(np.finfo(np.float64).eps)
"""Points nearer to an edge than this share of the largest coordinate lie on it, as far as floats can tell."""


def prepared_region(vertices: Floats, loops: tuple[Ints, ...]) -> shapely.Polygon:
    """The region, with its trees, which are made by the first query: so it is made here.

    Args:
        vertices: (n, 2).
        loops: their numbers, the outer one first.
    """
    region = region_of(vertices, loops)
    shapely.prepare(region)
    corner = shapely.points(vertices[0])
    shapely.intersects(region, corner)
    shapely.dwithin(region, corner, 0.0)
    return region


def contained(region: shapely.Polygon, vertices: Floats, points: Floats) -> NDArray[np.bool_]:
    """Whether points lie in a region or, within rounding, on its boundary.

    Args:
        region: from `prepared_region`.
        vertices: (n, 2) its vertices.
        points: (p, 2).

    >>> square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    >>> region = prepared_region(square, (np.arange(4),))
    >>> contained(region, square, np.array([[0.5, 1.0], [0.5, 1.1]])).tolist()
    [True, False]
    """
    inside: NDArray[np.bool_] = shapely.intersects_xy(region, points[:, 0], points[:, 1])
    slack = ON_EDGE_ROUNDING * float(np.abs(vertices).max())
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    beside = ~inside & ((points >= low - slack) & (points <= high + slack)).all(axis=1)
    inside[beside] = shapely.dwithin(region, shapely.points(points[beside]), slack)
    return inside
