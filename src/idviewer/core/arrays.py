"""Arrays that the library takes and gives: their types, and the doors for lists of points."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
AnyArray = TypeVar("AnyArray", bound=np.ndarray)


def frozen(array: AnyArray) -> AnyArray:
    """The array itself, read-only from now on.

    >>> frozen(np.ones(2)).flags.writeable
    False
    """
    array.setflags(write=False)
    return array


def as_points(points: ArrayLike, dimension: int) -> Floats:
    """Convert points to (p, dimension) float64.

    Args:
        points: (p, dimension) numbers.
        dimension: 2 or 3.

    Raises:
        ValueError: they have another shape.

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
    """Convert two lists of points to float64; either may hold a single one, for all of the other.

    Args:
        p, q: (p, dimension) or (1, dimension).
        dimension: 2 or 3.

    Returns:
        The two as they are, not broadcast.

    Raises:
        ValueError: they have another shape, or there are not as many of both.

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


def counted(counts: Ints) -> tuple[Ints, Ints]:
    """For each item so many entries: the item, and the number of the entry among the item's.

    Args:
        counts: (i,) how many.

    >>> [part.tolist() for part in counted(np.array([2, 0, 3]))]
    [[0, 0, 2, 2, 2], [0, 1, 0, 1, 2]]
    """
    item = np.repeat(np.arange(len(counts)), counts)
    return item, np.arange(len(item)) - (np.cumsum(counts) - counts)[item]
