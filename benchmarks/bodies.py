"""What is measured on: bundled shapes and others, made finer where size is the question; points inside."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from idviewer.core import InteriorDistance, Mesh, Plane, section
from idviewer.core.shapes.plane import AXES
from idviewer.core.slices import slice_mesh, spacing_for
from idviewer.session.pipeline import Pipeline
from idviewer.session.run_to_end import run_to_end
from idviewer.session.state import Query, default_plane

Floats = NDArray[np.float64]

SEED = 20090715
LAYERS = 40
LARGE = 40_000
"""Vertices from which on a body is one that the bars for 43,000 of them mean."""

PEBBLE = (1.0, 0.8, 0.6)
BUMPS = ((3.0, 1.0, 2.0), (-2.0, 4.0, 1.0), (1.0, -3.0, 4.0))
"""Half axes of an ellipsoid, and the waves of its bumps."""

WAVES = ((23.0, 31.0, 17.0), (41.0, -29.0, 37.0), (-61.0, 53.0, 47.0))
"""Bumps of a body made finer, in radians a diagonal of the bounding box."""


@dataclass(eq=False)
class Body:
    """A mesh with what several subjects measure by; each part is made when it is first asked for.

    Attributes:
        mesh: the body.
        path: its file, if it has one.
        readme: whether its rows belong into the README's table.
    """

    mesh: Mesh
    path: Path | None = None
    readme: bool = False

    @property
    def label(self) -> str:
        """Name and size."""
        return f"{self.mesh.name}, {self.size}"

    @property
    def size(self) -> str:
        """In thousands of faces."""
        return f"{len(self.mesh.faces) / 1000:,.0f}K faces"

    @property
    def large(self) -> bool:
        """Whether the bars of large bodies hold for it."""
        return len(self.mesh.vertices) >= LARGE

    @cached_property
    def solver(self) -> InteriorDistance:
        """The exact one."""
        return InteriorDistance(self.mesh, refine="no")

    @cached_property
    def pipeline(self) -> Pipeline:
        """One that has shown the default plane to the last level, as a viewer that was left alone."""
        pipeline = Pipeline()
        run_to_end(self.mesh, Query(planes=(default_plane(self.mesh),)), pipeline)
        return pipeline


def inner_points(mesh: Mesh, count: int) -> Floats:
    """(count, 3) points spread evenly over the inside."""
    axis = list(AXES)[int(np.argmax(np.ptp(mesh.bounds, axis=0)))]
    cuts = [section(mesh, Plane.along(axis, (i + 0.5) / LAYERS, mesh.bounds)) for i in range(LAYERS)]
    spacing = np.sqrt(sum(cut.area for cut in cuts) / count)
    points = np.empty((0, 3))
    while len(points) < count:
        spacing *= 0.9
        points = np.concatenate([slice_mesh(cut, spacing).node_points for cut in cuts if cut.area > 0.0])
    return np.random.default_rng(SEED).permutation(points)[:count]


def slice_points(mesh: Mesh, count: int) -> Floats:
    """(about count, 3) points of the default plane inside the mesh."""
    cut = section(mesh, default_plane(mesh))
    return slice_mesh(cut, spacing_for(cut, count)).node_points


def finer(mesh: Mesh) -> Mesh:
    """Each face cut into four by the middles of its edges, which are then smoothed."""
    corners = mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    ends, middle = np.unique(np.sort(corners, axis=1), axis=0, return_inverse=True)
    vertices = np.concatenate([mesh.vertices, mesh.vertices[ends].mean(axis=1)])
    (a, b, c), (ab, bc, ca) = mesh.faces.T, (middle.reshape(-1, 3) + len(mesh.vertices)).T
    fans = [np.stack(face, axis=1) for face in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    faces = np.stack(fans, axis=1).reshape(-1, 3)
    return Mesh(_smoothed(vertices, faces), faces, name=mesh.name)


def pebble(vertices: int) -> Mesh:
    """An ellipsoid with bumps and so many vertices, evenly spread: a compact body, which needs many modes."""
    count = np.arange(vertices) + 0.5
    # A spiral over the ball in equal steps of area; its convex hull is the mesh.
    height, turn = 1.0 - 2.0 * count / vertices, np.pi * (1.0 + math.sqrt(5.0)) * count
    ring = np.sqrt(1.0 - height**2)
    ball = np.column_stack([ring * np.cos(turn), ring * np.sin(turn), height])
    hull = ConvexHull(ball)
    outward = np.einsum("fd,fd->f", np.cross(*_sides(ball, hull.simplices)), ball[hull.simplices[:, 0]]) > 0.0
    faces = np.where(outward[:, None], hull.simplices, hull.simplices[:, ::-1]).astype(np.int64)
    bumps = 1.0 + 0.1 * np.sin(ball @ np.array(BUMPS).T).sum(axis=1, keepdims=True)
    return Mesh(ball * bumps * PEBBLE, faces, name="pebble")


def _sides(points: Floats, faces: NDArray[np.int32]) -> tuple[Floats, Floats]:
    a, b, c = (points[faces[:, i]] for i in range(3))
    return b - a, c - a


def bumpy(mesh: Mesh) -> Mesh:
    """The mesh with waves of a thousandth of its size, so that no patch of it is plane."""
    places = (mesh.vertices - mesh.bounds.mean(axis=0)) / mesh.diagonal
    shift = np.sin(places @ np.array(WAVES).T) * 3e-4 * mesh.diagonal
    return Mesh(mesh.vertices + shift, mesh.faces, name=mesh.name)


def _smoothed(vertices: Floats, faces: NDArray[np.int64]) -> Floats:
    """Each vertex half-way towards the mean of its neighbours."""
    sums, counts = np.zeros_like(vertices), np.zeros(len(vertices))
    for i, j in ((0, 1), (1, 2), (2, 0)):
        for axis in range(3):
            sums[:, axis] += np.bincount(faces[:, i], vertices[faces[:, j], axis], len(vertices))
        counts += np.bincount(faces[:, i], minlength=len(vertices))
    return 0.5 * (vertices + sums / counts[:, None])
