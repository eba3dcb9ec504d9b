"""What the shapes that have an interior share: triangle meshes in space, polygons in the plane."""

from __future__ import annotations

from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class ShapeError(ValueError):
    """A shape that cannot be read or used; one line says what is wrong, where, and what to do."""


class DistanceError(ValueError):
    """A boundary distance that a shape cannot have, or that is given wrongly; one line says why."""


class Shape(Protocol):
    """A boundary with vertices, and the interior that it encloses.

    Attributes:
        dimension: of the space, 2 or 3.
        name: for titles.
    """

    dimension: ClassVar[int]

    @property
    def name(self) -> str:
        """For titles; file name without its suffix."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What was repaired when it was read, one sentence each."""

    @property
    def vertices(self) -> Floats:
        """(n, dimension), read-only."""

    @property
    def edges(self) -> Ints:
        """(e, 2) vertices of each edge of the boundary."""

    @property
    def facets(self) -> Ints:
        """(f, dimension) vertices of each piece of the boundary: triangles in space, edges in the plane."""

    @property
    def bounds(self) -> Floats:
        """(2, dimension) lowest and highest corner of the bounding box."""

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal."""


def as_points(points: ArrayLike, dimension: int) -> Floats:
    """points as (p, dimension) float64; a ValueError names any other shape.

    >>> as_points([[0, 1, 2]], 3).shape
    (1, 3)
    """
    array = np.asarray(points, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != dimension:
        raise ValueError(f"points must have shape (p, {dimension}), not {array.shape}")
    return array


def in_space(points: ArrayLike) -> Floats:
    """Points (p, 3) as they are; points of a polygon, (p, 2), in the plane z = 0.

    >>> in_space([[1.0, 2.0]]).tolist()
    [[1.0, 2.0, 0.0]]
    """
    array = np.asarray(points, dtype=np.float64)
    return np.column_stack([array, np.zeros(len(array))]) if array.shape[1] == 2 else array


def as_pairs(p: ArrayLike, q: ArrayLike, dimension: int) -> tuple[Floats, Floats]:
    """Two lists of points, (p, dimension) each, or (1, dimension); a ValueError names what does not match.

    >>> [len(points) for points in as_pairs([[0, 0]], [[1, 1], [2, 2]], 2)]
    [1, 2]
    """
    first, second = as_points(p, dimension), as_points(q, dimension)
    if len(first) != len(second) and 1 not in (len(first), len(second)):
        raise ValueError(
            f"distances between {len(first)} points and {len(second)} points: "
            "there must be as many of both, or one of either"
        )
    return first, second
