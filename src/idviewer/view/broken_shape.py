"""Broken shape: a body that is no mesh, as far as the picture and its camera ask for a shape."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from idviewer.core.shapes import Health
from idviewer.core.validation import FileNumbering


@dataclass(frozen=True, eq=False)
class BrokenShape:
    """A body that was refused: it can be looked at, and nothing can be computed on it."""

    dimension: ClassVar[int] = 3

    health: Health
    notes: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """For titles."""
        return self.health.body.name

    @property
    def numbering(self) -> FileNumbering:
        """Which vertex of the file became which of these."""
        return self.health.outcome.report.numbering

    @property
    def unit(self) -> str:
        """Unit of the coordinates; empty where it is not known."""
        return self.health.body.unit

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Vertices (n, 3) of the surface."""
        return self.health.vertices

    @property
    def edges(self) -> NDArray[np.int64]:
        """Vertices (e, 2) of each edge."""
        return self.health.outcome.report.topology.ends

    @property
    def facets(self) -> NDArray[np.int64]:
        """Vertices (m, 3) of each triangle."""
        return self.health.faces

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest corner of the bounding box, (2, 3)."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @cached_property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal."""
        return float(np.linalg.norm(self.bounds[1] - self.bounds[0]))
