"""Sparse factors in an order from nested dissection, and the vectors that Lanczos makes with them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse
from scipy.spatial import Delaunay

from idviewer.core._kernels.linear_algebra.supernodes import group_columns
from idviewer.core.spectrum.block_lanczos import BLOCK, BlockLanczos
from idviewer.core.spectrum.ldl_factorization import LDLFactorization
from idviewer.core.spectrum.nested_dissection import MOST_OFF_CENTRE, SEPARATOR, dissect


def graph(rng, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and the edges of their Delaunay triangulation."""
    points = rng.random((count, 2))
    corners = Delaunay(points).simplices
    return points, np.unique(np.sort(corners[:, [[0, 1], [1, 2], [0, 2]]].reshape(-1, 2), axis=1), axis=0)


def laplacian(edges: np.ndarray, weights: np.ndarray, count: int) -> sparse.csc_array:
    half = sparse.coo_array((weights, edges.T), shape=(count, count))
    whole = half + half.T
    return sparse.csc_array(sparse.diags_array(whole.sum(axis=0)) - whole)


@pytest.mark.parametrize("count", [4, 50, 1000])
def test_no_edge_joins_the_halves_of_a_part(rng, count):
    """Follow both ends of every edge down the levels: they stay together until one of them separates."""
    points, edges = graph(rng, count)
    order, path = dissect(points, edges)
    np.testing.assert_array_equal(np.sort(order), np.arange(count))
    together = np.ones(len(edges), dtype=bool)
    for a, b in zip(path[edges[:, 0]].T, path[edges[:, 1]].T, strict=True):
        separated = (a == SEPARATOR) | (b == SEPARATOR)
        assert (a[together & ~separated] == b[together & ~separated]).all()
        together &= ~separated


def test_separators_come_after_what_they_separate(rng):
    points, edges = graph(rng, 1000)
    order, path = dissect(points, edges)
    first = path[order, 0]
    assert (np.diff(first) >= 0).all()
    assert abs(np.mean(first == 0) - 0.5) < MOST_OFF_CENTRE + 0.05
    assert (first == SEPARATOR).sum() < 4 * np.sqrt(1000)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("count", [3, 30, 1500])
@pytest.mark.parametrize("width", [1, BLOCK, 2 * BLOCK + 3])
def test_a_solution_solves(rng, count, width):
    points, edges = graph(rng, max(count, 3))
    matrix = laplacian(edges, rng.uniform(0.1, 10.0, len(edges)), count)
    matrix = sparse.csc_array(matrix + 0.1 * sparse.eye_array(count))
    sides = rng.standard_normal((count, width))
    found = LDLFactorization(matrix, points).solve(sides)
    np.testing.assert_allclose(found, np.linalg.solve(matrix.toarray(), sides), rtol=1e-9, atol=1e-10)


def test_parts_that_do_not_touch_are_solved_too(rng):
    points, edges = graph(rng, 300)
    apart = edges[(edges[:, 0] < 150) == (edges[:, 1] < 150)]
    matrix = sparse.csc_array(laplacian(apart, np.ones(len(apart)), 300) + sparse.eye_array(300))
    sides = rng.standard_normal((300, 2))
    found = LDLFactorization(matrix, points).solve(sides)
    np.testing.assert_allclose(matrix @ found, sides, atol=1e-12)


def test_what_is_not_positive_definite_is_refused(rng):
    points, edges = graph(rng, 200)
    matrix = laplacian(edges, np.ones(len(edges)), 200)
    with pytest.raises(np.linalg.LinAlgError, match="not positive definite"):
        LDLFactorization(sparse.csc_array(matrix - 0.5 * sparse.eye_array(200)), points)


def test_an_indefinite_matrix_is_solved_and_its_inertia_counted(rng):
    points, edges = graph(rng, 500)
    matrix = laplacian(edges, rng.uniform(0.1, 10.0, len(edges)), 500)
    shifted = sparse.csc_array(matrix - 3.0 * sparse.eye_array(500))
    factor = LDLFactorization(shifted, points, definite=False)
    assert factor.negative == np.count_nonzero(np.linalg.eigvalsh(shifted.toarray()) < 0)
    sides = rng.standard_normal((500, 3))
    np.testing.assert_allclose(shifted @ factor.solve(sides), sides, atol=1e-9)


def test_digits_lost_for_want_of_pivots_are_found_again(rng):
    """A shift next to an eigenvalue of what is eliminated first makes a tiny pivot."""
    points, edges = graph(rng, 500)
    matrix = laplacian(edges, rng.uniform(0.1, 10.0, len(edges)), 500)
    upper = sparse.coo_array(sparse.triu(matrix, 1))
    first = dissect(points, np.stack([upper.row, upper.col], axis=1))[0][0]
    shifted = sparse.csc_array(matrix - (matrix[first, first] + 1e-7) * sparse.eye_array(500))
    sides = rng.standard_normal((500, 3))
    found = LDLFactorization(shifted, points, definite=False)
    assert np.linalg.norm(shifted @ found.solve(sides) - sides) < 1e-9 * np.linalg.norm(sides)
    found._refining = None
    assert np.linalg.norm(shifted @ found.solve(sides) - sides) > 1e-9


def test_columns_that_go_together_have_the_same_entries(rng):
    """Everything below the diagonal of a dense block goes by fours; a path's columns go by pairs at most."""
    lower = np.tril(rng.random((11, 11)) < 0.4, -1)
    lower[5:, 4:9] = np.tril(np.ones((11, 11), dtype=bool))[5:, 4:9]
    matrix = sparse.csc_array((lower | np.eye(11, dtype=bool)).astype(float))
    matrix.sort_indices()
    part = np.array([0] * 7 + [1] * 4)
    widths = group_columns(matrix.indptr, matrix.indices, part)
    firsts = np.flatnonzero(widths)
    assert widths.sum() == 11
    assert widths.max() > 1
    np.testing.assert_array_equal(np.diff(np.append(firsts, 11)), widths[firsts])
    for first, width in zip(firsts, widths[firsts], strict=True):
        for column in range(first + 1, first + width):
            assert part[column] == part[first]
            below = set(np.flatnonzero(matrix.toarray()[:, column - 1])) - {column - 1}
            assert set(np.flatnonzero(matrix.toarray()[:, column])) == below


@pytest.mark.slow
def test_the_basis_stays_orthonormal_and_projects_the_inverse(rng):
    """By hand: the projected matrix is Q^T (A + shift)^-1 Q, and the left out vector stays out."""
    points, edges = graph(rng, 900)
    matrix = laplacian(edges, np.ones(len(edges)), 900)
    factor = LDLFactorization(sparse.csc_array(matrix + 0.01 * sparse.eye_array(900)), points)
    krylov = BlockLanczos(factor, 0.01, np.ones(900))
    for _ in range(10):
        for _ in krylov.expand():
            pass
    basis = krylov.vectors(np.eye(krylov.size))
    np.testing.assert_allclose(basis.T @ basis, np.eye(krylov.size), atol=1e-13)
    assert np.abs(basis.sum(axis=0)).max() < 1e-12
    inverse = np.linalg.inv(matrix.toarray() + 0.01 * np.eye(900))
    inner = krylov._projected[:-BLOCK, :-BLOCK]
    expected = (basis.T @ inverse @ basis)[:-BLOCK, :-BLOCK]
    np.testing.assert_allclose(inner, expected, atol=1e-10 * np.abs(expected).max())
