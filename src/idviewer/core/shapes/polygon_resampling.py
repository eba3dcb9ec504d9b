"""Points spread evenly along a polygon's boundary: its corners kept, or all of its vertices."""

from __future__ import annotations

import heapq
import itertools
import math
from dataclasses import dataclass

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.validation.polygon_checks import PolygonError

MOST_PARTS = 100_000
"""Of an outline whose edges are cut."""

CORNER_TURN = float(np.radians(20.0))
"""Radians: a vertex where the outline turns by more is a corner; smooth outlines turn less."""


@dataclass(frozen=True)
class _Arc:
    """A part of a loop from one corner to the next, or all of a loop without corners.

    Attributes:
        loop: its number.
        points: (k, 2) vertices from its first to its last.
        places: (k,) their lengths along the arc.
        least: fewest points that it needs, its last one not counted.
    """

    loop: int
    points: Floats
    places: Floats
    least: int

    def at(self, count: int) -> Floats:
        """So many points at equal spacing, the first included and the last not."""
        wanted = np.arange(count) * (self.places[-1] / count)
        made = np.stack([np.interp(wanted, self.places, axis) for axis in self.points.T], axis=1)
        made[0] = self.points[0]  # corners exactly
        return made


def resampled_loops(vertices: Floats, loops: tuple[Ints, ...], count: int) -> list[Floats]:
    """Points of each loop, (k, 2), count in all.

    Args:
        vertices: (n, 2).
        loops: indices into them.
        count: of the points.

    Raises:
        PolygonError: the corners alone are more than that.

    >>> square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    >>> resampled_loops(square, (np.arange(4),), 8)[0][:3].tolist()
    [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0]]
    """
    arcs = [arc for number, loop in enumerate(loops) for arc in _arcs(number, vertices[loop])]
    counts = _shared(arcs, count)
    made: list[list[Floats]] = [[] for _ in loops]
    for arc, number in zip(arcs, counts, strict=True):
        made[arc.loop].append(arc.at(number))
    return [np.concatenate(parts) for parts in made]


def cut_loops(
    vertices: Floats, loops: tuple[Ints, ...], lengths: Floats, longest: float
) -> tuple[Floats, tuple[Ints, ...]]:
    """Cut the edges of loops into equal parts no longer than asked.

    Args:
        vertices: (n, 2).
        loops: their numbers.
        lengths: (n,) of the edges, each from its vertex on.
        longest: that a part may be.

    Returns:
        The vertices, those that are new behind the others, and the loops through all of them.

    Raises:
        PolygonError: it is no positive number, or too small.

    >>> square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    >>> cut_loops(square, (np.arange(4),), np.ones(4), 0.5)[1][0].tolist()
    [0, 4, 1, 5, 2, 6, 3, 7]
    """
    if not 0.0 < longest < math.inf:
        raise PolygonError(f"the longest edge must be a positive number, not {longest}")
    if (count := lengths.sum() / longest) > MOST_PARTS:
        raise PolygonError(
            f"with edges of at most {longest:.4g} it would have about {count:,.0f} vertices, "
            f"and {MOST_PARTS:,} is the limit; choose longer ones"
        )
    parts = np.maximum(np.ceil(lengths / longest * (1.0 - 1e-9)), 1.0).astype(np.int64)
    made, through, count = [vertices], [], len(vertices)
    for loop in loops:
        pieces = parts[loop]
        step = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        share = (step / np.repeat(pieces, pieces))[:, None]
        starts, stops = np.repeat(loop, pieces), np.repeat(np.roll(loop, -1), pieces)
        new = step > 0
        numbers = starts.copy()
        numbers[new] = count + np.arange(np.count_nonzero(new))
        count += np.count_nonzero(new)
        made.append(((1.0 - share) * vertices[starts] + share * vertices[stops])[new])
        through.append(numbers)
    return np.concatenate(made), tuple(through)


def _arcs(number: int, points: Floats) -> list[_Arc]:
    sides = np.roll(points, -1, axis=0) - points
    before = np.roll(sides, 1, axis=0)
    across = before[:, 0] * sides[:, 1] - before[:, 1] * sides[:, 0]
    turn = np.abs(np.arctan2(across, np.einsum("ij,ij->i", before, sides)))
    corners = np.flatnonzero(turn > CORNER_TURN)
    first = corners if len(corners) else np.zeros(1, dtype=np.int64)
    rolled = np.roll(points, -first[0], axis=0)
    closed = np.concatenate([rolled, rolled[:1]])
    stops = np.append(first - first[0], len(points))
    # Three points make a loop, so one or two arcs need more than their corner each.
    least = {1: 3, 2: 2}.get(len(first), 1)
    return [_arc(number, closed[start : stop + 1], least) for start, stop in itertools.pairwise(stops)]


def _arc(number: int, points: Floats, least: int) -> _Arc:
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return _Arc(number, points, np.concatenate([[0.0], np.cumsum(lengths)]), least)


def _shared(arcs: list[_Arc], count: int) -> list[int]:
    """Numbers of points on each arc: one more, again and again, on the one where they are farthest apart."""
    counts = [arc.least for arc in arcs]
    if sum(counts) > count:
        raise PolygonError(f"{count} points are too few for the {sum(counts)} corners; ask for more")
    spacings = [(-arc.places[-1] / arc.least, number) for number, arc in enumerate(arcs)]
    heapq.heapify(spacings)
    for _ in range(count - sum(counts)):
        number = spacings[0][1]
        counts[number] += 1
        heapq.heapreplace(spacings, (-arcs[number].places[-1] / counts[number], number))
    return counts
