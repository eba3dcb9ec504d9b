"""Coordinates and planes as the panel writes them."""

from __future__ import annotations

import math

from idviewer.core import Plane


def format_coordinate(value: float, size: float) -> str:
    """A coordinate in six digits, without the noise of a number that is zero against the shape's size.

    >>> format_coordinate(1 / 3, 2.0), format_coordinate(-1e-12, 2.0), format_coordinate(1e6 + 1 / 3, 2.0)
    ('0.333333', '0', '1000000.333')
    """
    if abs(value) < 1e-7 * size:
        return "0"
    digits = max(6, math.ceil(math.log10(abs(value) / size)) + 4)
    return f"{value:.{digits}g}"


def format_plane(plane: Plane, size: float) -> str:
    """The plane as `Plane.parse` reads it; size is the shape's.

    >>> format_plane(Plane((0.5, 0, 1e-12), (0, 0, 1)), 2.0)
    '0.5,0,0/0,0,1'
    """
    return "/".join(
        ",".join(format_coordinate(value, scale) for value in part)
        for part, scale in ((plane.origin, size), (plane.normal, 1.0))
    )
