"""Union of the shells of a surface that overlap each other, by manifold3d."""

from __future__ import annotations

from typing import NamedTuple

import manifold3d
import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.shapes.solid_parts import crossings_of, simple_parts
from idviewer.core.validation.soup_repairs import volume_and_area, without_unused_vertices
from idviewer.core.validation.topology import Topology


class ShellUnion(NamedTuple):
    """A surface whose shells were united.

    Attributes:
        vertices: (n, 3).
        faces: (m, 3).
        shells: how many there were before.
        left: how many there are.
        before: the sum of the shells' volumes.
        after: the volume of the union.
        crossing: how many pairs of faces cross each other still, where no cut took a shell apart.
    """

    vertices: Floats
    faces: Ints
    shells: int
    left: int
    before: float
    after: float
    crossing: int


def unite_shells(vertices: Floats, faces: Ints) -> ShellUnion | None:
    """Unite the closed shells of a surface, each also with itself; those wound inward are taken away.

    Args:
        vertices: (n, 3).
        faces: (m, 3), all shells closed and wound alike in themselves.

    Returns:
        None where a shell is not closed, or nothing overlaps.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> both = np.concatenate([corners, corners + [0.1, 0.05, 0.02]])
    >>> found = unite_shells(both, np.concatenate([faces, faces + 4]))
    >>> found.left, found.after < found.before
    (1, True)
    """
    middle, size = vertices.mean(axis=0), float(np.linalg.norm(np.ptp(vertices, axis=0))) or 1.0
    number, of_face = Topology(faces, len(vertices)).components
    solids: list[manifold3d.Manifold] = []
    voids: list[manifold3d.Manifold] = []
    volume = 0.0
    for shell in range(number):
        own_vertices, own = without_unused_vertices((vertices - middle) / size, faces[of_face == shell])
        sign = volume_and_area(own_vertices, own)[0]
        volume += sign
        turned = own if sign > 0.0 else own[:, ::-1]
        made = manifold3d.Manifold(manifold3d.Mesh64(own_vertices, np.ascontiguousarray(turned, np.uint64)))
        if made.is_empty():
            return None
        (solids if sign > 0.0 else voids).extend(simple_parts(made))
    united = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add)
    if voids:
        united = united - manifold3d.Manifold.batch_boolean(voids, manifold3d.OpType.Add)
    if abs(united.volume() - volume) <= 1e-9 * abs(volume):
        return None
    mesh = united.to_mesh64()
    points = np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3] * size + middle
    corners = np.asarray(mesh.tri_verts).astype(np.int64)
    scale = size**3
    left = Topology(corners, len(points)).components[0]
    crossing = len(crossings_of(united))
    return ShellUnion(points, corners, number, left, volume * scale, united.volume() * scale, crossing)
