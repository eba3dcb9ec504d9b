"""Triangle meshes of a section: square cells inside, and a band that ends exactly at the outline."""

from __future__ import annotations

import math
from dataclasses import dataclass

import manifold3d
import numpy as np
from numpy.typing import NDArray

from idviewer.core._kernels.ears import cut_ears
from idviewer.core._lattice import Lattice
from idviewer.core.slices import Section

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Ints32 = NDArray[np.int32]

STEPS = 16
"""The outline is at most so many lattice constants long for each sample asked for."""

LARGEST_LATTICE = 2**24
"""Cells from one side of a section to the other, at most."""


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
    lattice = Lattice.inside(section, spacing)
    stairs = [stair[::-1] for stair in lattice.staircases()]
    band = _fill(section, stairs, np.multiply(lattice.nodes, spacing, dtype=np.float64))
    triangles = np.concatenate([band, lattice.triangles() + np.int32(len(section.flat))])
    return SliceMesh(section, spacing, lattice.nodes, triangles)


def spacing_for(section: Section, samples: int) -> float:
    """The lattice constant that puts about so many nodes into the section; fewer into slivers and specks."""
    if not section.loops:
        return 0.0
    starts, ends = section.segments
    length = float(np.abs(section.flat[ends] - section.flat[starts]).sum())
    extent = float((section.flat.max(axis=0) - section.flat.min(axis=0)).max())
    return max(
        math.sqrt(max(section.area, 0.0) / samples), length / (STEPS * samples), extent / LARGEST_LATTICE
    )


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
    corners = np.ascontiguousarray(triangles.T, dtype=np.int64)
    tails, heads = corners.ravel(), corners[[1, 2, 0]].ravel()
    count, bits = len(flat), len(tails).bit_length()
    # Sorted together with their places: one plain sort, several times faster than sorting the places.
    keys = np.minimum(tails, heads) * count + np.maximum(tails, heads)
    keys = np.sort(keys << bits | np.arange(len(keys)))
    places, keys = keys & ((1 << bits) - 1), keys >> bits
    first = np.diff(keys, prepend=-1) != 0
    middles = np.empty(len(tails), dtype=np.int64)
    middles[places] = np.cumsum(first) - 1 + count
    a, b, c = corners
    ab, bc, ca = middles.reshape(3, -1)
    smaller = np.empty((4, len(triangles), 3), dtype=np.int32)
    for part, three in zip(smaller, ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)), strict=True):
        for place, corner in enumerate(three):
            part[:, place] = corner
    return np.stack(np.divmod(keys[first], count), axis=1), smaller.reshape(-1, 3)


def _fill(section: Section, stairs: list[Ints], nodes: Floats) -> Ints32:
    """Triangulate the band between the outline and staircases (clockwise) of (q, 2) nodes."""
    loops = [*section.loops, *(stair + len(section.flat) for stair in stairs)]
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
