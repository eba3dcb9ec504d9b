"""The shapes: a hand, an octopus, a cat and a couple (genus 3). Lengths in metres, z up, facing -y."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from field import Array, Body, Part, ellipsoid, sweep, unite

# fmt: off
# a finger's joints from inside the palm to the tip, and its thickness; centimetres
FINGERS = [
    ([(1.2, 0.2, 2.0), (2.55, 0.25, 8.6), (3.1, -0.05, 12.6), (3.4, -0.6, 14.9), (3.5, -1.3, 16.7)], 0.98),
    ([(0.5, 0.3, 2.0), (0.6, 0.4, 9.0), (0.75, 0.1, 13.6), (0.85, -0.5, 16.3), (0.9, -1.3, 18.2)], 1.0),
    ([(-0.3, 0.3, 2.0), (-1.35, 0.25, 8.6), (-1.8, -0.1, 12.8), (-2, -0.75, 15.2), (-2.1, -1.6, 17)], 0.95),
    ([(-1.1, 0.2, 2.0), (-3.1, -0.05, 7.8), (-4.05, -0.35, 11), (-4.5, -0.85, 12.8), (-4.7, -1.4, 14)], 0.83),
]
FINGER_RADII = np.array([(1.05, 1.1), (0.98, 1.1), (0.98, 0.98), (0.92, 0.86), (0.76, 0.66)])
# an arm's heading in degrees (0 is +x), reach, lift of its middle, size of its curl, and whether it curls up
OCTOPUS_ARMS = [
    (-68, 0.20, 0.030, 0.040, True), (-25, 0.23, 0.055, 0.036, False),
    (22, 0.21, 0.020, 0.044, True), (65, 0.22, 0.050, 0.038, True),
    (112, 0.20, 0.025, 0.042, False), (158, 0.22, 0.055, 0.038, True),
    (204, 0.23, 0.015, 0.042, True), (250, 0.21, 0.060, 0.036, False),
]
# fmt: on


def hand() -> Body:
    """An open right hand, in centimetres."""
    return unite([forearm_end("hand"), *hand_parts("hand", spread=1.3, slim=1.06)])


def forearm_end(group: str) -> Part:
    points = [(0, 0.0, -5.5), (0, 0.0, -2.5), (0, 0.05, 0), (0, 0.1, 3.0)]
    return sweep(
        points,
        [(2.8, 2.15, 0.9), (2.65, 1.95, 0.9), (2.75, 1.75, 0.9), (3.0, 1.2, 0.9)],
        blend=1.0,
        group=group,
    )


def hand_parts(
    group: str, web: float = 0.6, curl: float = 1.0, spread: float = 1.0, slim: float = 1.0
) -> list[Part]:
    """A right hand, centimetres, wrist at the origin, fingers up, palm to -y, thumb to +x.

    `web` is the width over which fingers melt together, `curl` how far they bend, `spread` how far they part,
    and `slim` scales their thickness.
    """
    # fmt: off
    parts = [
        ellipsoid((0.0, 0.1, 5.2), (3.7, 1.3, 4.6), 1.2, group),
        sweep([(-1.3, -0.2, 0.6), (-2.5, -0.55, 3.6), (-2.9, -0.35, 6.6)],
              [0.7, 1.25, 0.9], blend=1.5, group=group),
        sweep([(1.0, -0.1, 0.4), (2.6, -1.0, 3.4), (4.0, -1.4, 5.7), (5.2, -1.55, 7.8)],
              [0.8, 1.65, 1.2, 0.6], blend=1.5, group=group),
        sweep([(2.7, -1.0, 3.6), (4.4, -1.5, 6.3), (5.6, -1.6, 8.5), (6.2, -1.75, 10.2)],
              [(0.8, 0.8), (1.05, 1.0), (1.1, 1.0), (0.85, 0.72)], blend=0.9, group=group),
        sweep([(4.0, -1.0, 6.0), (3.2, -0.4, 7.0), (2.4, 0.1, 8.0)],
              [(0.5, 0.5), (0.55, 0.6), (0.5, 0.6)], blend=1.6, group=group),
    ]
    # fmt: on
    fingers = [bent(points, curl, spread) for points, _ in FINGERS]
    for points, (_, thickness) in zip(fingers, FINGERS, strict=True):
        parts.append(sweep(points, list(slim * thickness * FINGER_RADII), blend=web, group=group))
    for one, other in pairwise(fingers):
        # a thick web, or the fingers would melt to a thin skin
        at = 0.5 * (0.85 * one[1] + 0.15 * one[2] + 0.85 * other[1] + 0.15 * other[2])
        parts.append(ellipsoid(at, (0.6, 0.55, 0.9), 0.8, group))
    return parts


def bent(points: list[tuple[float, float, float]], curl: float, spread: float) -> Array:
    """A finger's joints, bent and spread beyond the knuckle."""
    joints = np.array(points)
    joints[1:, 0] = joints[1, 0] + spread * (joints[1:, 0] - joints[1, 0])
    joints[1:, 1] = 0.3 + curl * (joints[1:, 1] - 0.3)
    return joints


def octopus() -> Body:
    """An octopus, 0.5 m across, its mantle leaning back and its eight arms curling at their tips."""
    parts = [
        ellipsoid((0, 0.05, 0.185), (0.068, 0.072, 0.088), 0.03, axes=tilt(-28)),
        ellipsoid((0, -0.005, 0.095), (0.056, 0.054, 0.05), 0.06),
        ellipsoid((0, 0, 0.05), (0.062, 0.062, 0.035), 0.05),
    ]
    for side in (-1, 1):
        parts.append(ellipsoid((0.045 * side, -0.036, 0.128), (0.019, 0.019, 0.022), 0.02))
    for index, (heading, reach, lift, curl, is_up) in enumerate(OCTOPUS_ARMS):
        out, up = octopus_arm(reach, lift, curl, is_up)
        around = np.radians(heading) + 0.25 * (-1) ** index * np.linspace(0, 1, len(out)) ** 2
        points = np.stack([out * np.cos(around), out * np.sin(around), up], axis=1)
        radii = 0.0065 + 0.0255 * (1 - np.linspace(0, 1, len(points))) ** 1.15
        parts.append(sweep(points, list(radii), side=(0, 0, 1), blend=0.03))
    return unite(parts)


def tilt(degrees: float) -> Array:
    """Axes turned about x; positive angles lean the top forward, to -y."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([(1, 0, 0), (0, c, s), (0, -s, c)])


def octopus_arm(reach: float, lift: float, curl: float, is_up: bool) -> tuple[Array, Array]:
    """How far out and how high an arm runs: from the body down to the floor, then a tightening spiral."""
    run, bend = np.linspace(0, 1, 6), np.linspace(0, 1, 9)[1:]
    out = 0.03 + (reach - 0.03) * run
    up = 0.055 * (1 - run) ** 2 + 0.02 + 0.6 * lift * np.sin(np.pi * run) ** 2
    angle, size = 1.45 * np.pi * bend, curl * (1 - 0.62 * bend)
    out = np.concatenate([out, reach + size * np.sin(angle)])
    rise = curl - size * np.cos(angle)
    up = np.concatenate([up, up[-1] + (rise if is_up else -rise)])
    return out, up if is_up else up + 2 * curl * np.linspace(0, 1, len(up))


def cat() -> Body:
    """A cat-like animal walking, 0.95 m from its nose to the bend of its tail."""
    # fmt: off
    parts = [
        sweep([(0, -0.20, 0.318), (0, -0.11, 0.300), (0, 0.02, 0.302), (0, 0.12, 0.314), (0, 0.21, 0.312)],
              [(0.050, 0.062), (0.063, 0.084), (0.056, 0.070), (0.051, 0.058), (0.046, 0.052)], blend=0.04),
        sweep([(0, -0.16, 0.330), (0, -0.230, 0.378), (0, -0.270, 0.412)],
              [(0.048, 0.058), (0.039, 0.047), (0.038, 0.042)], blend=0.05),
        ellipsoid((0, -0.290, 0.432), (0.052, 0.050, 0.046), 0.03),
        ellipsoid((0, -0.331, 0.417), (0.028, 0.024, 0.022), 0.03),
        ellipsoid((0, -0.349, 0.424), (0.010, 0.009, 0.008), 0.016),
        sweep([(0, 0.20, 0.325), (0, 0.28, 0.335), (0, 0.36, 0.275), (0, 0.44, 0.225), (0, 0.52, 0.245),
               (0, 0.565, 0.30), (0.01, 0.575, 0.35)],
              [0.026, 0.020, 0.0165, 0.0155, 0.015, 0.0145, 0.013], blend=0.04),
    ]
    # fmt: on
    for side in (-1, 1):
        ear = [(0.030 * side, -0.281, 0.458), (0.037 * side, -0.279, 0.482), (0.043 * side, -0.278, 0.502)]
        parts.append(sweep(ear, [(0.023, 0.013), (0.017, 0.009), (0.007, 0.006)], blend=0.02))
        parts.extend(cat_legs(side))
    return unite(parts)


def cat_legs(side: int) -> list[Part]:
    """A front and a hind leg; the left ones (+x) are set forward in front and at the back."""
    step = 0.045 * side
    # fmt: off
    front = [(0.040, -0.150, 0.310), (0.048, -0.135, 0.245), (0.047, -0.130 - 0.4 * step, 0.190),
             (0.045, -0.150 - step, 0.105), (0.044, -0.150 - 1.3 * step, 0.040)]
    hind = [(0.036, 0.190, 0.300), (0.050, 0.170 + 0.3 * step, 0.225), (0.047, 0.195 + 0.7 * step, 0.160),
            (0.044, 0.245 + step, 0.105), (0.043, 0.228 + 1.2 * step, 0.035)]
    shapes = [
        (front, [(0.030, 0.046), (0.028, 0.036), (0.024, 0.027), (0.018, 0.019), (0.017, 0.018)]),
        (hind, [(0.036, 0.056), (0.034, 0.046), (0.024, 0.028), (0.016, 0.019), (0.017, 0.018)]),
    ]
    # fmt: on
    parts = []
    for points, radii in shapes:
        x, y, _ = points[-1]
        parts.append(sweep([(side * a, b, c) for a, b, c in points], radii, blend=0.035))
        paw = [(side * x, y + 0.002, 0.022), (side * x, y - 0.03, 0.018)]
        parts.append(sweep(paw, [(0.020, 0.018), (0.023, 0.016)], blend=0.02))
    return parts


def couple() -> Body:
    """Two leaning figures that hold each other, after modern garden sculptures: three holes, 0.5 m high."""
    parts = [ellipsoid((0, 0, 0.035), (0.155, 0.095, 0.035), 0.05)]
    # fmt: off
    trunk = [(0.082, 0.012, 0.082), (0.099, 0.02, 0.15), (0.098, 0.0, 0.24), (0.078, -0.012, 0.33),
             (0.047, -0.01, 0.425)]
    radii = [(0.052, 0.056), (0.048, 0.046), (0.040, 0.038), (0.043, 0.040), (0.022, 0.022)]
    # fmt: on
    for side in (-1, 1):
        parts.append(sweep([(side * x, side * y, z) for x, y, z in trunk], radii, blend=0.05))
        parts.append(ellipsoid((side * 0.037, side * -0.008, 0.468), (0.040, 0.042, 0.050), 0.025))
    for height, bow in ((0.335, -0.050), (0.215, 0.055)):
        sag = [0.0, 0.018, 0.022, 0.014, 0.0]
        places = zip(np.linspace(-0.09, 0.09, 5), (0.0, 0.8, 1.0, 0.8, 0.0), sag, strict=True)
        arm = [(x, bow * y, height - dip) for x, y, dip in places]
        parts.append(sweep(arm, [0.027, 0.022, 0.0195, 0.022, 0.027], side=(0, 0, 1), blend=0.035))
    return unite(parts)
