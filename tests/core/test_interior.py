"""The interior distance: the paper's theorems, and two routes to each number."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes
from tests.core.test_mean_value import BODIES, inner_points

from idviewer.core import (
    DISTANCES,
    Diffusion,
    Euclidean,
    InteriorDistance,
    Mesh,
    gram_distance,
    interior_distance,
    voronoi_areas,
)
from idviewer.core.distances import missing_parameters
from idviewer.core.interior.barycentroid import SEARCH


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return BODIES["bumpy sphere"]


@pytest.fixture(scope="module")
def solver(mesh: Mesh) -> InteriorDistance:
    return InteriorDistance(mesh)


@pytest.mark.slow
def test_euclidean_distance_is_reproduced(mesh, rng):
    points = inner_points(mesh, rng, 60)
    p, q = points[:30], points[30:]
    distances = interior_distance(mesh, p, q, Euclidean())
    np.testing.assert_allclose(distances, np.linalg.norm(p - q, axis=1), atol=1e-12 * mesh.diagonal)


def test_the_boundary_distance_is_interpolated(mesh, solver):
    """d(v_i, v_j) is the diffusion distance, computed here from its definition."""
    values, vectors = solver.spectrum.values, solver.spectrum.vectors
    time = 1 / (8 * values[0])
    i, j = np.arange(0, 60), np.arange(60, 120)
    expected = np.sqrt((np.exp(-2 * values * time) * (vectors[i] - vectors[j]) ** 2).sum(axis=1))
    np.testing.assert_allclose(
        solver.distance(mesh.vertices[i], mesh.vertices[j]), expected, atol=1e-12 * expected.max()
    )


@pytest.mark.slow
def test_equation_1_and_equation_2_agree(mesh, solver, rng):
    points = inner_points(mesh, rng, 60)
    first = solver.distance(points[:30], points[30:])
    np.testing.assert_allclose(gram_distance(solver, points[:30], points[30:]), first, rtol=1e-9)
    # Equation 4 needs only the boundary distances.
    weights = solver.coordinates.weights(points[:30]) - solver.coordinates.weights(points[30:])
    embedded = solver.boundary.embedding
    norms = (embedded**2).sum(axis=1)
    squares = norms[:, None] + norms[None] - 2 * embedded @ embedded.T
    fourth = np.sqrt(-0.5 * np.einsum("pi,ij,pj->p", weights, squares, weights))
    np.testing.assert_allclose(fourth, first, rtol=1e-8)


@pytest.mark.slow
def test_it_is_a_metric(mesh, solver, rng):
    p, q, r = inner_points(mesh, rng, 90).reshape(3, 30, 3)
    pq, qr, pr = solver.distance(p, q), solver.distance(q, r), solver.distance(p, r)
    assert (pr <= pq + qr + 1e-12 * pq.max()).all()
    assert (pq > 0).all()
    np.testing.assert_allclose(solver.distance(q, p), pq, rtol=1e-12)
    np.testing.assert_allclose(solver.distance(p, p), 0, atol=1e-13 * pq.max())


@pytest.mark.slow
def test_field_is_the_distance_from_one_source(mesh, solver, rng):
    points = inner_points(mesh, rng)
    np.testing.assert_allclose(
        solver.field(points[0], points), solver.distance(points[:1], points), rtol=1e-12, atol=1e-14
    )


@pytest.mark.slow
def test_moving_and_scaling_the_shape_scales_the_distances(mesh, solver, rng):
    """phi scales with 1 / size, and so does the distance; t = 1 / (8 lambda_2) follows the size."""
    points = inner_points(mesh, rng)
    rotation = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    rotation *= np.linalg.det(rotation)
    moved = InteriorDistance(Mesh(3 * mesh.vertices @ rotation.T + 5, mesh.faces))
    images = 3 * points @ rotation.T + 5
    np.testing.assert_allclose(
        3 * moved.field(images[0], images), solver.field(points[0], points), rtol=1e-6, atol=1e-9
    )


@pytest.mark.slow
def test_renumbering_changes_nothing(mesh, solver, rng):
    points = inner_points(mesh, rng)
    order = rng.permutation(len(mesh.vertices))
    rank = np.argsort(order)
    other = InteriorDistance(Mesh(mesh.vertices[order], rank[mesh.faces][rng.permutation(len(mesh.faces))]))
    np.testing.assert_allclose(
        other.field(points[0], points), solver.field(points[0], points), rtol=1e-6, atol=1e-9
    )


def test_points_outside_are_nan_and_points_on_the_surface_are_not(mesh, solver):
    outside = solver.embed([[9.0, 9.0, 9.0], mesh.vertices[0].tolist()])
    assert np.isnan(outside[0]).all()
    np.testing.assert_allclose(outside[1], solver.boundary.embedding[0], rtol=1e-12)


@pytest.mark.slow
def test_the_potential_is_the_mean_square_distance_but_for_a_constant(mesh, solver, rng):
    points = inner_points(mesh, rng)
    masses = solver.spectrum.masses / solver.spectrum.masses.sum()
    squares = np.array([solver.field(p, mesh.vertices) ** 2 for p in points]) @ masses
    difference = squares - solver.potential(points) ** 2
    np.testing.assert_allclose(difference, difference[0], rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bumpy sphere", "L", "torus"])
def test_the_barycentroid_lies_inside_and_lower_than_all_that_was_sampled(name, rng):
    body = BODIES[name]
    if name == "L":
        body = Mesh(*shapes.subdivided(*shapes.subdivided(body.vertices, body.faces)))
    solver = InteriorDistance(body, Diffusion(time=0.2))
    found = solver.barycentroid()
    assert np.isfinite(solver.potential(found.point[None])).all()
    assert found.potential == pytest.approx(float(solver.potential(found.point[None])[0]), rel=1e-12)
    assert found.potential <= solver.potential(inner_points(body, rng, 300)).min()
    heights = solver.potential(found.path)
    assert (np.diff(heights) < 1e-14 * heights[0]).all()  # the last steps are as small as rounding
    # No step in any direction goes lower.
    around = found.point + 1e-3 * body.diagonal * np.concatenate([np.eye(3), -np.eye(3)])
    assert found.potential <= np.nanmin(solver.potential(around))


@pytest.mark.slow
@pytest.mark.parametrize("thickness", [1e-2, 1e-3])
def test_a_thin_sheet_has_a_barycentroid_too(thickness):
    vertices, faces = shapes.cube()
    for _ in range(3):
        vertices, faces = shapes.subdivided(vertices, faces)
    sheet = Mesh(vertices * [1.0, 1.4, thickness], faces)
    found = InteriorDistance(sheet, Diffusion(time=0.1)).barycentroid().point
    assert 0 < found[2] < thickness
    np.testing.assert_allclose(found[:2], [0.5, 0.7], atol=0.05)


@pytest.mark.slow
def test_the_barycentroid_of_a_box_is_its_centre_and_the_euclidean_one_the_surface_s_centroid():
    vertices, faces = shapes.cube()
    for _ in range(3):
        vertices, faces = shapes.subdivided(vertices, faces)
    box = Mesh(vertices * [1.0, 1.3, 1.9], faces)
    np.testing.assert_allclose(InteriorDistance(box).barycentroid().point, [0.5, 0.65, 0.95], atol=1e-4)
    body = BODIES["bumpy sphere"]
    solver = InteriorDistance(body, Euclidean())
    expected = voronoi_areas(body) @ body.vertices / body.area
    np.testing.assert_allclose(solver.barycentroid().point, expected, atol=1e-6)


@pytest.mark.slow
def test_the_barycentroid_of_an_ellipsoid_is_its_centre_after_any_time():
    vertices, faces = shapes.icosphere(2)
    body = Mesh(vertices * [1.6, 0.6, 0.4], faces)
    solver = InteriorDistance(body)
    for times in (1.0, 20.0, 50.0):
        longer = solver.with_distance(Diffusion(time=times / (8.0 * solver.spectrum.values[0])))
        assert np.linalg.norm(longer.barycentroid().point) < SEARCH.last_radius * body.diagonal


def test_distances_that_need_no_spectrum_have_none(mesh):
    solver = InteriorDistance(mesh, Euclidean())
    with pytest.raises(ValueError, match="uses no eigenpairs"):
        _ = solver.spectrum


def test_bad_arguments_are_named(mesh):
    with pytest.raises(ValueError, match="unknown coordinates 'shepherd'; there are: mean_value, max"):
        InteriorDistance(mesh, coordinates="shepherd")
    with pytest.raises(ValueError, match="rtol"):
        InteriorDistance(mesh, rtol=-1)
    with pytest.raises(ValueError, match="positive number, not 0"):
        Diffusion(time=0)


def with_files(name, mesh):
    """A distance of that name that lacks nothing."""
    apart = np.linalg.norm(mesh.vertices[:, None] - mesh.vertices, axis=2)
    return DISTANCES[name](
        **{one: {"matrix": apart}.get(one, mesh.vertices) for one in missing_parameters(DISTANCES[name]())}
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", DISTANCES)
def test_every_registered_distance_works(name, mesh, rng):
    solver = InteriorDistance(mesh, with_files(name, mesh))
    field = solver.field(mesh.vertices[0], inner_points(mesh, rng))
    assert (field > 0).all()
    assert solver.description.startswith(solver.boundary.distance.title)


def test_the_class_is_small_and_shows_how_each_member_is_called(mesh):
    members = {name for name in dir(InteriorDistance(mesh, Euclidean())) if not name.startswith("_")}
    assert len(members) <= 16
    without = {
        name for name in members if ">>>" not in (getattr(InteriorDistance, name, InteriorDistance).__doc__)
    }
    assert not without
