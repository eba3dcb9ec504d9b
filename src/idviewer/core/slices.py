"""Sections of a body by a plane: exact outlines, and triangle meshes that sample their inside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from idviewer.core.mesh import Mesh
from idviewer.core.plane import Plane

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Section:
    """Where a plane cuts the surface: closed loops of points on mesh edges.

    A value that is linear on each face is known exactly on the whole outline: at point i it is
    (1 - t_i) f(a_i) + t_i f(b_i).

    Attributes:
        plane: the plane.
        edges: (s, 2) vertex indices a, b of the mesh edge that each outline point lies on.
        fractions: (s,) t, where on that edge.
        flat: (s, 2) the points' coordinates in the plane's basis, about its origin.
        loops: index arrays into the points, one closed loop each, the body on the left as seen
            against the normal (outer loops counterclockwise, holes clockwise).
    """

    plane: Plane
    edges: Ints
    fractions: Floats
    flat: Floats
    loops: tuple[Ints, ...]

    @property
    def points(self) -> Floats:
        """(s, 3) positions of the outline points."""
        return self.lift(self.flat)

    @property
    def area(self) -> float:
        """Area of the section, in the mesh's unit squared."""
        return float(sum(_signed_area(self.flat[loop]) for loop in self.loops))

    def lift(self, flat: ArrayLike) -> Floats:
        """(p, 2) coordinates in the plane's basis to (p, 3) positions."""
        return np.array(self.plane.origin) + np.asarray(flat, dtype=np.float64) @ self.plane.basis

    def interpolate(self, values: Floats) -> Floats:
        """Values (n, k) given at the mesh's vertices, on the outline: (s, k), exact."""
        share = self.fractions[:, None]
        return (1.0 - share) * values[self.edges[:, 0]] + share * values[self.edges[:, 1]]


def section(mesh: Mesh, plane: Plane) -> Section:
    """The section of a closed mesh by a plane.

    A vertex exactly on the plane counts as lying below it, so the outline always closes.

    Args:
        mesh: n vertices.
        plane: where to cut.

    Returns:
        The outline; it has no loops where the plane misses the body.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> round(section(tetrahedron, Plane((0, 0, 0.5), (0, 0, 1))).area, 12)
    0.125
    """
    heights = plane.height(mesh.vertices)
    above = heights > 0.0
    faces = mesh.faces[above[mesh.faces].any(axis=1) & ~above[mesh.faces].all(axis=1)]
    rising = _crossed_edges(faces, above, rising=True)
    falling = _crossed_edges(faces, above, rising=False)
    # Each face leads from the edge where its boundary falls to the one where it rises; the same edge,
    # run through backwards, is the next face's first.
    n = len(mesh.vertices)
    keys, start = np.unique(falling[:, 1] * n + falling[:, 0], return_inverse=True)
    end = np.searchsorted(keys, rising[:, 0] * n + rising[:, 1])
    low, high = keys // n, keys % n
    fractions = heights[low] / (heights[low] - heights[high])
    follower = np.empty(len(keys), dtype=np.int64)
    follower[start.ravel()] = end
    relative = mesh.vertices - np.array(plane.origin)
    share = fractions[:, None]
    flat = ((1.0 - share) * relative[low] + share * relative[high]) @ plane.basis.T
    loops = tuple(loop for cycle in _cycles(follower) if len(loop := _without_repeats(cycle, flat)) >= 3)
    return Section(plane, np.stack([low, high], axis=1), fractions, flat, loops)


def _crossed_edges(faces: Ints, above: NDArray[np.bool_], rising: bool) -> Ints:
    """For each crossed face the directed edge that goes up (or down) through the plane."""
    tails, heads = faces, np.roll(faces, -1, axis=1)
    passes = (above[heads] & ~above[tails]) if rising else (above[tails] & ~above[heads])
    corner = np.argmax(passes, axis=1)[:, None]
    return np.concatenate(
        [np.take_along_axis(tails, corner, axis=1), np.take_along_axis(heads, corner, axis=1)], axis=1
    )


def _cycles(follower: Ints) -> list[Ints]:
    """The cycles of a permutation."""
    successor = follower.tolist()
    seen = bytearray(len(successor))
    cycles = []
    for first in range(len(successor)):
        if seen[first]:
            continue
        cycle, at = [], first
        while not seen[at]:
            seen[at] = 1
            cycle.append(at)
            at = successor[at]
        cycles.append(np.array(cycle, dtype=np.int64))
    return cycles


def _without_repeats(loop: Ints, flat: Floats) -> Ints:
    """The loop without points that coincide with their predecessor (cuts through a vertex make them)."""
    return loop[(flat[loop] != flat[np.roll(loop, 1)]).any(axis=1)]


def _signed_area(polygon: Floats) -> float:
    x, y = (polygon - polygon[0]).T if len(polygon) else np.zeros((2, 1))
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
