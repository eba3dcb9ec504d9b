"""Boundaries that are too coarse for the modes of a distance are refined; others stay as they are."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import solids
from tests.core.shapes import icosphere

from idviewer.core import (
    GPS,
    CommuteTime,
    Diffusion,
    Euclidean,
    Geodesic,
    GivenEmbedding,
    InteriorDistance,
    Mesh,
    MeshError,
    Polygon,
    ShapeError,
    eigenpairs,
    interior_distance,
    read_mesh,
    read_polygon,
    sample_path,
)
from idviewer.core.spectrum import resolved_steps
from idviewer.core.spectrum.eigen_solver import paper_cutoff
from idviewer.core.spectrum.lowest_eigenvalue import largest_lambda_2, lowest_eigenvalue_steps
from idviewer.core.spectrum.resolution import needed_edge_length
from idviewer.core.steps import finish

pytestmark = pytest.mark.refined

RECTANGLE = Polygon([[0, 0], [10, 0], [10, 1], [0, 1]], name="rectangle")
ANGLE = Polygon([[0, 0], [8, 0], [8, 2], [2, 2], [2, 8], [0, 8]], name="L")
HOLE = [[1.2, 1.7], [2.2, 0.7], [3.2, 1.7], [2.2, 2.7]]  # nearest to the outline in one place
FRAME = Polygon.of_loops([[[0, 0], [6, 0], [6, 4], [0, 4]], HOLE], "frame")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("polygon", "lambda_2", "ends"),
    [
        (RECTANGLE, (2 * np.pi / 22) ** 2, ([[1, 0.5]], [[8, 0.5]])),
        (ANGLE, (2 * np.pi / 32) ** 2, ([[1, 7]], [[7, 1]])),
        (FRAME, None, ([[0.5, 0.5]], [[5, 3]])),
    ],
    ids=lambda value: value.name if isinstance(value, Polygon) else "",
)
def test_polygons_are_the_same_however_their_sides_are_cut(polygon, lambda_2, ends) -> None:
    finest = InteriorDistance(polygon.refined(polygon.perimeter / 1200), refine="no")
    for length in (np.inf, 2.0, 0.5):
        given = polygon if np.isinf(length) else polygon.refined(length)
        solver = InteriorDistance(given)
        assert solver.boundary.full_shape is given
        exact = finest.spectrum.values[0] if lambda_2 is None else lambda_2
        assert solver.spectrum.values[0] == pytest.approx(exact, rel=3e-3)
        for distance in (None, GPS()):
            other = solver if distance is None else solver.with_distance(distance)
            wanted = (finest if distance is None else finest.with_distance(distance)).distance(*ends)
            np.testing.assert_allclose(other.distance(*ends), wanted, rtol=0.01)


def test_a_rectangle_as_it_is_gives_something_else() -> None:
    coarse = InteriorDistance(RECTANGLE, refine="no")
    assert coarse.shape is RECTANGLE
    assert coarse.spectrum.values[0] < 0.5 * (2 * np.pi / 22) ** 2


BODIES = {
    "box": solids.box(1, 1, 1),
    "L": solids.angle(),
    "cylinder": solids.cylinder(32),
    "plate": solids.plate(16),
    "needle": solids.needle(),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", BODIES)
def test_bodies_give_what_a_far_finer_mesh_gives(name: str, rng: np.random.Generator) -> None:
    body = BODIES[name]
    solver = InteriorDistance(body)
    resolved = solver.boundary.resolved
    # Errors go with one over the number of vertices: those of the sixteen-fold differ by a fourth more.
    length = resolved.edge_length
    assert resolved.added > 0
    assert length is not None
    finer = InteriorDistance(body.refined(0.5 * length), Diffusion(), refine="no")
    assert solver.spectrum.values[0] == pytest.approx(finer.spectrum.values[0], rel=5e-3)
    corners = rng.integers(0, len(body.vertices), (12, 4))
    points = 0.7 * body.vertices[corners[:, 0]] + 0.1 * body.vertices[corners[:, 1:]].sum(axis=1)
    points = points[solver.contains(points)]
    assert len(points) > 3
    first, second = np.triu_indices(len(points), 1)
    here, there = (one.distance(points[first], points[second]) for one in (solver, finer))
    assert np.abs(here - there).max() < 0.01 * there.max()
    usual = there > 0.2 * there.max()
    assert np.abs(here / there - 1.0)[usual].max() < 0.02


@pytest.mark.slow
def test_a_cube_of_eight_vertices_is_that_of_many() -> None:
    solver = InteriorDistance(solids.box(1, 1, 1))
    assert solver.spectrum.values[0] == pytest.approx(4.16, abs=0.01)
    assert "8 -> " in solver.boundary.resolved.remark(229)
    assert solver.boundary.resolved.remark(229).endswith("since its triangles are too large for 229 modes")


@pytest.mark.parametrize("name", ["hand_2k", "couple_2k", "octopus_2k", "human_2k"])
def test_dense_meshes_stay_as_they_are(name: str) -> None:
    mesh = read_mesh(sample_path(name))
    resolved = finish(resolved_steps(mesh))
    assert resolved.shape is mesh
    assert resolved.remark() == ""


def test_dense_polygons_stay_as_they_are() -> None:
    for name in ("blob", "star", "plate"):
        polygon = read_polygon(sample_path(name))
        assert finish(resolved_steps(polygon)).shape is polygon


@pytest.mark.slow
def test_only_what_is_too_large_is_cut() -> None:
    fine = solids.box(1, 1, 1).refined(0.04)
    beside = fine.vertices[:, 2] < 0.5
    cut = Mesh(*icosphere(3))
    assert finish(resolved_steps(cut)).added > 0
    assert finish(resolved_steps(fine)).added == 0
    assert beside.any()


@pytest.mark.slow
def test_the_bound_of_lambda_2_lies_above_it_and_is_sharp_on_a_sphere() -> None:
    sphere = Mesh(*icosphere(3))
    assert largest_lambda_2(sphere) == pytest.approx(2.0, rel=0.02)
    for body in (*BODIES.values(), RECTANGLE, ANGLE):
        fine = body.refined(needed_edge_length(body.dimension, largest_lambda_2(body), paper_cutoff) * 3.0)
        assert largest_lambda_2(body) == pytest.approx(largest_lambda_2(fine), rel=1e-9)
        assert finish(lowest_eigenvalue_steps(fine)) < 1.01 * largest_lambda_2(body)


@pytest.mark.slow
def test_the_lowest_eigenvalue_is_that_of_the_solver() -> None:
    for shape in (read_mesh(sample_path("hand_2k")), RECTANGLE.refined(0.3), FRAME.refined(0.3)):
        assert finish(lowest_eigenvalue_steps(shape)) == pytest.approx(eigenpairs(shape).values[0], rel=1e-3)


@pytest.mark.slow
def test_shorter_times_ask_for_finer_boundaries() -> None:
    counts = [len(InteriorDistance(RECTANGLE, Diffusion(time)).shape.vertices) for time in (2.0, 0.5, 0.05)]
    assert counts[0] < counts[1] < counts[2]


@pytest.mark.slow
def test_distances_that_are_exact_anyway_are_not_refined(rng: np.random.Generator) -> None:
    rows = rng.normal(size=(4, 3))
    for distance in (Euclidean(), GivenEmbedding(rows)):
        assert InteriorDistance(RECTANGLE, distance).shape is RECTANGLE
    for distance in (CommuteTime(), Geodesic(), GPS()):
        assert len(InteriorDistance(RECTANGLE, distance).shape.vertices) > 60


def test_changing_the_distance_goes_to_the_boundary_that_it_needs(rng: np.random.Generator) -> None:
    rows = rng.normal(size=(4, 3))
    points = [[1, 0.5]], [[8, 0.5]]
    diffusion = InteriorDistance(RECTANGLE)
    given = diffusion.with_distance(GivenEmbedding(rows))
    assert given.shape is RECTANGLE
    assert given.distance(*points) == InteriorDistance(RECTANGLE, GivenEmbedding(rows)).distance(*points)
    assert given.with_distance(Diffusion()).distance(*points) == diffusion.distance(*points)
    assert diffusion.with_distance(Euclidean()).distance(*points) == pytest.approx(7.0, rel=1e-12)
    unrefined = InteriorDistance(RECTANGLE, Euclidean(), refine="no").with_distance(Diffusion())
    assert unrefined.shape is RECTANGLE


def test_a_length_can_be_asked_for() -> None:
    solver = InteriorDistance(RECTANGLE, refine=0.1)
    assert len(solver.shape.vertices) == 220
    assert solver.boundary.resolved.remark() == "4 -> 220 vertices, since edges of at most 0.1 were asked for"
    one, other = (
        interior_distance(RECTANGLE, [[1, 0.5]], [[8, 0.5]], refine=refine) for refine in (0.1, "no")
    )
    assert one == pytest.approx(solver.distance([[1, 0.5]], [[8, 0.5]]))
    assert other < 0.9 * one


@pytest.mark.parametrize("refine", ["fine", -1.0, 0.0, np.nan, True, None])
def test_what_is_no_refinement_is_refused(refine) -> None:
    with pytest.raises(ValueError, match="auto, no, or the longest edge allowed"):
        InteriorDistance(RECTANGLE, refine=refine)


def test_lengths_that_take_more_than_the_memory_are_refused() -> None:
    with pytest.raises(MeshError, match="choose longer ones"):
        InteriorDistance(solids.box(1, 1, 1), refine=1e-6)


@pytest.mark.slow
def test_where_too_many_vertices_were_needed_edges_stay_longer_and_it_is_told(monkeypatch) -> None:
    from idviewer.core.spectrum import resolution

    monkeypatch.setattr(resolution, "RESOLUTION", resolution.ResolutionSettings(most_vertices=400))
    resolved = finish(resolved_steps(solids.box(1, 1, 1)))
    assert 200 < len(resolved.shape.vertices) < 600
    assert "times as many would resolve them" in resolved.remark(76)


def test_a_spectrum_that_is_given_is_that_of_the_shape_as_it_is() -> None:
    spectrum = eigenpairs(RECTANGLE)
    assert InteriorDistance(RECTANGLE, spectrum=spectrum).shape is RECTANGLE


def test_errors_of_a_shape_come_before_any_work() -> None:
    with pytest.raises((ValueError, ShapeError), match="unknown coordinates"):
        InteriorDistance(solids.box(1, 1, 1), coordinates="none")
