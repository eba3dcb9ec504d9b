"""Frames whose every value is known: sections of spheres, with values that are formulas of the position."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import trimesh
from numpy.typing import NDArray

from idviewer.core import Mesh, Plane
from idviewer.core.sampling import SliceValues
from idviewer.session.state import Frame, Query, State

Floats = NDArray[np.float64]
Values = Callable[[Floats], Floats]

FACING = Plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
"""The plane through the middle that is seen face on from +z."""


def sphere(radius: float = 1.0, centre: tuple[float, float, float] = (0.0, 0.0, 0.0), level: int = 4) -> Mesh:
    """A sphere of 20 * 4**level triangles, its vertices exactly on it."""
    ball = trimesh.creation.icosphere(subdivisions=level, radius=1.0)
    return Mesh(radius * ball.vertices + np.array(centre), ball.faces, name="sphere")


def from_centre(points: Floats) -> Floats:
    """Distance from the origin."""
    return np.linalg.norm(points, axis=1)


def along_x(points: Floats) -> Floats:
    """The first coordinate."""
    return points[:, 0].copy()


def disc(
    plane: Plane = FACING, radius: float = 1.0, values: Values = from_centre, rings: int = 40
) -> SliceValues:
    """A disc around the plane's origin, sampled on rings of six times as many points."""
    counts = 6 * np.arange(1, rings + 1)
    radii = np.repeat(radius * np.arange(1, rings + 1) / rings, counts)
    angles = np.concatenate([2 * np.pi * np.arange(count) / count for count in counts])
    flat = np.vstack([[0.0, 0.0], np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])])
    first, second = plane.basis
    points = np.array(plane.origin) + flat[:, :1] * first + flat[:, 1:] * second
    outline = np.arange(len(points) - counts[-1], len(points), dtype=np.int32)
    return SliceValues(plane, points, _ring_triangles(counts), values(points), (outline,))


def _ring_triangles(counts: NDArray[np.int64]) -> NDArray[np.int32]:
    """Triangles between each ring and the next one inside, whose six sectors have one point less."""
    triangles = []
    starts = np.concatenate([[1], 1 + np.cumsum(counts)])
    for ring, (start, count) in enumerate(zip(starts[:-1], counts, strict=True)):
        inner, inner_count = (int(starts[ring - 1]), int(counts[ring - 1])) if ring else (0, 1)
        for sector in range(6):
            for step in range(ring + 1):
                outer = start + (sector * (ring + 1) + np.array([step, step + 1])) % count
                near = inner + (sector * ring + np.array([step, step + 1])) % inner_count
                triangles.append([outer[0], outer[1], near[0]])
                if step < ring:
                    triangles.append([near[0], outer[1], near[1]])
    return np.array(triangles, np.int32)


def frame(
    mesh: Mesh, *slices: SliceValues, value_range: tuple[float, float] = (0.0, 1.0), **changes: object
) -> Frame:
    """A frame of these slices with its source and barycentroid at the origin."""
    made = Frame(
        shape=mesh,
        query=Query(planes=tuple(section.plane for section in slices), source=(0.0, 0.0, 0.0)),
        slices=slices,
        level=0,
        exact=True,
        error=0.0,
        source=np.zeros(3),
        barycentroid=np.zeros(3),
        value_range=value_range,
        title="Distance (test)",
    )
    return replace(made, **changes)  # type: ignore[arg-type]


def shown(mesh: Mesh, **fields: object) -> State:
    """A state that shows nothing but what is asked for."""
    plain = {"isolines": 0, "opacity": 0.0, "scale_bar": False}
    return State(shape=mesh).with_(**(plain | fields))
