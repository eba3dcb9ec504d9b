"""Functions interpolated at points of a simplified surface: linear ones exactly, at the closest points."""

from __future__ import annotations

import numpy as np
import trimesh

from idviewer.core import read_mesh, sample_path
from idviewer.core.shapes.closest_points import ClosestPointProjection
from idviewer.core.shapes.simplification import simplification_steps
from idviewer.core.steps import finish

HAND = read_mesh(sample_path("hand_2k"))
SMALL = finish(simplification_steps(HAND, 600))
PROJECTION = ClosestPointProjection(SMALL.mesh)


def test_what_is_linear_on_the_simplified_faces_is_interpolated_exactly(rng):
    faces = SMALL.mesh.faces[rng.integers(0, len(SMALL.mesh.faces), 300)]
    shares = rng.dirichlet(np.ones(3), 300)
    values = rng.standard_normal(len(SMALL.mesh.vertices))
    points = np.einsum("pc,pcx->px", shares, SMALL.mesh.vertices[faces])
    found = PROJECTION.project(points).matrix(SMALL.mesh) @ values
    np.testing.assert_allclose(found, (shares * values[faces]).sum(axis=1), atol=1e-9)


def test_vertices_that_are_left_keep_their_values():
    values = np.arange(len(SMALL.mesh.vertices), dtype=float)
    matrix = PROJECTION.project(HAND.vertices, SMALL.parents).matrix(SMALL.mesh)
    left = np.flatnonzero((HAND.vertices == SMALL.mesh.vertices[SMALL.parents]).all(axis=1))
    np.testing.assert_allclose((matrix @ values)[left], values[SMALL.parents[left]], atol=1e-9)


def test_points_land_where_the_surface_is_closest():
    """Against all faces, by another library; walking ends in another place only across a fold."""
    points = HAND.vertices[::200]
    closest = PROJECTION.project(points, SMALL.parents[::200]).matrix(SMALL.mesh) @ SMALL.mesh.vertices
    corners = SMALL.mesh.vertices[SMALL.mesh.faces]
    gaps = np.linalg.norm(closest - points, axis=1)
    for point, gap in zip(points, gaps, strict=True):
        nearest = trimesh.triangles.closest_point(corners, np.tile(point, (len(corners), 1)))
        assert gap <= np.linalg.norm(nearest - point, axis=1).min() + 1e-9 * HAND.diagonal


def test_shares_are_not_negative_and_make_one(rng):
    points = HAND.vertices + 0.05 * HAND.diagonal * rng.standard_normal(HAND.vertices.shape)
    shares = PROJECTION.project(points).shares
    assert shares.min() >= 0.0
    np.testing.assert_allclose(shares.sum(axis=1), 1.0)
