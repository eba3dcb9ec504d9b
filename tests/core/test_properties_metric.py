"""Section 5 of the paper: a metric, the topology of the Euclidean one, and the maximum principle."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.property_shapes import (
    EVERYWHERE,
    EXACT,
    RANDOM,
    full_rank,
    inside,
    shape,
    solver_of,
    stretch,
    thorough,
)

from idviewer.core import (
    COORDINATES,
    Geodesic,
    GivenEmbedding,
    InteriorDistance,
    MeanValueCoordinates,
    Property,
    read_shape,
    sample_path,
)
from idviewer.core.coordinates import coordinates_of
from idviewer.core.interior.embedded_points import squares_of

POSITIVE = [name for name, kind in COORDINATES.items() if Property.NON_NEGATIVITY in kind.properties]
BARYCENTRIC = [name for name, kind in COORDINATES.items() if Property.LINEAR_PRECISION in kind.properties]


def all_distances(solver: InteriorDistance, points: np.ndarray) -> np.ndarray:
    """(p, p) from `distance`, each pair in both orders."""
    count = len(points)
    i, j = (axis.ravel() for axis in np.indices((count, count)))
    return solver.distance(points[i], points[j]).reshape(count, count)


def check_axioms(apart: np.ndarray) -> None:
    """Of all ordered triples; sums and differences of rounded numbers are off by a few roundings."""
    largest = apart.max()
    assert (apart >= 0).all()
    np.testing.assert_allclose(apart, apart.T, rtol=1e-9, atol=1e-12 * largest)
    assert np.diag(apart).max() < 1e-12 * largest
    for third in range(len(apart)):
        assert (apart <= apart[:, third, None] + apart[third] + 1e-12 * largest).all()
    # "One usually gets a metric even without assuming the conditional positive definiteness."
    assert apart[~np.eye(len(apart), dtype=bool)].min() > 1e-6 * largest


@pytest.mark.one_is_quick
@EVERYWHERE
@pytest.mark.parametrize("kind", [*EXACT, "geodesic"])
def test_metric_also_where_modes_are_cut_off(name, kind, rng):
    """Non-negativity, symmetry and the triangle inequality "follow from those of Euclidean distance": in a
    million triples, also where modes are cut off and where distances do not embed exactly.
    """
    body = shape(name)
    points = np.concatenate([inside(body, rng, 90), body.vertices[:10]])
    solver = InteriorDistance(body, Geodesic()) if kind == "geodesic" else solver_of(kind, body, "mean_value")
    check_axioms(all_distances(solver, points))


@pytest.mark.one_is_quick
@EVERYWHERE
@pytest.mark.parametrize("kind", ["commute", "diffusion"])
@pytest.mark.parametrize("coordinates", thorough(("mean_value",), BARYCENTRIC))
def test_metric_of_full_rank(name, kind, coordinates, rng):
    """ "If the Gram matrix A is conditionally positive definite, then d^ is a metric": d^(p, q) = 0 only if
    p = q. The proof says more: d^(p, q) >= c |p - q|, with a c that depends on A and the vertices alone.
    """
    body = shape(name)
    solver = full_rank(body, kind, coordinates)
    bound = stretch(solver)
    assert bound * body.diagonal > 1e-3 * np.sqrt(squares_of(solver.boundary.embedding).max())
    points = np.concatenate([inside(body, rng, 40), body.vertices[:10]])
    check_axioms(all_distances(solver, points))
    p = np.repeat(points, 40, axis=0)
    q = p + body.diagonal * 10.0 ** rng.uniform(-8, -1, (len(p), 1)) * rng.standard_normal(p.shape)
    distances, straight = solver.distance(p, q), np.linalg.norm(p - q, axis=1)
    # Points hardly outside have the distance of the nearest on the surface.
    within = np.isfinite(distances) & MeanValueCoordinates(body).contains(q)
    assert within.sum() > 0.5 * len(p)
    assert (distances[within] >= (1 - 1e-6) * bound * straight[within]).all()


def test_without_conditional_positive_definiteness_it_need_not_be_one(rng):
    """A control: with an embedding of rank one, there are points apart at distance 0."""
    body = shape("random polygon")
    solver = InteriorDistance(body, GivenEmbedding(body.vertices[:, :1]))
    assert stretch(solver) < 1e-6
    points = inside(body, rng, 100)
    mirrored = points + np.array([0.0, 0.1])
    distances = solver.distance(points, mirrored)
    assert np.nanmax(distances) < 1e-12


@pytest.mark.one_is_quick
@EVERYWHERE
@pytest.mark.parametrize("kind", ["commute", "diffusion"])
@pytest.mark.parametrize("coordinates", thorough(("mean_value",), BARYCENTRIC))
def test_same_topology_along_sequences(name, kind, coordinates, rng):
    """ "For a sequence of points p_n, d^(p_n, p) -> 0 if and only if |p_n - p| -> 0", inside and at vertices.

    Sequences: one that converges to p, one to another point, one that returns to p at every second step.
    """
    body = shape(name)
    solver = full_rank(body, kind, coordinates)
    bound = stretch(solver)
    points = inside(body, rng, 30)
    largest = np.sqrt(squares_of(solver.boundary.embedding).max())
    assert bound * body.diagonal > 1e-3 * largest
    steps = 0.5 ** np.arange(40.0)[:, None]
    for limit in (*points[:5], *body.vertices[:5]):
        near = limit + 1e-3 * (points - limit)
        other = points[solver.contains(near)][-1]
        converging = limit + 1e-3 * steps * (other - limit)
        elsewhere = other + 1e-3 * steps * (limit - other)
        alternating = np.stack([converging, elsewhere], axis=1).reshape(-1, body.dimension)
        distances, other_distances = solver.field(limit, alternating).reshape(-1, 2).T
        # |p_n - p| -> 0 gives d -> 0, from 1e-3 of the diagonal down to 1e-15 of it.
        assert distances[-1] < 1e-9 * largest
        assert (np.diff(distances[:30]) < 0).all()
        # What does not converge to p stays away from it, by the bound of the metric's proof.
        gaps = np.linalg.norm(elsewhere - limit, axis=1)
        assert (other_distances >= (1 - 1e-6) * bound * gaps).all()
        assert other_distances.min() > 1e3 * distances[-1]


@pytest.mark.slow
@EVERYWHERE
@pytest.mark.parametrize("coordinates", thorough(("mean_value",), BARYCENTRIC))
def test_same_topology_of_balls(name, coordinates, rng):
    """ "The opposite implication": what lies in a small ball of d^ lies in a small Euclidean ball."""
    body = shape(name)
    solver = full_rank(body, "commute", coordinates)
    centre = inside(body, rng, 1)
    scales = body.diagonal * 10.0 ** rng.uniform(-9, -1, (1500, 1))
    points = np.concatenate(
        [inside(body, rng, 1500), centre + scales * rng.standard_normal((1500, 2 + (body.dimension == 3)))]
    )
    distances, straight = solver.field(centre[0], points), np.linalg.norm(points - centre, axis=1)
    radii = 10.0 ** -np.arange(0.0, 7.0) * np.nanmedian(distances[:1500])
    sizes = [straight[distances < radius].max() for radius in radii]
    assert (np.array(sizes) <= (1 + 1e-6) * radii / stretch(solver)).all()
    # Each tenth of the radius is about a tenth of the size, once the ball is small.
    np.testing.assert_allclose(np.divide(sizes[3:], sizes[2:-1]), 0.1, rtol=0.3)


@pytest.mark.one_is_quick
@pytest.mark.parametrize(
    "name", thorough((*RANDOM, "plate"), [*RANDOM, "gingerbread", "plate", "bay_3", "spiral", "snake"])
)
@pytest.mark.parametrize("coordinates", POSITIVE)
def test_maximum_principle(name, coordinates, rng):
    """ "If the weights are non-negative, then the diameter of the interior under d^ is not greater than the
    diameter of the boundary under d." Also with an embedding that is made to break it.
    """
    body = shape(name)
    points = inside(body, rng, 150)
    mean_value = solver_of("diffusion", body, "mean_value")
    against = np.sign(
        mean_value.coordinates.weights(points)[np.argmax(mean_value.coordinates.negativity(points))]
    )
    weights = coordinates_of(body, coordinates).weights(points)
    assert weights.min() >= 0
    for kind in (*EXACT, "geodesic", "against mean value"):
        if kind in EXACT:
            solver = solver_of(kind, body, coordinates)
        else:
            made = Geodesic() if kind == "geodesic" else GivenEmbedding(against[:, None])
            solver = InteriorDistance(body, made, coordinates)
        images = weights @ solver.boundary.embedding
        inner, outer = np.sqrt(squares_of(images).max()), np.sqrt(squares_of(solver.boundary.embedding).max())
        assert inner <= outer * (1 + 1e-12)
        assert inner > 0.1 * outer, "the points reach far"
    assert (solver.coordinates.negativity(points[:9]) == 0).all()


@pytest.mark.slow
@pytest.mark.parametrize(("name", "excess"), [("bay_3", 0.05), ("spiral", 0.25), ("snake", 0.04)])
def test_maximum_principle_is_violated_with_mean_value_coordinates_in_deep_bays(name, excess, rng):
    """ "The mean value coordinates do become negative with concavity", and then the bound need not hold.

    With the paper's own distance: in the spiral points inside lie 30 % farther apart than any two vertices.
    Where weights are not negative the same points keep the bound.
    """
    body = read_shape(sample_path(name))
    points = inside(body, rng, 1500)
    solver = solver_of("diffusion", body, "mean_value")
    negative = solver.coordinates.negativity(points)
    assert negative.max() > 0.2
    images = solver.embed(points)
    between = squares_of(images)
    largest = np.sqrt(squares_of(solver.boundary.embedding).max())
    assert np.sqrt(between.max()) > (1 + excess) * largest
    ends = points[list(np.unravel_index(between.argmax(), between.shape))]
    assert solver.distance(ends[:1], ends[1:]) > (1 + excess) * largest
    assert solver.coordinates.negativity(ends).max() > 0
    for coordinates in POSITIVE:
        other = solver_of("diffusion", body, coordinates)
        assert (other.coordinates.negativity(ends) == 0).all()
        assert other.distance(ends[:1], ends[1:]) <= largest


@pytest.mark.slow
def test_maximum_principle_can_be_violated_wherever_weights_are_negative(rng):
    """The boundary distance |s_i - s_j|, s_i the sign of w_i(p), is 2 at most; p is farther from some vertex.

    By the negativity: p* = sum |w_i| = 1 + 2 sum max(0, -w_i), and a vertex with a negative weight is at -1.
    """
    for name in ("random polygon", "plate", "random mesh", "random ring", "hand_2k"):
        body = shape(name)
        points = inside(body, rng, 300)
        weights = coordinates_of(body, "mean_value").weights(points)
        at = int(np.argmin(weights.min(axis=1)))
        signs = np.where(weights[at] < 0, -1.0, 1.0)
        solver = InteriorDistance(body, GivenEmbedding(signs[:, None]))
        negativity = solver.coordinates.negativity(points[at : at + 1])[0]
        assert negativity > 1e-3
        worst = body.vertices[[int(weights[at].argmin())]]
        found = solver.distance(points[at : at + 1], worst)
        np.testing.assert_allclose(found, 2 + 2 * negativity, rtol=1e-9)
