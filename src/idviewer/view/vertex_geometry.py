"""A polygon's vertices without any window: which one is under the mouse, and where dragging it takes them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from idviewer.core import Polygon
from idviewer.core.arrays import Floats, in_space
from idviewer.view.camera import Projection

VERTEX_GRAB_DISTANCE_PX = 8.0
"""Largest distance, in pixels, at which the mouse hits a vertex."""
SOFT_DRAG_SHARE = 0.08
"""The share of its loop's length, to either side of a vertex, that follows it in a soft drag."""


def vertex_at(polygon: Polygon, projection: Projection, x: float, y: float) -> int | None:
    """Number of the vertex nearest to the mouse; None where none is near."""
    apart = np.hypot(*(projection.project(in_space(polygon.vertices)) - (x, y)).T)
    nearest = int(np.argmin(apart))
    return nearest if apart[nearest] <= VERTEX_GRAB_DISTANCE_PX else None


@dataclass(frozen=True)
class VertexDrag:
    """A vertex held by the mouse.

    Attributes:
        polygon: as it was when the vertex was grabbed.
        vertex: its number.
        held: (2,) the way from the mouse to the vertex.
    """

    polygon: Polygon
    vertex: int
    held: Floats

    @classmethod
    def grab(cls, polygon: Polygon, vertex: int, projection: Projection, x: float, y: float) -> VertexDrag:
        """Have the mouse at (x, y) hold a vertex."""
        return cls(polygon, vertex, polygon.vertices[vertex] - _under(projection, x, y))

    def to(self, projection: Projection, x: float, y: float, soft: bool = False) -> Floats:
        """The vertices (n, 2) when the mouse is at (x, y); in a soft drag the neighbours follow."""
        way = _under(projection, x, y) + self.held - self.polygon.vertices[self.vertex]
        if soft:
            return self.polygon.vertices + soft_drag_weights(self.polygon, self.vertex)[:, None] * way
        vertices = self.polygon.vertices.copy()
        vertices[self.vertex] += way
        return vertices


def soft_drag_weights(polygon: Polygon, vertex: int, reach: float = SOFT_DRAG_SHARE) -> Floats:
    """The share of a vertex's way that each vertex goes in a soft drag, (n,).

    1 for itself, and (1 - (s / r)^2)^2 at the distance s along the outline, which ends smoothly at r.

    Args:
        polygon: n vertices.
        vertex: which one is dragged.
        reach: r as a share of the length of the vertex's loop; one half reaches all around.
    """
    share = np.zeros(len(polygon.vertices))
    loop = next(loop for loop in polygon.loops if vertex in loop)
    loop = np.roll(loop, -int(np.flatnonzero(loop == vertex)[0]))
    ends = np.cumsum(polygon.lengths[loop])
    along = np.concatenate([[0.0], ends[:-1]])
    apart = np.minimum(along, ends[-1] - along) / (reach * ends[-1])
    share[loop] = np.maximum(1.0 - apart**2, 0.0) ** 2
    return share


def _under(projection: Projection, x: float, y: float) -> Floats:
    """The point (2,) where the line of sight meets the plane z = 0, on which it is looked straight down."""
    return np.array(projection.ray(x, y).origin[:2])
