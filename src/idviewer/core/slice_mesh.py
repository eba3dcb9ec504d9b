"""Triangle meshes of a section: square cells inside, and a band that ends exactly at the outline."""

from __future__ import annotations

import math
from dataclasses import dataclass

import manifold3d
import numpy as np
from numpy.typing import NDArray

from idviewer.core.slices import Section

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

MARGIN = 0.25
"""Cells nearer to the outline than this share of their side are left to the band."""


@dataclass(frozen=True, eq=False)
class SliceMesh:
    """A section cut into triangles.

    The outline's points come first, then the nodes of a square lattice. Halving the spacing adds nodes
    and removes none, so samples of a coarse mesh serve the finer ones.

    Attributes:
        section: what was cut.
        spacing: distance between neighbouring nodes.
        nodes: (q, 2) integer lattice coordinates; a node lies at nodes * spacing in the plane's basis.
        triangles: (t, 3) indices, counterclockwise as seen against the plane's normal.
    """

    section: Section
    spacing: float
    nodes: Ints
    triangles: NDArray[np.int32]

    @property
    def points(self) -> Floats:
        """(s + q, 3) positions: the outline, then the nodes."""
        return self.section.lift(np.concatenate([self.section.flat, self.nodes * self.spacing]))

    @property
    def node_points(self) -> Floats:
        """(q, 3) positions of the nodes alone."""
        return self.section.lift(self.nodes * self.spacing)


def slice_mesh(section: Section, spacing: float) -> SliceMesh:
    """Triangulate a section with interior nodes on a lattice of the given spacing.

    Args:
        section: the outline to fill.
        spacing: lattice constant, in the mesh's unit.

    >>> from idviewer.core import Mesh, Plane, section
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> mesh = slice_mesh(section(tetrahedron, Plane((0, 0, 0.5), (0, 0, 1))), 0.05)
    >>> corners = mesh.points[mesh.triangles]
    >>> sides = corners[:, 1:] - corners[:, :1]
    >>> round(float(np.cross(sides[:, 0], sides[:, 1])[:, 2].sum()) / 2, 12)
    0.125
    """
    if not section.loops:
        return SliceMesh(section, spacing, np.empty((0, 2), dtype=np.int64), np.empty((0, 3), dtype=np.int32))
    grid = _Grid.around(section.flat, spacing)
    full = grid.full_cells(section)
    nodes, index = _corners_of(full)
    cell_triangles = _cell_triangles(full, index)
    stairs = [index[tuple(loop.T)] for loop in _staircases(full)]
    first_node = len(section.flat)
    flat = np.concatenate([section.flat, (nodes + grid.lowest) * spacing])
    band = _fill(flat, [*section.loops, *(stair[::-1] + first_node for stair in stairs)])
    triangles = np.concatenate([band, cell_triangles + first_node]).astype(np.int32)
    return SliceMesh(section, spacing, nodes + grid.lowest, triangles)


def spacing_for(section: Section, samples: int) -> float:
    """The lattice constant that puts about so many nodes into the section."""
    return math.sqrt(max(section.area, 0.0) / samples)


def refined(flat: Floats, triangles: NDArray[np.int32]) -> tuple[Ints, NDArray[np.int32]]:
    """Cut each triangle into four.

    Args:
        flat: (p, d) points, of which only the number matters.
        triangles: (t, 3).

    Returns:
        (e, 2) the two ends of each edge, whose middle becomes point p + e; and (4 t, 3) triangles.

    >>> ends, triangles = refined(np.zeros((3, 2)), np.array([[0, 1, 2]], dtype=np.int32))
    >>> ends.tolist(), len(triangles)
    ([[0, 1], [0, 2], [1, 2]], 4)
    """
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2).astype(np.int64)
    sides.sort(axis=1)
    count = len(flat)
    keys, middle = np.unique(sides[:, 0] * count + sides[:, 1], return_inverse=True)
    ab, bc, ca = (middle.reshape(-1, 3) + count).T
    a, b, c = triangles.T
    parts = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    smaller = np.concatenate([np.stack(part, axis=1) for part in parts]).astype(np.int32)
    return np.stack([keys // count, keys % count], axis=1), smaller


@dataclass(frozen=True)
class _Grid:
    """The part of the lattice that covers an outline; cell (i, j) has its low corner at node (i, j)."""

    lowest: Ints
    shape: tuple[int, int]
    spacing: float

    @classmethod
    def around(cls, flat: Floats, spacing: float) -> _Grid:
        lowest = np.floor(flat.min(axis=0) / spacing).astype(np.int64) - 1
        highest = np.ceil(flat.max(axis=0) / spacing).astype(np.int64) + 1
        width, height = (highest - lowest).tolist()
        return cls(lowest, (width, height), spacing)

    def full_cells(self, section: Section) -> Bools:
        """Cells inside the outline and clear of it."""
        scaled = section.flat / self.spacing - self.lowest
        starts = scaled[np.concatenate(section.loops)]
        ends = scaled[np.concatenate([np.roll(loop, -1) for loop in section.loops])]
        return self._inside(starts, ends) & ~self._near(starts, ends)

    def _inside(self, starts: Floats, ends: Floats) -> Bools:
        """Even-odd rule for the cells' centres: crossings to the left of each, row by row."""
        low = np.minimum(starts[:, 1], ends[:, 1])
        high = np.maximum(starts[:, 1], ends[:, 1])
        # Row j has its centres at j + 1/2; a segment crosses the rows with low <= j + 1/2 < high.
        first = np.ceil(low - 0.5).astype(np.int64)
        count = np.ceil(high - 0.5).astype(np.int64) - first
        segment = np.repeat(np.arange(len(starts)), count)
        row = np.arange(len(segment)) - np.repeat(np.cumsum(count) - count, count) + first[segment]
        a, b = starts[segment], ends[segment]
        x = a[:, 0] + (row + 0.5 - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
        crossings = np.zeros((self.shape[0] + 1, self.shape[1]), dtype=np.int64)
        np.add.at(crossings, (np.ceil(x - 0.5).astype(np.int64), row), 1)
        return np.cumsum(crossings[:-1], axis=0) % 2 == 1

    def _near(self, starts: Floats, ends: Floats) -> Bools:
        """Cells within the margin of the outline, found by walking along it in quarter cells."""
        length = np.abs(ends - starts).max(axis=1)
        count = np.floor(length / MARGIN).astype(np.int64) + 1
        segment = np.repeat(np.arange(len(starts)), count)
        step = np.arange(len(segment)) - np.repeat(np.cumsum(count) - count, count)
        along = (step / count[segment])[:, None]
        walk = starts[segment] + along * (ends - starts)[segment]
        near = np.zeros(self.shape, dtype=np.bool_)
        for dx in (-MARGIN, MARGIN):
            for dy in (-MARGIN, MARGIN):
                i, j = np.floor(walk + np.array([dx, dy])).astype(np.int64).T
                near[i, j] = True
        return near


def _corners_of(full: Bools) -> tuple[Ints, Ints]:
    """(q, 2) corners of the full cells, and an array that maps a corner (i, j) to its place in them."""
    used = np.zeros((full.shape[0] + 1, full.shape[1] + 1), dtype=np.bool_)
    for i in (0, 1):
        for j in (0, 1):
            used[i : i + full.shape[0], j : j + full.shape[1]] |= full
    index = np.full(used.shape, -1, dtype=np.int64)
    index[used] = np.arange(np.count_nonzero(used))
    return np.argwhere(used), index


def _cell_triangles(full: Bools, index: Ints) -> Ints:
    """Two triangles a cell, the diagonals alternating so that no direction is favoured."""
    i, j = np.nonzero(full)
    a, b, c, d = index[i, j], index[i + 1, j], index[i + 1, j + 1], index[i, j + 1]
    even = ((i + j) % 2 == 0)[:, None, None]
    rising = np.stack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)], axis=1)
    falling = np.stack([np.stack([a, b, d], axis=1), np.stack([b, c, d], axis=1)], axis=1)
    return np.where(even, rising, falling).reshape(-1, 3)


def _staircases(full: Bools) -> list[Ints]:
    """Boundary loops of the full cells, (k, 2) nodes each, the cells on the left."""
    framed = np.pad(full, 1)
    inner = framed[1:-1, 1:-1]
    # Side: outward neighbour, start and end corner, counterclockwise round the cell.
    sides = [
        (framed[1:-1, :-2], (0, 0), (1, 0)),
        (framed[2:, 1:-1], (1, 0), (1, 1)),
        (framed[1:-1, 2:], (1, 1), (0, 1)),
        (framed[:-2, 1:-1], (0, 1), (0, 0)),
    ]
    edges: dict[tuple[int, int], list[tuple[tuple[int, int], tuple[int, int]]]] = {}
    for neighbour, tail, head in sides:
        for i, j in np.argwhere(inner & ~neighbour).tolist():
            edges.setdefault((i + tail[0], j + tail[1]), []).append(((i + head[0], j + head[1]), (i, j)))
    loops = []
    while edges:
        start = next(iter(edges))
        at, cell, loop = start, (-1, -1), []
        while at in edges:
            loop.append(at)
            ways = edges[at]
            # Where two cells touch at a corner, staying with the same cell keeps the loops simple.
            way = next((way for way in ways if way[1] == cell), ways[0])
            ways.remove(way)
            if not ways:
                del edges[at]
            at, cell = way
        loops.append(np.array(loop, dtype=np.int64))
    return loops


def _fill(flat: Floats, loops: list[Ints]) -> Ints:
    """Triangulate the region bounded by loops (outer ones counterclockwise, holes clockwise)."""
    # About the region's middle and in its own unit, so that the library's tolerance means the same anywhere.
    middle = 0.5 * (flat.min(axis=0) + flat.max(axis=0))
    size = float(np.ptp(flat, axis=0).max())
    scaled = (flat - middle) / size
    triangles = manifold3d.triangulate([scaled[loop] for loop in loops])
    return np.concatenate(loops)[np.asarray(triangles, dtype=np.int64).reshape(-1, 3)]
