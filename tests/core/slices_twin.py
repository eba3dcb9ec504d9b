"""Slow twins of sections and slice meshes: plain loops over all faces, edges and cells."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.plane import Plane
from idviewer.core.slices.lattice import OUTLINE_MARGIN
from idviewer.core.slices.mesh_sections import Section

Edge = tuple[int, int]


def heights_above(plane: Plane, points: np.ndarray) -> list[float]:
    """One point at a time, in the order of the axes."""
    return [
        sum((v - o) * n for v, o, n in zip(point, plane.origin, plane.normal, strict=True))
        for point in points.tolist()
    ]


def outline(mesh: Mesh, plane: Plane) -> tuple[dict[Edge, np.ndarray], list[list[Edge]]]:
    """Where each crossed edge (below, above) meets the plane; loops of such edges, the body on the left."""
    heights = heights_above(plane, mesh.vertices)
    follower: dict[Edge, Edge] = {}
    for face in mesh.faces.tolist():
        sides = list(zip(face, [*face[1:], face[0]], strict=True))
        falls = [(b, a) for a, b in sides if heights[a] > 0 >= heights[b]]
        rises = [(a, b) for a, b in sides if heights[b] > 0 >= heights[a]]
        follower.update(zip(falls, rises, strict=True))
    points = {}
    for low, high in follower:
        share = heights[low] / (heights[low] - heights[high])
        points[low, high] = (1 - share) * mesh.vertices[low] + share * mesh.vertices[high]
    loops = []
    while follower:
        at = min(follower)
        loop = []
        while at in follower:
            loop.append(at)
            at = follower.pop(at)
        loops.append(loop)
    return points, loops


def lattice_nodes(cut: Section, spacing: float) -> set[tuple[int, int]]:
    """Corners of the cells with their centre inside and no quarter-cell step of the outline near."""
    segments = [
        (cut.in_plane[a] / spacing, cut.in_plane[b] / spacing)
        for loop in cut.loops
        for a, b in zip(loop, np.roll(loop, -1), strict=True)
    ]
    low = np.floor(np.min([start for start, _ in segments], axis=0)).astype(int)
    high = np.ceil(np.max([start for start, _ in segments], axis=0)).astype(int)
    near = set()
    for start, end in segments:
        count = math.floor(np.abs(end - start).max() / OUTLINE_MARGIN) + 1
        for step in range(count):
            x, y = start + step / count * (end - start)
            near |= {
                (math.floor(x + dx), math.floor(y + dy))
                for dx in (-OUTLINE_MARGIN, OUTLINE_MARGIN)
                for dy in (-OUTLINE_MARGIN, OUTLINE_MARGIN)
            }
    full = [
        (i, j)
        for i in range(low[0], high[0])
        for j in range(low[1], high[1])
        if (i, j) not in near and inside(segments, i + 0.5, j + 0.5)
    ]
    return {(i + di, j + dj) for i, j in full for di in (0, 1) for dj in (0, 1)}


def inside(segments: list[tuple[np.ndarray, np.ndarray]], x: float, y: float) -> bool:
    """Even-odd rule, in rational numbers."""
    crossings = 0
    for start, end in segments:
        if (start[1] <= y) != (end[1] <= y):
            (ax, ay), (bx, by) = (map(Fraction, point.tolist()) for point in (start, end))
            crossings += ax + (Fraction(y) - ay) / (by - ay) * (bx - ax) < Fraction(x)
    return crossings % 2 == 1
