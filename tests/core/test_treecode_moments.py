"""What clusters of faces keep for points far away: monomials, moments, and the field that they give."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.test_mean_value import bumpy_sphere

from idviewer.core._kernels.treecode.clusters import LEAST_RADII
from idviewer.core._kernels.treecode.expansion import INDICES, TABLES, monomials
from idviewer.core.coordinates.treecode import Treecode
from idviewer.core.steps import finish


@pytest.mark.slow
def test_shifted_monomials_are_the_sum_of_the_table(rng):
    """(y + t)^beta, directly and by the shifts and binomials."""
    y, t = rng.normal(size=(2, 3))
    of_y, of_t, of_sum = (np.empty(len(INDICES)) for _ in range(3))
    for place, powers in ((y, of_y), (t, of_t), (y + t, of_sum)):
        monomials(*place, powers)
    np.testing.assert_allclose(of_sum, [np.prod((y + t) ** index) for index in INDICES], rtol=1e-12)
    total = of_t[1:].copy()  # the term with y^0, which the table leaves out
    np.add.at(
        total,
        TABLES.shifts[:, 0],
        TABLES.binomials * of_y[1 + TABLES.shifts[:, 1]] * of_t[TABLES.shifts[:, 2]],
    )
    np.testing.assert_allclose(total, of_sum[1:], rtol=1e-10)


def test_the_moments_of_every_node_give_its_far_field(rng):
    """The sum over faces of f K against the node's factors, at a distance where the expansion converges."""
    mesh = bumpy_sphere(3)
    places = (mesh.vertices - mesh.bounds.mean(axis=0)) / mesh.diagonal
    values = np.cos(places @ rng.normal(scale=3.0, size=(3, 4)))
    tree = finish(Treecode.build_steps((places, mesh.faces), values, np.ones(4), 1e-6, 0.0))
    nodes, factors, depth = tree.nodes, tree._tree.factors, tree._tree.depth
    ordered = tree_faces(tree, len(mesh.faces))
    for node in rng.choice(np.flatnonzero(nodes.ranks), size=10, replace=False):
        level = int(node).bit_length() - 1
        place, count = node - (1 << level), len(mesh.faces)
        own = ordered[(count * place) >> level : (count * (place + 1)) >> level]
        direction = rng.normal(size=3)
        away = 6 * LEAST_RADII * nodes.radii[node] * direction / np.linalg.norm(direction)
        point = nodes.centres[node] - away
        direct = far_field(places, own, np.column_stack([np.ones(len(places)), places, values]), point)
        rows = slice(nodes.first[node], nodes.first[node] + nodes.ranks[node])
        moments = factors.left[rows].T @ factors.right[rows][:, :8]
        series = derivatives(away) @ moments
        size = np.abs(direct).max()
        np.testing.assert_allclose(series, direct, atol=2e-4 * size)
    assert depth > 3


def tree_faces(tree: Treecode, count: int) -> np.ndarray:
    """(m, 3) vertices of the faces in the tree's order."""
    leaves = tree._tree.leaves
    rows = leaves.rows + leaves.first_row[:-1, None, None]
    parts = [leaves.vertices[rows[i, :, :n]].T for i, n in enumerate(leaves.counts)]
    faces = np.concatenate(parts)
    assert len(faces) == count
    return faces


def far_field(places, faces, values, point) -> np.ndarray:
    """Integral of f n.(p - x) / |p - x|^4 over some faces, each cut into 64 by three subdivisions."""
    corners = places[faces]
    of_corners = values[faces]
    for _ in range(3):
        corners, of_corners = (split(array) for array in (corners, of_corners))
    normals = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    r = corners.mean(axis=1) - point
    kernel = (normals * r).sum(axis=1) / (r**2).sum(axis=1) ** 2
    return kernel @ of_corners.mean(axis=1)


def split(corners: np.ndarray) -> np.ndarray:
    """Four triangles for each one."""
    a, b, c = corners.transpose(1, 0, 2)
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
    return np.concatenate([np.stack(part, axis=1) for part in parts])


def derivatives(r: np.ndarray) -> np.ndarray:
    """b_beta of 1 / |r|^2 for all proper multi-indices, from the power series of 1 / (1 + u).

    |r + y|^-2 = |r|^-2 sum_m (-u)^m with u = (2 r.y + |y|^2) / |r|^2, multiplied out.
    """
    order = max(sum(index) for index in INDICES)
    u: dict[tuple[int, ...], float] = {}
    for axis, unit in enumerate(np.eye(3, dtype=int)):
        u[tuple(unit)] = 2 * r[axis] / (r @ r)
        u[tuple(2 * unit)] = 1 / (r @ r)
    power, total = {(0, 0, 0): 1.0}, {(0, 0, 0): 1.0}
    for _ in range(order):
        product: dict[tuple[int, ...], float] = {}
        for a, value in power.items():
            for b, factor in u.items():
                index = tuple(np.add(a, b).tolist())
                if sum(index) <= order:
                    product[index] = product.get(index, 0.0) - value * factor
        power = product
        for index, value in power.items():
            total[index] = total.get(index, 0.0) + value
    return np.array([total[index] for index in INDICES[1:]]) / (r @ r)
