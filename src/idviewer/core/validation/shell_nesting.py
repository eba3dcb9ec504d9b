"""Nesting of closed shells: which lies inside which, however they are wound."""

from __future__ import annotations

from dataclasses import dataclass

import manifold3d
import numpy as np

from idviewer.core.arrays import Bools, Floats, Ints

SAMPLES = 48
"""So many vertices of a shell tell whether it lies inside another, outside, or crosses it."""

WINDING_PAIRS = 200_000
"""Winding numbers are summed for up to so many pairs of points and faces; beyond, rays are cast."""

DOUBTS = 8
"""Where rays disagree about a shell, winding numbers are summed for so many of the points in the minority."""

CLEAR = 0.05
"""A point whose winding number is nearer than this to a whole one is not on the surface."""


@dataclass(frozen=True)
class Nesting:
    """How closed shells lie in one another.

    Attributes:
        depth: (s,) how many others each lies in.
        parent: (s,) the innermost of them; -1 for none.
        crossing: pairs of shells that cross each other, each with a vertex (3,) of the first one inside the
            second.
    """

    depth: Ints
    parent: Ints
    crossing: tuple[tuple[int, int, Floats], ...]


def winding_numbers(points: Floats, corners: Floats) -> Floats:
    """How often a closed surface winds around each point, (p,); a half on a face.

    Args:
        points: (p, 3).
        corners: (m, 3, 3) of the faces.

    Source: van Oosterom and Strackee 1983, "The solid angle of a plane triangle".

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> faces = corners[np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])]
    >>> winding_numbers(np.array([[0.1, 0.1, 0.1], [1, 1, 1]]), faces).round(12).tolist()
    [1.0, 0.0]
    """
    result = np.empty(len(points))
    for row, point in enumerate(points):
        a, b, c = (corners[:, k] - point for k in range(3))
        la, lb, lc = (np.sqrt(np.einsum("ij,ij->i", v, v)) for v in (a, b, c))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        below = la * lb * lc
        for pair, length in (((a, b), lc), ((b, c), la), ((c, a), lb)):
            below += np.einsum("ij,ij->i", *pair) * length
        result[row] = np.arctan2(volume, below).sum() / (2.0 * np.pi)
    return result


class _Shells:
    """Closed shells as points and faces, and answers to where points lie."""

    def __init__(self, vertices: Floats, faces: Ints, labels: Ints, number: int) -> None:
        self._vertices = vertices
        order = np.argsort(labels, kind="stable")
        ends = np.searchsorted(labels[order], np.arange(number + 1))
        self.faces = [faces[order[ends[one] : ends[one + 1]]] for one in range(number)]
        boxes = [vertices[part].reshape(-1, 3) for part in self.faces]
        self.low = np.array([box.min(axis=0) for box in boxes]).reshape(-1, 3)
        self.high = np.array([box.max(axis=0) for box in boxes]).reshape(-1, 3)
        self._bodies: dict[int, manifold3d.Manifold] = {}

    def samples(self, one: int) -> Floats:
        """Some vertices of a shell, spread over it."""
        corners = np.unique(self.faces[one])
        return self._vertices[
            corners[np.linspace(0, len(corners) - 1, min(SAMPLES, len(corners))).astype(int)]
        ]

    def sides(self, points: Floats, other: int) -> Floats:
        """1 for points inside a shell, 0 for those outside, NaN for those on it, (p,)."""
        inside_box = ((points >= self.low[other]) & (points <= self.high[other])).all(axis=1)
        result = np.zeros(len(points))
        some = np.flatnonzero(inside_box)
        if len(some) * len(self.faces[other]) > WINDING_PAIRS:
            result[some] = [self._parity(point, other) for point in points[some]]
            rare = 1.0 if result.mean() < 0.5 else 0.0
            some = np.flatnonzero(result == rare)
            result[some[DOUBTS:]] = np.nan
            some = some[:DOUBTS]
        found = np.abs(winding_numbers(points[some], self._vertices[self.faces[other]]))
        whole = np.rint(found)
        result[some] = np.where(np.abs(found - whole) < CLEAR, np.minimum(whole, 1.0), np.nan)
        return result

    def _parity(self, point: Floats, other: int) -> float:
        """The same by one ray out of the shell's box."""
        if other not in self._bodies:
            numbers, faces = np.unique(self.faces[other], return_inverse=True)
            mesh = manifold3d.Mesh64(self._vertices[numbers], faces.reshape(-1, 3).astype(np.uint64))
            self._bodies[other] = manifold3d.Manifold(mesh)
        far = point.copy()
        far[2] = self.high[other, 2] + 0.137 * (self.high[other] - self.low[other]).max()
        return float(len(self._bodies[other].ray_cast(point.tolist(), far.tolist())) % 2)


def nesting_of(vertices: Floats, faces: Ints, labels: Ints, number: int) -> Nesting:
    """Find out how closed shells lie in one another.

    Args:
        vertices: (n, 3).
        faces: (m, 3) of all shells, those of one wound alike.
        labels: (m,) the shell of each face, from 0.
        number: of shells.
    """
    shells = _Shells(vertices, faces, labels, number)
    inside, crossing = [], []
    for outer in range(number):
        for inner in _met(shells, outer).tolist():
            points = shells.samples(inner)
            sides = shells.sides(points, outer)
            clear = sides[np.isfinite(sides)]
            if len(clear) == 0:
                clear = _between(shells, inner, outer)
            if 0.0 < clear.mean() < 1.0:
                crossing.append((inner, outer, points[np.flatnonzero(sides == 1.0)[0]]))
            elif clear.mean() == 1.0:
                inside.append((inner, outer))
    depth = np.zeros(number, np.int64)
    parent = np.full(number, -1)
    for inner, _ in inside:
        depth[inner] += 1
    for inner, outer in inside:
        if parent[inner] < 0 or depth[outer] > depth[parent[inner]]:
            parent[inner] = outer
    return Nesting(depth, parent, tuple(crossing))


def _met(shells: _Shells, outer: int) -> Ints:
    """The other shells that reach into a shell's box."""
    reaching: Bools = ((shells.low <= shells.high[outer]) & (shells.high >= shells.low[outer])).all(axis=1)
    reaching[outer] = False
    return np.flatnonzero(reaching)


def _between(shells: _Shells, inner: int, outer: int) -> Floats:
    """The sides of faces' middles, where all vertices lie on the other shell; outside if these do, too."""
    middles = shells._vertices[shells.faces[inner][:SAMPLES]].mean(axis=1)
    sides = shells.sides(middles, outer)
    clear = sides[np.isfinite(sides)]
    return clear if len(clear) else np.zeros(1)
