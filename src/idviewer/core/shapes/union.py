"""Union of a body that overlaps itself: the surface around what it covers, and what that changes."""

from __future__ import annotations

import itertools
from dataclasses import asdict, dataclass
from typing import Any

import manifold3d
import numpy as np

from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.mesh_repair import repair_mesh
from idviewer.core.shapes.shape import MeshLike, as_mesh
from idviewer.core.validation.self_intersections import SelfIntersections, self_intersections_of
from idviewer.core.validation.topology import Topology

CUTS = tuple(itertools.product(range(3), (0.3, 0.5, 0.7)))
"""Axes of the planes that a part is tried to be cut by, and where in its box they lie."""

DEEPEST_CUT = 8
"""A part is cut so many times at most."""


@dataclass(frozen=True)
class Sizes:
    """Sizes of a mesh.

    Attributes:
        vertices, faces: how many.
        genus: handles of the surface.
        volume: that it encloses; what is covered twice counts twice.
        self_intersections: pairs of faces that cross.
    """

    vertices: int
    faces: int
    genus: int
    volume: float
    self_intersections: int

    @classmethod
    def of(cls, mesh: Mesh) -> Sizes:
        """Those of a mesh."""
        topology = Topology(mesh.faces, len(mesh.vertices))
        fans, (parts, _) = len(topology.vertex_fans()), topology.components
        genus = (2 * parts - (fans - len(topology.ends) + len(mesh.faces))) // 2
        return cls(len(mesh.vertices), len(mesh.faces), genus, mesh.volume, len(mesh.self_intersections))


@dataclass(frozen=True)
class Union:
    """A body united with itself, and what that changed.

    Attributes:
        mesh: the surface around everything that the given one goes round at least once.
        before, after: sizes of the given mesh and of this one.
    """

    mesh: Mesh
    before: Sizes
    after: Sizes

    @property
    def report(self) -> str:
        """The changes in one sentence."""
        changes = [
            f"{name} {getattr(self.before, name):,} -> {getattr(self.after, name):,}"
            for name in ("vertices", "faces", "genus")
        ]
        volume = f"volume {self.before.volume:.6g} -> {self.after.volume:.6g}"
        return f"united with itself where it overlapped: {', '.join([*changes, volume])}"

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers, for JSON."""
        return {"before": asdict(self.before), "after": asdict(self.after)}


def unite_mesh(mesh: MeshLike) -> Union:
    """Unite a body with itself: what its surface covers twice is covered once, and no face crosses another.

    The body is cut by planes until no part overlaps itself, parts that are inside out are left out, and the
    others are united by manifold3d. The new surface bounds all that the old one goes round at least once.

    Args:
        mesh: the body, or its `(vertices, faces)`.

    Raises:
        MeshError: parts overlap themselves however they are cut, or what is left is no single body.

    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> unite_mesh((corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])).after.faces
    4
    """
    mesh = as_mesh(mesh)
    before = Sizes.of(mesh)
    if not mesh.self_intersections:
        return Union(mesh, before, before)
    name, unit = f"{mesh.name}: " if mesh.name else "", mesh.diagonal
    corners = manifold3d.Mesh64((mesh.vertices - mesh.centre) / unit, mesh.faces.astype(np.uint64))
    parts: list[manifold3d.Manifold] = []
    _cut(manifold3d.Manifold(corners), DEEPEST_CUT, parts)
    united = manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add)
    if not parts or _crossings(united):
        raise MeshError(
            f"{name}the body cannot be united with itself: cut into parts, it still overlaps itself near "
            f"{tuple(round(x, 4) for x in mesh.self_intersections.places[0])}; mend it in a mesh editor"
        )
    made = united.to_mesh64()
    vertices = np.asarray(made.vert_properties)[:, :3] * unit + mesh.centre
    faces = np.asarray(made.tri_verts).astype(np.int64)
    result = repair_mesh(vertices, faces, mesh.name)
    result = result.with_labels(notes=(*mesh.notes, *result.notes), unit=mesh.unit)
    return Union(result, before, Sizes.of(result))


def _crossings(part: manifold3d.Manifold) -> SelfIntersections:
    """Faces of a part that cross each other."""
    mesh = part.to_mesh64()
    return self_intersections_of(
        np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts).astype(np.int64)
    )


def _pieces(body: manifold3d.Manifold) -> list[tuple[manifold3d.Manifold, SelfIntersections]]:
    """The components of a body that are not inside out, with the faces of each that cross each other."""
    return [(piece, _crossings(piece)) for piece in body.decompose() if piece.volume() > 0.0]


def _cut(body: manifold3d.Manifold, times: int, parts: list[manifold3d.Manifold]) -> None:
    """Append parts of a body, cut until none overlaps itself, or so many times."""
    for piece, crossing in _pieces(body):
        if not crossing or times == 0:
            parts.append(piece)
            continue
        box = np.array(piece.bounding_box()).reshape(2, 3)
        tried: list[tuple[int, int, tuple[manifold3d.Manifold, manifold3d.Manifold]]] = []
        for axis, share in CUTS:
            height = float(box[0, axis] + share * (box[1, axis] - box[0, axis]))
            halves = piece.split_by_plane(np.eye(3)[axis].tolist(), height)
            left = sum(len(found) for half in halves for _, found in _pieces(half))
            tried.append((left, len(tried), halves))
            if left == 0:
                break
        for half in min(tried, key=lambda one: one[:2])[2]:
            _cut(half, times - 1, parts)
