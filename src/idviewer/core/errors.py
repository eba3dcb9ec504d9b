"""The errors of the library: one line each, which says what is wrong, where, and what to do."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Part:
    """One of several shapes in a file.

    Attributes:
        name: by which it is chosen: an id, a label's number, the name of a feature.
        description: of it in a few words, such as its size; may be empty.
    """

    name: str
    description: str = ""


class ShapeError(ValueError):
    """A shape that cannot be read or used; one line says what is wrong, where, and what to do.

    Attributes:
        parts: the shapes in a file that holds several, where choosing one is the way out; else empty.
    """

    parts: tuple[Part, ...] = ()

    def with_parts(self, parts: tuple[Part, ...]) -> ShapeError:
        """This error, naming the shapes to choose from.

        Args:
            parts: the shapes, in the file's order.
        """
        self.parts = parts
        return self


class DistanceError(ValueError):
    """A boundary distance that a shape cannot have, or that is given wrongly; one line says why."""
