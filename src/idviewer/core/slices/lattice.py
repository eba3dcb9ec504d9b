"""The cells of a square lattice that lie inside an outline and clear of it, stored run by run.

Work and memory grow with the cells and with the outline, not with the box around them, which may be mostly
empty where a plane cuts the tips of several limbs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints, counted
from idviewer.core.slices.mesh_sections import Section, cycles_of

Ints32 = NDArray[np.int32]

OUTLINE_MARGIN = 0.25
"""Cells nearer to the outline than this share of their side are left out."""


@dataclass(frozen=True, eq=False)
class Lattice:
    """Nodes and cells; a cell has the number of the node at its low corner.

    Attributes:
        nodes: (q, 2) lattice coordinates of the cells' corners, in ascending order.
        cells: (c,) ascending; the corner after a cell's low one is the next node.
        opposite: (c,) the corner on the other side from the low one, at the next higher first coordinate.
    """

    nodes: Ints
    cells: Ints
    opposite: Ints

    @classmethod
    def inside(cls, section: Section, spacing: float) -> Lattice:
        """The cells of a lattice that are inside a section and a margin away from its outline.

        Args:
            section: with loops.
            spacing: lattice constant, in the mesh's unit; positive.

        >>> from idviewer.core.shapes.polygon import Polygon
        >>> from idviewer.core.slices.polygon_sections import polygon_section
        >>> square = polygon_section(Polygon([[0.5, 0.5], [4.5, 0.5], [4.5, 4.5], [0.5, 4.5]]))
        >>> lattice = Lattice.inside(square, 1.0)
        >>> len(lattice.cells), len(lattice.nodes), lattice.triangles().shape
        (9, 16, (18, 3))
        """
        scaled = section.in_plane / spacing
        lowest = np.floor(scaled.min(axis=0)).astype(np.int64) - 1
        stride = int(np.ceil(scaled[:, 1].max())) + 2 - int(lowest[1])
        scaled -= lowest
        starts, ends = (scaled[points] for points in section.segments)
        keys = _without(_between(starts, ends, stride), _near(starts, ends, stride))
        # A run of cells has two runs of corners, and these overlap with those of the neighbouring runs.
        breaks = np.flatnonzero(np.diff(keys, prepend=-2) != 1)
        first, length = keys[breaks], np.diff(breaks, append=len(keys))
        corners = _union(np.concatenate([first, first + stride]), np.tile(length + 1, 2))
        run, step = counted(length)
        cells = np.searchsorted(corners, first)[run] + step
        opposite = np.searchsorted(corners, first + stride)[run] + step
        return cls(np.stack(np.divmod(corners, stride), axis=1) + lowest, cells, opposite)

    @property
    def _corners(self) -> tuple[Ints, Ints, Ints, Ints]:
        """The corners of each cell, counterclockwise."""
        return self.cells, self.opposite, self.opposite + 1, self.cells + 1

    def triangles(self) -> Ints32:
        """Triangles (2 c, 3), two a cell, the diagonals alternating so that no direction is favoured."""
        a, b, c, d = self._corners
        odd = ((self.nodes[:, 0] + self.nodes[:, 1]) & 1).astype(np.bool_)[self.cells]
        halves = np.empty((len(a), 6), dtype=np.int32)
        for place, corner in enumerate((a, b, np.where(odd, d, c), np.where(odd, b, a), c, d)):
            halves[:, place] = corner
        return halves.reshape(-1, 3)

    def staircases(self) -> list[Ints]:
        """Boundary loops of the cells, nodes each, cells on the left; simple, though corners may touch."""
        beside = self._neighbours()
        # Sides counterclockwise, each from the corner of its number on.
        side, at = np.nonzero(beside[:, self.cells] < 0)
        cell = self.cells[at]
        # At the end of a side the loop turns left round its own cell, or goes straight on along the next
        # one, or turns right where there is one across.
        left = (side + 1) % 4
        ahead = beside[left, cell]
        across = np.where(ahead < 0, -1, beside[side, ahead])
        next_cell = np.where(ahead < 0, cell, np.where(across < 0, ahead, across))
        next_side = np.where(ahead < 0, left, np.where(across < 0, side, (side + 3) % 4))
        number = np.empty(beside.shape, dtype=np.int64)
        number[side, cell] = np.arange(len(cell))
        tails = np.stack(self._corners)[side, at]
        return [tails[cycle] for cycle in cycles_of(number[next_side, next_cell])]

    def _neighbours(self) -> Ints32:
        """Neighbours (4, q): for each cell the one across each side, or -1."""
        full = np.full(len(self.nodes) + 1, -1, dtype=np.int32)
        full[self.cells] = self.cells
        beside = np.full((4, len(self.nodes)), -1, dtype=np.int32)
        beside[0, self.cells] = full[self.cells - 1]
        beside[1, self.cells] = full[self.opposite]
        beside[2, self.cells] = full[self.cells + 1]
        beside[3, self.opposite] = self.cells
        return beside


def _between(starts: Floats, ends: Floats, stride: int) -> Ints:
    """Keys row * stride + column of the cells with their centre inside, ascending, by the even-odd rule."""
    low = np.minimum(starts[:, 0], ends[:, 0])
    high = np.maximum(starts[:, 0], ends[:, 0])
    # Row i has its centres at i + 1/2; a segment crosses those with low <= i + 1/2 < high.
    first = np.ceil(low - 0.5).astype(np.int64)
    segment, step = counted(np.ceil(high - 0.5).astype(np.int64) - first)
    row = step + first[segment]
    a, b = starts[segment], ends[segment]
    y = a[:, 1] + (row + 0.5 - a[:, 0]) / (b[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1])
    # Closed loops cross each row an even number of times: in, out, in, out.
    crossings = np.sort(row * stride + np.ceil(y - 0.5).astype(np.int64))
    return _runs(crossings[::2], crossings[1::2] - crossings[::2])


def _near(starts: Floats, ends: Floats, stride: int) -> Ints:
    """Keys of the cells within the margin of the outline, found by walking along it in quarter cells."""
    sides = ends - starts
    count = np.floor(np.abs(sides).max(axis=1) / OUTLINE_MARGIN).astype(np.int64) + 1
    segment, step = counted(count)
    walk = starts[segment] + (step / count[segment])[:, None] * sides[segment]
    low = np.floor(walk - OUTLINE_MARGIN).astype(np.int64)
    high = np.floor(walk + OUTLINE_MARGIN).astype(np.int64)
    rows, columns = ((low[:, axis], high[:, axis]) for axis in (0, 1))
    return np.concatenate([row * stride + column for row in rows for column in columns])


def _without(keys: Ints, unwanted: Ints) -> Ints:
    """Ascending keys without some."""
    unwanted = np.sort(unwanted)
    unwanted = unwanted[np.diff(unwanted, prepend=-1) > 0]
    place = np.searchsorted(keys, unwanted)
    kept = np.ones(len(keys) + 1, dtype=np.bool_)
    kept[place[np.append(keys, -1)[place] == unwanted]] = False
    return keys[kept[:-1]]


def _union(first: Ints, length: Ints) -> Ints:
    """The numbers in runs, ascending and each once."""
    order = np.argsort(first)
    first, end = first[order], np.maximum.accumulate((first + length)[order])
    opens = np.concatenate([[True], first[1:] > end[:-1]])[: len(first)]
    closes = np.concatenate([opens[1:], [True]])[: len(first)]
    return _runs(first[opens], end[closes] - first[opens])


def _runs(first: Ints, length: Ints) -> Ints:
    run, step = counted(length)
    return first[run] + step
