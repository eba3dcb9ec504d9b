"""Implicit bodies: smooth unions of swept ellipsoids, and their fields.

A `Part` is an ellipsoid carried along a smooth curve: one point makes an ellipsoid, equal radii a capsule,
changing radii a round cone. A sweep is sampled densely and united sharply, so a limb has no lumps at its
joints; the parts then melt into each other by a smooth minimum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit, prange
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline, PchipInterpolator
from scipy.ndimage import gaussian_filter1d

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Part:
    """Samples of a sweep: centres (m, 3), half axes (m, 3), their directions (m, 3, 3), and how it melts.

    Parts of one group melt first, each over the width `blend`; groups then melt over `group_blend`.
    """

    centres: Array
    radii: Array
    frames: Array
    blend: float
    group: str = "body"


@dataclass(frozen=True)
class Body:
    """Parts, in the order in which they melt, and the width over which each group melts with those before."""

    parts: tuple[Part, ...]
    group_blend: dict[str, float]

    @cached_property
    def packed(self) -> tuple[Array, ...]:
        """The arrays that the kernels read: samples, first sample of each part, blends, bounding spheres."""
        samples = [
            np.hstack([p.centres, p.radii, p.frames.reshape(-1, 9), segment_spheres(p)]) for p in self.parts
        ]
        starts = np.cumsum([0] + [len(s) for s in samples])
        groups = list(dict.fromkeys(p.group for p in self.parts))
        assert [p.group for p in self.parts] == sorted((p.group for p in self.parts), key=groups.index)
        rules = [[p.blend, groups.index(p.group), self.group_blend.get(p.group, p.blend)] for p in self.parts]
        return (
            np.vstack(samples),
            starts.astype(np.float64),
            np.array(rules),
            np.array([bounding_sphere(p) for p in self.parts]),
        )

    def bounds(self, margin: float) -> Array:
        """(2, 3) box around the body, `margin` wider on every side."""
        spheres = [(p.centres, p.radii.max(axis=1, keepdims=True)) for p in self.parts]
        low = np.min([(c - r).min(axis=0) for c, r in spheres], axis=0)
        high = np.max([(c + r).max(axis=0) for c, r in spheres], axis=0)
        return np.array([low - margin, high + margin])


def bounding_sphere(part: Part) -> tuple[float, float, float, float]:
    middle = (part.centres.min(axis=0) + part.centres.max(axis=0)) / 2
    radius = (np.linalg.norm(part.centres - middle, axis=1) + part.radii.max(axis=1)).max()
    return (*middle.tolist(), float(radius))


def segment_spheres(part: Part) -> Array:
    """(m, 4) spheres (centre, radius) around the segments from each sample to the next."""
    following = np.minimum(np.arange(len(part.centres)) + 1, len(part.centres) - 1)
    reach = np.linalg.norm(part.centres[following] - part.centres, axis=1) / 2
    radius = np.maximum(part.radii, part.radii[following]).max(axis=1) + reach
    return np.column_stack([(part.centres + part.centres[following]) / 2, radius])


def sweep(
    points: ArrayLike,
    radii: Sequence[float | Sequence[float]],
    side: ArrayLike = (1, 0, 0),
    blend: float = 0.0,
    group: str = "body",
) -> Part:
    """An ellipsoid carried along the spline through `points` (n, 3).

    `radii` are n numbers (round), n pairs (along `side`, across it) or n triples (and along the curve: how
    long the ends are). `side` is one direction or one for each point.
    """
    knots = np.asarray(points, dtype=float).reshape(-1, 3)
    half = half_axes(radii)
    sides = np.broadcast_to(np.asarray(side, dtype=float), knots.shape)
    chord = np.concatenate([[0], np.cumsum(np.sqrt(np.linalg.norm(np.diff(knots, axis=0), axis=1)))])
    curve = CubicSpline(chord, knots, bc_type="natural")
    at = np.linspace(0, chord[-1], max(10 * (len(knots) - 1), 24) + 1)
    # no overshoot between knots, nor visible bands at them
    thickness = PchipInterpolator(chord, half)(at)
    thickness = gaussian_filter1d(thickness, 0.25 * len(at) / len(knots), axis=0, mode="nearest")
    return Part(
        curve(at), thickness, frames_along(curve(at, 1), PchipInterpolator(chord, sides)(at)), blend, group
    )


def half_axes(radii: Sequence[float | Sequence[float]]) -> Array:
    """(n, 3) from n numbers, pairs or triples; a third half axis not given is the smaller of the others."""
    rows = [tuple(np.atleast_1d(row)) for row in radii]
    return np.array([row if len(row) == 3 else (row[0], row[-1], min(row)) for row in rows], dtype=float)


def frames_along(tangents: Array, sides: Array) -> Array:
    """(m, 3, 3): rows are the side made perpendicular to the tangent, the direction across, the tangent."""
    along = tangents / np.linalg.norm(tangents, axis=1, keepdims=True)
    across = np.cross(along, sides)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return np.stack([np.cross(across, along), across, along], axis=1)


def ellipsoid(
    centre: ArrayLike, radii: ArrayLike, blend: float, group: str = "body", axes: ArrayLike | None = None
) -> Part:
    """An ellipsoid; `axes` (3, 3) are the rows along which the half axes lie, x, y and z unless given."""
    frame = np.eye(3) if axes is None else np.asarray(axes, dtype=float)
    return Part(
        np.asarray(centre, dtype=float).reshape(1, 3),
        np.asarray(radii, dtype=float).reshape(1, 3),
        frame[None],
        blend,
        group,
    )


@njit(cache=False)
def nearest_place(point, first, second, length_squared):  # type: ignore[no-untyped-def]
    """Where along the segment (0 to 1) the swept ellipsoid reaches closest to the point.

    From the foot of the perpendicular, it lies towards the thicker end: slope times radius for a round cone.
    """
    foot = 0.0
    for i in range(3):
        foot += (point[i] - first[i]) * (second[i] - first[i])
    foot /= length_squared
    t = min(max(foot, 0.0), 1.0)
    shift = 0.0
    for axis in range(2):
        radius, q = (1 - t) * first[3 + axis] + t * second[3 + axis], 0.0
        for i in range(3):
            direction = (1 - t) * first[6 + 3 * axis + i] + t * second[6 + 3 * axis + i]
            q += direction * (point[i] - (1 - t) * first[i] - t * second[i])
        shift += min((q / radius) ** 2, 1.5) * (second[3 + axis] - first[3 + axis]) / radius
    along = (1 - t) * first[5] + t * second[5]
    return min(max(foot + shift * along * along / length_squared, 0.0), 1.0)


@njit(cache=False)
def segment_distance(point, first, second):  # type: ignore[no-untyped-def]
    """First-order distance of a point to the ellipsoid between two samples that is nearest to it."""
    length = 0.0
    for i in range(3):
        length += (second[i] - first[i]) ** 2
    t = nearest_place(point, first, second, length) if length > 0 else 0.0
    scaled, slope, least = 0.0, 0.0, 1e30
    for axis in range(3):
        radius = (1 - t) * first[3 + axis] + t * second[3 + axis]
        q = 0.0
        for i in range(3):
            direction = (1 - t) * first[6 + 3 * axis + i] + t * second[6 + 3 * axis + i]
            q += direction * (point[i] - (1 - t) * first[i] - t * second[i])
        scaled += (q / radius) ** 2
        slope += (q / radius**2) ** 2
        least = min(least, radius)
    if slope * least * least < 1e-12:
        return -least
    return np.sqrt(scaled / slope) * (np.sqrt(scaled) - 1)


@njit(cache=False)
def is_beyond(point, sphere, distance):  # type: ignore[no-untyped-def]
    """Whether the sphere (x, y, z, radius) lies further from the point than the distance."""
    gap = 0.0
    for i in range(3):
        gap += (point[i] - sphere[i]) ** 2
    return gap > (sphere[3] + max(distance, 0.0)) ** 2


@njit(cache=False)
def smooth_minimum(a, b, width):  # type: ignore[no-untyped-def]
    """min(a, b), rounded twice differentiably where the two differ by less than `width`."""
    if width <= 0:
        return min(a, b)
    h = max(width - abs(a - b), 0.0) / width
    return min(a, b) - h * h * h * width / 6


@njit(cache=False)
def field_at(point, packed, far):  # type: ignore[no-untyped-def]
    """The field at one point; parts too far away to change it are passed over."""
    samples, starts, rules, spheres = packed
    total, group_value, group = far, far, -1.0
    blend_before = 0.0
    for part in range(len(rules)):
        if rules[part, 1] != group:
            total = smooth_minimum(total, group_value, blend_before)
            group, group_value, blend_before = rules[part, 1], far, rules[part, 2]
        nearest = min(far, group_value + rules[part, 0], total + blend_before + rules[part, 0])
        if is_beyond(point, spheres[part], nearest):
            continue
        first, last = int(starts[part]), int(starts[part + 1]) - 1
        for j in range(first, max(last, first + 1)):
            if not is_beyond(point, samples[j, 15:], nearest):
                nearest = min(nearest, segment_distance(point, samples[j], samples[min(j + 1, last)]))
        group_value = smooth_minimum(group_value, nearest, rules[part, 0])
    return smooth_minimum(total, group_value, blend_before)


@njit(parallel=True, cache=False)
def field_values(points, packed, far):  # type: ignore[no-untyped-def]
    out = np.empty(len(points))
    for i in prange(len(points)):
        out[i] = field_at(points[i], packed, far)
    return out


@njit(parallel=True, cache=False)
def fill_grid(low, step, shape, packed, far):  # type: ignore[no-untyped-def]
    """Values on a grid; blocks of points that are clearly away from the surface get one value for all."""
    block, out = 4, np.empty((shape[0], shape[1], shape[2]), np.float32)
    for bi in prange((shape[0] + block - 1) // block):
        for bj in range((shape[1] + block - 1) // block):
            for bk in range((shape[2] + block - 1) // block):
                corner = np.array([bi, bj, bk]) * block
                end = np.minimum(corner + block, shape)
                middle = low + step * (corner + end - 1) / 2
                guess = field_at(middle, packed, far)
                for i in range(corner[0], end[0]):
                    for j in range(corner[1], end[1]):
                        for k in range(corner[2], end[2]):
                            if abs(guess) > 1.25 * block * step:
                                out[i, j, k] = guess
                            else:
                                point = low + step * np.array([i, j, k])
                                out[i, j, k] = field_at(point, packed, far)
    return out


def grid_values(
    body: Body, low: Array, step: float, shape: NDArray[np.int64], far: float
) -> NDArray[np.float32]:
    """The field at low + step * (i, j, k)."""
    return fill_grid(low, step, shape, body.packed, far)


def evaluate(body: Body, points: Array, far: float) -> Array:
    """The field at points (p, 3): negative inside, about the distance near the surface, at most `far`."""
    return field_values(points, body.packed, far)


def gradient(body: Body, points: Array, far: float) -> Array:
    """(p, 3) slopes of the field by differences to the corners of a small tetrahedron."""
    corners = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], dtype=float)
    step = far / 400
    return sum(evaluate(body, points + step * corner, far)[:, None] * corner for corner in corners) / (
        4 * step
    )


def unite(parts: Sequence[Part], **group_blend: float) -> Body:
    """A body of parts, put in the order of their groups."""
    groups = list(dict.fromkeys(p.group for p in parts))
    return Body(tuple(sorted(parts, key=lambda p: groups.index(p.group))), dict(group_blend))
