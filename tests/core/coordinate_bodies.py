"""Shapes in both dimensions for tests of coordinates, and points in them told apart by angles."""

from __future__ import annotations

import numpy as np
from tests.core import shapes
from tests.core.test_mean_value import BODIES, winding_numbers

from idviewer.core import Mesh, Polygon

Body = Mesh | Polygon


def slab() -> Mesh:
    """A box a thousand times as wide as high."""
    vertices, faces = shapes.subdivided(*shapes.cube())
    return Mesh(vertices * [1.0, 1.4, 1e-3], faces)


SHAPES: dict[str, Body] = {
    **shapes.outlines(),
    **{name.replace("L", "L prism"): body for name, body in BODIES.items()},
    "slab": slab(),
}
CONCAVE = ["comb", "star", "two holes", "torus", "bumpy sphere"]


def turns(outline: Polygon, points: np.ndarray) -> np.ndarray:
    """Sum of the angles under which edges are seen, over 2 pi."""
    a, b = (outline.vertices[outline.edges[:, end]][None] - points[:, None] for end in (0, 1))
    cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return np.arctan2(cross, (a * b).sum(axis=2)).sum(axis=1) / (2 * np.pi)


def windings(body: Body, points: np.ndarray) -> np.ndarray:
    return turns(body, points) if body.dimension == 2 else winding_numbers(body, points)


def inner_points(body: Body, rng: np.random.Generator, count: int = 40) -> np.ndarray:
    low, high = body.bounds
    points = rng.uniform(low, high, size=(20 * count, body.dimension))
    return points[windings(body, points) > 0.5][:count]


def normals(body: Body) -> np.ndarray:
    """Unit vectors inward, one an element."""
    corners = body.vertices[body.facets]
    if body.dimension == 2:
        side = corners[:, 1] - corners[:, 0]
        inward = np.column_stack([-side[:, 1], side[:, 0]])
    else:
        inward = -np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return inward / np.linalg.norm(inward, axis=1, keepdims=True)


def clearance(body: Body, points: np.ndarray) -> np.ndarray:
    """At most the distance to the boundary: the smallest one to lines or planes of its elements."""
    first = body.vertices[body.facets[:, 0]]
    return np.abs(np.einsum("pei,ei->pe", points[:, None] - first, normals(body))).min(axis=1)


def on_elements(body: Body, shares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A point on each element with these shares of its vertices, and its linear weights."""
    corners = body.facets
    expected = np.zeros((len(corners), len(body.vertices)))
    np.add.at(expected, (np.arange(len(corners))[:, None], corners), shares)
    return np.einsum("c,eci->ei", shares, body.vertices[corners]), expected


def with_vertices(body: Body, vertices: np.ndarray) -> Body:
    """The same faces or loops, the vertices elsewhere."""
    return body.with_vertices(vertices) if body.dimension == 2 else Mesh(vertices, body.faces)
