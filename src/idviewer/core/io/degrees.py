"""Degrees of longitude and latitude: told from lengths, and projected about their middle."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.io.outlines import Outline

EQUATORIAL_RADIUS = 6_378_137.0
"""Of the ellipsoid of WGS 84, in metres."""

ECCENTRICITY_SQUARED = 6.694_379_990_14e-3
"""Of the same ellipsoid."""


@dataclass(frozen=True)
class DegreeSettings:
    """Settings by which numbers are taken for degrees where a file does not say.

    Attributes:
        decimals: a drawing has so many digits behind the point at most; a place on Earth has more.
        most_stretch: share by which projected lengths may be off without a word.
    """

    decimals: int = 3
    most_stretch: float = 1e-4


DEGREES = DegreeSettings()


def projected(outline: Outline) -> Outline:
    """Project degrees of longitude and latitude to metres about the middle of an outline.

    The projection is the equirectangular one: a degree is as long everywhere as it is in the middle, on the
    ellipsoid of WGS 84, with the radii of curvature M along the meridian and N across it.

    Args:
        outline: in degrees.

    >>> square = np.array([[7.0, 60.0], [7.02, 60.0], [7.02, 60.01], [7.0, 60.01]])
    >>> [round(size) for size in projected(Outline((square,))).extent]
    [1116, 1114]
    """
    points = np.concatenate(outline.loops)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2.0
    latitude = np.radians(middle[1])
    flattening = 1.0 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2
    across = EQUATORIAL_RADIUS / np.sqrt(flattening)
    along = across * (1.0 - ECCENTRICITY_SQUARED) / flattening
    metres = np.radians([across * np.cos(latitude), along])
    note = (
        "Degrees of longitude and latitude were projected to metres about their middle, "
        f"{middle[0]:.6g}, {middle[1]:.6g}{_stretch(low[1], high[1], latitude)}."
    )
    loops = tuple((loop - middle) * metres for loop in outline.loops)
    return replace(outline, loops=loops, notes=(*outline.notes, note))


def _stretch(low: float, high: float, latitude: float) -> str:
    """By how much lengths from west to east are off at the ends, in words; empty if hardly."""
    ratios = np.cos(np.radians([low, high])) / np.cos(latitude)
    worst = float(np.abs(1.0 / np.maximum(ratios, 1e-6) - 1.0).max())
    if worst <= DEGREES.most_stretch:
        return ""
    return f", so that lengths from west to east are off by up to {100 * worst:.2g} % at its ends"


def system_is_degrees(name: str, points: Floats) -> bool | None:
    """Whether a named system of coordinates has degrees; None where the name does not tell.

    Args:
        name: such as "urn:ogc:def:crs:OGC:1.3:CRS84" or "EPSG:25832".
        points: (n, 2) coordinates; the geographic systems of the EPSG are among its numbers 4,000 to 4,999,
            with few others, whose coordinates are large.

    >>> [system_is_degrees(name, np.ones((1, 2))) for name in ("EPSG:4326", "EPSG:25832", "local")]
    [True, False, None]
    """
    if re.search(r"CRS:?(84|83|27)\b|WGS ?84$", name, re.IGNORECASE):
        return True
    code = re.search(r"EPSG:.*?(\d+)$", name, re.IGNORECASE)
    if code is None:
        return None
    return 4000 <= int(code[1]) < 5000 and within_degrees(points)


def within_degrees(points: Floats) -> bool:
    """Whether all points (n, 2) lie within 180 degrees of longitude and 90 of latitude.

    >>> within_degrees(np.array([[180.0, -90.0]])), within_degrees(np.array([[7.0, 91.0]]))
    (True, False)
    """
    return bool((np.abs(points) <= [180.0, 90.0]).all())


def why_lengths(outlines: Sequence[Outline]) -> str:
    """Why numbers in a format of degrees are taken for lengths all the same; empty where they are degrees.

    Numbers out of range are none. A drawing lies about the origin, which is in the sea: its box holds the
    origin, or is nearer to it than it is wide, with short numbers.

    Args:
        outlines: all of the file.

    >>> square = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]])
    >>> [bool(why_lengths([Outline((square + shift,))])) for shift in (0.0, 1.0, 40.0, 400.0)]
    [True, True, False, True]
    """
    points = np.concatenate([loop for one in outlines for loop in one.loops])
    if not within_degrees(points):
        return "some lie beyond 180 or 90"
    low, high = points.min(axis=0), points.max(axis=0)
    away = float(np.linalg.norm(np.maximum(np.maximum(low, -high), 0.0)))
    short = np.allclose(points, np.round(points, DEGREES.decimals), rtol=0.0, atol=1e-9)
    if away == 0.0 or (short and away <= float(np.linalg.norm(high - low))):
        return "they lie about the origin, as those of a drawing do"
    return ""
