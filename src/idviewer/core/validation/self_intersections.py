"""Faces of a surface that cross each other, or lie on each other: how many, which and where."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from idviewer.core._kernels.geometry.face_overlaps import find_overlaps
from idviewer.core.arrays import Floats, Ints
from idviewer.core.morton import morton_order
from idviewer.core.validation.findings import Finding, Point, point_text, stated


@dataclass(frozen=True)
class SelfIntersectionSettings:
    """Settings of the search for faces that cross each other.

    Attributes:
        depth: faces that a shift by this share of the bounding box's diagonal parts only touch each other;
            it is what rounding to single precision moves vertices by.
        most_tests: pairs of boxes that are compared at most, some ten seconds; where that is not enough,
            the finding says so.
        most_places: so many places are named, the largest first.
    """

    depth: float = 2.0**-22
    most_tests: int = 2 * 10**9
    most_places: int = 5


SELF_INTERSECTIONS = SelfIntersectionSettings()


@dataclass(frozen=True, eq=False)
class SelfIntersections:
    """Faces of one surface that cross each other, or lie on each other.

    Attributes:
        pairs: (k, 2) numbers of the two faces.
        complete: whether all faces were compared; there may be more pairs where they were not.
        places: up to five points (3,) where faces cross, one for each place, that of most faces first.
        place_count: how many places there are: faces that cross and hang together are one.
        size: of the surface, its bounding box's diagonal.
    """

    pairs: Ints
    complete: bool = True
    places: tuple[Point, ...] = ()
    place_count: int = 0
    size: float = field(default=1.0, repr=False)

    def __len__(self) -> int:
        """The number of pairs."""
        return len(self.pairs)

    def __bool__(self) -> bool:
        """Whether there may be values that are none: faces cross, or it was not found out."""
        return len(self.pairs) > 0 or not self.complete

    @cached_property
    def faces(self) -> Ints:
        """Numbers (f,) of the faces that cross another, ascending."""
        return np.unique(self.pairs)

    @property
    def finding(self) -> Finding:
        """The finding that tells of them."""
        count = len(self.pairs)
        least = "" if self.complete else "at least "
        pairs = f"{least}{count:,} {'pair' if count == 1 else 'pairs'} of faces that cross each other"
        if self.places:
            others = self.place_count - 1
            more = f" and at {others:,} other place{'' if others == 1 else 's'}" if others else ""
            pairs += f" near {point_text(np.array(self.places[0]), self.size)}{more}"
        found = stated("self_intersections", pairs, count=max(count, 1))
        where = self.places[0] if self.places else None
        return Finding(**{**vars(found), "where": where})

    def as_dict(self) -> dict[str, Any]:
        """Plain values, for JSON: the number of pairs, places and faces."""
        return {
            "count": len(self.pairs),
            "complete": self.complete,
            "place_count": self.place_count,
            "places": [list(place) for place in self.places],
            "faces": self.faces.tolist(),
        }


def self_intersections_of(
    vertices: Floats, faces: Ints, settings: SelfIntersectionSettings = SELF_INTERSECTIONS
) -> SelfIntersections:
    """Find the faces of a surface that cross each other or lie on each other.

    Faces that share corners count as well, if they have more in common than these: where one folds back onto
    its neighbour, or passes through another at a corner. Faces that only touch each other do not.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
        settings: see there.

    >>> wedge = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [0.2, 0.2, 1], [0.2, 0.2, -1], [0.3, 0.4, 1]])
    >>> self_intersections_of(wedge, np.array([[0, 1, 2], [3, 4, 5]])).pairs.tolist()
    [[0, 1]]
    >>> len(self_intersections_of(wedge, np.array([[0, 1, 2], [0, 3, 5]])))
    0
    """
    size = float(np.linalg.norm(np.ptp(vertices, axis=0))) if len(vertices) else 0.0
    if len(faces) < 2 or size == 0.0:
        return SelfIntersections(np.empty((0, 2), dtype=np.int64))
    corners = (vertices - vertices.mean(axis=0))[faces] / size
    order = morton_order(corners.mean(axis=1))
    found, compared = find_overlaps(corners[order], settings.depth, settings.most_tests)
    pairs = np.sort(order[found], axis=1)
    pairs = pairs[np.lexsort(pairs.T[::-1])]
    if len(pairs) == 0:
        return SelfIntersections(pairs, compared == len(faces), size=size)
    number, places = _places(vertices[faces], faces, pairs, settings.most_places)
    return SelfIntersections(pairs, compared == len(faces), places, number, size)


def _places(corners: Floats, faces: Ints, pairs: Ints, most: int) -> tuple[int, tuple[Point, ...]]:
    """How many places crossing faces make up, and a point of each of the largest.

    Args:
        corners: (m, 3, 3) of the faces.
        faces: (m, 3).
        pairs: (k, 2) of faces.
        most: places to name.
    """
    involved, ends = np.unique(pairs, return_inverse=True)
    ends = ends.reshape(-1, 2)
    # Faces hang together where they cross, and where they share a vertex: vertices are nodes, too.
    _, used = np.unique(faces[involved], return_inverse=True)
    tails = np.concatenate([ends[:, 0], np.repeat(np.arange(len(involved)), 3)])
    heads = np.concatenate([ends[:, 1], used.ravel() + len(involved)])
    count = int(heads.max()) + 1
    graph = coo_array((np.ones(len(tails)), (tails, heads)), shape=(count, count))
    of_pair = connected_components(graph, directed=False)[1][ends[:, 0]]
    # The middle of what two faces' boxes have in common.
    boxes = corners[pairs]
    middles = 0.5 * (boxes.min(axis=2).max(axis=1) + boxes.max(axis=2).min(axis=1))
    names, sizes = np.unique(of_pair, return_counts=True)
    chosen = []
    for name in names[np.argsort(-sizes, kind="stable")[:most]]:
        own = middles[of_pair == name]
        x, y, z = own[np.argmin(((own - own.mean(axis=0)) ** 2).sum(axis=1))].tolist()
        chosen.append((x, y, z))
    return len(names), tuple(chosen)
