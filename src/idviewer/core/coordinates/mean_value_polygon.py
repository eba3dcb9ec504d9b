"""Mean value coordinates of points inside a polygon, with or without holes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core._kernels.mean_value.polygon_edges import classify, mean_value
from idviewer.core.arrays import Floats, as_points
from idviewer.core.coordinates.point_classification import Boundary, PointClassification
from idviewer.core.shapes.shape import Shape


class PolygonMeanValue(Boundary):
    """Evaluates mean value coordinates of one polygon.

    Source: Hormann and Floater 2006: w_i = (tan(alpha_(i-1) / 2) + tan(alpha_i / 2)) / r_i, signed angles.

    Args:
        polygon: n vertices; edges with the interior on their left.

    >>> from idviewer.core import Polygon
    >>> square = PolygonMeanValue(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]))
    >>> square.weights([[2.0, 2.0], [5.0, 2.0]]).round(12).tolist()
    [[0.25, 0.25, 0.25, 0.25], [nan, nan, nan, nan]]
    """

    def __init__(self, polygon: Shape) -> None:
        super().__init__(polygon)
        self.elements = np.ascontiguousarray(polygon.edges)
        vertices = self.normalise(polygon.vertices)
        self._vertices = np.ascontiguousarray(vertices.T)
        self._ends = np.ascontiguousarray(vertices[self.elements].reshape(-1, 4).T)

    def classify(self, points: Floats) -> PointClassification:
        """Classify points (p, 2) as inside, on an edge or outside."""
        edge, share, winding = classify(self.normalise(points), self._ends, self.tolerance)
        on = np.flatnonzero(edge >= 0)
        shares = np.stack([1.0 - share[on], share[on]], axis=1)
        return PointClassification(
            np.flatnonzero((edge < 0) & (winding > 0)), on, self.elements[edge[on]], shares
        )

    def weights(self, points: ArrayLike) -> Floats:
        """Coordinates of points with respect to every vertex.

        Args:
            points: (p, 2).

        Returns:
            (p, n) rows that sum to 1; NaN for points outside.
        """
        places, classified, result = self.rows(as_points(points, 2))
        mean_value(places, classified.inside, self._vertices, self.elements, self._ends, result)
        return result
