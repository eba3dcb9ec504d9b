"""Make the bundled polygons: `python assets/make_polygons.py [FOLDER]` writes there, or beside this script.

Needs the package; contourpy comes with matplotlib. Running it again gives the same bytes.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Callable
from pathlib import Path

import contourpy
import numpy as np

from idviewer.core import Polygon, write_polygon

Array = np.ndarray

STEP = 0.004
"""Of the grid on which fields are contoured."""

BLEND = 0.09
"""Over this length limbs melt into each other."""


def main(folder: Path) -> None:
    for name, (make, count) in SHAPES.items():
        polygon = rounded(Polygon.of_loops(make()).resampled(count))
        write_polygon(polygon, folder / f"{name}.csv")
        print(f"{name:20s} {len(polygon.vertices):4d} vertices  area {polygon.area:.4f}")


def rounded(polygon: Polygon) -> Polygon:
    """With five digits, which a file of a few kilobytes holds."""
    return polygon.with_vertices(np.round(polygon.vertices, 5) + 0.0)


def blob() -> list[Array]:
    """A circle with a few low waves."""
    angle = circle_of_angles(2000)
    radius = 0.5 + 0.11 * np.cos(2 * angle + 0.4) + 0.07 * np.cos(3 * angle - 1.0) + 0.03 * np.cos(5 * angle)
    return [polar(radius, angle)]


def bay(depth: float) -> list[Array]:
    """A square, cut in from above: the deeper, the nearer it comes to a U."""
    low = 1.0 - depth
    corners = [(0, 0), (1, 0), (1, 1), (0.58, 1), (0.58, low), (0.42, low), (0.42, 1), (0, 1)]
    return [np.array(corners, dtype=float)]


def star() -> list[Array]:
    """Five points."""
    angle = circle_of_angles(10) + np.pi / 2
    return [polar(np.where(np.arange(10) % 2 == 0, 0.55, 0.22), angle)]


def ring() -> list[Array]:
    """A disc with a round hole beside its middle."""
    angle = circle_of_angles(2000)
    return [polar(np.full(2000, 0.5), angle), np.array([0.12, 0.0]) + polar(np.full(2000, 0.22), angle)]


def plate() -> list[Array]:
    """An oblong with three holes, each of another shape."""
    angle = circle_of_angles(2000)
    outer = np.stack([powered(np.cos(angle), 0.5) * 0.65, powered(np.sin(angle), 0.5) * 0.4], axis=1)
    bean = polar(0.11 + 0.035 * np.cos(3 * angle), angle)
    slit = np.stack([0.035 * np.cos(angle), 0.22 * np.sin(angle)], axis=1)
    disc = polar(np.full(2000, 0.12), angle)
    return [outer, np.add(bean, (-0.4, 0.1)), np.add(slit, (-0.05, 0.0)), np.add(disc, (0.32, -0.12))]


def gingerbread(left_arm: float, right_arm: float, left_leg: float, right_leg: float) -> list[Array]:
    """A head, a body and four limbs, each at its angle (degrees, 0 to the right, 90 upward)."""
    limbs = [limb((0.0, 0.36), (0.0, 0.36), 0.16), limb((0.0, 0.08), (0.0, -0.12), 0.15)]
    for shoulder, angle in (((-0.1, 0.13), left_arm), ((0.1, 0.13), right_arm)):
        limbs.append(limb(shoulder, reach(shoulder, angle, 0.32), 0.075))
    for hip, angle in (((-0.08, -0.16), left_leg), ((0.08, -0.16), right_leg)):
        limbs.append(limb(hip, reach(hip, angle, 0.36), 0.09))
    return outline(melted(limbs), 0.75)


def spiral() -> list[Array]:
    """A band that winds inward in two and a half turns."""
    angle = np.linspace(0.9 * np.pi, 6.0 * np.pi, 160)
    return outline(nearest(polar(0.03 * angle, angle), 0.055), 0.8)


def snake() -> list[Array]:
    """A corridor that goes to and fro."""
    rows = [(side, 0.17 * row) for row in range(6) for side in ((-0.5, 0.5) if row % 2 == 0 else (0.5, -0.5))]
    middle = np.array(rows) - [0.0, 0.425]
    return [np.concatenate([beside(middle, 0.05), beside(middle, -0.05)[::-1]])]


def beside(points: Array, away: float) -> Array:
    """A broken line moved to its left, with mitred corners."""
    along = np.diff(points, axis=0)
    along /= np.linalg.norm(along, axis=1)[:, None]
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    before, after = np.vstack([normal[:1], normal]), np.vstack([normal, normal[-1:]])
    return points + away * (before + after) / (1.0 + np.sum(before * after, axis=1))[:, None]


def limb(start: tuple[float, float], end: tuple[float, float], radius: float) -> Callable[[Array], Array]:
    """Distance from a stroke with round ends, negative inside."""
    first, along = np.array(start), np.subtract(end, start)

    def field(points: Array) -> Array:
        to = points - first
        share = np.clip(to @ along / max(along @ along, 1e-30), 0.0, 1.0)
        return np.linalg.norm(to - share[..., None] * along, axis=-1) - radius

    return field


def nearest(points: Array, radius: float) -> Callable[[Array], Array]:
    """Distance from a broken line drawn with a round pen."""
    strokes = [limb(tuple(a), tuple(b), radius) for a, b in itertools.pairwise(points)]
    return lambda places: np.min([stroke(places) for stroke in strokes], axis=0)


def melted(fields: list[Callable[[Array], Array]]) -> Callable[[Array], Array]:
    """Bodies joined with fillets, by a polynomial smooth minimum."""

    def field(points: Array) -> Array:
        result = fields[0](points)
        for other in (item(points) for item in fields[1:]):
            share = np.clip(0.5 + 0.5 * (other - result) / BLEND, 0.0, 1.0)
            result = other + share * (result - other) - BLEND * share * (1.0 - share)
        return result

    return field


def outline(field: Callable[[Array], Array], reach: float) -> list[Array]:
    """Where a field is zero within a square about the origin: one loop."""
    ticks = np.arange(-reach, reach + STEP, STEP)
    x, y = np.meshgrid(ticks, ticks)
    lines = contourpy.contour_generator(x, y, field(np.stack([x, y], axis=-1))).lines(0.0)
    (loop,) = [line for line in lines if len(line) > 3]
    # Where the contour passes near a grid point it has two points next to each other.
    apart = np.linalg.norm(np.diff(loop, axis=0), axis=1) > 0.1 * STEP
    return [loop[:-1][apart]]


def reach(start: tuple[float, float], degrees: float, length: float) -> tuple[float, float]:
    angle = np.radians(degrees)
    return start[0] + length * float(np.cos(angle)), start[1] + length * float(np.sin(angle))


def polar(radius: Array, angle: Array) -> Array:
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def powered(values: Array, power: float) -> Array:
    return np.sign(values) * np.abs(values) ** power


def circle_of_angles(count: int) -> Array:
    return 2.0 * np.pi * np.arange(count) / count


SHAPES: dict[str, tuple[Callable[[], list[Array]], int]] = {
    "blob": (blob, 200),
    "star": (star, 200),
    "bay_1": (lambda: bay(0.15), 240),
    "bay_2": (lambda: bay(0.5), 240),
    "bay_3": (lambda: bay(0.85), 240),
    "gingerbread": (lambda: gingerbread(195, -15, 250, 290), 300),
    "gingerbread_waving": (lambda: gingerbread(225, 28, 262, 318), 300),
    "spiral": (spiral, 400),
    "snake": (snake, 400),
    "ring": (ring, 220),
    "plate": (plate, 320),
}

if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
