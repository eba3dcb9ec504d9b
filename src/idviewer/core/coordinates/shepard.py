"""Shepard's weights: inverse powers of the distance to the vertices; all but linearly precise."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from idviewer.core.arrays import Floats, as_points
from idviewer.core.coordinates.mean_value import mean_value_on
from idviewer.core.coordinates.registry import Coordinates, Property, register_coordinates
from idviewer.core.shapes.shape import ShapeLike

PAIRS_IN_MEMORY = 1 << 18
"""Points times vertices that are worked on at once: 2 MB an array."""

LEAST_RELATIVE_PART = 1e-12
"""Of a vertex's part of the boundary, as a share of the mean one; faces without area have no other."""


@register_coordinates
class ShepardCoordinates(Coordinates):
    """Inverse distance weights w_i = a_i |p - v_i|^-k / sum, with k the dimension of the space.

    a_i is the vertex's part of the boundary: half the length of its edges, a third of the area of its faces.
    In the plane, on evenly sampled polygons, these are Shepard's weights of 1968 with his power 2. The parts
    make a fine and a coarse stretch of the boundary count alike. k is the dimension because the sums then
    tend, under refinement, to an integral with the power of the Poisson kernel. With k = 2 in space, that
    integral would diverge so slowly near a surface that the vertices on the far side would still be seen.

    Between vertices, also on edges and faces, they are not linear. Source: Shepard, "A two-dimensional
    interpolation function for irregularly-spaced data", 1968.

    Args:
        shape: n vertices.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> ShepardCoordinates(tetrahedron).weights([[0.0, 1.0, 0.0], [0.2, 0.2, 0.2]]).round(3).tolist()
    [[0.0, 0.0, 1.0, 0.0], [0.797, 0.068, 0.068, 0.068]]
    """

    name = "shepard"
    title = "Shepard's weights"
    menu_order = 30
    properties = frozenset(Property) - {Property.LINEAR_PRECISION}
    linear_on_boundary: ClassVar[bool] = False
    pairs_per_step: ClassVar[float] = 3e5

    def __init__(self, shape: ShapeLike) -> None:
        super().__init__(shape)
        shape = self.shape
        self._boundary = mean_value_on(shape)
        self._vertices = self._boundary.normalise(shape.vertices)
        self._parts = boundary_parts(self._vertices, self._boundary.elements)

    def weights(self, points: ArrayLike) -> Floats:
        """Weights of points with respect to every vertex.

        Args:
            points: (p, dimension).

        Returns:
            (p, n) rows that sum to 1; NaN for points outside.
        """
        places, classified, result = self._boundary.rows(as_points(points, self.shape.dimension))
        within = np.concatenate([classified.inside, classified.on])
        at_once = max(1, PAIRS_IN_MEMORY // len(self._vertices))
        for start in range(0, len(within), at_once):
            some = within[start : start + at_once]
            result[some] = self._at(places[some])
        return result

    def _at(self, places: Floats) -> Floats:
        squares = np.zeros((len(places), len(self._vertices)))
        for axis in range(places.shape[1]):
            squares += (places[:, axis, None] - self._vertices[:, axis]) ** 2
        nearest = squares.min(axis=1, keepdims=True)
        # Relative to the nearest vertex nothing overflows, and on a vertex 0 / 0 is its own ratio, 1.
        ratios = np.divide(nearest, squares, out=np.ones_like(squares), where=squares > 0.0)
        weights = self._parts * (ratios if places.shape[1] == 2 else ratios * np.sqrt(ratios))
        return weights / weights.sum(axis=1, keepdims=True)


def boundary_parts(vertices: Floats, elements: NDArray[np.int64]) -> Floats:
    """Each vertex's part (n,) of the boundary, every edge or face shared equally among its vertices.

    Args:
        vertices: (n, dimension).
        elements: (e, 2) edges or (m, 3) faces.

    Returns:
        (n,) the lengths of a vertex's edges, or twice the areas of its faces: only the ratios count.

    >>> boundary_parts(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]), np.array([[0, 1], [1, 2]])).tolist()
    [2.0, 3.0, 1.0]
    """
    sides = vertices[elements[:, 1:]] - vertices[elements[:, :1]]
    normals = sides[:, 0] if elements.shape[1] == 2 else np.cross(sides[:, 0], sides[:, 1])
    sizes = np.repeat(np.linalg.norm(normals, axis=1), elements.shape[1])
    parts = np.bincount(elements.ravel(), sizes, len(vertices))
    return np.maximum(parts, LEAST_RELATIVE_PART * parts.mean())
