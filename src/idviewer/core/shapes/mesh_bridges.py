"""The bridges that join the shells of a mesh, so that heat gets to the boundaries of voids."""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array

from idviewer.core.arrays import Floats, Ints
from idviewer.core.shapes.surface_projection import SurfaceProjection

PREFERRED_DIRECTION = np.array([1.0, 0.61, 0.37]) / math.hypot(1.0, 0.61, 0.37)
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


@dataclass(frozen=True)
class BridgeSettings:
    """Settings of bridges between the shells of a mesh.

    Attributes:
        radius: of a bridge, in radii of the sphere that has the smaller shell's area. With 1 / pi, a ball's
            void exchanges heat as fast as a polygon's round hole, as wide and as far from the outline.
        least_length: in radii of the bridge; shorter ones conduct as if they were so long. What the surfaces
            themselves resist is then hundreds of times as much.
        preference: of places that are about as near, one may be farther by this share of how much farther
            it lies in a fixed direction: so it is about the same place on all meshes of a body, however
            symmetric.
        equally_near: share of the shortest distance; the middle of all places that are no farther is taken.
        aligned: cosine between bridges from one such place and from another.
        fewest_threads: of a bridge.
        most_threads: of a bridge.
        threads_per_edge: on fine meshes, threads lie nearer than edges are long, by this factor.
        turns: how often the ends are moved to the points closest to each other.
    """

    radius: float = 1.0 / math.pi
    least_length: float = 1e-3
    preference: float = 0.01
    equally_near: float = 0.01
    aligned: float = 0.9
    fewest_threads: int = 64
    most_threads: int = 4096
    threads_per_edge: float = 2.0
    turns: int = 40


BRIDGES = BridgeSettings()


@dataclass(frozen=True, eq=False)
class Bridge:
    """A bridge between two shells: a tube of the surface's own kind, from disc to disc.

    Attributes:
        shells: numbers of the two.
        ends: (2, 3) the points, one on each shell, that it joins.
        length: between them.
        radius: of the tube.
        faces: (2,) in which the ends lie.
        shares: (2, 3) barycentric coordinates of the ends there.
    """

    shells: tuple[int, int]
    ends: Floats
    length: float
    radius: float
    faces: Ints
    shares: Floats

    @property
    def conductance(self) -> float:
        """What it conducts, 2 pi radius / length: without unit, as the entries of a mesh's Laplacian are."""
        return 2.0 * math.pi * self.radius / max(self.length, BRIDGES.least_length * self.radius)


class _Contact(NamedTuple):
    """The place where two shells are nearest."""

    length: float
    ends: Floats


class ShellBridges:
    """The shortest bridges that join all shells: a minimum spanning tree (Kruskal), as of a polygon's loops.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
        shells: faces of each shell.
    """

    def __init__(self, vertices: Floats, faces: Ints, shells: tuple[Ints, ...]) -> None:
        self._vertices, self._faces, self._shells = vertices, faces, shells
        self._numbers = [np.unique(faces[shell]) for shell in shells]
        self._surfaces = [SurfaceProjection(vertices, faces[shell]) for shell in shells]
        self.bridges = tuple(self._tree())

    def laplacian(self) -> csr_array:
        """What the bridges add to the Laplacian of n vertices, (n, n).

        A bridge is a bundle of threads, parallel to it and even over its cross-section, that go on to the
        closest points of both shells. The energy of u is the bridge's conductance times the mean over its
        threads of the squared difference of u between their ends.
        """
        count = len(self._vertices)
        total = csr_array((count, count))
        for bridge in self.bridges:
            threads = self._threads(bridge)
            total = total + (bridge.conductance / threads.shape[0]) * (threads.T @ threads)
        return csr_array(total)

    def _tree(self) -> list[Bridge]:
        """Kruskal's algorithm; how far shells are apart is found out only where it may matter."""
        count = len(self._shells)
        boxes = np.array([[s.min(axis=0), s.max(axis=0)] for s in (self._vertices[n] for n in self._numbers)])
        heap: list[tuple[float, int, int, int]] = []
        for one in range(count - 1):
            gaps = np.maximum(boxes[one + 1 :, 0] - boxes[one, 1], boxes[one, 0] - boxes[one + 1 :, 1])
            bounds = np.linalg.norm(np.maximum(gaps, 0.0), axis=1)
            heap += [(bound, 0, one, one + 1 + k) for k, bound in enumerate(bounds.tolist())]
        heapq.heapify(heap)
        group, contacts = list(range(count)), dict[tuple[int, int], _Contact]()
        made: list[Bridge] = []
        while len(made) < count - 1:
            _, known, one, other = heapq.heappop(heap)
            if group[one] == group[other]:
                continue
            if not known:
                contact = contacts[one, other] = self._contact(one, other)
                heapq.heappush(heap, (contact.length, 1, one, other))
                continue
            old, new = group[other], group[one]
            group = [new if label == old else label for label in group]
            made.append(self._bridge(one, other, contacts[one, other]))
        return made

    def _contact(self, one: int, other: int) -> _Contact:
        """Where two shells are nearest."""
        reach = self._reach(one, other)
        ends = np.concatenate([self._pairs(one, other, reach), self._pairs(other, one, reach)[:, ::-1]])
        lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        best = int(np.argmin(lengths - BRIDGES.preference * (ends[:, 0] @ PREFERRED_DIRECTION)))
        # Where surfaces run side by side, a bridge stands in the middle of that stretch, not on its rim.
        ways = (ends[:, 1] - ends[:, 0]) / np.maximum(lengths, np.finfo(float).tiny)[:, None]
        near = lengths <= (1.0 + BRIDGES.equally_near) * lengths[best]
        near &= ways @ ways[best] >= BRIDGES.aligned
        near[best] = True
        a = 0.5 * (ends[near, 0].min(axis=0) + ends[near, 0].max(axis=0))
        a = b = self._surfaces[one].closest(a[None]).points[0]
        for _ in range(BRIDGES.turns):
            last = a
            b = self._surfaces[other].closest(a[None]).points[0]
            a = self._surfaces[one].closest(b[None]).points[0]
            if np.linalg.norm(a - last) <= 1e-9 * np.linalg.norm(b - a):
                break
        return _Contact(float(np.linalg.norm(b - a)), np.stack([a, b]))

    def _reach(self, one: int, other: int) -> float:
        """Distance between the nearest vertices of two shells."""
        small, large = sorted((one, other), key=lambda shell: len(self._numbers[shell]))
        return float(self._surfaces[large].vertex_distances(self._vertices[self._numbers[small]]).min())

    def _pairs(self, one: int, other: int, reach: float) -> Floats:
        """Vertices of a shell that may be near another, and the closest points there, (p, 2, 3)."""
        points, corners = self._vertices[self._numbers[one]], self._vertices[self._numbers[other]]
        # The preference is worth less than the extent of either shell. What rounding takes is given back.
        margin = (1.0 + 1e-9) * reach + BRIDGES.preference * float(np.ptp(points, axis=0).max())
        low, high = corners.min(axis=0) - margin, corners.max(axis=0) + margin
        points = points[((points >= low) & (points <= high)).all(axis=1)]
        return np.stack([points, self._surfaces[other].closest(points).points], axis=1)

    def _bridge(self, one: int, other: int, contact: _Contact) -> Bridge:
        areas = [self._surfaces[shell].area for shell in (one, other)]
        radius = BRIDGES.radius * math.sqrt(min(areas) / (4.0 * math.pi))
        found = [self._surfaces[shell].closest(contact.ends[k][None]) for k, shell in enumerate((one, other))]
        faces = np.array(
            [self._shells[shell][at.faces[0]] for shell, at in zip((one, other), found, strict=True)]
        )
        shares = np.concatenate([at.shares for at in found])
        return Bridge((one, other), contact.ends, contact.length, radius, faces, shares)

    def _threads(self, bridge: Bridge) -> csr_array:
        """Matrix (k, n) from values at vertices to their differences between the ends of each thread."""
        count = BRIDGES.fewest_threads
        sides = self._ends(bridge, count)
        edges = [math.sqrt(4.0 / math.sqrt(3.0) * float(np.median(areas))) for _, _, areas in sides]
        spacing = min(edges) / BRIDGES.threads_per_edge
        wanted = min(math.pi * bridge.radius**2 / spacing**2, BRIDGES.most_threads)
        if wanted > count:
            sides = self._ends(bridge, int(wanted))
        matrices = []
        for faces, shares, _ in sides:
            starts = np.arange(0, shares.size + 1, 3)
            entries = shares.ravel(), self._faces[faces].ravel(), starts
            matrices.append(csr_array(entries, shape=(len(faces), len(self._vertices))))
        return csr_array(matrices[0] - matrices[1])

    def _ends(self, bridge: Bridge, count: int) -> list[tuple[Ints, Floats, Floats]]:
        """Faces, barycentric coordinates and the faces' areas at the ends of so many threads."""
        radii = bridge.radius * np.sqrt((np.arange(count) + 0.5) / count)
        angles = GOLDEN_ANGLE * np.arange(count)
        across = _across(self._axis(bridge))
        disc = np.outer(radii * np.cos(angles), across[0]) + np.outer(radii * np.sin(angles), across[1])
        result = []
        for end, shell in zip(bridge.ends, bridge.shells, strict=True):
            found = self._surfaces[shell].closest(end + disc)
            result.append((self._shells[shell][found.faces], found.shares, found.areas))
        return result

    def _axis(self, bridge: Bridge) -> Floats:
        """The bridge's direction, or the surface's normal where both shells touch."""
        axis = bridge.ends[1] - bridge.ends[0]
        if bridge.length > 1e-9 * bridge.radius:
            return np.asarray(axis / bridge.length)
        a, b, c = self._vertices[self._faces[bridge.faces[0]]]
        normal = np.cross(b - a, c - a)
        return np.asarray(normal / np.linalg.norm(normal))


def _across(axis: Floats) -> Floats:
    """Two directions (2, 3) at right angles to an axis and to each other."""
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    first = np.cross(axis, helper)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(axis, first)])
