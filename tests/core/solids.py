"""Bodies as CAD programs tessellate them: large flat faces, fans and strips of slivers, needles."""

from __future__ import annotations

import manifold3d
import numpy as np

from idviewer.core import Mesh

Solid = manifold3d.Manifold


def mesh_of(solid: manifold3d.Manifold, name: str) -> Mesh:
    made = solid.to_mesh64()
    return Mesh(np.array(made.vert_properties)[:, :3], np.array(made.tri_verts).astype(int), name)


def box(*size: float) -> Mesh:
    """12 triangles."""
    return mesh_of(Solid.cube(size), "box")


def angle() -> Mesh:
    """An L: two bars that meet."""
    return mesh_of(Solid.cube((3, 1, 1)) + Solid.cube((1, 2, 1)), "L")


def cylinder(sides: int) -> Mesh:
    """Strips along the side, and a fan from the middle of each end."""
    angles = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(sides)], axis=1)
    vertices = np.concatenate([ring, ring + np.array([0, 0, 3]), [[0, 0, 0], [0, 0, 3]]])
    i, j = np.arange(sides), (np.arange(sides) + 1) % sides
    low, high = np.full(sides, 2 * sides), np.full(sides, 2 * sides + 1)
    corners = [(i, j, sides + j), (i, sides + j, sides + i), (low, j, i), (high, sides + i, sides + j)]
    return Mesh(vertices, np.concatenate([np.stack(part, axis=1) for part in corners]), "cylinder")


def plate(sides: int = 24) -> Mesh:
    """A plate with three holes, whose faces are cut into slivers between far corners."""
    made = Solid.cube((8, 4, 1))
    for x, y, radius in ((2, 2, 1.2), (5, 1.4, 0.7), (6.4, 2.8, 0.8)):
        made -= Solid.cylinder(3, radius, radius, sides).translate((x, y, -1))
    return mesh_of(made, "plate")


def needle() -> Mesh:
    """Ten thousand times as long as wide."""
    return box(1e4, 1, 1)


def turned(mesh: Mesh, seed: int = 3) -> Mesh:
    """Turned some way and kept in single precision, as STL files have it: flat faces no longer are quite."""
    rotation = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    return Mesh((mesh.vertices @ rotation.T).astype(np.float32), mesh.faces, mesh.name)
