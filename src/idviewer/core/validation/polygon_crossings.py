"""Crossings, contacts and folds of a polygon's edges: shapely's robust predicates, and no tolerance."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints


def _rings(vertices: Floats, loops: tuple[Ints, ...]) -> NDArray[np.object_]:
    """The loops as shapely's rings, (l,)."""
    return np.array([shapely.linearrings(vertices[loop]) for loop in loops], dtype=object)


def region_of(vertices: Floats, loops: tuple[Ints, ...]) -> shapely.Polygon:
    """A polygon as shapely's; the outer one of its loops comes first.

    Args:
        vertices: (n, 2).
        loops: indices into them.

    >>> region_of(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), (np.arange(3),)).area
    0.5
    """
    rings = _rings(vertices, loops)
    return shapely.polygons(rings[0], rings[1:])


def is_simple(vertices: Floats, loops: tuple[Ints, ...]) -> bool:
    """Whether edges have nothing in common but the vertex between neighbours, and holes lie inside.

    Holes that touch something are valid for shapely, but none of ours.

    Args:
        vertices: (n, 2).
        loops: vertex numbers of each loop, the outer one first.

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> is_simple(square, (np.arange(4),)), is_simple(square, (np.array([0, 2, 1, 3]),))
    (True, False)
    """
    if not shapely.is_valid(region_of(vertices, loops)):
        return False
    rings = _rings(vertices, loops)
    first, second = shapely.STRtree(rings).query(rings, predicate="intersects")
    return bool(np.all(first == second))


def folded_vertex(vertices: Floats, successors: Ints) -> int | None:
    """The first vertex at which the outline turns back on itself; None if there is none.

    Args:
        vertices: (n, 2); edge i goes from vertex i to its successor.
        successors: (n,).

    >>> folded_vertex(np.array([[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), np.array([1, 2, 3, 0]))
    1
    """
    edges = shapely.linestrings(vertices[_ends(successors)])
    folded = np.flatnonzero(~shapely.touches(edges, edges[successors]))
    return int(successors[folded[0]]) if len(folded) else None


def crossing(vertices: Floats, successors: Ints) -> tuple[int, int] | None:
    """Two edges that have a point in common though they do not follow each other; None if there are none.

    Args:
        vertices: (n, 2); edge i goes from vertex i to its successor.
        successors: (n,).

    Returns:
        The pair with the lowest numbers.

    >>> crossing(np.array([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 2.0]]), np.array([1, 2, 3, 0]))
    (0, 2)
    """
    edges = shapely.linestrings(vertices[_ends(successors)])
    i, j = shapely.STRtree(edges).query(edges, predicate="intersects")
    apart = (i < j) & (successors[i] != j) & (successors[j] != i)
    first, second = min(np.stack([i[apart], j[apart]], axis=1).tolist(), default=(-1, -1))
    return None if first < 0 else (first, second)


def _ends(successors: Ints) -> Ints:
    return np.stack([np.arange(len(successors)), successors], axis=1)
