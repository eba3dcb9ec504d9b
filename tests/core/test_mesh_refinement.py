"""Meshes and polygons with shorter edges: the same boundary, at no more vertices than it needs."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from tests.core import solids
from tests.core.shapes import icosphere

from idviewer.core import MeanValueCoordinates, Mesh, MeshError, Polygon, PolygonError
from idviewer.core.shapes.mesh_refinement import refined_arrays, refined_count
from idviewer.core.shapes.subdivision import bends, subdivided

BODIES = {
    "box": (solids.box(1, 2, 3), 0.4),
    "L": (solids.angle(), 0.4),
    "cylinder": (solids.cylinder(48), 0.4),
    "plate": (solids.plate(), 0.6),
    "plate in single precision": (solids.turned(solids.plate()), 0.6),
    "needle": (solids.needle(), 500.0),
    "sphere": (Mesh(*icosphere(1)), 0.3),
}


def edge_lengths(mesh: Mesh) -> np.ndarray:
    return np.linalg.norm(mesh.vertices[mesh.edges[:, 0]] - mesh.vertices[mesh.edges[:, 1]], axis=1)


@pytest.fixture(params=BODIES)
def case(request: pytest.FixtureRequest) -> tuple[Mesh, Mesh, float]:
    mesh, length = BODIES[request.param]
    return mesh, mesh.refined(length), length


def test_no_edge_is_longer_and_the_boundary_is_where_it_was(case) -> None:
    mesh, finer, length = case
    assert edge_lengths(finer).max() <= length * (1.0 + 1e-6)
    np.testing.assert_array_equal(finer.vertices[: len(mesh.vertices)], mesh.vertices)
    assert finer.volume == pytest.approx(mesh.volume, rel=1e-7)
    assert finer.area == pytest.approx(mesh.area, rel=1e-7)
    assert distances_from(mesh, finer.vertices).max() <= 1e-6 * mesh.diagonal
    assert distances_from(mesh, finer.vertices[finer.faces].mean(axis=1)).max() <= 1e-6 * mesh.diagonal


def distances_from(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """Of points from the surface, face by face."""
    nearest = np.full(len(points), np.inf)
    for corners in mesh.vertices[mesh.faces]:
        closest = trimesh.triangles.closest_point(np.broadcast_to(corners, (len(points), 3, 3)), points)
        nearest = np.minimum(nearest, np.linalg.norm(closest - points, axis=1))
    return nearest


def test_labels_and_numbers_of_the_file_stay(case) -> None:
    mesh, finer, _ = case
    labelled = mesh.with_labels(name="part 7", notes=("welded",), unit="mm").refined(
        edge_lengths(finer).max()
    )
    assert (labelled.name, labelled.notes, labelled.unit) == ("part 7", ("welded",), "mm")
    np.testing.assert_array_equal(labelled.file_vertices, mesh.file_vertices)


def test_mean_value_coordinates_still_interpolate_linear_functions(case, rng: np.random.Generator) -> None:
    mesh, finer, _ = case
    corners = mesh.vertices[mesh.faces[rng.integers(0, len(mesh.faces), 40)]]
    points = 0.98 * corners.mean(axis=1) + 0.02 * mesh.vertices.mean(axis=0)
    weights = MeanValueCoordinates(finer).weights(points)
    inside = np.isfinite(weights).all(axis=1)
    np.testing.assert_allclose(
        weights[inside] @ finer.vertices, points[inside], rtol=0.0, atol=1e-10 * mesh.diagonal
    )


def test_exchanging_edges_spares_the_rows_that_slivers_would_take() -> None:
    for mesh, length, gain in ((solids.plate(), 0.5, 2.5), (solids.cylinder(200), 0.3, 1.8)):
        plain = refined_arrays(mesh.vertices, mesh.faces, length, exchanging=False)[0]
        assert len(plain) > gain * len(mesh.refined(length).vertices)


def test_a_needle_takes_no_vertices_across() -> None:
    assert len(solids.needle().refined(500.0).vertices) < 130


def test_the_count_is_foretold(case) -> None:
    mesh, finer, length = case
    assert 0.6 < refined_count(mesh.vertices, mesh.faces, length) / len(finer.vertices) < 2.0


def test_size_and_place_make_no_difference() -> None:
    mesh = solids.plate()
    small = Mesh(1e-9 * mesh.vertices, mesh.faces).refined(0.7e-9)
    far = Mesh(mesh.vertices + 1e6, mesh.faces).refined(0.7)
    assert len(small.vertices) == len(mesh.refined(0.7).vertices)
    assert len(far.vertices) == pytest.approx(len(small.vertices), rel=0.05)


@pytest.mark.parametrize("length", [0.0, -1.0, np.nan, np.inf])
def test_lengths_that_are_none_are_refused(length: float) -> None:
    for shape, error in ((Mesh(*icosphere(0)), MeshError), (Polygon([[0, 0], [1, 0], [0, 1]]), PolygonError)):
        with pytest.raises(error, match="positive number"):
            shape.refined(length)


def test_too_many_vertices_are_refused_before_they_are_made() -> None:
    with pytest.raises(MeshError, match="choose longer ones"):
        solids.box(1, 1, 1).refined(1e-7)
    with pytest.raises(PolygonError, match="choose longer ones"):
        Polygon([[0, 0], [1, 0], [0, 1]]).refined(1e-7)


def test_a_polygon_with_a_hole_keeps_its_loops() -> None:
    outer, hole = [[0, 0], [4, 0], [4, 4], [0, 4]], [[1, 1], [2, 1], [2, 2], [1, 2]]
    polygon = Polygon.of_loops([outer, hole], "frame").with_labels(unit="m")
    finer = polygon.refined(0.3)
    np.testing.assert_array_equal(finer.vertices[:8], polygon.vertices)
    assert (finer.name, finer.unit, len(finer.loops)) == ("frame", "m", 2)
    assert (finer.area, finer.perimeter) == pytest.approx((polygon.area, polygon.perimeter), rel=1e-12)
    assert finer.lengths.max() <= 0.3
    assert Polygon(finer.vertices, finer.loops).loops[1].tolist() == finer.loops[1].tolist()


def test_a_curved_subdivision_comes_near_the_sphere_and_leaves_boxes_alone() -> None:
    sphere = Mesh(*icosphere(2))
    radius = np.linalg.norm(sphere.vertices[0])
    flat, curved = (
        np.linalg.norm(subdivided(sphere, bent).vertices, axis=1) / radius for bent in (False, True)
    )
    assert 1.0 - flat.min() > 1e-2 > 10.0 * np.abs(curved - 1.0).max()
    for sharp in (solids.box(1, 2, 3), solids.angle()):
        assert not bends(sharp)
        np.testing.assert_allclose(subdivided(sharp, True).vertices, subdivided(sharp).vertices)


def test_a_curved_cylinder_keeps_its_ends_flat_and_gets_rounder() -> None:
    cylinder = solids.cylinder(24)
    curved = subdivided(cylinder, curved=True)
    assert isinstance(curved, Mesh)
    assert np.ptp(curved.vertices[:, 2]) == pytest.approx(3.0)
    assert 3.0 * np.pi - curved.volume < 0.3 * (3.0 * np.pi - cylinder.volume)
