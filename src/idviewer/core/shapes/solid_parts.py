"""Parts of a solid that overlaps itself, none of which does, by manifold3d."""

from __future__ import annotations

import itertools

import manifold3d
import numpy as np

from idviewer.core.validation.self_intersections import SelfIntersections, self_intersections_of

CUTS = tuple(itertools.product(range(3), (0.3, 0.5, 0.7)))
"""Axes of the planes that a part is tried to be cut by, and where in its box they lie."""

DEEPEST_CUT = 8
"""A part is cut so many times at most."""


def simple_parts(body: manifold3d.Manifold) -> list[manifold3d.Manifold]:
    """Cut a body by planes until no part overlaps itself; parts that are inside out are left out.

    A part may still overlap itself where that many cuts do not help: see `crossings_of`.

    Args:
        body: of any size about the origin.

    >>> len(simple_parts(manifold3d.Manifold.cube((1.0, 1.0, 1.0))))
    1
    """
    parts: list[manifold3d.Manifold] = []
    _cut(body, DEEPEST_CUT, parts)
    return parts


def crossings_of(part: manifold3d.Manifold) -> SelfIntersections:
    """Faces of a part that cross each other."""
    mesh = part.to_mesh64()
    return self_intersections_of(
        np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts).astype(np.int64)
    )


def _pieces(body: manifold3d.Manifold) -> list[tuple[manifold3d.Manifold, SelfIntersections]]:
    """The components of a body that are not inside out, with the faces of each that cross each other."""
    return [(piece, crossings_of(piece)) for piece in body.decompose() if piece.volume() > 0.0]


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
