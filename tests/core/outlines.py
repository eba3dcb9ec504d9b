"""Small polygons for tests."""

from __future__ import annotations

import numpy as np

from idviewer.core import Polygon

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def circle(count: int, radius: float = 1.0, centre: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    angles = 2.0 * np.pi * np.arange(count) / count
    return np.array(centre) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def regular(sides: int) -> Polygon:
    return Polygon(circle(sides))


def flower(count: int, petals: int = 5, depth: float = 0.35) -> Polygon:
    """Smooth, concave, without mirror symmetry, its vertices at unequal distances."""
    angles = 2.0 * np.pi * (np.arange(count) / count) ** 1.1
    radii = 1.0 + depth * np.cos(petals * angles) + 0.2 * np.sin(angles)
    return Polygon(np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1), name="flower")


def with_holes() -> Polygon:
    """A round plate with three holes of different size."""
    holes = [circle(12, 0.2, (0.45, 0.1)), circle(9, 0.15, (-0.4, 0.3)), circle(15, 0.25, (-0.1, -0.5))]
    return Polygon.of_loops([circle(60), *holes], name="plate")


def shortest_paths(polygon: Polygon) -> np.ndarray:
    """(n, n) lengths of the shortest paths along loops and bridges, with every vertex tried on the way."""
    result = np.full((len(polygon.vertices),) * 2, np.inf)
    np.fill_diagonal(result, 0.0)
    for ends, lengths in ((polygon.edges, polygon.lengths), (polygon.bridges, polygon.bridge_lengths)):
        result[ends[:, 0], ends[:, 1]] = result[ends[:, 1], ends[:, 0]] = lengths
    for way in range(len(result)):
        np.minimum(result, result[:, [way]] + result[way], out=result)
    return result


def staircase(steps: int) -> Polygon:
    """Axis-parallel edges only, many of them on common lines."""
    corners = [(0.0, 0.0), (float(steps), 0.0)]
    for step in range(steps, 0, -1):
        corners += [(float(step), float(steps - step + 1)), (float(step - 1), float(steps - step + 1))]
    return Polygon(corners)
