"""Triangle meshes of a section: square cells inside, and a band that ends exactly at the outline."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import manifold3d
import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints
from idviewer.core.slices.lattice import Lattice
from idviewer.core.slices.mesh_sections import Section

Ints32 = NDArray[np.int32]

OUTLINE_STEPS_PER_SAMPLE = 16
"""The outline is at most so many lattice constants long for each sample asked for."""

LARGEST_LATTICE_SIDE = 2**24
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

    >>> from idviewer.core.shapes.polygon import Polygon
    >>> from idviewer.core.slices.polygon_sections import polygon_section
    >>> mesh = slice_mesh(polygon_section(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]])), 1.0)
    >>> len(mesh.points), len(mesh.node_points), len(mesh.triangles)
    (13, 9, 20)
    """

    section: Section
    spacing: float
    nodes: Ints
    triangles: NDArray[np.int32]

    @cached_property
    def in_plane(self) -> Floats:
        """The points in the plane's basis, (s + q, 2)."""
        return np.concatenate([self.section.in_plane, self.nodes * self.spacing])

    @property
    def points(self) -> Floats:
        """Positions (s + q, 3): the outline, then the nodes."""
        return self.section.lift(self.in_plane)

    @property
    def node_points(self) -> Floats:
        """Positions (q, 3) of the nodes alone."""
        return self.section.lift(self.nodes * self.spacing)


def slice_mesh(section: Section, spacing: float) -> SliceMesh:
    """Triangulate a section with interior nodes on a lattice of the given spacing.

    Args:
        section: the outline to fill.
        spacing: lattice constant, in the mesh's unit; positive.

    Returns:
        The triangles; none where the section has no loops.

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
    band = _triangulate_band(section, stairs, np.multiply(lattice.nodes, spacing, dtype=np.float64))
    triangles = np.concatenate([band, lattice.triangles() + np.int32(len(section.in_plane))])
    return SliceMesh(section, spacing, lattice.nodes, triangles)


def spacing_for(section: Section, samples: int) -> float:
    """The lattice constant that puts about so many nodes into the section; fewer into slivers and specks.

    Args:
        section: the outline to fill.
        samples: about how many nodes.

    Returns:
        In the mesh's unit; 0 where the section has no loops.

    >>> from idviewer.core.shapes.polygon import Polygon
    >>> from idviewer.core.slices.polygon_sections import polygon_section
    >>> spacing_for(polygon_section(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]])), 16)
    1.0
    """
    if not section.loops:
        return 0.0
    starts, ends = section.segments
    length = float(np.abs(section.in_plane[ends] - section.in_plane[starts]).sum())
    extent = float((section.in_plane.max(axis=0) - section.in_plane.min(axis=0)).max())
    return max(
        math.sqrt(max(section.area, 0.0) / samples),
        length / (OUTLINE_STEPS_PER_SAMPLE * samples),
        extent / LARGEST_LATTICE_SIDE,
    )


def edges_of(count: int, triangles: Ints32) -> tuple[Ints, Ints]:
    """The edges of triangles.

    Args:
        count: of points.
        triangles: (t, 3) indices of points.

    Returns:
        (e, 2) the two ends of each edge, the smaller first, in ascending order; and (t, 3) the edges of each
        triangle, the one from its first corner to its second first.

    >>> ends, sides = edges_of(4, np.array([[0, 1, 2], [2, 1, 3]], dtype=np.int32))
    >>> ends.tolist(), sides.tolist()
    ([[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]], [[0, 2, 1], [2, 3, 4]])
    """
    corners = np.ascontiguousarray(triangles.T, dtype=np.int64)
    tails, heads = corners.ravel(), corners[[1, 2, 0]].ravel()
    bits = len(tails).bit_length()
    # Sorted together with their places: one plain sort, several times faster than sorting the places.
    keys = np.minimum(tails, heads) * count + np.maximum(tails, heads)
    keys = np.sort(keys << bits | np.arange(len(keys)))
    places, keys = keys & ((1 << bits) - 1), keys >> bits
    first = np.diff(keys, prepend=-1) != 0
    sides = np.empty(len(tails), dtype=np.int64)
    sides[places] = np.cumsum(first) - 1
    return np.stack(np.divmod(keys[first], max(count, 1)), axis=1), sides.reshape(3, -1).T


def split(triangles: Ints32, middles: Ints) -> Ints32:
    """Cut triangles at middles of some of their edges.

    Args:
        triangles: (t, 3).
        middles: (t, 3) the point in the middle of the edge from each corner to the next, or -1 where that
            edge stays whole.

    Returns:
        (s, 3) triangles, wound as those they are parts of.

    >>> split(np.array([[0, 1, 2]], dtype=np.int32), np.array([[-1, 3, -1]])).tolist()
    [[1, 3, 0], [3, 2, 0]]
    """
    marked = middles >= 0
    if marked.all():
        points = np.concatenate([triangles, middles.astype(np.int32)], axis=1)
        return points[:, _PATTERNS[3]].reshape(-1, 3)
    number = marked.sum(axis=1)
    # Turned so that the whole edges come last.
    first = np.where(number == 2, np.argmin(marked, axis=1) + 1, np.argmax(marked, axis=1))
    turned = (first[:, None] + np.arange(3)) % 3
    corners = np.take_along_axis(triangles, turned, axis=1)
    cuts = np.take_along_axis(middles, turned, axis=1).astype(np.int32)
    parts = [triangles[number == 0]]
    for count, pattern in _PATTERNS.items():
        chosen = number == count
        points = np.concatenate([corners[chosen], cuts[chosen]], axis=1)
        parts.extend(points[:, three] for three in pattern)
    return np.concatenate(parts)


_PATTERNS = {
    1: [[0, 3, 2], [3, 1, 2]],
    2: [[3, 1, 4], [0, 3, 4], [0, 4, 2]],
    3: [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
}
"""Parts of a triangle with corners 0, 1, 2 whose first so many edges are cut, in points 3, 4 and 5."""


def _triangulate_band(section: Section, stairs: list[Ints], nodes: Floats) -> Ints32:
    """Triangulate the band between the outline and staircases (clockwise) of (q, 2) nodes."""
    loops = [*section.loops, *(stair + len(section.in_plane) for stair in stairs)]
    flat = np.concatenate([section.in_plane, nodes])
    band, ends = np.concatenate(loops), np.cumsum([len(loop) for loop in loops])[:-1]
    # About the region's middle and in its own unit, so that rounding and tolerances mean the same anywhere.
    lowest, highest = section.in_plane.min(axis=0), section.in_plane.max(axis=0)
    scaled = (flat[band] - 0.5 * (lowest + highest)) / float((highest - lowest).max())
    return band.astype(np.int32)[triangulate_polygons(np.split(scaled, ends))]


def triangulate_polygons(loops: list[Floats]) -> Ints32:
    """Triangulate the region that polygons bound, without new points (manifold3d's ear clipping).

    Loops may touch, and points be repeated or collinear. Loops that cross themselves give triangles too,
    some of them clockwise; their sides cancel up to the loops all the same.

    Args:
        loops: (p_i, 2) points of each, the region on their left; of the size of 1 or so.

    Returns:
        (t, 3) indices into the concatenated loops, counterclockwise up to rounding.

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> triangles = triangulate_polygons([square, 0.5 * square[::-1] + 0.25])
    >>> len(triangles), int(triangles.max())
    (8, 7)
    """
    return np.asarray(manifold3d.triangulate(loops), dtype=np.int32).reshape(-1, 3)
