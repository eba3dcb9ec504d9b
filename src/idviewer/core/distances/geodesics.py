"""Lengths of shortest paths along a boundary, from one vertex to all."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.errors import DistanceError
from idviewer.core.shapes.shape import Shape

PACKAGES = {"heat": "potpourri3d", "exact": "pygeodesic"}
METHODS = tuple(PACKAGES)


class Geodesics:
    """Shortest paths along the boundary of one shape.

    On meshes "heat" is the heat method of Crane, Weischedel and Wardetzky 2013 on the intrinsic Delaunay
    triangulation (potpourri3d): a few percent off, the time of two sparse solves. "exact" is that of
    Mitchell, Mount and Papadimitriou 1987 (pygeodesic). Along a polygon's edges both are exact arc lengths.

    Args:
        shape: n vertices.
        method: "heat" or "exact".

    Raises:
        DistanceError: there is no such method, or its package is not installed.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> Geodesics(tetrahedron, "exact").from_vertex(0).round(12).tolist()
    [0.0, 1.0, 1.0, 1.0]
    """

    def __init__(self, shape: Shape, method: str = "heat") -> None:
        if method not in METHODS:
            raise DistanceError(
                f"there is no method {method!r} for geodesics; there are: {', '.join(METHODS)}"
            )
        self._scale, self._method = shape.diagonal, method
        vertices = (shape.vertices - shape.bounds.mean(axis=0)) / shape.diagonal
        make = along_edges if shape.dimension == 2 else {"heat": by_heat, "exact": exactly}[method]
        self._solve = make(vertices, shape)

    def from_vertex(self, vertex: int) -> Floats:
        """Distances of all vertices from one, (n,), in the shape's unit.

        Raises:
            DistanceError: the method fails on this shape.
        """
        found = np.asarray(self._solve(vertex), dtype=np.float64)
        if not (np.isfinite(found).all() and found.min() >= -1e-6):
            other = "exact" if self._method == "heat" else "heat"
            raise DistanceError(
                f"the {self._method} geodesics from vertex {vertex} are not finite, perhaps because of "
                f"triangles without area; take the method {other}"
            )
        found = np.maximum(found, 0.0) * self._scale
        found[vertex] = 0.0
        return found


def by_heat(vertices: Floats, shape: Any) -> Callable[[int], Floats]:
    """The heat method."""
    solver = _package("heat").MeshHeatMethodDistanceSolver(vertices, np.array(shape.faces))
    return lambda vertex: solver.compute_distance(vertex)


def exactly(vertices: Floats, shape: Any) -> Callable[[int], Floats]:
    """Windows propagated over the surface."""
    solver = _package("exact", ".geodesic").PyGeodesicAlgorithmExact(vertices, np.array(shape.faces))
    return lambda vertex: solver.geodesicDistances(np.array([vertex]), None)[0]


def along_edges(vertices: Floats, shape: Any) -> Callable[[int], Floats]:
    """Along a polygon's edges, and the bridges that join its loops."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra

    bridges = np.asarray(getattr(shape, "bridges", np.empty((0, 2))), dtype=np.int64).reshape(-1, 2)
    ends = np.concatenate([shape.edges, bridges])
    lengths = np.linalg.norm(vertices[ends[:, 0]] - vertices[ends[:, 1]], axis=1)
    graph = csr_array((lengths, (ends[:, 0], ends[:, 1])), shape=(len(vertices), len(vertices)))
    return lambda vertex: dijkstra(graph, directed=False, indices=vertex)


def _package(method: str, module: str = "") -> Any:
    from importlib import import_module

    try:
        return import_module(PACKAGES[method] + module)
    except ImportError as error:
        name = PACKAGES[method]
        raise DistanceError(
            f"{method} geodesics need the package {name}: pip install {name} ({error})"
        ) from error


def landmark_steps(
    shape: Shape, geodesics: Geodesics, count: int
) -> Generator[float, None, tuple[Ints, Floats]]:
    """Landmarks by farthest-point sampling, and the distances to them; yields the share done.

    The first is the vertex farthest, in a straight line, from the mean of all; each next one is the vertex
    farthest from those before. Source: Gonzalez 1985; de Silva and Tenenbaum 2004, section 3 (maxmin).

    Returns:
        (l,) their indices, and (n, l) the distance of each vertex from each; l is count, at most n.
    """
    centred = shape.vertices - shape.vertices.mean(axis=0)
    count = min(count, len(centred))
    chosen = np.empty(count, dtype=np.int64)
    distances = np.empty((len(centred), count), order="F")
    nearest = np.full(len(centred), np.inf)
    following = int(np.argmax(np.einsum("nd,nd->n", centred, centred)))
    for index in range(count):
        chosen[index] = following
        distances[:, index] = geodesics.from_vertex(following)
        np.minimum(nearest, distances[:, index], out=nearest)
        nearest[following] = -1.0
        following = int(np.argmax(nearest))
        yield (index + 1) / count
    return chosen, distances
