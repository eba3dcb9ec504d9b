"""Bodies that are not bundled: other numbers of vertices, other poses, other members of a class.

The makers of the bundled shapes (assets/) do the work; they need the package fast-simplification.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from figures.bending import Floats, Map
from figures.registry import SEED, Run
from idviewer.core import Mesh, Plane, read_mesh, sample_path, section
from idviewer.core.shapes import AXES
from idviewer.core.slices import slice_mesh

sys.path.append(str(Path(__file__).resolve().parents[2] / "assets"))

LAYERS = 40
TINY = 650
"""Vertices of a body in a test."""
METRES = 0.01
"""The hand is drawn in centimetres."""


def bundled(name: str) -> Mesh:
    """A bundled body."""
    return read_mesh(sample_path(name))


def body(run: Run, name: str) -> Mesh:
    """A bundled body, or a tiny one."""
    return tiny_body(name) if run.tiny else bundled(name)


@cache
def tiny_body(name: str) -> Mesh:
    """A bundled body with few vertices."""
    return simplified(bundled(f"{name}_2k"), TINY)


def in_pose(run: Run, name: str, pose: str) -> Mesh:
    """A bundled body in another bundled pose, with the triangles that `body` gives it at rest."""
    if not run.tiny:
        return bundled(pose)
    rest, posed, tiny = bundled(f"{name}_2k"), bundled(f"{pose}_2k"), tiny_body(name)
    nearest = cKDTree(rest.vertices).query(tiny.vertices)[1]
    return Mesh(tiny.vertices + posed.vertices[nearest] - rest.vertices[nearest], tiny.faces, name=pose)


def simplified(mesh: Mesh, count: int) -> Mesh:
    """The body with so many vertices, by quadric collapses."""
    from contour import simplify

    vertices, faces = simplify(mesh.vertices.copy(), mesh.faces.copy(), count)
    return Mesh(vertices, faces, name=mesh.name)


def moved(mesh: Mesh, by: Map) -> Mesh:
    """The body with its vertices (n, 3) moved by a map of space; the same triangles."""
    return Mesh(by(mesh.vertices), mesh.faces, name=mesh.name)


def within_plane(by: Map, along: int, across: int) -> Map:
    """A map of the plane of two axes, done to points in space; the third coordinate stays."""

    def carry(points: Floats) -> Floats:
        result = points.copy()
        result[:, [along, across]] = by(points[:, [along, across]])
        return result

    return carry


def noisy_body(mesh: Mesh, share: float) -> Mesh:
    """Vertices displaced along their normals by Gaussian noise, its deviation a share of the diagonal."""
    corners = mesh.vertices[mesh.faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(mesh.vertices)
    for corner in range(3):
        np.add.at(normals, mesh.faces[:, corner], across)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    size = np.random.default_rng(SEED).normal(0.0, share * mesh.diagonal, (len(normals), 1))
    return Mesh(mesh.vertices + size * normals, mesh.faces, name=mesh.name)


HANDS = {
    "a hand": {"spread": 1.3, "slim": 1.06},
    "stout": {"spread": 1.6, "slim": 1.3, "web": 0.8},
    "slender, spread wide": {"spread": 2.4, "slim": 0.85},
    "half closed": {"spread": 1.0, "slim": 1.06, "curl": 3.2},
}
"""Members of a class: arguments of the hand's maker in assets/bodies.py."""


def made_hand(name: str, step: float, count: int) -> Mesh:
    """One of `HANDS`, in metres, all of them in one frame: the wrist at the origin."""
    from bodies import forearm_end, hand_parts
    from contour import contour, simplify
    from field import unite

    body = unite([forearm_end("hand"), *hand_parts("hand", **HANDS[name])])
    vertices, faces = simplify(*contour(body, step, 4.0), count)
    return Mesh(METRES * vertices, faces, name=name)


def inner_points(mesh: Mesh, count: int) -> Floats:
    """(count, 3) points spread evenly over the inside, in random order."""
    axis = list(AXES)[int(np.argmax(np.ptp(mesh.bounds, axis=0)))]
    cuts = [section(mesh, Plane.along(axis, (i + 0.5) / LAYERS, mesh.bounds)) for i in range(LAYERS)]
    spacing = np.sqrt(sum(cut.area for cut in cuts) / count)
    points = np.empty((0, 3))
    while len(points) < count:
        spacing *= 0.9
        points = np.concatenate([slice_mesh(cut, spacing).node_points for cut in cuts if cut.area > 0.0])
    return np.random.default_rng(SEED).permutation(points)[:count]
