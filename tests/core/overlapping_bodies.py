"""Closed surfaces that overlap themselves, as (vertices, faces): tubes along curves, boxes, folds."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from tests.core import shapes
from tests.core.shapes import Arrays


def tube(curve: np.ndarray, radius: float, sides: int = 8, along: np.ndarray | None = None) -> Arrays:
    """A tube of a radius along a curve (c, 3) in a plane z = const, capped; along are its tangents."""
    along = np.gradient(curve, axis=0) if along is None else along
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    across = np.cross([0.0, 0.0, 1.0], along)
    angles = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    rings = (
        curve[:, None]
        + radius * np.cos(angles)[:, None] * across[:, None]
        + radius * np.sin(angles)[:, None] * np.array([0.0, 0.0, 1.0])
    )
    count = len(curve)
    row, column = (
        part.ravel() for part in np.meshgrid(np.arange(count - 1), np.arange(sides), indexing="ij")
    )
    a, b = row * sides + column, row * sides + (column + 1) % sides
    side = np.concatenate([np.column_stack([a, b, b + sides]), np.column_stack([a, b + sides, a + sides])])
    rim, end = np.arange(sides), (count - 1) * sides
    first = np.column_stack([np.roll(rim, -1), rim, np.full(sides, count * sides)])
    last = np.column_stack([rim + end, np.roll(rim, -1) + end, np.full(sides, count * sides + 1)])
    faces = np.concatenate([side, first, last])
    return np.concatenate([rings.reshape(-1, 3), curve[[0, -1]]]), faces


def bent_tube(turns: float, sections: int = 24, sides: int = 6) -> Arrays:
    """A tube bent to a circle: beyond one turn its ends overlap; at one turn exactly they touch."""
    angle = np.linspace(0.0, 2 * np.pi * turns, sections)
    circle, tangents = (np.column_stack([np.cos(a), np.sin(a), 0 * a]) for a in (angle, angle + np.pi / 2))
    return tube(2.0 * circle, 0.5, sides, tangents)


def crossing_arms(sections: int = 25) -> Arrays:
    """A tube along a curve that crosses itself: two arms of one body pass through each other."""
    t = np.linspace(-1.3, 1.3, sections)
    return tube(np.column_stack([3.0 * (t**3 - t), 3.0 * t**2, 0 * t]), 0.3, 6)


def spindle_torus() -> Arrays:
    """A torus whose tube is wider than its ring: about the axis everything is covered twice."""
    return shapes.torus(16, 10, ring=0.5, tube=0.8)


def dented_through() -> Arrays:
    """A ball dented so deep that the dent comes out on the other side, where the surface is inside out."""
    vertices, faces = shapes.icosphere(2)
    dent = np.exp(-((vertices[:, 0] ** 2 + vertices[:, 1] ** 2) / 0.15)) * (vertices[:, 2] > 0.0)
    return vertices - 2.5 * dent[:, None] * [0.0, 0.0, 1.0], faces


def pushed_boxes(depth: float = 0.3) -> Arrays:
    """A square frame of beams in one piece, the end of the last beam pushed into the side of the first."""
    corners = np.array([[-1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 3.0, 0.0], [0.0, 3.0, 0.0]])
    corners = np.concatenate([corners, [[0.0, 0.5**0.5 * 0.5 - depth, 0.0]]])
    parts = [np.linspace(a, b, 5, endpoint=False) for a, b in pairwise(corners)]
    return tube(np.concatenate([*parts, corners[-1:]]), 0.5, 4)


OVERLAPPING = {
    "bent tube": bent_tube(1.02),
    "crossing arms": crossing_arms(),
    "spindle torus": spindle_torus(),
    "pushed boxes": pushed_boxes(),
    "dented through": dented_through(),
}
