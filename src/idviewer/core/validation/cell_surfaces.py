"""Outer surfaces of volume meshes: the faces that belong to one cell alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints
from idviewer.core.validation.polygon_soup import concatenated

Faces = tuple[tuple[int, ...], ...]

# Corners as VTK, Gmsh and Abaqus number them; faces are wound outward.
_TETRA: Faces = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
_HEXAHEDRON: Faces = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
_WEDGE: Faces = ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))
_PYRAMID: Faces = ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4))
_TETRA_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_HEXAHEDRON_EDGES = (
    *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)
_WEDGE_EDGES = ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))
_PYRAMID_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4))
_TRIANGLE_EDGES = ((0, 1), (1, 2), (2, 0))
_QUAD_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0))


@dataclass(frozen=True)
class CellKind:
    """One kind of cell.

    Attributes:
        faces: corners of each face, wound outward; those of flat cells are the cell itself.
        flat: whether the cell is a face itself.
        points: how many points such a cell has, with those on its edges, faces and inside.
        curved: whether there are points on the edges.
    """

    faces: Faces
    flat: bool
    points: int
    curved: bool = False


def _curved(
    faces: Faces, corners: int, edges: Sequence[tuple[int, int]], flat: bool, points: int
) -> CellKind:
    """A kind with a point in the middle of each edge: its faces pass through these."""
    middle = {frozenset(edge): corners + place for place, edge in enumerate(edges)}
    longer = []
    for face in faces:
        following = (*face[1:], face[0])
        pairs = zip(face, following, strict=True)
        longer.append(
            tuple(place for one, other in pairs for place in (one, middle[frozenset((one, other))]))
        )
    return CellKind(tuple(longer), flat, points, True)


_TRIANGLE_FACE: Faces = ((0, 1, 2),)
_QUAD_FACE: Faces = ((0, 1, 2, 3),)
CELL_KINDS = {
    "triangle": CellKind(_TRIANGLE_FACE, True, 3),
    "quad": CellKind(_QUAD_FACE, True, 4),
    "tetra": CellKind(_TETRA, False, 4),
    "hexahedron": CellKind(_HEXAHEDRON, False, 8),
    "wedge": CellKind(_WEDGE, False, 6),
    "pyramid": CellKind(_PYRAMID, False, 5),
    "triangle6": _curved(_TRIANGLE_FACE, 3, _TRIANGLE_EDGES, True, 6),
    "triangle7": _curved(_TRIANGLE_FACE, 3, _TRIANGLE_EDGES, True, 7),
    "quad8": _curved(_QUAD_FACE, 4, _QUAD_EDGES, True, 8),
    "quad9": _curved(_QUAD_FACE, 4, _QUAD_EDGES, True, 9),
    "tetra10": _curved(_TETRA, 4, _TETRA_EDGES, False, 10),
    "hexahedron20": _curved(_HEXAHEDRON, 8, _HEXAHEDRON_EDGES, False, 20),
    "hexahedron24": _curved(_HEXAHEDRON, 8, _HEXAHEDRON_EDGES, False, 24),
    "hexahedron27": _curved(_HEXAHEDRON, 8, _HEXAHEDRON_EDGES, False, 27),
    "wedge15": _curved(_WEDGE, 6, _WEDGE_EDGES, False, 15),
    "wedge18": _curved(_WEDGE, 6, _WEDGE_EDGES, False, 18),
    "pyramid13": _curved(_PYRAMID, 5, _PYRAMID_EDGES, False, 13),
    "pyramid14": _curved(_PYRAMID, 5, _PYRAMID_EDGES, False, 14),
}
"""The kinds of cells by meshio's names; others have no surface, or one that is not known."""


Polygons = tuple[Ints, Ints]
"""Corners of all polygons one after the other, and how many each has."""


@dataclass(frozen=True)
class Cells:
    """Cells of one kind.

    Attributes:
        kind: one of `CELL_KINDS`.
        points: (n, k) vertex indices of each cell.
    """

    kind: str
    points: Ints

    def __post_init__(self) -> None:
        expected = CELL_KINDS[self.kind].points
        if self.points.ndim != 2 or self.points.shape[1] != expected:
            raise ValueError(f"cells of the kind {self.kind} have {expected} points")


def surface_of_cells(
    vertices: Floats, blocks: Sequence[Cells], polyhedra: Polygons | None = None
) -> tuple[Polygons, tuple[str, ...]]:
    """Outer faces of the volumes among cells, wound outward, or else all flat cells; and notes.

    A face is inside if two cells or more have it, with its corners in any order. Faces with points on their
    edges are cut into triangles and quadrilaterals through these.

    Args:
        vertices: (n, 3) points.
        blocks: cells of each kind.
        polyhedra: all faces of further volumes.

    Raises:
        ValueError: a cell refers to a missing point.

    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -1]])
    >>> cells = Cells("tetra", np.array([[0, 1, 2, 3], [0, 2, 1, 4]]))
    >>> (corners, sizes), _ = surface_of_cells(points, [cells])
    >>> len(sizes), [0, 1, 2] in np.sort(corners.reshape(-1, 3)).tolist()
    (6, False)
    """
    if any(
        one.points.size and not 0 <= one.points.min() <= one.points.max() < len(vertices) for one in blocks
    ):
        raise ValueError("truncated or damaged: it has fewer points than its cells name")
    solid = [one for one in blocks if not CELL_KINDS[one.kind].flat and len(one.points)]
    flat = [one for one in blocks if CELL_KINDS[one.kind].flat and len(one.points)]
    if not solid and polyhedra is None:
        return _joined([_cut(one.kind, *_faces(one)) for one in flat]), ()
    groups = [(one.kind, _outward(vertices, one)) for one in solid]
    if polyhedra is not None:
        groups.append(("polyhedron", polyhedra))
    outer = _outer(_joined([polygons for _, polygons in groups]))
    kept, place = [], 0
    for kind, (corners, sizes) in groups:
        mask = outer[place : place + len(sizes)]
        kept.append(_cut(kind, corners[np.repeat(mask, sizes)], sizes[mask]))
        place += len(sizes)
    notes = [f"The outer surface of {_named(solid, polyhedra)} was taken."]
    if flat:
        count = sum(len(one.points) for one in flat)
        notes.append(f"{count:,} flat cells beside the volumes were passed over.")
    return _joined(kept), tuple(notes)


def _named(solid: Sequence[Cells], polyhedra: Polygons | None) -> str:
    count = sum(len(one.points) for one in solid)
    kinds = [f"{count:,} volume cells"] if count else []
    return " and ".join([*kinds, *(["polyhedra"] if polyhedra is not None else [])])


def _joined(groups: Sequence[Polygons]) -> Polygons:
    return concatenated([one for one, _ in groups]), concatenated([one for _, one in groups])


def _faces(block: Cells) -> Polygons:
    """All faces of cells of one kind, those inside the body included."""
    faces = CELL_KINDS[block.kind].faces
    by_cell = np.concatenate([np.array(face) for face in faces])
    sizes = np.array([len(face) for face in faces], dtype=np.int64)
    return block.points[:, by_cell].ravel().astype(np.int64), np.tile(sizes, len(block.points))


def _outward(vertices: Floats, block: Cells) -> Polygons:
    """The same, wound outward, whichever way round a cell's points are listed."""
    corners, sizes = _faces(block)
    faces = CELL_KINDS[block.kind].faces
    points = vertices[block.points]
    points = points - points[:, :1]
    volumes = np.zeros(len(points))
    for face in faces:
        for second, third in pairwise(face[1:]):
            volumes += np.linalg.det(points[:, [face[0], second, third]])
    per_cell = corners.reshape(len(points), -1)
    backward = np.concatenate([start + -np.arange(len(face)) % len(face) for start, face in _starts(faces)])
    per_cell = np.where((volumes < 0.0)[:, None], per_cell[:, backward], per_cell)
    return per_cell.ravel(), sizes


def _starts(faces: Faces) -> list[tuple[int, tuple[int, ...]]]:
    places = np.cumsum([0, *(len(face) for face in faces)]).tolist()
    return list(zip(places, faces, strict=False))


def _outer(polygons: Polygons) -> NDArray[np.bool_]:
    """Which polygons do not meet another on the same corners, in any order of these."""
    corners, sizes = polygons
    starts = np.cumsum(sizes) - sizes
    outer = np.zeros(len(sizes), dtype=bool)
    for size in np.unique(sizes).tolist():
        alike = np.flatnonzero(sizes == size)
        rings = np.sort(corners[starts[alike, None] + np.arange(size)], axis=1)
        order = np.lexsort(rings.T)
        same = np.all(rings[order[1:]] == rings[order[:-1]], axis=1)
        ends = np.zeros(len(alike) + 1, dtype=bool)
        ends[1:-1] = same
        outer[alike[order]] = ~(ends[1:] | ends[:-1])
    return outer


def _cut(kind: str, corners: Ints, sizes: Ints) -> Polygons:
    """Faces with points on their edges as triangles at their corners and a polygon between."""
    if kind not in CELL_KINDS or not CELL_KINDS[kind].curved:
        return corners, sizes
    made = []
    starts = np.cumsum(sizes) - sizes
    for size in np.unique(sizes).tolist():
        rings = corners[starts[sizes == size, None] + np.arange(size)]
        at_corners = np.stack([np.roll(rings, shift, axis=1)[:, :3] for shift in range(1, size, 2)], axis=1)
        made.append((at_corners.ravel(), np.full(at_corners.shape[0] * at_corners.shape[1], 3)))
        made.append((rings[:, 1::2].ravel(), np.full(len(rings), size // 2)))
    return _joined(made)
