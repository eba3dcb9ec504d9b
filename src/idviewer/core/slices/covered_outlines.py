"""Outlines whose sides cross: the boundary of what they cover, that is, go round at least once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely
from scipy.spatial import cKDTree

from idviewer.core.arrays import Floats, Ints

SAME_POINT = 1e-9
"""Points nearer to each other than this share of an outline's extent are one."""

SNAPPED = 1e-12
"""Grid that points are moved to where floating-point numbers do not suffice, as a share of the extent."""


class CoveredOutline(NamedTuple):
    """The boundary of what an outline goes round at least once, counterclockwise.

    Attributes:
        points: (e,) the outline's points that are left, by their numbers.
        crossings: (c, 2) points in which sides cross.
        loops: of numbers of these points, the crossings last; what is covered lies on the left.
        chords: (c, 2) two of the points left, neighbours on the outline, between which each crossing lies.
        chord_fractions: (c,) where between them.
    """

    points: Ints
    crossings: Floats
    loops: tuple[Ints, ...]
    chords: Ints
    chord_fractions: Floats


def covered_outline(points: Floats, loops: tuple[Ints, ...]) -> CoveredOutline:
    """The boundary of where an outline's winding number is positive (cut apart and put together by shapely).

    Args:
        points: (s, 2).
        loops: numbers of points, one closed loop each; there is at least one.

    >>> squares = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2], [1, 1], [3, 1], [3, 3], [1, 3]])
    >>> union = covered_outline(squares, (np.arange(4), np.arange(4, 8)))
    >>> sorted(union.crossings.tolist()), len(union.loops[0])
    ([[1.0, 2.0], [2.0, 1.0]], 8)
    """
    starts = np.concatenate(loops)
    stops = np.concatenate([np.roll(loop, -1) for loop in loops])
    lowest = points[starts].min(axis=0)
    extent = float(np.ptp(points[starts], axis=0).max())
    scaled = (points - lowest) / extent
    rings = _rings_of_covered(scaled[starts], scaled[stops])
    corners = np.concatenate([np.empty((0, 2)), *rings])
    apart, nearest = cKDTree(scaled[starts]).query(corners)
    number = np.where(apart <= SAME_POINT, starts[nearest], -1)
    sides, fractions = _sides_of(corners[number < 0], scaled[starts], scaled[stops])
    chords = np.stack([starts[sides], stops[sides]], axis=1)
    kept = np.unique(np.concatenate([number[number >= 0], chords.ravel()]))
    crossings, first = np.unique(corners[number < 0], axis=0, return_index=True)
    place = np.searchsorted(kept, number)
    place[number < 0] = len(kept) + np.unique(corners[number < 0], axis=0, return_inverse=True)[1].ravel()
    ends = np.cumsum([len(ring) for ring in rings])[:-1]
    return CoveredOutline(
        kept,
        lowest + extent * crossings,
        tuple(loop for loop in map(_without_repeats, np.split(place, ends)) if len(loop) >= 3),
        np.searchsorted(kept, chords[first]),
        fractions[first],
    )


def _without_repeats(loop: Ints) -> Ints:
    """A closed loop without points equal to the one before."""
    return loop[loop != np.roll(loop, 1)]


def _rings_of_covered(starts: Floats, stops: Floats) -> list[Floats]:
    """Closed rings (r_i, 2), no point repeated, around the region with a positive winding number."""
    sides = shapely.linestrings(np.stack([starts, stops], axis=1))
    try:
        cut = shapely.unary_union(sides)
    except shapely.errors.GEOSException:
        cut = shapely.unary_union(sides, grid_size=SNAPPED)
    cells = shapely.get_parts(shapely.polygonize(shapely.get_parts(cut)))
    inner = shapely.get_coordinates(shapely.point_on_surface(cells))
    covered = cells[[_turns(point, starts, stops) > 0 for point in inner]]
    if len(covered) == 0:
        return []
    rings = []
    for polygon in shapely.get_parts(shapely.coverage_union_all(covered)):
        for number, ring in enumerate(shapely.get_rings(polygon)):
            points = shapely.get_coordinates(ring)[:-1]
            inner = number > 0
            rings.append(points[::-1] if shapely.is_ccw(ring) == inner else points)
    return rings


def _turns(point: Floats, starts: Floats, stops: Floats) -> int:
    """Winding number of sides (s, 2) about a point off them."""
    rising = (starts[:, 1] <= point[1]) & (stops[:, 1] > point[1])
    falling = (starts[:, 1] > point[1]) & (stops[:, 1] <= point[1])
    along, off = stops - starts, point - starts
    left = along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0] > 0.0
    return int(np.count_nonzero(rising & left)) - int(np.count_nonzero(falling & ~left))


def _sides_of(corners: Floats, starts: Floats, stops: Floats) -> tuple[Ints, Floats]:
    """The side (c,) that each of some points lies on, and where between its ends (c,)."""
    sides, fractions = np.empty(len(corners), dtype=np.int64), np.empty(len(corners))
    along = stops - starts
    squares = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    for number, corner in enumerate(corners):
        share = np.clip(((corner - starts) * along).sum(axis=1) / squares, 0.0, 1.0)
        off = ((starts + share[:, None] * along - corner) ** 2).sum(axis=1)
        sides[number] = np.argmin(off)
        fractions[number] = share[sides[number]]
    return sides, fractions
