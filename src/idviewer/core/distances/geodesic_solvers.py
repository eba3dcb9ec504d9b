"""Lengths of shortest paths along a boundary, from one vertex to all."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import cast

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.distances.parameters import Extra
from idviewer.core.distances.shell_geodesics import Solve, shell_solver
from idviewer.core.errors import DistanceError
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.polygon import Polygon
from idviewer.core.shapes.shape import Shape

EXACT_GEODESICS = Extra("exact-geodesics", "pygeodesic")


class Geodesics:
    """Shortest paths along the boundary of one shape.

    On meshes "heat" is the heat method of Crane, Weischedel and Wardetzky 2013 on the intrinsic Delaunay
    triangulation (potpourri3d): a few percent off, the time of two sparse solves. "exact" is that of
    Mitchell, Mount and Papadimitriou 1987 (pygeodesic, which the extra `exact-geodesics` installs). Along a
    polygon's edges both are exact arc lengths.

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
        solvers = {"heat": heat_solver, "exact": exact_solver}
        if method not in solvers:
            raise DistanceError(
                f"there is no method {method!r} for geodesics; there are: {', '.join(solvers)}"
            )
        self._scale, self._method = shape.diagonal, method
        vertices = (shape.vertices - shape.bounds.mean(axis=0)) / shape.diagonal
        if shape.dimension == 2:
            self._solve = edge_path_solver(vertices, cast(Polygon, shape))
        else:
            self._solve = surface_solver(vertices, cast(Mesh, shape), solvers[method])

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


def surface_solver(vertices: Floats, mesh: Mesh, prepare: Callable[[Floats, Ints], Solve]) -> Solve:
    """Prepare geodesics of a mesh; those between its shells go over the bridges that join them.

    Args:
        vertices: (n, 3) the mesh's, in any unit.
        mesh: whose faces and bridges they are.
        prepare: makes a solver of the vertices and faces of a connected surface.
    """
    if len(mesh.shells) == 1:
        return prepare(vertices, mesh.faces)
    return shell_solver(vertices, mesh.faces, mesh.shells, mesh.bridges, prepare)


def heat_solver(vertices: Floats, faces: Ints) -> Solve:
    """Prepare the heat method: two sparse factorizations, after which each vertex takes two solves.

    Source: Crane, Weischedel and Wardetzky 2013, "Geodesics in heat".

    Args:
        vertices: (n, 3).
        faces: (m, 3).
    """
    from potpourri3d import MeshHeatMethodDistanceSolver

    solver = MeshHeatMethodDistanceSolver(vertices, np.array(faces))
    return lambda vertex: solver.compute_distance(vertex)


def exact_solver(vertices: Floats, faces: Ints) -> Solve:
    """Prepare exact geodesics by windows propagated over the surface.

    Source: Mitchell, Mount and Papadimitriou 1987, "The discrete geodesic problem".

    Args:
        vertices: (n, 3).
        faces: (m, 3).

    Raises:
        DistanceError: the extra is not installed.
    """
    try:
        from pygeodesic.geodesic import PyGeodesicAlgorithmExact
    except ImportError as error:
        raise DistanceError(
            f"the method exact for geodesics {EXACT_GEODESICS.remedy}; or take the method heat"
        ) from error
    solver = PyGeodesicAlgorithmExact(vertices, np.array(faces))
    return lambda vertex: solver.geodesicDistances(np.array([vertex]), None)[0]


def edge_path_solver(vertices: Floats, polygon: Polygon) -> Solve:
    """Dijkstra's shortest paths along a polygon's edges and the bridges that join its loops.

    Args:
        vertices: (n, 2) the polygon's, in any unit.
        polygon: whose edges and bridges they are.

    >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> edge_path_solver(square.vertices, square)(0).tolist()
    [0.0, 1.0, 2.0, 1.0]
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra

    ends = np.concatenate([polygon.edges, polygon.bridges])
    lengths = np.linalg.norm(vertices[ends[:, 0]] - vertices[ends[:, 1]], axis=1)
    graph = csr_array((lengths, (ends[:, 0], ends[:, 1])), shape=(len(vertices), len(vertices)))
    return lambda vertex: dijkstra(graph, directed=False, indices=vertex)


def landmark_steps(
    shape: Shape, geodesics: Geodesics, count: int
) -> Generator[float, None, tuple[Ints, Floats]]:
    """Choose landmarks by farthest-point sampling, with the distances to them; yields the share done.

    The first is the vertex farthest, in a straight line, from the mean of all; each next one is the vertex
    farthest from those before. Source: Gonzalez 1985; de Silva and Tenenbaum 2004, section 3 (maxmin).

    Args:
        shape: n vertices.
        geodesics: of the shape.
        count: of landmarks.

    Returns:
        (l,) their indices, and (n, l) the distance of each vertex from each; l is count, at most n.

    Raises:
        DistanceError: geodesics fail on this shape.

    >>> from idviewer.core import Polygon
    >>> from idviewer.core.steps import finish
    >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> chosen, distances = finish(landmark_steps(square, Geodesics(square), 2))
    >>> chosen.tolist(), distances.round(12).tolist()
    ([0, 2], [[0.0, 2.0], [1.0, 1.0], [2.0, 0.0], [1.0, 1.0]])
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
