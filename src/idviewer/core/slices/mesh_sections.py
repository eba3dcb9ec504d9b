"""Sections of a body by a plane: exact outlines, and triangle meshes that sample their inside."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from idviewer.core.arrays import Floats, Ints
from idviewer.core.shapes.face_boxes import heights
from idviewer.core.shapes.plane import Plane
from idviewer.core.shapes.shape import MeshLike, as_mesh
from idviewer.core.slices.covered_outlines import covered_outline

FOLLOWING = np.array([1, 2, 0])
"""The corner that follows each corner of a face."""


@dataclass(frozen=True, eq=False)
class Section:
    """Outline of a plane's cut through a surface: closed loops of points on mesh edges.

    A value that is linear on each face is known exactly on the whole outline: at point i it is
    (1 - t_i) f(a_i) + t_i f(b_i).

    Where a surface overlaps itself, sides of the outline cross. Only what has the body on one side is left
    of them, and each crossing is a point of its own, which comes after those on mesh edges.

    Attributes:
        plane: the plane.
        edges: (e, 2) vertex indices a, b of the mesh edge that each of the first outline points lies on.
        fractions: (e,) t, where on that edge.
        in_plane: (s, 2) the points' in-plane coordinates: in the plane's basis, about its origin.
        loops: index arrays into the points, one closed loop each, the body on the left as seen
            against the normal (outer loops counterclockwise, holes clockwise).
        chords: (s - e, 2) two of the first points between which each of the others lies.
        chord_fractions: (s - e,) where between them.

    >>> from idviewer.core.shapes.polygon import Polygon
    >>> from idviewer.core.slices.polygon_sections import polygon_section
    >>> square = polygon_section(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]))
    >>> square.area, square.interpolate(square.points).shape, [len(loop) for loop in square.loops]
    (16.0, (4, 3), [4])
    """

    plane: Plane
    edges: Ints
    fractions: Floats
    in_plane: Floats
    loops: tuple[Ints, ...]
    chords: Ints = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    chord_fractions: Floats = field(default_factory=lambda: np.empty(0))

    @property
    def points(self) -> Floats:
        """Positions (s, 3) of the outline points."""
        return self.lift(self.in_plane)

    @property
    def area(self) -> float:
        """Area of the section, in the mesh's unit squared."""
        return float(sum(_signed_area(self.in_plane[loop]) for loop in self.loops))

    @property
    def segments(self) -> tuple[Ints, Ints]:
        """Points at which the sides of all loops start, (s,) indices, and those at which they end."""
        if not self.loops:
            return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
        closed = [(loop, loop[1:], loop[:1]) for loop in self.loops]
        return np.concatenate(self.loops), np.concatenate([part for loop in closed for part in loop[1:]])

    def lift(self, in_plane: ArrayLike) -> Floats:
        """Positions (p, 3) of points (p, 2) in the plane's basis."""
        return np.array(self.plane.origin) + np.asarray(in_plane, dtype=np.float64) @ self.plane.basis

    def interpolate(self, values: Floats) -> Floats:
        """Interpolate values (n, k) given at the mesh's vertices to the outline, (s, k); exact."""
        share, between = self.fractions[:, None], self.chord_fractions[:, None]
        on_edges = (1.0 - share) * values[self.edges[:, 0]] + share * values[self.edges[:, 1]]
        first, second = on_edges[self.chords[:, 0]], on_edges[self.chords[:, 1]]
        return np.concatenate([on_edges, (1.0 - between) * first + between * second])

    @property
    def stencil(self) -> tuple[Ints, Floats]:
        """Vertices (s, v) whose values make up that of each outline point, and their shares (s, v)."""
        shares = np.stack([1.0 - self.fractions, self.fractions], axis=1)
        if len(self.chords) == 0:
            return self.edges, shares
        between = np.stack([1.0 - self.chord_fractions, self.chord_fractions], axis=1)[:, :, None]
        ends = np.concatenate([self.edges, self.edges], axis=1), self.edges[self.chords].reshape(-1, 4)
        parts = (
            np.concatenate([shares, np.zeros_like(shares)], axis=1),
            (between * shares[self.chords]).reshape(-1, 4),
        )
        return np.concatenate(ends), np.concatenate(parts)


def section(mesh: MeshLike, plane: Plane) -> Section:
    """The section of a closed mesh by a plane.

    A vertex exactly on the plane counts as lying below it, so the outline always closes.

    Args:
        mesh: n vertices, or its `(vertices, faces)`.
        plane: where to cut.

    Returns:
        The outline; it has no loops where the plane misses the body.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> round(section(tetrahedron, Plane((0, 0, 0.5), (0, 0, 1))).area, 12)
    0.125
    """
    mesh = as_mesh(mesh)
    faces, above = mesh.patches.crossed(plane)
    tops, bottoms = _passage(above)
    rising_tails, rising_heads = _passage(~above)
    # Each face leads from the edge where its boundary falls to the one where it rises; the same edge,
    # run through backwards, is the next face's first.
    corners, n = faces.ravel(), len(mesh.vertices)
    keys = corners[bottoms] * n + corners[tops]
    order = np.argsort(keys)
    follower = np.searchsorted(keys[order], (corners[rising_tails] * n + corners[rising_heads])[order])
    edges = corners[np.stack([bottoms[order], tops[order]], axis=1)]
    fractions, in_plane = _where_crossed(mesh.vertices[edges], plane)
    loops = _loops(follower, in_plane)
    if not loops or not mesh.self_intersections:
        return Section(plane, edges, fractions, in_plane, loops)
    outline = covered_outline(in_plane, loops)
    kept = outline.points
    return Section(
        plane,
        edges[kept],
        fractions[kept],
        np.concatenate([in_plane[kept], outline.crossings]),
        outline.loops,
        outline.chords,
        outline.chord_fractions,
    )


def _where_crossed(ends: Floats, plane: Plane) -> tuple[Floats, Floats]:
    """Fractions and in-plane coordinates where edges with ends (s, 2, 3) below and above a plane cross it."""
    low, high = heights(np.moveaxis(ends, 2, 0), plane).T
    fractions = low / (low - high)
    share = fractions[:, None]
    starts, stops = np.moveaxis(ends - np.array(plane.origin), 1, 0)
    return fractions, ((1.0 - share) * starts + share * stops) @ plane.basis.T


def _passage(above: NDArray[np.bool_]) -> tuple[Ints, Ints]:
    """Edges where each face's boundary goes from above to below: places of their two ends among all corners.

    Args:
        above: (m, 3), of the faces' corners.
    """
    corner = np.argmax(above > above[:, FOLLOWING], axis=1)
    first = np.arange(0, above.size, 3)
    return first + corner, first + FOLLOWING[corner]


def _loops(follower: Ints, in_plane: Floats) -> tuple[Ints, ...]:
    """The closed loops, without points equal to the one before (cuts through a vertex make them)."""
    moves = np.empty(len(follower), dtype=np.bool_)
    moves[follower] = (in_plane[follower] != in_plane).any(axis=1)
    loops = cycles_of(follower)
    if not moves.all():
        loops = [loop[moves[loop]] for loop in loops]
    return tuple(loop for loop in loops if len(loop) >= 3)


def cycles_of(follower: Ints) -> list[Ints]:
    """The cycles of a permutation.

    >>> [cycle.tolist() for cycle in cycles_of(np.array([1, 0, 3, 4, 2]))]
    [[0, 1], [2, 3, 4]]
    """
    successor = follower.tolist()
    cycles = []
    for first in range(len(successor)):
        at, cycle = first, []
        while (following := successor[at]) >= 0:
            cycle.append(at)
            successor[at] = -1
            at = following
        if cycle:
            cycles.append(np.array(cycle, dtype=np.int64))
    return cycles


def _signed_area(polygon: Floats) -> float:
    x, y = (polygon - polygon[0]).T
    # The sides from and to the first point, now the origin, add nothing.
    return 0.5 * float(x[:-1] @ y[1:] - y[:-1] @ x[1:])
