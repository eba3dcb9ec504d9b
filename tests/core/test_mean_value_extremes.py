"""Mean value coordinates where formulas lose their digits: against long doubles, and against the limit."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from tests.core import shapes
from tests.core.test_mean_value import BODIES

from idviewer.core._kernels.mean_value.surface import surface_in_blocks
from idviewer.core.coordinates.mean_value import mean_value_weights
from idviewer.core.coordinates.mean_value_mesh import MeshMeanValue
from idviewer.core.shapes.mesh import Mesh

Wide = np.longdouble


def wide_weights(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """(p, n) by the solve of the article in long doubles, three digits more; not in a face's plane."""
    return np.array([_wide_row(mesh, point) for point in points])


def _wide_row(mesh: Mesh, point: np.ndarray) -> np.ndarray:
    offsets = mesh.vertices.astype(Wide) - point.astype(Wide)
    distances = np.sqrt((offsets**2).sum(axis=1))
    a, b, c = (offsets / distances[:, None])[mesh.faces].transpose(1, 0, 2)
    r = sum(_arc(*edge) for edge in ((a, b), (b, c), (c, a)))
    det = (a * np.cross(b - a, c - a)).sum(axis=1)
    weights = np.zeros(len(mesh.vertices), dtype=Wide)
    for corner, (one, other) in zip(mesh.faces.T, ((b, c), (c, a), (a, b)), strict=True):
        np.add.at(weights, corner, (r * np.cross(one, other - one)).sum(axis=1) / det / distances[corner])
    return (weights / weights.sum()).astype(np.float64)


def _arc(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """theta times the unit normal of directions a and b, halved."""
    sine, cosine = (np.sqrt((side**2).sum(axis=1)) / 2 for side in (b - a, a + b))
    return (np.arctan2(sine, cosine) / (2 * sine * cosine))[:, None] * np.cross(a, b - a)


def subdivided(arrays: shapes.Arrays, times: int) -> shapes.Arrays:
    for _ in range(times):
        arrays = shapes.subdivided(*arrays)
    return arrays


def assert_right(mesh: Mesh, points: np.ndarray, atol: float) -> None:
    weights = mean_value_weights(mesh, points)
    np.testing.assert_allclose(weights, wide_weights(mesh, points), atol=atol)
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-13)
    np.testing.assert_allclose(weights @ mesh.vertices, points, atol=1e-14 * mesh.diagonal)


def needled_drum(gap: float) -> Mesh:
    """A drum of 24 sides, every other one so thin, and its lids in slices."""
    angles = np.arange(0, 2 * np.pi, np.pi / 6) + 0.1
    angles = np.sort(np.concatenate([angles, angles + gap]))
    count, i = len(angles), np.arange(len(angles))
    rim, j, middle = np.stack([np.cos(angles), np.sin(angles)], axis=1), (i + 1) % count, 0 * i + 2 * count
    heights = np.repeat([0.0, 1.0], count)[:, None]
    vertices = np.vstack([np.hstack([np.vstack([rim, rim]), heights]), [[0, 0, 0], [0, 0, 1]]])
    sides = [np.stack([i, j, j + count], axis=1), np.stack([i, j + count, i + count], axis=1)]
    lids = [np.stack([j, i, middle], axis=1), np.stack([i + count, j + count, middle + 1], axis=1)]
    return Mesh(vertices, np.vstack(sides + lids))


@pytest.mark.parametrize(("gap", "atol"), [(1e-2, 1e-13), (1e-4, 1e-11), (1e-6, 1e-9)])
def test_needles_cost_their_aspect_s_digits_and_no_more(gap, atol, rng):
    turn, radius = rng.uniform(0, 2 * np.pi, 40), rng.uniform(0, 0.9, 40)
    points = np.stack([radius * np.cos(turn), radius * np.sin(turn), rng.uniform(0.05, 0.95, 40)], axis=1)
    assert_right(needled_drum(gap), points, atol)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("thickness", [1e-2, 1e-4, 1e-6])
def test_between_two_sheets_they_are_right(thickness, rng):
    vertices, faces = subdivided(shapes.cube(), 3)
    size = np.array([1.0, 1.4, thickness])
    assert_right(Mesh(vertices * size, faces), rng.uniform(0.1, 0.9, (40, 3)) * size, 1e-13)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("depth", [1e-3, 1e-5, 1e-7, 1e-9])
@pytest.mark.parametrize("shares", [(1 / 3, 1 / 3, 1 / 3), (0.5, 0.5 - 1e-6, 1e-6), (1 - 2e-9, 1e-9, 1e-9)])
def test_close_to_the_surface_they_are_right(shares, depth):
    body = BODIES["bumpy sphere"]
    corners = body.vertices[body.faces[::40]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    assert_right(body, np.einsum("c,fci->fi", shares, corners) - depth * normals, 1e-13)


@pytest.mark.parametrize("tip", [1e-2, 1e-5, 1e-9])
def test_in_the_tip_of_a_spike_they_are_right(tip, rng):
    """All edges of a narrow face may look short from a point near its tip."""
    turn, i = np.arange(12) * np.pi / 6, np.arange(12)
    rim = 0.05 * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    sides = [np.stack([i, (i + 1) % 12, 0 * i + 12], axis=1), np.stack([(i + 1) % 12, i, 0 * i + 13], axis=1)]
    spike = Mesh(np.vstack([rim, [[0, 0, 1], [0, 0, 0]]]), np.vstack(sides))
    aside = rng.uniform(-0.3, 0.3, (20, 2)) * 0.05 * tip
    assert_right(spike, np.hstack([aside, np.full((20, 1), 1 - tip)]), 1e-14)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("tilt", [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2])
def test_in_the_planes_of_many_small_faces_they_are_smooth(tilt):
    """As in the L of a few large faces, but all of these are seen under small angles."""
    mesh = Mesh(*subdivided(shapes.l_shape(), 3))
    points = np.array([[0.3, 1.0, 0.41], [0.71, 1.0, 0.52], [1.0, 0.37, 0.43], [1.0, 0.71, 0.77]])
    moved = points + tilt * np.array([[0, 1, 0], [0, 1, 0], [1, 0, 0], [1, 0, 0]])
    weights = mean_value_weights(mesh, moved)
    np.testing.assert_allclose(weights @ mesh.vertices, moved, atol=1e-14)
    np.testing.assert_allclose(weights, mean_value_weights(mesh, points), atol=2 * tilt + 1e-13)
    if tilt >= 1e-6:
        np.testing.assert_allclose(weights, wide_weights(mesh, moved), atol=5e-12)


@pytest.mark.parametrize(("lift", "atol"), [(1e-6, 1e-7), (1e-9, 1e-7), (0.0, 1e-14)])
def test_faces_of_hardly_any_area_do_no_harm(lift, atol, rng):
    """A face is split at the middle of an edge, its neighbour is not: a sliver fills the gap."""
    vertices, faces = shapes.tetrahedron()
    (i, j, k), rest = faces[0], faces[1:]
    middle = 0.5 * (vertices[i] + vertices[j]) + lift * np.array([0.3, 0.5, 0.7])
    extended = np.vstack([vertices, middle])
    split = np.vstack([rest, [[i, 4, k], [4, j, k], [i, j, 4]]])
    # `Mesh` refuses faces whose area is lost in rounding.
    bounds = np.array([vertices.min(axis=0), vertices.max(axis=0)])
    diagonal = float(np.linalg.norm(bounds[1] - bounds[0]))
    mesh = SimpleNamespace(
        vertices=extended, faces=split, bounds=bounds, diagonal=diagonal, self_intersections=()
    )
    points = rng.dirichlet(np.ones(4), 40) @ vertices
    weights = MeshMeanValue(mesh).weights(points)
    np.testing.assert_allclose(weights @ extended, points, atol=1e-14)
    without = SimpleNamespace(vertices=extended, faces=split[:-1])
    np.testing.assert_allclose(weights, wide_weights(without, points), atol=atol)
    assert np.isfinite(surface_in_blocks(extended, split).constants).all()
