"""Polygons for the window: a small star in a file, a ring, and frames of them with known values."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from tests.view.frames import Values, along_x, frame

from idviewer.core import Polygon, write_polygon
from idviewer.core.sampling import POLYGON_PLANE, SliceValues
from idviewer.core.slices.polygon_sections import polygon_section
from idviewer.core.slices.triangulation import slice_mesh
from idviewer.session.state import Frame


def star(points: int = 5, between: int = 4, name: str = "star") -> Polygon:
    """A star with its tips at radius 1, the first upwards, each edge divided evenly."""
    angles = np.pi / 2 + np.pi * np.arange(2 * points) / points
    radii = np.where(np.arange(2 * points) % 2, 0.5, 1.0)[:, None]
    corners = radii * np.column_stack([np.cos(angles), np.sin(angles)])
    shares = np.arange(between)[:, None] / between
    sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    return Polygon(np.concatenate([(1 - shares) * start + shares * end for start, end in sides]), name=name)


def write_star(folder: Path, name: str = "star.csv") -> Path:
    """A file with the star."""
    path = folder / name
    write_polygon(star(), path)
    return path


def ring(count: int = 120) -> Polygon:
    """Between the circles of radius 1 and 0.5."""
    angles = 2 * np.pi * np.arange(count) / count
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    return Polygon.of_loops([circle, 0.5 * circle], name="ring")


def coloured(polygon: Polygon, values: Values = along_x) -> SliceValues:
    """The whole polygon with values that are a formula of the position."""
    mesh = slice_mesh(polygon_section(polygon), 0.05)
    loops = tuple(loop.astype(np.int32) for loop in mesh.section.loops)
    return SliceValues(
        POLYGON_PLANE, mesh.points, mesh.triangles.astype(np.int32), values(mesh.points), loops
    )


def flat_frame(polygon: Polygon, values: Values = along_x, **changes: object) -> Frame:
    """A frame of a polygon, from -1 to 1."""
    made: dict[str, object] = {"value_range": (-1.0, 1.0)}
    return frame(polygon, coloured(polygon, values), **(made | changes))  # type: ignore[arg-type]
