"""Union of a body that overlaps itself: the surface around what it covers, and what that changes."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import manifold3d
import numpy as np

from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.mesh_repair import repair_mesh
from idviewer.core.shapes.shape import MeshLike, as_mesh
from idviewer.core.shapes.solid_parts import crossings_of, simple_parts
from idviewer.core.validation.topology import Topology


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
    parts = simple_parts(manifold3d.Manifold(corners))
    united = manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add)
    if not parts or crossings_of(united):
        raise MeshError(
            f"{name}the body cannot be united with itself: cut into parts, it still overlaps itself near "
            f"{tuple(round(x, 4) for x in mesh.self_intersections.places[0])}; mend it in a mesh editor"
        )
    made = united.to_mesh64()
    vertices = np.asarray(made.vert_properties)[:, :3] * unit + mesh.centre
    faces = np.asarray(made.tri_verts).astype(np.int64)
    result = repair_mesh(vertices, faces, mesh.name)
    kept = [note for note in mesh.notes if note != mesh.self_intersections.finding.note]
    result = result.with_labels(notes=(*kept, *result.notes), unit=mesh.unit)
    return Union(result, before, Sizes.of(result))
