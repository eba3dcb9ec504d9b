"""Rays against a mesh and against planes: what lies under the mouse."""

from __future__ import annotations

import atexit
import itertools
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import manifold3d
import numpy as np

from idviewer.core.arrays import Bools, Floats
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.plane import Plane

RAY_PIECES = 16
"""manifold3d looks at all faces in a ray's bounding box; the boxes of pieces hold far fewer."""

RELATIVE_SHIFT = 1e-12
"""Shift of a ray that ends on the surface or runs in it, as a share of the body's diagonal."""

MOST_SHIFTS = 4
GENERAL_DIRECTION = np.array([0.36, 0.58, 0.73])


@dataclass(frozen=True)
class Ray:
    """A half line.

    Attributes:
        origin: where it starts.
        direction: where it goes; any length but zero.
    """

    origin: tuple[float, float, float]
    direction: tuple[float, float, float]

    def at(self, distances: Floats | float) -> Floats:
        """Positions origin + distance * direction: (3,) for a number, (p, 3) for (p,)."""
        return np.array(self.origin) + np.multiply.outer(distances, np.array(self.direction))

    def meets(self, plane: Plane) -> float | None:
        """Parameter at which the ray meets the plane, in lengths of its direction; None if it does not.

        >>> Ray((0, 0, 2), (0, 0, -1)).meets(Plane((0, 0, 0), (0, 0, 1)))
        2.0
        """
        fall = float(np.dot(plane.normal, self.direction))
        if abs(fall) <= np.finfo(float).eps * float(np.linalg.norm(self.direction)):
            return None
        distance = -float(plane.height(self.origin)) / fall
        return distance if distance >= 0.0 else None


@dataclass(frozen=True, eq=False)
class Crossings:
    """Crossings of a ray with a surface, nearest first; a crossing of an edge counts once.

    Attributes:
        distances: (c,) how far along the ray, in lengths of its direction.
        points: (c, 3) positions, on the surface to 1e-12 of its size.
        exits: (c,) which of them lead out.
    """

    distances: Floats
    points: Floats
    exits: Bools


def crossings(mesh: Mesh, ray: Ray) -> Crossings:
    """All passages of a ray through a mesh's surface, by manifold3d.

    A ray that meets vertices or edges in such a way that it does not go in and out in turns is taken for one
    beside it, by 1e-12 of the body's size, so that it leaves the body as often as it enters.

    Args:
        mesh: m faces; the first ray sorts them into a tree.
        ray: where to look.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> crossings(tetrahedron, Ray((0.2, 0.2, -1), (0, 0, 1))).distances.round(12).tolist()
    [1.0, 1.6]
    """
    direction = np.array(ray.direction, dtype=np.float64)
    length = float(np.linalg.norm(direction))
    direction /= length
    relative = np.array(ray.origin, dtype=np.float64) - mesh.centre
    # The ball around the body, with unequal margins: no piece shall end at the middle of a symmetric body.
    middle, radius = -float(relative @ direction), 0.5 * mesh.diagonal
    start, stop = max(middle - 1.01 * radius, 0.0), middle + 1.03 * radius
    if start >= stop:
        return Crossings(np.empty(0), np.empty((0, 3)), np.empty(0, dtype=np.bool_))
    places = np.linspace(start, stop, RAY_PIECES + 1)
    for step in range(MOST_SHIFTS + 1):
        shifted = relative + step * RELATIVE_SHIFT * mesh.diagonal * GENERAL_DIRECTION
        distances, points, exits = _cast(mesh, shifted, direction, places)
        if _alternate(exits):
            break
    return Crossings(distances / length, points + mesh.centre, exits)


_MANIFOLDS: WeakKeyDictionary[Mesh, manifold3d.Manifold] = WeakKeyDictionary()
atexit.register(_MANIFOLDS.clear)  # nanobind complains of what outlives the interpreter


def _manifold_of(mesh: Mesh) -> manifold3d.Manifold:
    """The body about its centre; made for the mesh's first ray, some 10 ms for 14,000 faces."""
    if mesh not in _MANIFOLDS:
        corners = mesh.faces.astype(np.uint64)
        _MANIFOLDS[mesh] = manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices - mesh.centre, corners))
    return _MANIFOLDS[mesh]


def _cast(mesh: Mesh, origin: Floats, direction: Floats, places: Floats) -> tuple[Floats, Floats, Bools]:
    """Hits between places along a ray: distances, points about the body's centre, and which ones lead out."""
    ends = origin + np.multiply.outer(places, direction)
    body, pieces = _manifold_of(mesh), itertools.pairwise(ends.tolist())
    hits = [hit for start, end in pieces for hit in body.ray_cast(start, end)]
    points = np.array([hit.position for hit in hits]).reshape(-1, 3)
    normals = np.array([hit.normal for hit in hits]).reshape(-1, 3)
    return np.maximum((points - origin) @ direction, 0.0), points, normals @ direction > 0.0


def _alternate(exits: Bools) -> bool:
    """Whether the ray goes in and out in turns, and out in the end."""
    return len(exits) == 0 or bool(exits[-1] and np.all(exits[1:] != exits[:-1]))


def middle_of_first_chord(mesh: Mesh, ray: Ray) -> Floats | None:
    """Middle (3,) of the first stretch of the ray that lies inside the mesh; None if it misses.

    A ray that starts inside begins its first stretch where it starts.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> middle_of_first_chord(tetrahedron, Ray((0.2, 0.2, -1), (0, 0, 1))).round(12).tolist()
    [0.2, 0.2, 0.3]
    """
    met = crossings(mesh, ray)
    if len(met.distances) == 0:
        return None
    # How many times the surface goes round each stretch: beyond the last crossing it does not.
    steps = np.where(met.exits, -1, 1)
    depths = np.append(0, np.cumsum(steps)) - steps.sum()
    ends = np.concatenate([[ray.origin], met.points])
    inside = np.flatnonzero(depths > 0)
    if len(inside) == 0:
        return None
    first = int(inside[0])
    last = first + int(np.argmax(depths[first:] <= 0))
    return 0.5 * (ends[first] + ends[last])
