"""Interior distances of polygons with the eigenpairs of their boundaries: routes that share no code."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.outlines import circle, regular, shortest_paths
from tests.core.property_shapes import exact_distance, inside, pairs, shape, solver_of, thorough

from idviewer.core import (
    GPS,
    CommuteTime,
    Diffusion,
    DistanceError,
    Euclidean,
    Geodesic,
    GivenDistances,
    InteriorDistance,
    Polygon,
    gram_distance,
    interior_distance,
)
from idviewer.core.interior.barycentroid import interior_samples
from idviewer.core.interior.interpolation import BasisInterpolation

POLYGONS = pytest.mark.parametrize(
    "name", ["random polygon", "random polygon with a hole", "gingerbread", "plate"]
)


@pytest.mark.slow
@POLYGONS
@pytest.mark.parametrize("kind", thorough(("diffusion",), ["diffusion", "gps", "biharmonic"]))
def test_the_barycentroid_lies_inside_and_no_lower_point_was_found(name, kind, rng):
    polygon, solver = shape(name), solver_of(kind, shape(name), "mean_value")
    found = solver.barycentroid()
    assert found.point.shape == (2,)
    assert polygon.contains(found.point[None]).all()
    np.testing.assert_allclose(found.potential, solver.potential(found.point[None])[0], rtol=1e-12)
    assert found.potential <= solver.potential(inside(polygon, rng, 1000)).min()
    angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    around = np.column_stack([np.cos(angles), np.sin(angles)])
    for radius in (1e-3, 1e-2):
        assert found.potential <= np.nanmin(
            solver.potential(found.point + radius * polygon.diagonal * around)
        )
    assert polygon.contains(found.path).all()
    assert (np.diff(solver.potential(found.path)) < 1e-14).all()


@pytest.mark.one_is_quick
@pytest.mark.parametrize("sides", [3, 4, 7, 40])
def test_the_barycentroid_of_a_regular_polygon_is_its_centre(sides):
    polygon = Polygon(circle(sides) * 2.0 + [5.0, -3.0])
    found = InteriorDistance(polygon).barycentroid()
    np.testing.assert_allclose(found.point, [5.0, -3.0], atol=2e-5)


@pytest.mark.slow
def test_the_euclidean_barycentroid_is_the_boundary_s_centre_of_mass():
    polygon = shape("random polygon")
    ends = polygon.vertices[polygon.edges]
    expected = polygon.lengths @ ends.mean(axis=1) / polygon.perimeter
    assert polygon.contains(expected[None]).all()
    found = InteriorDistance(polygon, Euclidean()).barycentroid()
    np.testing.assert_allclose(found.point, expected, atol=2e-5 * polygon.diagonal)


@pytest.mark.one_is_quick
@POLYGONS
def test_commute_time_is_that_of_the_resistances(name):
    """Eq. 4 with D the resistances in closed form, in which no matrix is solved or decomposed."""
    polygon, (p, q) = shape(name), pairs(name)
    resistances = polygon.resistances()
    solver = solver_of("commute", polygon, "mean_value")
    z = solver.coordinates.weights(p) - solver.coordinates.weights(q)
    expected = np.sqrt(-0.5 * np.einsum("pi,ij,pj->p", z, resistances, z))
    np.testing.assert_allclose(solver.distance(p, q), expected, rtol=1e-9)
    np.testing.assert_allclose(gram_distance(solver, p, q), expected, rtol=1e-9)
    np.testing.assert_allclose(solver.boundary.squares(), resistances, atol=1e-10 * resistances.max())
    given = InteriorDistance(polygon, GivenDistances(np.sqrt(resistances)))
    np.testing.assert_allclose(given.distance(p, q), expected, rtol=1e-7)


@pytest.mark.parametrize("name", ["random polygon", "plate"])
def test_truncation_loses_what_the_modes_left_out_weigh(name):
    """In the plane the sum of phi^2 / lambda converges: on average little is cut off."""
    polygon = shape(name)
    points = interior_samples(polygon)
    p, q = points[np.random.default_rng(0).permutation(len(points))[:100].reshape(2, 50)]
    exact = InteriorDistance(polygon, CommuteTime()).distance(p, q)
    truncated = InteriorDistance(polygon, GPS()).distance(p, q)
    assert 0 < np.nanmean(np.abs(truncated - exact) / exact) < 0.05


@pytest.mark.one_is_quick
@POLYGONS
def test_geodesics_are_those_of_the_polygon_nearest_to_embeddable(name):
    """The positive part of the Gram matrix of the shortest paths, by classical scaling of all pairs."""
    polygon, (p, q) = shape(name), pairs(name)
    lengths = shortest_paths(polygon)
    with pytest.raises(DistanceError, match="do not embed exactly"):
        InteriorDistance(polygon, GivenDistances(lengths))
    expected = InteriorDistance(polygon, GivenDistances(lengths, fit="approximate"))
    found = InteriorDistance(polygon, Geodesic())
    np.testing.assert_allclose(found.distance(p, q), expected.distance(p, q), rtol=1e-6)
    # Without the negative part no distance between vertices is shorter.
    i, j = np.triu_indices(len(lengths), 1)
    between = found.distance(polygon.vertices[i[::41]], polygon.vertices[j[::41]])
    assert (between >= (1 - 1e-9) * lengths[i, j][::41]).all()
    assert np.median(between / lengths[i, j][::41]) < 1.5


def test_landmarks_of_a_polygon_come_near_to_all_pairs():
    polygon, (p, q) = shape("gingerbread"), pairs("gingerbread")
    everything = InteriorDistance(polygon, Geodesic()).distance(p, q)
    few = InteriorDistance(polygon, Geodesic(landmarks=100))
    assert "100 landmarks" in few.description
    np.testing.assert_allclose(few.distance(p, q), everything, atol=0.05 * everything.max())


def test_heat_spreads_evenly_on_a_circle(rng):
    """On a regular polygon diffusion distances between vertices depend on their angle alone; Fourier sums."""
    sides = 60
    polygon = regular(sides)
    side = polygon.lengths[0]
    k = np.arange(1, sides // 2)
    values = (2 - 2 * np.cos(2 * np.pi * k / sides)) / side**2
    kept = values < -np.log(1e-6) * 8 * values[0]
    turn = 2 * np.pi * k * np.arange(sides)[:, None] / sides
    # A pair of modes cos, sin, of M-norm 1: (phi_i - phi_j)^2 sums to 4 (1 - cos k (a_i - a_j)) / perimeter.
    terms = np.exp(-values / (4 * values[0])) * 4 * (1 - np.cos(turn)) / polygon.perimeter
    expected = np.sqrt(terms[:, kept].sum(axis=1))
    for first in (0, 17):
        others = polygon.vertices[(first + np.arange(sides)) % sides]
        found = interior_distance(polygon, polygon.vertices[[first]], others, Diffusion())
        np.testing.assert_allclose(found, expected, atol=1e-9 * expected.max())


@pytest.mark.slow
def test_one_point_against_many_goes_through_the_many_in_portions(monkeypatch):
    """Both ways round, for a distance that is a quadratic form."""
    monkeypatch.setattr(BasisInterpolation, "weights_per_step", 700)
    for name in ("random polygon", "random mesh"):
        solver = InteriorDistance(shape(name), exact_distance("commute", shape(name)))
        assert isinstance(solver.boundary.distance, CommuteTime)
        p, q = pairs(name)
        one_by_one = np.array([solver.distance(p[:1], one[None])[0] for one in q])
        assert solver.distance(p[:1], q).shape == q.shape[:1]
        np.testing.assert_allclose(solver.distance(p[:1], q), one_by_one, rtol=1e-12)
        np.testing.assert_allclose(solver.distance(q, p[:1]), one_by_one, rtol=1e-12)
        np.testing.assert_allclose(solver.distance(p[:7], q[:7]), solver.distance(q[:7], p[:7]), rtol=1e-12)
