"""Coordinates and planes as the panel writes them."""

from __future__ import annotations

import math
from collections.abc import Iterable

from idviewer.core import Plane

MOST_DIGITS = 17
"""That a float has."""


def format_coordinate(value: float, size: float) -> str:
    """A coordinate in six digits, without the noise of a number that is zero against the shape's size.

    >>> format_coordinate(1 / 3, 2.0), format_coordinate(-1e-12, 2.0), format_coordinate(1e6 + 1 / 3, 2.0)
    ('0.333333', '0', '1000000.333')
    """
    if abs(value) < 1e-7 * size:
        return "0"
    digits = min(max(6, math.ceil(math.log10(abs(value)) - math.log10(size)) + 4), MOST_DIGITS)
    return f"{value:.{digits}g}"


def format_point(point: Iterable[float], unit: str) -> str:
    """A point in four digits, with the unit of its coordinates where that is known.

    >>> format_point((1.0, 2.5), "mm"), format_point((1.0, 1 / 3, 0.0), "")
    ('(1, 2.5) mm', '(1, 0.3333, 0)')
    """
    return in_unit(f"({', '.join(f'{value:.4g}' for value in point)})", unit)


def in_unit(text: str, unit: str) -> str:
    """A text with a unit behind it, where there is one.

    >>> in_unit("4.2", "mm"), in_unit("4.2", "")
    ('4.2 mm', '4.2')
    """
    return f"{text} {unit}" if unit else text


def format_plane(plane: Plane, size: float) -> str:
    """The plane as `Plane.parse` reads it; size is the shape's.

    >>> format_plane(Plane((0.5, 0, 1e-12), (0, 0, 1)), 2.0)
    '0.5,0,0/0,0,1'
    """
    return "/".join(
        ",".join(format_coordinate(value, scale) for value in part)
        for part, scale in ((plane.origin, size), (plane.normal, 1.0))
    )
