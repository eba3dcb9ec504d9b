"""From a field to a mesh: contour, keep the body, simplify, and check what came out."""

from __future__ import annotations

import fast_simplification
import numpy as np
import pyvista as pv
from field import Array, Body, grid_values
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

Faces = NDArray[np.int64]


def contour(body: Body, step: float, far: float) -> tuple[Array, Faces]:
    """The zero set of the field on a grid of the given step, by flying edges; outward, largest component."""
    low, high = body.bounds(3 * step)
    shape = np.ceil((high - low) / step).astype(int) + 1
    grid = pv.ImageData(dimensions=shape, spacing=(step,) * 3, origin=low)
    grid["field"] = grid_values(body, low, step, shape, far).ravel(order="F")
    surface = grid.contour([0.0], scalars="field", method="flying_edges", compute_normals=False)
    points, faces = np.asarray(surface.points, dtype=float), surface.regular_faces.astype(np.int64)
    return clean(*weld(points, faces, 1e-4 * step))


def weld(points: Array, faces: Faces, tolerance: float) -> tuple[Array, Faces]:
    """Unite points that agree to the tolerance, and drop the triangles that vanish by it."""
    keys = np.round(points / tolerance).astype(np.int64)
    _, first, to = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    faces = to.reshape(-1)[faces]
    distinct = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return points[first], faces[distinct]


def clean(points: Array, faces: Faces) -> tuple[Array, Faces]:
    """The largest component, without unused points, turned outward."""
    ends = faces[:, [0, 1, 1, 2]].reshape(-1, 2)
    graph = coo_matrix((np.ones(len(ends)), ends.T), shape=(len(points),) * 2)
    label = connected_components(graph, directed=False)[1]
    kept = faces[label[faces[:, 0]] == np.bincount(label[faces[:, 0]]).argmax()]
    used, kept = np.unique(kept, return_inverse=True)
    points, kept = points[used], kept.reshape(-1, 3)
    return points, kept if volume(points, kept) > 0 else kept[:, ::-1].copy()


def volume(points: Array, faces: Faces) -> float:
    a, b, c = points[faces].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def simplify(points: Array, faces: Faces, count: int) -> tuple[Array, Faces]:
    """`count` vertices by quadric collapses.

    A low aggression keeps most of the detail, but may stop early; and the library does not look whether
    a collapse pinches the surface. So the first run that ends well is taken.
    """
    target = 2 * (count - euler(points, faces))
    for aggression in (3, 3.5, 4, 4.5, 5, 6, 7):
        new, triangles = fast_simplification.simplify(
            points, faces.astype(np.int32), target_count=target, agg=aggression
        )
        result = clean(np.asarray(new, dtype=float), np.asarray(triangles, dtype=np.int64))
        if len(result[0]) == count and is_closed_manifold(*result):
            return result
    raise RuntimeError(f"no manifold with about {count} vertices")


def euler(points: Array, faces: Faces) -> int:
    return len(points) - len(faces) // 2


def is_closed_manifold(points: Array, faces: Faces) -> bool:
    """Whether each directed edge has one opposite, and the triangles at each point make one fan."""
    directed = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    forward, backward = directed @ [len(points), 1], directed @ [1, len(points)]
    if len(np.unique(forward)) < len(forward) or not np.array_equal(np.sort(forward), np.sort(backward)):
        return False
    corner = np.arange(faces.size)
    order = np.argsort(forward)
    # corner i starts directed edge i; the triangle across that edge has its own corner at the same point
    across = order[np.searchsorted(forward[order], backward)]
    neighbour = across // 3 * 3 + (across % 3 + 1) % 3
    fans = connected_components(coo_matrix((np.ones(faces.size), (corner, neighbour))), directed=False)[0]
    return fans == len(points)
