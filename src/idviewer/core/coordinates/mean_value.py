"""Mean value coordinates: smooth and linearly precise on every shape, negative in some concave ones."""

from __future__ import annotations

from collections.abc import Generator
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Bools, Floats, as_points
from idviewer.core.coordinates.mean_value_mesh import MeshMeanValue
from idviewer.core.coordinates.mean_value_polygon import PolygonMeanValue
from idviewer.core.coordinates.registry import Coordinates, Property, register_coordinates
from idviewer.core.coordinates.tolerance import Approximation
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.shape import Shape, ShapeLike


def mean_value_on(shape: Shape) -> MeshMeanValue | PolygonMeanValue:
    """The evaluator for a shape; it knows, too, which points are inside and on the boundary.

    >>> import numpy as np
    >>> from idviewer.core import Polygon
    >>> square = mean_value_on(Polygon([[0, 0], [1, 0], [1, 1], [0, 1]]))
    >>> square.classify(np.array([[0.5, 0.5], [0.5, 0.0], [2.0, 0.0]]))[:2]
    (array([0]), array([1]))
    """
    return MeshMeanValue(cast(Mesh, shape)) if shape.dimension == 3 else PolygonMeanValue(shape)


@register_coordinates
class MeanValueCoordinates(Coordinates):
    """Evaluates mean value coordinates of one shape.

    They are smooth, add up to 1, reproduce linear functions and interpolate on the boundary (vertex,
    edge and face alike); they may be negative in concave shapes. Sources: Hormann and Floater 2006 for
    polygons, with holes too; Ju, Schaefer and Warren 2005 for meshes; both without trigonometry
    (docs/mean_value.md, docs/coordinates.md).

    Args:
        shape: n vertices.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> MeanValueCoordinates(tetrahedron).weights([[0.1, 0.2, 0.3]]).round(12).tolist()
    [[0.4, 0.1, 0.2, 0.3]]
    """

    name = "mean_value"
    title = "Mean value coordinates"
    menu_order = 10
    properties = frozenset(Property) - {Property.NON_NEGATIVITY}

    def __init__(self, shape: ShapeLike) -> None:
        super().__init__(shape)
        self._on = mean_value_on(self.shape)

    def weights(self, points: ArrayLike) -> Floats:
        """Coordinates of points with respect to every vertex.

        Args:
            points: (p, dimension).

        Returns:
            (p, n) rows that sum to 1; NaN for points outside.
        """
        points = as_points(points, self.shape.dimension)
        return self._on.weights(points)

    def _interpolate_steps(self, points: Floats, values: Floats) -> Generator[float, None, Floats]:
        if isinstance(self._on, MeshMeanValue):
            return (yield from self._on.interpolate_steps(points, values))
        return (yield from super()._interpolate_steps(points, values))

    @property
    def undefined(self) -> int:  # type: ignore[override]
        """At how many points inside, of all so far, a body that overlaps itself left no value."""
        return self._on.undefined if isinstance(self._on, MeshMeanValue) else 0

    def negativity_bound_steps(self, points: Floats) -> Generator[float, None, Floats]:
        """Bound the negative weights' sum of points (p, dimension) quickly, or nearly; yields shares done.

        In a mesh by sums face by face, which are at least those of weights (`WeightSums`).
        """
        if isinstance(self._on, MeshMeanValue):
            return (yield from self._on.negativity_bound_steps(points))
        return (yield from super().negativity_bound_steps(points))

    def have_values(self, points: Floats) -> Bools:
        """Tell which of points (p, dimension) inside have values, (p,): all but beside overlaps."""
        if isinstance(self._on, MeshMeanValue):
            return self._on.have_values(points)
        return super().have_values(points)

    def contains(self, points: ArrayLike) -> Bools:
        """Tell which of points (p, dimension) lie inside the shape or on its boundary, (p,).

        Raises:
            ValueError: the points have another dimension.
        """
        classified = self._on.classify(as_points(points, self.shape.dimension))
        result = np.zeros(len(np.asarray(points)), dtype=np.bool_)
        result[classified.inside] = result[classified.on] = True
        return result

    def approximation(self, values: Floats, weights: Floats) -> Approximation | None:
        """Prepare to carry values inside a mesh within a tolerance; None for a polygon. See `Approximation`.

        Args:
            values: (n, k) at the vertices.
            weights: (k,) an error e (k,) of a point's values is measured as |weights * e|.
        """
        return self._on.approximation(values, weights) if isinstance(self._on, MeshMeanValue) else None


def mean_value_weights(shape: ShapeLike, points: ArrayLike) -> Floats:
    """Mean value coordinates of points; for many calls on one shape keep a `MeanValueCoordinates`.

    Args:
        shape: n vertices.
        points: (p, dimension).

    Returns:
        (p, n) rows that sum to 1; NaN for points outside.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> mean_value_weights(tetrahedron, [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]).round(12).tolist()
    [[1.0, 0.0, 0.0, 0.0], [nan, nan, nan, nan]]
    """
    return MeanValueCoordinates(shape).weights(points)
