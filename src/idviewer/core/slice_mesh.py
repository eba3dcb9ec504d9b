"""Triangle meshes of a section: square cells inside, and a band that ends exactly at the outline."""

from __future__ import annotations

import math
from dataclasses import dataclass

import manifold3d
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.ears import cut_ears
from idviewer.core.slices import Section, cycles_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Ints32 = NDArray[np.int32]
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
    grid = _Grid.around(section, spacing)
    cells = grid.full_cells()
    places, index = grid.corners_of(cells)
    nodes = np.stack(np.divmod(places, grid.shape[1]), axis=1) + grid.lowest
    stairs = [index[stair[::-1]] for stair in grid.staircases(cells)]
    band = _fill(section, stairs, np.multiply(nodes, spacing, dtype=np.float64))
    triangles = np.concatenate([band, grid.triangles(cells, index) + np.int32(len(section.flat))])
    return SliceMesh(section, spacing, nodes, triangles)


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
    """The part of the lattice that covers an outline, and a rim of cells outside it.

    Cells and nodes are numbered row by row; a cell has the number of its low corner.

    Attributes:
        lowest: (2,) lattice coordinates of the first node.
        shape: rows and columns.
        starts: (k, 2) where the outline's segments start, in cells from the first node.
        ends: (k, 2) where they end.
    """

    lowest: Ints
    shape: tuple[int, int]
    starts: Floats
    ends: Floats

    @classmethod
    def around(cls, section: Section, spacing: float) -> _Grid:
        scaled = section.flat / spacing
        lowest = np.floor(scaled.min(axis=0)).astype(np.int64) - 1
        highest = np.ceil(scaled.max(axis=0)).astype(np.int64) + 1
        rows, columns = (highest - lowest).tolist()
        scaled -= lowest
        starts, ends = section.segments
        return cls(lowest, (rows, columns), scaled[starts], scaled[ends])

    def full_cells(self) -> Ints:
        """Cells inside the outline and clear of it, in ascending order."""
        inside = self._inside()
        inside[self._near()] = False
        return np.flatnonzero(inside)

    def _inside(self) -> Bools:
        """Even-odd rule for the cells' centres: crossings to the left of each, row by row."""
        low = np.minimum(self.starts[:, 1], self.ends[:, 1])
        high = np.maximum(self.starts[:, 1], self.ends[:, 1])
        # Column j has its centres at j + 1/2; a segment crosses those with low <= j + 1/2 < high.
        first = np.ceil(low - 0.5).astype(np.int64)
        segment, step = _counted(np.ceil(high - 0.5).astype(np.int64) - first)
        column = step + first[segment]
        a, b = self.starts[segment], self.ends[segment]
        x = a[:, 0] + (column + 0.5 - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
        row = np.ceil(x - 0.5).astype(np.int64)
        rows, columns = self.shape
        crossings = np.bincount(row * columns + column, minlength=rows * columns)
        return (np.cumsum(crossings.reshape(rows, columns), axis=0) % 2 == 1).ravel()

    def _near(self) -> Ints:
        """Cells within the margin of the outline, found by walking along it in quarter cells."""
        sides = self.ends - self.starts
        count = np.floor(np.abs(sides).max(axis=1) / MARGIN).astype(np.int64) + 1
        segment, step = _counted(count)
        walk = self.starts[segment] + (step / count[segment])[:, None] * sides[segment]
        low = np.floor(walk - MARGIN).astype(np.int64)
        high = np.floor(walk + MARGIN).astype(np.int64)
        return np.concatenate(
            [(i[:, :1] * self.shape[1] + j[:, 1:]).ravel() for i in (low, high) for j in (low, high)]
        )

    def corners_of(self, cells: Ints) -> tuple[Ints, Ints32]:
        """The corners of cells in ascending order, and an array that tells each one's place among them."""
        used = np.zeros(self.shape[0] * self.shape[1], dtype=np.bool_)
        for corner in self._corner_offsets:
            used[cells + corner] = True
        corners = np.flatnonzero(used)
        index = np.empty(len(used), dtype=np.int32)
        index[corners] = np.arange(len(corners), dtype=np.int32)
        return corners, index

    @property
    def _corner_offsets(self) -> Ints:
        """(4,) the corners of cell 0, counterclockwise."""
        return np.array([0, self.shape[1], self.shape[1] + 1, 1])

    def triangles(self, cells: Ints, index: Ints32) -> Ints32:
        """Two triangles a cell, the diagonals alternating so that no direction is favoured."""
        halves = self._corner_offsets[[[0, 1, 2, 0, 2, 3], [0, 1, 3, 1, 2, 3]]]
        odd = (cells // self.shape[1] + cells) % 2
        return index[cells[:, None] + halves[odd]].reshape(-1, 3)

    def staircases(self, cells: Ints) -> list[Ints]:
        """Boundary loops of cells, nodes each, the cells on the left; simple, though corners may touch."""
        full = np.zeros(self.shape[0] * self.shape[1], dtype=np.bool_)
        full[cells] = True
        # Sides of a cell counterclockwise; each starts at the corner of its number.
        outward = np.array([-1, self.shape[1], 1, -self.shape[1]])
        side, at = np.nonzero(~full[cells + outward[:, None]])
        cell = cells[at]
        # At the end of a side the loop turns left round its own cell, or goes straight on along the next
        # one, or turns right where there is one across.
        left = (side + 1) % 4
        ahead = cell + outward[left]
        across = ahead + outward[side]
        turns, meets = ~full[ahead], full[across]
        next_cell = np.where(turns, cell, np.where(meets, across, ahead))
        next_side = np.where(turns, left, np.where(meets, (side + 3) % 4, side))
        keys = side * len(full) + cell
        follower = np.searchsorted(keys, next_side * len(full) + next_cell)
        tails = cell + self._corner_offsets[side]
        return [tails[cycle] for cycle in cycles_of(follower)]


def _counted(counts: Ints) -> tuple[Ints, Ints]:
    """For each item so many entries: the item, and the number of the entry among the item's."""
    item = np.repeat(np.arange(len(counts)), counts)
    return item, np.arange(len(item)) - (np.cumsum(counts) - counts)[item]


def _fill(section: Section, stairs: list[Ints32], nodes: Floats) -> Ints32:
    """Triangulate the band between the outline and staircases (clockwise) of (q, 2) nodes."""
    loops = [*section.loops, *(stair.astype(np.int64) + len(section.flat) for stair in stairs)]
    flat = np.concatenate([section.flat, nodes])
    band, first = np.concatenate(loops), np.cumsum([0, *map(len, loops)])
    # About the region's middle and in its own unit, so that rounding and tolerances mean the same anywhere.
    lowest, highest = section.flat.min(axis=0), section.flat.max(axis=0)
    scaled = (flat[band] - 0.5 * (lowest + highest)) / float((highest - lowest).max())
    triangles = cut_ears(scaled, first)
    if triangles is None:
        # Loops that cross themselves: this one copes with anything, and takes three times as long.
        triangles = np.asarray(manifold3d.triangulate(np.split(scaled, first[1:-1]))).reshape(-1, 3)
    return band.astype(np.int32)[triangles]
