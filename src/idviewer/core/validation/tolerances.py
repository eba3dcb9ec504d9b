"""Tolerances of validation, always relative to the shape's own size."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ValidationTolerances:
    """Limits of what counts as different, as having an area, as enclosing a volume.

    Attributes:
        face_height: a face whose height is at most this share of its longest side has no area, and a side
            that short no length.
        gap: boundary vertices within this share of the bounding box's diagonal are taken for the same vertex.
        volume: a body whose volume is at most this share of (its area) ** 1.5 encloses nothing; a ball has
            0.09.
        smallest_extent: below it, fourth powers of lengths leave the range of floating-point numbers.
        largest_extent: above it, they do too.
        side_of_outline: neighbours nearer than this share of the bounding box's diagonal are one vertex of
            a polygon.
        area_of_loop: a polygon's loop whose area is at most this share of (its extent) ** 2, times its number
            of vertices, encloses nothing.
    """

    face_height: float = 1e-12
    gap: float = 1e-6
    volume: float = 1e-9
    smallest_extent: float = 1e-60
    largest_extent: float = 1e60
    side_of_outline: float = 1e-12
    area_of_loop: float = 1e-15


TOLERANCES = ValidationTolerances()
