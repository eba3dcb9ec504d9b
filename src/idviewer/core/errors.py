"""The errors of the library: one line each, which says what is wrong, where, and what to do."""

from __future__ import annotations


class ShapeError(ValueError):
    """A shape that cannot be read or used; one line says what is wrong, where, and what to do."""


class DistanceError(ValueError):
    """A boundary distance that a shape cannot have, or that is given wrongly; one line says why."""
