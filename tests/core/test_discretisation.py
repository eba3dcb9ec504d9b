"""The stated error of the discretisation covers the true one, and is not absurdly large."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import solids
from tests.core.ball import diffusion_distance
from tests.core.shapes import icosphere

from idviewer.core import (
    GPS,
    CommuteTime,
    Diffusion,
    Euclidean,
    Geodesic,
    InteriorDistance,
    Mesh,
    Polygon,
    discretisation,
    read_mesh,
    sample_path,
)
from idviewer.core.interior import shape_discretisation_steps
from idviewer.core.steps import finish

pytestmark = [pytest.mark.refined, pytest.mark.slow]

TIME = 1.0 / 16.0
FIRST, SECOND = np.array([[0, 0, 0.9], [0, 0, 0.5]]), np.array([[0, 0, -0.9], [0, 0, -0.5]])
RECTANGLE = Polygon([[0, 0], [10, 0], [10, 1], [0, 1]])


@pytest.fixture(scope="module")
def exact() -> np.ndarray:
    return np.array([diffusion_distance(a, -a, TIME) for a in (0.9, 0.5)])


def test_the_closed_form(exact) -> None:
    np.testing.assert_allclose(exact, [0.96890126, 0.44265039], atol=1e-8)


@pytest.mark.parametrize(
    ("level", "refine"),
    [(1, "no"), (1, "auto"), (2, "no"), (2, "auto"), (3, "no"), (3, "auto"), (4, "auto")],
)
def test_it_covers_the_true_error_in_a_ball(level: int, refine: str, exact) -> None:
    solver = InteriorDistance(Mesh(*icosphere(level)), Diffusion(TIME), refine=refine)
    levels = discretisation(solver)
    true = np.abs(solver.distance(FIRST, SECOND) - exact)
    stated = levels.errors(FIRST, SECOND)
    assert np.all(true <= stated)
    assert np.all(stated <= 5.0 * true)
    assert abs(solver.spectrum.values[0] / 2.0 - 1.0) <= levels.summary.total_lambda_2 + 1e-9
    assert true.max() <= levels.summary.total_distances * levels.summary.largest


def test_faces_of_a_smooth_body_are_told_apart_from_long_edges() -> None:
    sphere = discretisation(InteriorDistance(Mesh(*icosphere(1)), refine="auto")).summary
    assert sphere.faces_distances > 3.0 * sphere.distances
    assert "if the faces stand for a smooth body" in sphere.remark
    box = discretisation(InteriorDistance(solids.box(1, 1, 1))).summary
    assert (box.faces_distances, box.faces_lambda_2) == (0.0, 0.0)
    assert 0.0 < box.distances < 0.02


@pytest.mark.parametrize(
    "body", [solids.box(3, 1, 1), solids.angle(), RECTANGLE], ids=["bar", "L", "rectangle"]
)
def test_it_covers_what_a_far_finer_boundary_gives(body, rng: np.random.Generator) -> None:
    for refine in ("no", "auto"):
        solver = InteriorDistance(body, refine=refine)
        distance = Diffusion(solver.boundary.distance.resolved_time(solver.spectrum.values[0]))
        length = 0.04 * body.diagonal if body.dimension == 3 else 0.002 * body.diagonal
        fine = InteriorDistance(body, distance, refine=length)
        corners = body.vertices[rng.integers(0, len(body.vertices), (8, 6))]
        points = corners.mean(axis=1)
        points = points[solver.contains(points)]
        first, second = np.triu_indices(len(points), 1)
        first, second = points[first], points[second]
        true = np.abs(solver.distance(first, second) - fine.distance(first, second))
        summary = discretisation(solver).summary
        assert true.max() <= summary.total_distances * summary.largest
        assert summary.serious == (refine == "no")


def test_what_may_be_off_by_more_than_five_percent_says_so() -> None:
    coarse = discretisation(InteriorDistance(RECTANGLE, refine="no")).summary
    assert coarse.serious
    assert "more than 5%" in coarse.remark
    assert "more than 5%" not in discretisation(InteriorDistance(RECTANGLE)).summary.remark


def test_exact_distances_have_none() -> None:
    levels = discretisation(InteriorDistance(RECTANGLE, Euclidean()))
    assert levels.errors([[1, 0.5]], [[8, 0.5]]).tolist() == [0.0]
    assert (levels.summary.total_distances, levels.summary.remark) == (0.0, "")


@pytest.mark.parametrize("distance", [GPS(), CommuteTime(), Geodesic(landmarks=20)], ids=lambda one: one.name)
def test_other_kinds_have_it_too(distance) -> None:
    solver = InteriorDistance(solids.box(3, 1, 1), distance)
    summary = discretisation(solver).summary
    assert 0.0 < summary.total_distances < 0.15
    assert (summary.lambda_2 > 0.0) == distance.spectral


def test_large_meshes_are_compared_with_simplified_ones() -> None:
    solver = InteriorDistance(read_mesh(sample_path("hand_2k")))
    summary = discretisation(solver).summary
    finer = InteriorDistance(read_mesh(sample_path("hand")))
    assert abs(finer.spectrum.values[0] / solver.spectrum.values[0] - 1.0) < summary.total_lambda_2
    assert 1e-3 < summary.total_distances < 0.05


def test_a_whole_shape_is_told_of_at_once() -> None:
    resolved, error = finish(shape_discretisation_steps(RECTANGLE, Diffusion()))
    assert resolved.added > 60
    assert error.total_distances == discretisation(InteriorDistance(RECTANGLE)).summary.total_distances


def test_points_outside_get_the_largest() -> None:
    levels = discretisation(InteriorDistance(RECTANGLE))
    most = levels.summary.total_distances * levels.summary.largest
    assert levels.errors([[50, 50]], [[8, 0.5]]) == pytest.approx(most)
