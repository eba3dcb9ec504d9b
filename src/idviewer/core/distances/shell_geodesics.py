"""Geodesics of a mesh with voids: along each shell, and from shell to shell over the bridges."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from idviewer.core.arrays import Floats, Ints
from idviewer.core.shapes.mesh_bridges import Bridge

Solve = Callable[[int], Floats]
"""From a vertex to the distances of all, in the unit of the vertices."""

ON_EDGE = 1e-9
"""Barycentric coordinate up to which a point of a face lies on the side opposite to the corner."""


def shell_solver(
    vertices: Floats,
    faces: Ints,
    shells: tuple[Ints, ...],
    bridges: tuple[Bridge, ...],
    prepare: Callable[[Floats, Ints], Solve],
) -> Solve:
    """Prepare geodesics that go along shells and cross the solid on bridges, straight from end to end.

    A bridge's end is reached over the corners of its face. The shells and bridges are a tree, so distances
    within a shell are those of the shell alone.

    Args:
        vertices: (n, 3) in any unit.
        faces: (m, 3).
        shells: faces of each shell.
        bridges: that join them, in the mesh's unit; lengths are measured anew between the vertices given.
        prepare: makes the solver of one shell of its vertices and faces.
    """
    numbers = [np.unique(faces[shell]) for shell in shells]
    shell_of = np.empty(len(vertices), np.int64)
    place = np.empty(len(vertices), np.int64)
    solvers: list[Solve] = []
    for index, (shell, own) in enumerate(zip(shells, numbers, strict=True)):
        shell_of[own], place[own] = index, np.arange(len(own))
        solvers.append(prepare(vertices[own], place[faces[shell]]))

    def along(vertex: int) -> Floats:
        """Distances (n,) from a vertex within its shell; infinite elsewhere."""
        found = np.full(len(vertices), np.inf)
        index = int(shell_of[vertex])
        found[numbers[index]] = np.asarray(solvers[index](int(place[vertex])))
        return found

    ends = [_End(vertices, faces, bridge, side, along) for bridge in bridges for side in (0, 1)]
    between = _between_ends(ends)

    def solve(vertex: int) -> Floats:
        own = along(vertex)
        reached = np.array([end.distance(own) for end in ends])
        home = [place for place, end in enumerate(ends) if end.shell == shell_of[vertex]]
        there = (reached[home][:, None] + between[home]).min(axis=0)
        found = own
        for end, arrived in zip(ends, there.tolist(), strict=True):
            if end.shell != shell_of[vertex]:
                found = np.minimum(found, arrived + end.field)
        return np.asarray(found)

    return solve


class _End:
    """An end of a bridge: the corners of its face, how far they are, and the distances along its shell."""

    def __init__(
        self, vertices: Floats, faces: Ints, bridge: Bridge, side: int, along: Callable[[int], Floats]
    ) -> None:
        self.shell = bridge.shells[side]
        corners, shares = faces[bridge.faces[side]], bridge.shares[side]
        self.point = shares @ vertices[corners]
        # An end on an edge or in a vertex is reached over these alone: methods that are off by some percent
        # would find a way around that is shorter.
        self._corners = corners[shares > ON_EDGE]
        self._steps = np.linalg.norm(vertices[self._corners] - self.point, axis=1)
        fields = [step + along(int(corner)) for step, corner in zip(self._steps, self._corners, strict=True)]
        self.field = np.minimum.reduce(fields)

    def distance(self, field: Floats) -> float:
        """Distance of the end from wherever a field (n,) measures distances from."""
        return float((field[self._corners] + self._steps).min())


def _between_ends(ends: list[_End]) -> Floats:
    """Shortest ways (e, e) between all ends of bridges; the two ends of a bridge follow each other."""
    count = len(ends)
    ways = np.full((count, count), np.inf)
    for i, one in enumerate(ends):
        for j, other in enumerate(ends):
            if i // 2 == j // 2:
                ways[i, j] = np.linalg.norm(one.point - other.point)
            elif one.shell == other.shell:
                ways[i, j] = other.distance(one.field)
    # An entry of 0 would be no way at all: bridges between shells that touch are the shortest there are.
    there = np.where(np.isfinite(ways), np.maximum(ways, np.finfo(float).tiny), 0.0)
    return np.asarray(dijkstra(csr_array(there), directed=False))
