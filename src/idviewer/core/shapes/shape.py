"""Shape: what triangle meshes in space and polygons in the plane share."""

from __future__ import annotations

from typing import ClassVar, Protocol

from idviewer.core.arrays import Floats, Ints


class Shape(Protocol):
    """A boundary with vertices, and the interior that it encloses.

    Attributes:
        dimension: of the space, 2 or 3.
        name: for titles.
    """

    dimension: ClassVar[int]

    @property
    def name(self) -> str:
        """For titles; file name without its suffix."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What was repaired when it was read, one sentence each."""

    @property
    def vertices(self) -> Floats:
        """(n, dimension), read-only."""

    @property
    def edges(self) -> Ints:
        """(e, 2) vertices of each edge of the boundary."""

    @property
    def facets(self) -> Ints:
        """(f, dimension) vertices of each piece of the boundary: triangles in space, edges in the plane."""

    @property
    def bounds(self) -> Floats:
        """(2, dimension) lowest and highest corner of the bounding box."""

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal."""
