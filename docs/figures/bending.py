"""What is done to shapes: noise that keeps outlines simple, and smooth maps of the plane and of space."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from idviewer.core import Polygon

Floats = NDArray[np.float64]
Map = Callable[[Floats], Floats]

MOST_DRAWS = 5000


def diameter(points: Floats) -> float:
    """The largest distance between two of the points (n, d)."""
    return float(max(np.linalg.norm(points - point, axis=1).max() for point in points))


def noisy(polygon: Polygon, share: float, rng: np.random.Generator) -> tuple[Polygon, float]:
    """Vertices displaced by Gaussian noise, each coordinate with a deviation of `share` of the diameter.

    Edges that cross are drawn anew, with their neighbours of one vertex, until none do: the outline stays
    simple, and displacements that can stand together are the more likely.

    Returns:
        The polygon, and the deviation of the displacements that were kept, as a share of the diameter.
    """
    size = diameter(polygon.vertices)
    shift = rng.normal(0.0, share * size, polygon.vertices.shape)
    for _ in range(MOST_DRAWS):
        crossing = crossing_edges(polygon.vertices + shift, polygon.edges)
        if not len(crossing):
            return polygon.with_vertices(polygon.vertices + shift), float(shift.std() / size)
        again = np.unique(polygon.edges[crossing])
        shift[again] = rng.normal(0.0, share * size, (len(again), 2))
    raise RuntimeError(f"no simple outline with {share:.0%} noise in {MOST_DRAWS} draws")


def crossing_edges(vertices: Floats, edges: NDArray[np.int64]) -> NDArray[np.int64]:
    """Which edges (e, 2) cross another one that they share no vertex with."""
    a, b = vertices[edges[:, 0]], vertices[edges[:, 1]]
    sides = side_of(a[:, None], b[:, None], a[None]) * side_of(a[:, None], b[:, None], b[None]) <= 0
    apart = (edges[:, None, :, None] != edges[None, :, None, :]).all(axis=(2, 3))
    return np.flatnonzero((sides & sides.T & apart).any(axis=1))


def side_of(a: Floats, b: Floats, p: Floats) -> Floats:
    """Sign of the area of the triangles a, b, p."""
    to, along = p - a, b - a
    return np.sign(along[..., 0] * to[..., 1] - along[..., 1] * to[..., 0])


def ramp(values: Floats, low: float, high: float) -> Floats:
    """0 up to `low`, 1 from `high` on, smooth between (quintic)."""
    share = np.clip((values - low) / (high - low), 0.0, 1.0)
    return share**3 * (10.0 + share * (6.0 * share - 15.0))


def bent(line: Map, low: float, high: float, angle: float) -> Map:
    """A map that bends a strip: `line` gives along and across of points, which turn by `angle` between.

    The middle line keeps its length. Between `low` and `high` it is an arc of a circle; beyond, straight.
    Args are in the points' unit, the angle in radians. Returns (p, 2) -> (p, 2), along and across as bent.
    """

    def carry(points: Floats) -> Floats:
        along, across = line(points).T
        share = np.clip((along - low) / (high - low), 0.0, 1.0)
        turn, radius = angle * share, (high - low) / angle
        beyond = along - low - share * (high - low)
        x = low + radius * np.sin(turn) - across * np.sin(turn) + beyond * np.cos(turn)
        y = radius * (1.0 - np.cos(turn)) + across * np.cos(turn) + beyond * np.sin(turn)
        return np.stack([x, y], axis=1)

    return carry


def skinned(bones: Floats, angles: ArrayLike, sharpness: float = 4.0) -> Map:
    """Limbs turned about their joints, by linear blend skinning.

    A point follows each bone by a share that falls off with a power of its distance from it.

    Args:
        bones: (b, 2, 2) joint and end of each.
        angles: (b,) to turn by, radians, counter-clockwise; bones that stay have 0.
        sharpness: that power.
    """
    joints, ends = bones[:, 0], bones[:, 1]
    along = ends - joints
    c, s = np.cos(np.asarray(angles)), np.sin(np.asarray(angles))
    turns = np.moveaxis(np.array([[c, -s], [s, c]]), 2, 0)

    def carry(points: Floats) -> Floats:
        to = points[:, None] - joints
        share = np.clip(np.sum(to * along, axis=2) / np.sum(along**2, axis=1), 0.0, 1.0)
        far = np.linalg.norm(to - share[..., None] * along, axis=2)
        weights = np.maximum(far, 1e-9) ** -sharpness
        weights /= weights.sum(axis=1, keepdims=True)
        moved = np.einsum("bij,pbj->pbi", turns, to) + joints
        return np.einsum("pb,pbi->pi", weights, moved)

    return carry


def one_after_another(*maps: Map) -> Map:
    """The maps composed, the first one first."""

    def carry(points: Floats) -> Floats:
        for each in maps:
            points = each(points)
        return points

    return carry


def carried(polygon: Polygon, by: Map) -> Polygon:
    """The polygon with its vertices moved by a map."""
    return polygon.with_vertices(by(polygon.vertices))


def change(before: Floats, after: Floats) -> tuple[float, float]:
    """Mean change of distances as a share of their mean: as they are, and but for a common factor."""
    known = np.isfinite(before) & np.isfinite(after)
    before, after = before[known], after[known]
    scaled = after * (before.mean() / after.mean())
    return tuple(float(np.abs(one - before).mean() / before.mean()) for one in (after, scaled))
