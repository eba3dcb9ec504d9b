"""Component: one of the pieces of a mesh, with the voids in it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Component:
    """One of the pieces of a mesh: an outer shell, and the shells of the voids in it.

    Attributes:
        number: by which it is chosen, 1 for that of the largest volume.
        faces: how many, those around its voids too.
        volume: that it encloses, voids not counted; of a surface that is not closed, some figure of its size.
        voids: how many shells lie directly inside the outer one.

    >>> str(Component(2, 120, 26.0, 1))
    '2: volume 26, 120 faces, 1 void'
    """

    number: int
    faces: int
    volume: float
    voids: int = 0

    def __str__(self) -> str:
        voids = "" if not self.voids else f", {self.voids:,} {'void' if self.voids == 1 else 'voids'}"
        return f"{self.number}: volume {self.volume:.4g}, {self.faces:,} faces{voids}"
