"""Classification of points: inside, on the boundary, or outside; and the units that evaluations work in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.shapes.shape import Shape


class PointClassification(NamedTuple):
    """Points inside and points on the boundary, of many; those in neither list are outside.

    Attributes:
        inside: (q,) indices of points inside and off the boundary.
        on: (l,) indices of points on the boundary.
        vertices: (l, dimension) of the edge or face that each of these lies on.
        shares: (l, dimension) of these vertices, which sum to 1.

    >>> from idviewer.core import Polygon
    >>> from idviewer.core.coordinates.mean_value_polygon import PolygonMeanValue
    >>> square = PolygonMeanValue(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]))
    >>> classified = square.classify(np.array([[1.0, 0.0], [2.0, 2.0], [9.0, 9.0]]))
    >>> classified.inside.tolist(), classified.on.tolist(), classified.shares.tolist()
    ([1], [0], [[0.75, 0.25]])
    """

    inside: Ints
    on: Ints
    vertices: Ints
    shares: Floats


class Boundary(ABC):
    """A shape's boundary as evaluations need it.

    Attributes:
        elements: (e, 2) edges of a polygon, with the interior on their left, or (m, 3) faces of a mesh.
        tolerance: how near the boundary a point counts as lying on it, in diagonals: 64 roundings of the
            input, which are large on a shape far from the origin.
    """

    elements: Ints

    def __init__(self, shape: Shape) -> None:
        self._count = len(shape.vertices)
        self._centre = shape.bounds.mean(axis=0)
        self._scale = 1.0 / shape.diagonal
        reach = float(np.abs(shape.bounds).max()) * self._scale
        self.tolerance = 64.0 * float(np.finfo(float).eps) * (1.0 + reach)

    def normalise(self, points: Floats) -> Floats:
        """Points (p, dimension) in units of the bounding box's diagonal, about its centre."""
        return (points - self._centre) * self._scale

    @abstractmethod
    def classify(self, points: Floats) -> PointClassification:
        """Classify points (p, dimension) as inside, on the boundary or outside."""

    def rows(self, points: Floats) -> tuple[Floats, PointClassification, Floats]:
        """Normalise and classify points (p, dimension), and begin their (p, n) rows of weights.

        The rows are ready for points on the boundary, where weights are linear, and outside, where they are
        NaN; those of points inside are to be filled in.
        """
        classified = self.classify(points)
        result = np.empty((len(points), self._count))
        outside = np.ones(len(points), dtype=bool)
        outside[classified.inside] = False
        result[outside] = np.nan
        result[classified.on] = 0.0
        np.add.at(result, (classified.on[:, None], classified.vertices), classified.shares)
        return self.normalise(points), classified, result
