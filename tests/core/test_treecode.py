"""Interpolation within a tolerance: the error holds everywhere, and the parts it is made of are right."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from tests.core import shapes
from tests.core.test_mean_value import bumpy_sphere

from idviewer.core import Diffusion, InteriorDistance, Mesh, read_mesh, sample_path
from idviewer.core._kernels.treecode.normalize import Target
from idviewer.core.coordinates.mean_value_mesh import MeshMeanValue
from idviewer.core.coordinates.tolerance import Approximation, ApproximationSettings
from idviewer.core.coordinates.treecode import Treecode
from idviewer.core.interior import extent
from idviewer.core.steps import finish

DEPTHS = (0.0, 1e-9, 1e-6, 1e-3)
"""How deep under the surface points are tried, in diagonals."""


def flattened() -> Mesh:
    """A thin sheet: a ball pressed to a thousandth of its height."""
    vertices, faces = shapes.icosphere(4)
    return Mesh(vertices * [1.0, 1.0, 1e-3], faces)


def back_to_back() -> Mesh:
    """A U of two thin sheets, one close upon the other."""
    outline = [(0, 0), (1, 0), (1, 0.01), (0.02, 0.01), (0.02, 0.011), (1, 0.011), (1, 0.021), (0, 0.021)]
    vertices, polygons = shapes.extruded([(float(x), y) for x, y in outline])
    top = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 7], [4, 5, 6], [4, 6, 7]]
    bottom = [face[::-1] for face in top]
    sides = [part for a, b, c, d in polygons[2:] for part in ([a, b, c], [a, c, d])]
    arrays = vertices, np.array(bottom + [[8 + i for i in face] for face in top] + sides)
    for _ in range(3):
        arrays = shapes.subdivided(*arrays)
    return Mesh(*arrays)


def needles() -> Mesh:
    """A spindle of slivers, 400 times as long as wide."""
    angles = 2 * np.pi * np.arange(1200) / 1200
    ring = np.stack([0.5 * np.cos(angles), 0.5 * np.sin(angles), np.zeros(1200)], axis=1)
    i, j = np.arange(1200), np.roll(np.arange(1200), -1)
    upper, lower = np.stack([i, j, 0 * i + 1200], axis=1), np.stack([j, i, 0 * i + 1201], axis=1)
    return Mesh(np.concatenate([ring, [[0, 0, 1], [0, 0, -1]]]), np.concatenate([upper, lower]))


BODIES = {
    "bumpy sphere": bumpy_sphere(4),
    "torus": Mesh(*shapes.torus(80, 40)),
    "cube": Mesh(*shapes.cube()),
    "thin sheet": flattened(),
    "back to back": back_to_back(),
    "needles": needles(),
}


def values_on(mesh: Mesh, rng: np.random.Generator) -> np.ndarray:
    """(n, 20) waves of several lengths, and noise."""
    places = (mesh.vertices - mesh.bounds.mean(axis=0)) / mesh.diagonal
    waves = np.cos(places @ rng.normal(scale=8.0, size=(3, 18)) + rng.uniform(0, 6, size=18))
    return np.column_stack([waves, rng.uniform(-1, 1, size=(len(places), 2))])


def inner_points(mesh: Mesh, rng: np.random.Generator, count: int) -> np.ndarray:
    """Random points inside, told apart by the exact coordinates, which have tests of their own."""
    points = rng.uniform(*mesh.bounds, size=(12 * count, 3))
    found = finish(MeshMeanValue(mesh).interpolate_steps(points, np.ones((len(mesh.vertices), 1))))
    return points[np.isfinite(found[:, 0])][:count]


def points_in(mesh: Mesh, rng: np.random.Generator) -> np.ndarray:
    """Points all over the inside, some of them at and just under the surface."""
    faces = rng.integers(len(mesh.faces), size=20)
    corners = mesh.vertices[mesh.faces[faces]]
    on = np.einsum("fc,fci->fi", rng.dirichlet([1, 1, 1], size=20), corners)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = -normals / np.linalg.norm(normals, axis=1)[:, None] * mesh.diagonal
    return np.concatenate([inner_points(mesh, rng, 120), *(on + depth * inward for depth in DEPTHS)])


@cache
def exact_on(name: str) -> tuple[MeshMeanValue, np.ndarray, np.ndarray, np.ndarray]:
    """Coordinates, values at the vertices, points, and the interpolated values there."""
    mesh, rng = BODIES[name], np.random.default_rng(20090715)
    coordinates, values, points = MeshMeanValue(mesh), values_on(mesh, rng), points_in(mesh, rng)
    return coordinates, values, points, finish(coordinates.interpolate_steps(points, values))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "tolerance"),
    [*((name, tolerance) for name in BODIES for tolerance in (1e-2, 1e-4)), ("torus", 1e-3), ("torus", 1e-5)],
)
def test_the_error_stays_below_the_tolerance_everywhere(name, tolerance):
    coordinates, values, points, exact = exact_on(name)
    weights = np.full(20, 1 / extent(values))
    near = finish(coordinates.approximation(values, weights).interpolate_steps(points, tolerance))
    np.testing.assert_array_equal(np.isnan(near), np.isnan(exact))
    assert np.isfinite(exact).all(axis=1).sum() > 120
    errors = np.linalg.norm(weights * (near - exact), axis=1)
    assert np.nanmax(errors) < tolerance


@pytest.mark.slow
def test_distances_are_within_rtol_of_the_largest(rng):
    mesh = read_mesh(sample_path("hand_2k"))
    exact, points = InteriorDistance(mesh), points_in(mesh, rng)
    true = exact.embed(points)
    p, q = rng.choice(np.flatnonzero(np.isfinite(true[:, 0])), size=(2, 5000))
    largest = max(
        np.linalg.norm(exact.boundary.embedding - row, axis=1).max() for row in exact.boundary.embedding
    )
    assert extent(exact.boundary.embedding) <= largest * (1 + 1e-12)
    for rtol in (1e-2, 1e-4, 1e-6):
        near = InteriorDistance(mesh, rtol=rtol, spectrum=exact.spectrum).embed(points)
        errors = np.linalg.norm(true[p] - true[q], axis=1) - np.linalg.norm(near[p] - near[q], axis=1)
        assert np.abs(errors).max() < rtol * largest


@pytest.mark.slow
def test_the_tree_is_what_answers(rng):
    """Not the exact loop behind it: all points of a smooth body pass the check at once."""
    mesh = BODIES["bumpy sphere"]
    values, points = values_on(mesh, rng), inner_points(mesh, rng, 300)
    coordinates = MeshMeanValue(mesh)
    tree, columns = finish(coordinates.approximation(values, np.ones(20)).prepare_steps(1e-3))
    assert len(columns) == 20
    _, doubtful = carried(tree, coordinates.normalise(points), 1e-3, 1e-3)
    assert doubtful.mean() < 0.05


def carried(tree: Treecode, points: np.ndarray, tolerance: float, bound: float):
    """What the tree alone makes of 20 columns at points, and which points it doubts."""
    values, doubtful = np.empty((len(points), 20)), np.empty(len(points), dtype=bool)
    target = Target(np.arange(len(points)), np.arange(20), values, doubtful)
    finish(tree.interpolate_steps(points, tolerance, bound, target))
    return values, doubtful


@pytest.mark.slow
def test_the_check_finds_a_tree_that_is_too_coarse(rng):
    mesh = BODIES["torus"]
    values, points = values_on(mesh, rng), inner_points(mesh, rng, 300)
    coordinates = MeshMeanValue(mesh)
    weights = np.full(20, 1 / extent(values))
    tree, _ = finish(coordinates.approximation(values, weights).prepare_steps(1e-1))
    near, doubtful = carried(tree, coordinates.normalise(points), 1e-1, 1e-4)
    exact = finish(coordinates.interpolate_steps(points, values))
    wrong = np.linalg.norm(weights * (near - exact), axis=1) > 1e-3
    assert wrong.any()
    assert doubtful[wrong].all()


def test_below_the_finest_tolerance_everything_is_exact(rng):
    mesh = BODIES["torus"]
    values, points = values_on(mesh, rng), inner_points(mesh, rng, 50)
    coordinates = MeshMeanValue(mesh)
    exact = finish(coordinates.interpolate_steps(points, values))
    approximation = coordinates.approximation(values, np.ones(20))
    for tolerance in (0.99 * ApproximationSettings().finest_tolerance, 1e-15, 1e-300):
        near = finish(approximation.interpolate_steps(points, tolerance))
        np.testing.assert_array_equal(near, exact)


def test_on_the_surface_values_are_those_of_the_surface(rng):
    mesh = BODIES["bumpy sphere"]
    values = values_on(mesh, rng)
    approximation = MeshMeanValue(mesh).approximation(values, np.ones(20))
    shares = rng.dirichlet([1, 1, 1], size=40)
    shares[:10] = np.eye(3)[rng.integers(3, size=10)]
    shares[10:20, 0], shares[10:20, 1] = 0.0, 1 - shares[10:20, 2]
    corners = mesh.faces[rng.integers(len(mesh.faces), size=40)]
    points = np.einsum("fc,fci->fi", shares, mesh.vertices[corners])
    expected = np.einsum("fc,fck->fk", shares, values[corners])
    near = finish(approximation.interpolate_steps(points, 1e-2))
    np.testing.assert_allclose(near, expected, atol=1e-6)


def test_points_outside_are_nan_wherever_they_are(rng):
    mesh = BODIES["torus"]
    approximation = MeshMeanValue(mesh).approximation(values_on(mesh, rng), np.ones(20))
    size, middle = mesh.diagonal, mesh.bounds.mean(axis=0)
    directions = rng.normal(size=(20, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    points = np.concatenate(
        [middle + directions * size * far for far in (0.6, 10.0, 1e6, 1e12)]
        + [[middle, [np.nan, 0, 0], [np.inf, 0, 0], [0, -np.inf, np.nan]]]
    )
    assert np.isnan(finish(approximation.interpolate_steps(points, 1e-3))).all()


@pytest.mark.slow
@pytest.mark.parametrize("size", [1e-9, 1e9])
def test_size_and_place_do_not_matter(size, rng):
    mesh = BODIES["bumpy sphere"]
    values, points = values_on(mesh, rng), inner_points(mesh, rng, 100)
    shift = np.array([1e5, -2e5, 3e5])
    here = MeshMeanValue(mesh).approximation(values, np.ones(20))
    there = MeshMeanValue(Mesh((mesh.vertices + shift) * size, mesh.faces)).approximation(values, np.ones(20))
    np.testing.assert_allclose(
        finish(there.interpolate_steps((points + shift) * size, 1e-3)),
        finish(here.interpolate_steps(points, 1e-3)),
        atol=2e-3,
    )


@pytest.mark.one_is_quick
@pytest.mark.parametrize("count", [0, 1, 15, 16, 17, 700])
def test_any_number_of_points(count, rng):
    mesh = BODIES["bumpy sphere"]
    values = values_on(mesh, rng)
    coordinates = MeshMeanValue(mesh)
    points = np.repeat(inner_points(mesh, rng, 70), 10, axis=0)[:count]
    near = finish(coordinates.approximation(values, np.full(20, 0.1)).interpolate_steps(points, 1e-3))
    assert near.shape == (count, 20)
    np.testing.assert_allclose(near, finish(coordinates.interpolate_steps(points, values)), atol=1e-2)


def test_columns_that_count_nothing_are_left_out(rng):
    mesh = BODIES["torus"]
    values, points = values_on(mesh, rng), inner_points(mesh, rng, 20)
    weights = np.where(np.arange(20) < 5, 1.0, 1e-9)
    near = finish(MeshMeanValue(mesh).approximation(values, weights).interpolate_steps(points, 1e-3))
    assert (near[:, 5:] == 0.0).all()
    assert (near[:, :5] != 0.0).all()


@pytest.mark.slow
def test_what_serves_several_distances_counts_the_worst_of_them():
    solver = InteriorDistance(read_mesh(sample_path("hand_2k")))
    short = Diffusion(time=solver.boundary.distance.resolved_time(float(solver.spectrum.values[0])) / 8)
    own, both = solver.interpolation.error_weights(), solver.interpolation.error_weights([short])
    assert (both >= own).all()
    assert both[-1] > 1000 * own[-1]


@pytest.mark.slow
def test_building_and_evaluating_can_be_left_at_any_step(rng):
    mesh = BODIES["torus"]
    values, points = values_on(mesh, rng), inner_points(mesh, rng, 300)
    approximation = MeshMeanValue(mesh).approximation(values, np.full(20, 0.1))
    expected = finish(
        MeshMeanValue(mesh).approximation(values, np.full(20, 0.1)).interpolate_steps(points, 1e-3)
    )
    for stop in (1, 2, 5):
        steps = approximation.interpolate_steps(points, 1e-3)
        for _ in range(stop):
            next(steps, None)
        steps.close()
    np.testing.assert_array_equal(finish(approximation.interpolate_steps(points, 1e-3)), expected)


def test_an_approximation_says_nothing_of_meshes_too_small_to_cut(rng):
    """A tetrahedron is one leaf."""
    mesh = Mesh(*shapes.tetrahedron())
    values = rng.normal(size=(4, 3))
    coordinates = MeshMeanValue(mesh)
    points = inner_points(mesh, rng, 20)
    near = finish(Approximation(coordinates, values, np.ones(3)).interpolate_steps(points, 1e-4))
    np.testing.assert_allclose(near, finish(coordinates.interpolate_steps(points, values)), atol=1e-5)
