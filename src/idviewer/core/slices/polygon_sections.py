"""A whole polygon as a section: what colours the slices of a body colours a polygon too."""

from __future__ import annotations

import math

import numpy as np

from idviewer.core.shapes.plane import Plane
from idviewer.core.shapes.polygon import Polygon
from idviewer.core.shapes.shape import PolygonLike, as_polygon
from idviewer.core.slices.mesh_sections import Section

UPWARD = (0.0, 0.0, 1.0)


def polygon_section(polygon: PolygonLike, longest: float = math.inf) -> Section:
    """The polygon in the plane z = 0, as if that were the section of a body.

    Its outline points lie on the polygon's edges, edge by edge: first the vertex that it starts from (with
    fraction 0, and exactly where it is), then those that divide it evenly. So `Section.interpolate` carries
    values at the polygon's vertices to the outline exactly, and `slice_mesh` fills it with a lattice.

    Args:
        polygon: n vertices.
        longest: edges longer than this are divided; by default none is, and outline point i is vertex i.

    Raises:
        ValueError: longest is not positive.

    >>> square = polygon_section(Polygon([[0, 0], [1, 0], [1, 1], [0, 1]]), 0.5)
    >>> square.area, len(square.in_plane), square.fractions[:3].tolist()
    (1.0, 8, [0.0, 0.5, 0.0])
    """
    polygon = as_polygon(polygon)
    if not longest > 0.0:
        raise ValueError(f"edges can be no longer than a positive length, and not than {longest}")
    plane = Plane((*_origin(polygon), 0.0), UPWARD)
    parts = np.ceil(polygon.lengths / longest).astype(np.int64).clip(min=1)
    first = np.cumsum(parts) - parts
    edge = np.repeat(np.arange(len(parts)), parts)
    fractions = (np.arange(len(edge)) - first[edge]) / parts[edge]
    edges = polygon.edges[edge]
    share = fractions[:, None]
    near = polygon.vertices - np.array(plane.origin[:2])
    in_plane = ((1.0 - share) * near[edges[:, 0]] + share * near[edges[:, 1]]) @ plane.basis[:, :2].T
    within = [np.arange(start, start + count) for start, count in zip(first, parts, strict=True)]
    loops = tuple(np.concatenate([within[vertex] for vertex in loop]) for loop in polygon.loops)
    return Section(plane, edges, fractions, in_plane, loops)


def _origin(polygon: Polygon) -> tuple[float, float]:
    """Zero if that is near, else a corner of the box: no difference from it is rounded (Sterbenz)."""
    x, y = (_nearest(float(low), float(high)) for low, high in polygon.bounds.T)
    return x, y


def _nearest(low: float, high: float) -> float:
    if low > high - low:
        return low
    return high if -high > high - low else 0.0
