"""Rays against a mesh and against planes: what lies under the mouse."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.plane import Plane


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
        """How far along the ray, in lengths of its direction, it meets the plane; None if it does not.

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
    """Where a ray passes through a surface, nearest first; a crossing of an edge counts once.

    Attributes:
        distances: (c,) how far along the ray, in lengths of its direction.
        points: (c, 3) positions, interpolated on the faces and so on the surface to rounding.
    """

    distances: Floats
    points: Floats


def crossings(mesh: Mesh, ray: Ray) -> Crossings:
    """All passages of a ray through a mesh's surface.

    Args:
        mesh: m faces, each tested.
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
    # Seen along the ray the surface is flat and the ray is its origin: which triangles contain it?
    relative = mesh.vertices - np.array(ray.origin)
    flat = relative @ _across(direction).T
    a, b, c = (flat[mesh.faces[:, corner]] for corner in range(3))
    turns = np.stack([_turn(b, c), _turn(c, a), _turn(a, b)], axis=1)
    hit = ((turns >= 0.0).all(axis=1) | (turns <= 0.0).all(axis=1)) & (turns.sum(axis=1) != 0.0)
    shares = turns[hit] / turns[hit].sum(axis=1, keepdims=True)
    points = np.einsum("hc,hci->hi", shares, mesh.vertices[mesh.faces[hit]])
    depths = (points - np.array(ray.origin)) @ direction
    order = np.argsort(depths, kind="stable")
    order = order[depths[order] >= 0.0]
    order = order[np.diff(depths[order], prepend=-np.inf) > 1e-12 * mesh.diagonal]
    return Crossings(depths[order] / length, points[order])


def middle_of_first_chord(mesh: Mesh, ray: Ray) -> Floats | None:
    """(3,) the middle of the first stretch of the ray that lies inside the mesh; None if it misses.

    A ray that starts inside begins its first stretch where it starts.
    """
    met = crossings(mesh, ray)
    if len(met.distances) == 0:
        return None
    starts_inside = len(met.distances) % 2 == 1
    near, far = (np.array(ray.origin), met.points[0]) if starts_inside else met.points[:2]
    return 0.5 * (near + far)


def _across(direction: Floats) -> Floats:
    """(2, 3) orthonormal vectors across a unit direction."""
    helper = np.eye(3)[int(np.argmin(np.abs(direction)))]
    first = np.cross(helper, direction)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(direction, first)])


def _turn(p: Floats, q: Floats) -> Floats:
    return p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
