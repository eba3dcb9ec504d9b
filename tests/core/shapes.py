"""Small shapes for tests; meshes as (vertices, faces): float64 (n, 3) and int64 (m, 3), wound outward."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from idviewer.core import Polygon

Arrays = tuple[NDArray[np.float64], NDArray[np.int64]]


def tetrahedron() -> Arrays:
    """Corner of the unit cube; volume 1/6."""
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    return vertices, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def cube_quads() -> Arrays:
    """The unit cube as six quads."""
    vertices = np.array([[x, y, z] for z in (0.0, 1) for y in (0.0, 1) for x in (0.0, 1)])
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return vertices, np.array(quads)


def cube() -> Arrays:
    """The unit cube as twelve triangles."""
    vertices, quads = cube_quads()
    return vertices, quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def octahedron() -> Arrays:
    """The six unit points on the axes."""
    vertices = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    return vertices, np.array(faces)


def subdivided(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> Arrays:
    """Every face cut into four at the middles of its edges."""
    sides = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    edges, index = np.unique(sides, axis=0, return_inverse=True)
    middle = index.reshape(-1, 3) + len(vertices)
    (a, b, c), (ab, bc, ca) = faces.T, middle.T
    corners = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    points = np.concatenate([vertices, vertices[edges].mean(axis=1)])
    return points, np.stack([np.stack(corner, axis=-1) for corner in corners], axis=1).reshape(-1, 3)


def icosphere(level: int = 2) -> Arrays:
    """The unit sphere: an icosahedron subdivided `level` times; 20 * 4**level faces."""
    g = (1 + 5**0.5) / 2
    corners = [[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0]]
    vertices = np.concatenate([np.roll(corners, shift, axis=1) for shift in (0, 1, 2)])
    faces = np.array(
        [
            *([0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2]),
            *([10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5]),
            *([2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]),
        ]
    )
    for _ in range(level):
        vertices, faces = subdivided(vertices, faces)
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), faces


def grid_faces(rows: int, columns: int, twist: bool = False) -> NDArray[np.int64]:
    """Triangles of a grid of rows x columns vertices that closes on itself both ways.

    With a twist, the rows are joined to the first one backwards: a Klein bottle.
    """

    def index(row: NDArray[np.int64], column: NDArray[np.int64]) -> NDArray[np.int64]:
        crossed = twist & (row >= rows)
        return (row % rows) * columns + np.where(crossed, -column, column) % columns

    row, column = (axis.ravel() for axis in np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"))
    a, b = index(row, column), index(row + 1, column)
    c, d = index(row + 1, column + 1), index(row, column + 1)
    return np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def torus(rows: int = 12, columns: int = 8, ring: float = 1.0, tube: float = 0.4) -> Arrays:
    """A torus around the z axis; genus 1."""
    u, v = np.meshgrid(np.arange(rows) / rows, np.arange(columns) / columns, indexing="ij")
    u, v = 2 * np.pi * u.ravel(), 2 * np.pi * v.ravel()
    out = ring + tube * np.cos(v)
    return np.column_stack([out * np.cos(u), out * np.sin(u), tube * np.sin(v)]), grid_faces(rows, columns)


def klein_bottle(rows: int = 12, columns: int = 8) -> Arrays:
    """A closed, one-sided surface (the figure-eight immersion)."""
    u, v = np.meshgrid(np.arange(rows) / rows, np.arange(columns) / columns, indexing="ij")
    u, v = 2 * np.pi * u.ravel(), 2 * np.pi * v.ravel() + 0.1
    out = 2 + np.cos(u / 2) * np.sin(v) - np.sin(u / 2) * np.sin(2 * v)
    height = np.sin(u / 2) * np.sin(v) + np.cos(u / 2) * np.sin(2 * v)
    return np.column_stack([out * np.cos(u), out * np.sin(u), height]), grid_faces(rows, columns, twist=True)


def moebius_band(count: int = 12) -> Arrays:
    """An open, one-sided band of 2 * count triangles."""
    u = 2 * np.pi * np.arange(count) / count
    sides = [1 + s * np.column_stack([np.cos(u / 2), np.cos(u / 2), np.sin(u / 2)]) for s in (-0.3, 0.3)]
    circle = np.column_stack([np.cos(u), np.sin(u), np.ones(count)])
    vertices = np.concatenate([circle * side - [0, 0, 1] for side in sides])
    near = np.arange(count)
    far = near + count
    following = np.append(near[1:], count)
    beyond = np.append(far[1:], 0)
    return vertices, np.concatenate(
        [np.column_stack([near, following, far]), np.column_stack([following, beyond, far])]
    )


def extruded(
    outline: list[tuple[float, float]], height: float = 1.0
) -> tuple[NDArray[np.float64], list[list[int]]]:
    """A prism over a counter-clockwise polygon, as polygons: bottom, top, sides."""
    count = len(outline)
    flat = np.array(outline, dtype=np.float64)
    vertices = np.concatenate(
        [np.column_stack([flat, np.zeros(count)]), np.column_stack([flat, np.full(count, height)])]
    )
    sides = [[i, (i + 1) % count, count + (i + 1) % count, count + i] for i in range(count)]
    return vertices, [list(range(count))[::-1], list(range(count, 2 * count)), *sides]


L_OUTLINE = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)]


def l_shape() -> Arrays:
    """A concave prism over an L of area 3, height 1, as triangles."""
    vertices, polygons = extruded(L_OUTLINE)
    caps = [[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 5, 4]]
    top = [[6 + i for i in reversed(face)] for face in caps]
    sides = [part for a, b, c, d in polygons[2:] for part in ([a, b, c], [a, c, d])]
    return vertices, np.array(caps + top + sides)


def joined(*parts: Arrays) -> Arrays:
    """All parts in one mesh, nothing merged."""
    offsets = np.cumsum([0] + [len(vertices) for vertices, _ in parts[:-1]])
    return (
        np.concatenate([vertices for vertices, _ in parts]),
        np.concatenate([faces + offset for (_, faces), offset in zip(parts, offsets, strict=True)]),
    )


def moved(arrays: Arrays, *shift: float) -> Arrays:
    """Translated."""
    return arrays[0] + np.array(shift), arrays[1]


def two_components() -> Arrays:
    """A cube and, apart from it, an octahedron: 12 and 8 faces."""
    return joined(moved(octahedron(), 5, 0, 0), cube())


def soup(arrays: Arrays) -> Arrays:
    """Every face with vertices of its own, as in an STL file."""
    vertices, faces = arrays
    return vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)


def opened(arrays: Arrays, faces: int = 1) -> Arrays:
    """Without the last faces."""
    return arrays[0], arrays[1][:-faces]


def pinched_cubes() -> Arrays:
    """Two cubes that share one vertex: 15 vertices."""
    vertices, faces = joined(cube(), moved(cube(), 1, 1, 1))
    faces = np.where(faces == 8, 7, faces)  # the second cube's lowest corner is the first one's highest
    return np.delete(vertices, 8, axis=0), faces - (faces > 8)


def non_manifold_cubes() -> Arrays:
    """Two cubes that share one edge: it has four faces."""
    vertices, faces = joined(cube(), moved(cube(), 1, 1, 0))
    shared = {8: 3, 12: 7}
    for index, kept in shared.items():
        faces = np.where(faces == index, kept, faces)
    used, faces = np.unique(faces, return_inverse=True)
    return vertices[used], faces.reshape(-1, 3)


def flat_sheet() -> Arrays:
    """A square folded from a tetrahedron: closed, every edge has two faces, no volume."""
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    return vertices, np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])


def star(count: int, depth: float = 0.4, arms: int = 5, size: float = 1.0) -> NDArray[np.float64]:
    """A wavy circle of count points, counter-clockwise; depth 0 is a regular polygon."""
    angle = 2 * np.pi * np.arange(count) / count
    radius = size * (1 + depth * np.cos(arms * angle))
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def outlines() -> dict[str, Polygon]:
    """Polygons convex, concave, with holes and thin."""
    box = np.array([[0.0, 0], [3, 0], [3, 2], [0, 2]])
    holes = [np.array([[0.5, 0.5], [0.5, 1.5], [1.2, 1]]), star(9, 0.3, 3, 0.4)[::-1] + np.array([2.2, 1.0])]
    comb = [[0.0, 0], [5, 0], [5, 3], [4, 3], [4, 1], [3, 1], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3]]
    return {
        "triangle": Polygon([[0.0, 0], [1, 0], [0.2, 0.9]]),
        "heptagon": Polygon(star(7, 0.0)),
        "L": Polygon(L_OUTLINE),
        "comb": Polygon(comb),
        "star": Polygon(star(60)),
        "two holes": Polygon.of_loops([box, *holes]),
        "thin": Polygon([[0.0, 0], [1, 0], [2, 0], [2, 1e-3], [1.3, 1e-3], [0, 1e-3]]),
    }
