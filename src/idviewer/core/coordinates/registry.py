"""Coordinates, the base of all kinds, and the table of all kinds."""

from __future__ import annotations

from collections.abc import Generator
from enum import Enum
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Bools, Floats, as_points
from idviewer.core.shapes.shape import ShapeLike, as_shape
from idviewer.core.steps import finish

LARGEST_WIDTH, FEWEST_POINTS, PRODUCTS_PER_STEP = 256, 16, 2**26
"""Columns up to which values are interpolated all at once; else the fewest points of a portion, and about how
many products of a weight and a value it takes."""

NEGATIVITY_WEIGHTS = 1 << 20
"""Weights held at once by `negativity_steps`: 8 MB."""


class Property(Enum):
    """Properties that weights w_i(p) of a point p may have; v_i are the vertices."""

    PARTITION_OF_UNITY = "sum w_i = 1"
    LINEAR_PRECISION = "sum w_i v_i = p"
    LAGRANGE = "w_i(v_j) = 1 if i = j, else 0"
    NON_NEGATIVITY = "w_i >= 0"
    SMOOTHNESS = "w_i is smooth inside"


class Coordinates:
    """Base of all kinds of coordinates: a kind says what it is and defines `weights`.

    Args:
        shape: n vertices, in 2 or 3 dimensions, or its arrays (see `idviewer.core.shapes.shape`).

    Attributes:
        name: as `InteriorDistance` and the command line take it.
        title: for menus.
        menu_order: place in menus, the lowest first.
        dimensions: in which it works.
        properties: exactly those that it has; the tests prove them, and disprove the others.
        linear_on_boundary: whether on edges and faces it interpolates their ends linearly, so that it is
            enough to know a section's outline at the vertices.
        pairs_per_step: points times vertices that are worked on between two checkpoints, 5 to 10 ms.
        unconverged: at how many points inside, of all so far, no weights were found.
        undefined: at how many points inside, of all so far, there is no value, beside a place where the
            shape overlaps itself.
        warns: whether a warning tells of them; to be switched off by who reads `unconverged` instead.

    Raises:
        ValueError: it does not work in the shape's dimension.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    menu_order: ClassVar[int]
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    properties: ClassVar[frozenset[Property]]
    linear_on_boundary: ClassVar[bool] = True
    pairs_per_step: ClassVar[float] = 1e6
    unconverged = 0
    undefined = 0
    warns = True

    def __init__(self, shape: ShapeLike) -> None:
        shape = as_shape(shape)
        if shape.dimension not in self.dimensions:
            able = " and ".join(f"{dimension}D" for dimension in self.dimensions)
            raise ValueError(
                f"{self.title.lower()} work in {able}, not in {shape.dimension}D; choose other coordinates"
            )
        self.shape = shape

    def weights(self, points: ArrayLike) -> Floats:
        """Weights of points with respect to every vertex.

        Args:
            points: (p, dimension).

        Returns:
            (p, n) rows that sum to 1; NaN for points outside.

        >>> from idviewer.core import MeanValueCoordinates, Polygon
        >>> square = Polygon([[0, 0], [4, 0], [4, 4], [0, 4]])
        >>> MeanValueCoordinates(square).weights([[2.0, 2.0], [1.0, 0.0]]).round(12).tolist()
        [[0.25, 0.25, 0.25, 0.25], [0.75, 0.25, 0.0, 0.0]]
        """
        raise NotImplementedError

    def interpolate_steps(self, points: ArrayLike, values: Floats) -> Generator[float, None, Floats]:
        """Carry values at the vertices to points; yields the share done every few milliseconds.

        Args:
            points: (p, dimension).
            values: (n, k).

        Returns:
            (p, k), NaN for points outside.

        Raises:
            ValueError: the points have another dimension.

        >>> from idviewer.core import MeanValueCoordinates, Polygon
        >>> square = MeanValueCoordinates(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]))
        >>> heights = np.array([[0.0], [0.0], [8.0], [8.0]])
        >>> finish(square.interpolate_steps([[1.0, 1.0]], heights)).round(12).tolist()
        [[2.0]]
        """
        points = as_points(points, self.shape.dimension)
        if values.shape[1] <= LARGEST_WIDTH:
            return (yield from self._interpolate_steps(points, values))
        result = np.empty((len(points), values.shape[1]))
        size = max(FEWEST_POINTS, PRODUCTS_PER_STEP // values.size)
        for start in range(0, len(points), size):
            part = slice(start, start + size)
            result[part] = finish(self._interpolate_steps(points[part], values))
            yield min(1.0, (start + size) / len(points))
        return result

    def _interpolate_steps(self, points: Floats, values: Floats) -> Generator[float, None, Floats]:
        """The same of few columns, or few points: by rows of weights, unless a kind knows better."""
        result = np.empty((len(points), values.shape[1]))
        at_once = max(4, int(self.pairs_per_step / len(values)))
        for start in range(0, len(points), at_once):
            some = slice(start, start + at_once)
            result[some] = self.weights(points[some]) @ values
            yield min(1.0, (start + at_once) / len(points))
        return result

    def approximation(self, values: Floats, weights: Floats) -> Any:
        """Values (n, k) ready to be carried inside within a tolerance; None where there is no such way.

        Args:
            values: (n, k).
            weights: (k,) an error e (k,) of a point's values is measured as |weights * e|.
        """
        return None

    def negativity(self, points: ArrayLike) -> Floats:
        """sum_i max(0, -w_i(p)): 0 where all weights are non-negative, so that the maximum principle holds.

        Where it is N, sum |w_i| is 1 + 2 N, a value may leave the range of the boundary's by N times its
        width on either side, and d(p, q) is at most 1 + N(p) + N(q) largest boundary distances.

        Args:
            points: (p, dimension).

        Returns:
            (p,), NaN for points outside the shape.

        >>> from idviewer.core import MeanValueCoordinates, Polygon
        >>> square = Polygon([[0, 0], [4, 0], [4, 4], [0, 4]])
        >>> MeanValueCoordinates(square).negativity([[1.0, 2.0]]).tolist()
        [0.0]
        """
        return finish(self.negativity_steps(points))

    def negativity_steps(self, points: ArrayLike) -> Generator[float, None, Floats]:
        """Sum the negative weights, sum_i max(0, -w_i(p)), of points (p, dimension); yields the share done.

        Never more than a few megabytes of weights are held at once.

        Returns:
            (p,), NaN for points outside.
        """
        points = as_points(points, self.shape.dimension)
        result = np.empty(len(points))
        pairs = min(NEGATIVITY_WEIGHTS, self.pairs_per_step)
        at_once = max(4, int(pairs / len(self.shape.vertices)))
        for start in range(0, len(points), at_once):
            some = slice(start, start + at_once)
            result[some] = np.maximum(-self.weights(points[some]), 0.0).sum(axis=1)
            yield min(1.0, (start + at_once) / len(points))
        return result

    def negativity_bound_steps(self, points: Floats) -> Generator[float, None, Floats]:
        """Bound the negative weights' sum of points (p, dimension) quickly, or nearly; yields shares done.

        Returns:
            (p,); of points that have no value it means nothing.
        """
        if Property.NON_NEGATIVITY in self.properties:
            return np.zeros(len(points))
        return (yield from self.negativity_steps(points))

    def have_values(self, points: Floats) -> Bools:
        """Tell which of points (p, dimension) inside have values, (p,): all but beside overlaps."""
        return np.ones(len(points), dtype=np.bool_)


COORDINATES: dict[str, type[Coordinates]] = {}
"""Every kind of coordinates by its name, in the order of menus."""

Kind = TypeVar("Kind", bound=type[Coordinates])


def register_coordinates(kind: Kind) -> Kind:
    """Enter a kind of coordinates in `COORDINATES`; a class decorator.

    Args:
        kind: a class that derives from `Coordinates`.

    Raises:
        TypeError: the class lacks an attribute that menus or tests need, or its properties are none.
        ValueError: another kind has its name.

    >>> from idviewer.core.coordinates import COORDINATES
    >>> COORDINATES["mean_value"].title
    'Mean value coordinates'
    """
    for attribute in ("name", "title", "menu_order", "properties"):
        if not hasattr(kind, attribute):
            raise TypeError(
                f"{kind.__qualname__}: coordinates have a name, a title, a menu_order and properties; "
                f"it lacks {attribute!r}"
            )
    if not all(isinstance(each, Property) for each in kind.properties):
        raise TypeError(f"{kind.__qualname__}: its properties are members of Property")
    if kind.name in COORDINATES and COORDINATES[kind.name].__qualname__ != kind.__qualname__:
        raise ValueError(f"there are two kinds of coordinates with the name {kind.name!r}")
    COORDINATES[kind.name] = kind
    ordered = sorted(COORDINATES.values(), key=lambda each: (each.menu_order, each.name))
    COORDINATES.clear()
    COORDINATES.update({each.name: each for each in ordered})
    return kind


def coordinates_of(shape: ShapeLike, name: str) -> Coordinates:
    """The kind of coordinates of that name, for a shape.

    Args:
        shape: n vertices.
        name: a key of `COORDINATES`.

    Raises:
        ValueError: there is no such kind, or it does not work in the shape's dimension.

    >>> from idviewer.core import Polygon
    >>> from idviewer.core.coordinates import coordinates_of
    >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> coordinates_of(square, "mean_value").weights([[0.5, 0.5]]).round(12).tolist()
    [[0.25, 0.25, 0.25, 0.25]]
    """
    if name not in COORDINATES:
        raise ValueError(f"unknown coordinates {name!r}; there are: {', '.join(COORDINATES)}")
    return COORDINATES[name](shape)
