"""Points as people have them: those that rounding put a little outside belong to the surface."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Bools, Floats, Ints, as_points
from idviewer.core.coordinates import Coordinates
from idviewer.core.coordinates.mean_value import MeanValueCoordinates
from idviewer.core.shapes.nearest_points import nearest_points
from idviewer.core.steps import finish

SURFACE_REACH = 1e-5
"""A point that is outside by at most this share of the shape's diagonal lies on the surface: six digits of
coordinates about the origin round off no more."""

LARGEST_REACH = 1e-3
"""However few digits are written, a point farther outside than this share of the diagonal is outside."""


class Placement(NamedTuple):
    """Where points lie, and those just outside on the surface.

    Attributes:
        points: (p, dimension) as they were given, but for those that were taken onto the surface.
        moved: (m,) numbers of these.
        farthest: the longest way that one of them was taken, in the shape's unit; 0 where none was.
        outside: (o,) numbers of the points that are outside.
    """

    points: Floats
    moved: Ints
    farthest: float
    outside: Ints


def place_points(coordinates: Coordinates, points: ArrayLike, rounding: ArrayLike = 0.0) -> Placement:
    """Tell which points are inside a shape, and take those onto its surface that are hardly outside.

    A point is hardly outside if the surface is no farther away than `SURFACE_REACH` of the diagonal, or than
    the point's own rounding, though never more than `LARGEST_REACH` of the diagonal.

    Args:
        coordinates: of the shape.
        points: (p, dimension).
        rounding: (p,) or one for all: how far the points may be from where they are meant, in the shape's
            unit, such as half a unit of the last digit written.

    >>> from idviewer.core import Polygon
    >>> square = MeanValueCoordinates(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]))
    >>> placed = place_points(square, [[1.0, 1.0], [4.00001, 2.0], [4.001, 2.0]])
    >>> placed.points[1].tolist(), placed.moved.tolist(), placed.outside.tolist()
    ([4.0, 2.0], [1], [2])
    """
    shape = coordinates.shape
    points = as_points(points, shape.dimension)
    outside = np.flatnonzero(~within(coordinates, points))
    least, most = SURFACE_REACH * shape.diagonal, LARGEST_REACH * shape.diagonal
    reach = np.clip(np.broadcast_to(np.asarray(rounding, np.float64), len(points)), least, most)
    if len(outside) == 0:
        return Placement(points, outside, 0.0, outside)
    nearest = nearest_points(shape, points[outside], reach[outside])
    near = np.isfinite(nearest.distances)
    placed = points.copy()
    placed[outside[near]] = nearest.points[near]
    farthest = float(nearest.distances[near].max(initial=0.0))
    return Placement(placed, outside[near], farthest, outside[~near])


def within(coordinates: Coordinates, points: Floats) -> Bools:
    """Tell which points are inside or, but for the rounding of floats, on the boundary, (p,).

    Args:
        coordinates: of the shape.
        points: (p, dimension).
    """
    # Others may find no weights at a point inside.
    if not isinstance(coordinates, MeanValueCoordinates):
        coordinates = MeanValueCoordinates(coordinates.shape)
    return coordinates.contains(points)


def evaluate_placed(
    coordinates: Coordinates, steps: Callable[..., Generator[float, None, Floats]], *points: ArrayLike
) -> Floats:
    """Evaluate a function of points; where it has none, with points hardly outside taken onto the surface.

    Args:
        coordinates: of the shape.
        steps: the function as a generator, from lists of points to (p,) or (p, k); NaN for points outside.
        points: lists (p, dimension) or (1, dimension).

    >>> from idviewer.core import Polygon
    >>> square = MeanValueCoordinates(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]))
    >>> first = lambda points: square.interpolate_steps(points, np.array([[1.0], [0.0], [0.0], [0.0]]))
    >>> evaluate_placed(square, first, [[1.0, -0.00001], [5.0, 0.0]]).tolist()
    [[0.75], [nan]]
    """
    values = finish(steps(*points))
    lists = [as_points(some, coordinates.shape.dimension) for some in points]
    missing = np.flatnonzero(~np.isfinite(values).all(axis=tuple(range(1, values.ndim))))
    if len(missing) == 0:
        return values
    placed = [place_points(coordinates, some if len(some) == 1 else some[missing]) for some in lists]
    if any(len(place.moved) for place in placed):
        values[missing] = finish(steps(*(place.points for place in placed)))
    return values
