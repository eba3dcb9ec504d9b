"""Section 5 of the paper: independence of the embedding, interpolation, Euclidean reproduction."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.property_shapes import (
    BUNDLED,
    BY_ALL_COORDINATES,
    EVERYWHERE,
    EXACT,
    RANDOM,
    boundary_squares,
    exact_distance,
    pairs,
    shape,
    solver_of,
)

from idviewer.core import (
    COORDINATES,
    Euclidean,
    GivenDistances,
    GivenEmbedding,
    InteriorDistance,
    Property,
    gram_distance,
    pairwise_distance,
)
from idviewer.core.distances.classical_mds import double_centred


def quadratic(form: np.ndarray, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """sum_ij form_ij one_i other_j, row by row."""
    return np.einsum("pi,ij,pj->p", one, form, other)


@pytest.mark.one_is_quick
@EVERYWHERE
@pytest.mark.parametrize("kind", EXACT)
@BY_ALL_COORDINATES
def test_independence_of_the_embedding_by_four_equations(name, kind, coordinates):
    """ "The interior distance is uniquely determined by the input boundary distance d and the weights; it
    does not depend on the specific embedding used." Eq. 1 = eq. 2 = eq. 4 = eq. 5.

    The right sides are written out here, with D from the distance's definition and no embedding.
    """
    body, (p, q) = shape(name), pairs(name)
    solver = solver_of(kind, body, coordinates)
    first, second = solver.coordinates.weights(p), solver.coordinates.weights(q)
    squares = boundary_squares(kind, body)
    fourth = -0.5 * quadratic(squares, first - second, first - second)
    halves = 0.5 * (quadratic(squares, first, first) + quadratic(squares, second, second))
    fifth = quadratic(squares, first, second) - halves
    gram = solver.boundary.embedding @ solver.boundary.embedding.T
    assert fourth.min() > 0
    found = {
        "eq. 1": solver.distance(p, q),
        "eq. 2": gram_distance(solver, p, q),
        "eq. 2, the matrix formed": np.sqrt(quadratic(gram, first - second, first - second)),
        "eq. 4": pairwise_distance(solver, p, q),
        "eq. 4, written out": np.sqrt(fourth),
        "eq. 5": pairwise_distance(solver, p, q, expanded=True),
        "eq. 5, written out": np.sqrt(fifth),
    }
    for equation, values in found.items():
        np.testing.assert_allclose(values, np.sqrt(fourth), rtol=1e-6, err_msg=equation)


@pytest.mark.one_is_quick
@EVERYWHERE
@BY_ALL_COORDINATES
def test_independence_of_the_embedding_by_different_embeddings(name, coordinates, rng):
    """ "... it does not depend on the specific embedding used": the Gram matrix's eigenvectors, the Cholesky
    factor of the one about vertex 0, and both turned, mirrored and moved give the same numbers.
    """
    body, (p, q) = shape(name), pairs(name)
    squares = boundary_squares("commute", body)
    values, vectors = np.linalg.eigh(double_centred(squares))
    by_vectors = vectors[:, 1:] * np.sqrt(values[1:])
    about_first = 0.5 * (squares[0, 1:, None] + squares[0, 1:] - squares[1:, 1:])
    by_cholesky = np.pad(np.linalg.cholesky(about_first), [(1, 0), (0, 0)])
    # They are different embeddings: the first one has no vertex at the origin.
    assert np.linalg.norm(by_vectors, axis=1).min() > 0.1 * np.linalg.norm(by_vectors, axis=1).max()
    turn = np.linalg.qr(rng.standard_normal((by_vectors.shape[1],) * 2))[0]
    turn[:, 0] *= -np.sign(np.linalg.det(turn))
    assert np.linalg.det(turn) < 0, "a reflection"
    wider = np.pad(by_cholesky @ turn, [(0, 0), (3, 2)], constant_values=np.abs(by_cholesky).max())
    expected = InteriorDistance(body, GivenEmbedding(by_vectors), coordinates).distance(p, q)
    shift = rng.standard_normal(by_vectors.shape[1])
    for rows in (by_cholesky, by_vectors @ turn, by_vectors + shift, by_cholesky @ turn + shift, wider):
        found = InteriorDistance(body, GivenEmbedding(rows), coordinates).distance(p, q)
        np.testing.assert_allclose(found, expected, rtol=1e-8)
    for kind in (exact_distance("commute", body), GivenDistances(np.sqrt(squares))):
        found = InteriorDistance(body, kind, coordinates).distance(p, q)
        np.testing.assert_allclose(found, expected, rtol=1e-7)


@pytest.mark.one_is_quick
@EVERYWHERE
@pytest.mark.parametrize("kind", EXACT)
@BY_ALL_COORDINATES
def test_interpolation(name, kind, coordinates, rng):
    """ "d^ interpolates d on the boundary: d^(v_i, v_j) = d(v_i, v_j)"; d is computed from its definition."""
    body = shape(name)
    solver = solver_of(kind, body, coordinates)
    i, j = np.triu_indices(len(body.vertices), 1)
    some = rng.choice(len(i), 400, replace=False)
    i, j = i[some], j[some]
    expected = np.sqrt(boundary_squares(kind, body)[i, j])
    found = solver.distance(body.vertices[i], body.vertices[j])
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-9 * expected.max())


@pytest.mark.one_is_quick
@pytest.mark.parametrize("name", [*RANDOM, *BUNDLED])
@pytest.mark.parametrize("coordinates", COORDINATES)
def test_euclidean_reproduction(name, coordinates):
    """ "If d(v_i, v_j) = |v_i - v_j| then d^(p, q) = |p - q|."

    By linear precision, which Shepard's weights lack: they miss it.
    """
    body, (p, q) = shape(name), pairs(name, 50)
    found = InteriorDistance(body, Euclidean(), coordinates).distance(p, q)
    error = np.abs(found - np.linalg.norm(p - q, axis=1)).max() / body.diagonal
    if Property.LINEAR_PRECISION in COORDINATES[coordinates].properties:
        assert error < 1e-10
    else:
        assert error > 1e-2
