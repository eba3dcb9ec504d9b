"""Meshes with fewer vertices, by edge collapses that keep the surface closed and of its topology.

A half-edge is collapsed into its end, so every vertex left is one of the mesh. Short ones in flat places go
first, and triangles stay round: what matters for eigenfunctions is an even mesh, not one that looks sharp.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.geometry.collapses import HalfEdges, collapse_some, half_edges_of
from idviewer.core.arrays import Ints
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.steps import beside, finish

COST_GROWTH = 2.0
"""From pass to pass, the cost up to which edges are collapsed."""

LONGEST_EDGE = 4.0
"""Edges so many times as long as those of an even mesh are not collapsed: the shape itself resists."""

HALF_EDGES_PER_STEP = 20_000
"""Half-edges looked at between two checkpoints: some five milliseconds."""


@dataclass(frozen=True, eq=False)
class Simplified:
    """A mesh with fewer vertices, and where those of the full one went.

    Attributes:
        mesh: of c vertices, all of them vertices of the full mesh.
        parents: (n,) for each vertex of the full mesh, the one near it in the simplified mesh.
    """

    mesh: Mesh
    parents: Ints


def simplified(mesh: Mesh, vertices: int) -> Mesh:
    """Simplify a mesh to about so many vertices; it keeps more where edges can no longer be collapsed.

    Where no collapse is possible, or what is left encloses nothing, it is the mesh itself.

    Args:
        mesh: n vertices.
        vertices: about how many to keep.

    >>> from idviewer.core import read_mesh, sample_path
    >>> hand = simplified(read_mesh(sample_path("hand")), 1000)
    >>> len(hand.vertices), len(hand.faces)
    (1000, 1996)
    """
    return finish(simplification_steps(mesh, vertices)).mesh


def simplification_steps(mesh: Mesh, vertices: int) -> Generator[float | None, None, Simplified]:
    """`simplified` as a generator that yields the share done, or None, every few milliseconds.

    Args:
        mesh: n vertices.
        vertices: about how many to keep.

    Returns:
        The simplified mesh, and the parent in it of every vertex of the full one.
    """
    count = len(mesh.vertices)
    surface = yield from beside(lambda: _joined(mesh))
    yield 0.1
    # The square of an even mesh's edges.
    even = 2.0 * mesh.area / (math.sqrt(3.0) * mesh.diagonal**2 * max(vertices, 4))
    limit = even * max(vertices, 4) / count
    left = count
    while left > vertices and limit < LONGEST_EDGE**2 * even:
        for first in range(0, len(surface.tails), HALF_EDGES_PER_STEP):
            last = min(first + HALF_EDGES_PER_STEP, len(surface.tails))
            left -= collapse_some(surface, first, last, limit, left - vertices)
            yield 0.1 + 0.8 * (count - left) / max(count - vertices, 1)
        limit *= COST_GROWTH
    return _without_gaps(mesh, surface)


def _joined(mesh: Mesh) -> HalfEdges:
    """The surface in units of the diagonal; the mesh's area, which takes as long, is known afterwards."""
    _ = mesh.area
    return half_edges_of((mesh.vertices - mesh.bounds.mean(axis=0)) / mesh.diagonal, mesh.faces)


def _without_gaps(mesh: Mesh, surface: HalfEdges) -> Simplified:
    """The remaining surface, numbered anew."""
    everywhere = np.arange(len(mesh.vertices))
    kept = np.flatnonzero(surface.parents == everywhere)
    if len(kept) == len(everywhere):
        return Simplified(mesh, everywhere)
    numbers = np.full(len(everywhere), -1)
    numbers[kept] = np.arange(len(kept))
    tails = surface.tails[surface.tails >= 0]
    try:
        small = Mesh(mesh.vertices[kept], numbers[tails].reshape(-1, 3), name=mesh.name)
    except MeshError:
        return Simplified(mesh, everywhere)
    return Simplified(small, numbers[_last_parents(surface.parents)])


def _last_parents(parents: NDArray[np.int32]) -> Ints:
    """The vertex in which each chain of parents ends; each round halves the chains."""
    while True:
        further = parents[parents]
        if np.array_equal(further, parents):
            return parents.astype(np.int64)
        parents = further
