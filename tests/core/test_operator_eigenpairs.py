"""Eigenpairs by number, of shapes and of given operators: against ARPACK and LAPACK."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import scipy.linalg
from scipy import sparse
from scipy.sparse.linalg import eigsh
from tests.core import shapes
from tests.core.outlines import circle

from idviewer.core import (
    Diffusion,
    InteriorDistance,
    Mesh,
    Polygon,
    Spectrum,
    eigenpairs,
    laplacian_of,
    masses_of,
)
from idviewer.core.spectrum import operator_eigenpairs
from idviewer.core.spectrum.graph_positions import graph_positions
from idviewer.core.spectrum.ldl_factorization import LDLFactorization

Operator = tuple[sparse.csc_array, np.ndarray]

MESH = Mesh(*shapes.torus(40, 24))
POLYGON = Polygon(circle(720) * [1.0, 0.6])


def operator_of(shape: Mesh | Polygon) -> Operator:
    return laplacian_of(shape), masses_of(shape)


def graph_laplacian(count: int, edges: np.ndarray) -> sparse.csc_array:
    i, j = edges.T
    weights = sparse.coo_array((np.ones(2 * len(i)), (np.r_[i, j], np.r_[j, i])), shape=(count, count))
    adjacency = (weights.tocsc() > 0).astype(float)
    return sparse.csc_array(sparse.diags_array(adjacency.sum(axis=0)) - adjacency)


def two_components() -> Operator:
    """A random graph beside a path."""
    rng = np.random.default_rng(1)
    dense = rng.integers(0, 900, (3000, 2))
    dense = np.concatenate(
        [dense[dense[:, 0] != dense[:, 1]], np.column_stack([np.arange(899), np.arange(1, 900)])]
    )
    path = 900 + np.column_stack([np.arange(299), np.arange(1, 300)])
    return graph_laplacian(1200, np.concatenate([dense, path])), np.ones(1200)


def dirichlet() -> Operator:
    """A torus with a ring of vertices held at zero."""
    laplacian, masses = operator_of(MESH)
    return sparse.csc_array(laplacian[48:, 48:]), masses[48:]


def copies(count: int) -> Operator:
    """The same body so many times: eigenvalues are as often equal, more often than a block is wide."""
    laplacian, masses = operator_of(Mesh(*shapes.torus(16, 10)))
    return sparse.block_diag([laplacian] * count, format="csc"), np.tile(masses, count)


OPERATORS: dict[str, tuple[Callable[[], Operator], int]] = {
    "mesh": (lambda: operator_of(MESH), 1),
    "polygon": (lambda: operator_of(POLYGON), 1),
    "graph of two components": (two_components, 2),
    "Dirichlet": (dirichlet, 0),
    "eleven components": (lambda: copies(11), 11),
}
"""And the dimension of the null space."""


def assert_pairs(found: Spectrum, laplacian: sparse.csc_array, masses: np.ndarray, nullity: int) -> None:
    """Against LAPACK's values; vectors are right if orthonormal, and with the values for energies."""
    k = len(found.values)
    roots = np.sqrt(masses)
    values = scipy.linalg.eigvalsh(laplacian.toarray() / roots[:, None] / roots)
    largest = values[-1]
    assert np.abs(values[:nullity]).max(initial=0.0) < 1e-12 * largest
    np.testing.assert_allclose(found.values, values[nullity : nullity + k], rtol=1e-9, atol=1e-13 * largest)
    gram = found.vectors.T @ (masses[:, None] * found.vectors)
    np.testing.assert_allclose(gram, np.eye(k), atol=1e-9)
    energies = found.vectors.T @ (laplacian @ found.vectors)
    np.testing.assert_allclose(energies, np.diag(found.values), atol=1e-6 * found.values[-1])
    np.testing.assert_allclose(np.diag(energies), found.values, rtol=1e-8)


@pytest.mark.parametrize("dense", [0, 10**6], ids=["Krylov", "dense"])
@pytest.mark.parametrize("k", [1, 12, pytest.param(40, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", OPERATORS)
def test_they_are_lapack_s(name, k, dense, monkeypatch):
    monkeypatch.setattr(
        operator_eigenpairs, "OPERATOR", operator_eigenpairs.OperatorSettings(dense_unknowns=dense)
    )
    made, nullity = OPERATORS[name]
    laplacian, masses = made()
    found = eigenpairs(laplacian, masses, k)
    assert len(found.values) == k
    assert_pairs(found, laplacian, masses, nullity)
    np.testing.assert_array_equal(found.masses, masses)


@pytest.mark.parametrize("name", ["mesh", "graph of two components", "Dirichlet"])
def test_they_are_arpack_s(name):
    made, nullity = OPERATORS[name]
    laplacian, masses = made()
    mass_matrix = sparse.diags_array(masses, format="csc")
    start = np.random.default_rng(0).standard_normal(len(masses))
    shift = -1e-3 * float(laplacian.diagonal().mean() / masses.mean())
    expected = eigsh(laplacian, 10 + nullity, mass_matrix, sigma=shift, v0=start, return_eigenvectors=False)
    found = eigenpairs(laplacian, mass_matrix, k=10)
    np.testing.assert_allclose(found.values, np.sort(expected)[nullity:], rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("name", OPERATORS)
def test_k_may_be_all_there_are_and_no_more(name):
    made, nullity = OPERATORS[name]
    laplacian, masses = made()
    count = len(masses) - nullity
    found = eigenpairs(laplacian, masses, count)
    assert len(found.values) == count
    assert found.bound == np.inf
    assert len(eigenpairs(laplacian, masses, count - 1).values) == count - 1
    if nullity:
        with pytest.raises(ValueError, match=f"k = {count + 1} pairs .* has {count} positive eigenvalues"):
            eigenpairs(laplacian, masses, count + 1)


def test_one_eigenvalue_of_many_copies_takes_several_spaces():
    """A star of n vertices has the eigenvalues 0, 1 (n - 2 times) and n: no Krylov space gets far."""
    count = 900
    star = graph_laplacian(count, np.column_stack([np.zeros(count - 1, dtype=int), np.arange(1, count)]))
    found = eigenpairs(star, np.ones(count), 30)
    np.testing.assert_allclose(found.values, 1.0, rtol=1e-12)
    np.testing.assert_allclose(found.vectors.T @ found.vectors, np.eye(30), atol=1e-10)


@pytest.mark.slow
def test_a_null_space_other_than_constants_is_left_out():
    """Signs turned at some vertices: L maps a function of values 1 and -1 to zero."""
    laplacian, masses = operator_of(MESH)
    signs = sparse.diags_array(np.where(np.arange(len(masses)) % 3 == 0, -1.0, 1.0))
    turned = eigenpairs(sparse.csc_array(signs @ laplacian @ signs), masses, 10)
    np.testing.assert_allclose(turned.values, eigenpairs(laplacian, masses, 10).values, rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("shape", [MESH, POLYGON, Polygon(circle(60))], ids=["mesh", "polygon", "small"])
def test_those_of_a_shape_are_the_first_of_the_paper_s(shape):
    full, few = eigenpairs(shape), eigenpairs(shape, k=8)
    np.testing.assert_allclose(few.values, full.values[:8], rtol=1e-9)
    np.testing.assert_array_equal(few.masses, full.masses)
    assert_pairs(few, *operator_of(shape), 1)
    assert len(eigenpairs(shape, k=len(shape.vertices) - 1).values) == len(shape.vertices) - 1


def test_arrays_are_called_as_the_mesh():
    by_arrays = eigenpairs(MESH.vertices, MESH.faces, k=8)
    by_mesh = eigenpairs(MESH, k=8)
    np.testing.assert_array_equal(by_arrays.values, by_mesh.values)
    np.testing.assert_array_equal(by_arrays.vectors, by_mesh.vectors)


@pytest.mark.slow
def test_an_operator_of_one_s_own_makes_a_distance():
    spectrum = eigenpairs(*operator_of(MESH), 60)
    points = 0.9 * MESH.vertices[:2] + 0.1 * MESH.vertices[:2].mean(axis=0)
    own = InteriorDistance(MESH, Diffusion(time=1.0), spectrum=spectrum)
    plain = InteriorDistance(MESH, Diffusion(time=1.0))
    np.testing.assert_allclose(
        own.distance(points[:1], points[1:]), plain.distance(points[:1], points[1:]), rtol=1e-6
    )


@pytest.mark.slow
def test_matrices_given_are_not_changed():
    laplacian, masses = operator_of(MESH)
    laplacian = sparse.csc_array(laplacian + sparse.csc_array(laplacian.shape))
    before = laplacian.copy()
    eigenpairs(laplacian, masses, 3)
    for one in ("data", "indices", "indptr"):
        np.testing.assert_array_equal(getattr(laplacian, one), getattr(before, one))


def test_hops_make_a_factor_nearly_as_sparse_as_places():
    laplacian, masses = operator_of(MESH)
    matrix = sparse.csc_array(laplacian + sparse.diags_array(masses))
    entries = [
        LDLFactorization(matrix, points)._columns.values.size
        for points in (MESH.vertices, graph_positions(matrix))
    ]
    assert entries[1] < 1.6 * entries[0]


GOOD, ONES = sparse.csc_array(operator_of(MESH)[0][:20, :20]), np.ones(20)


def spoiled(value: complex) -> sparse.csc_array:
    matrix = GOOD.tolil().astype(type(value))
    matrix[3, 4] = value
    return sparse.csc_array(matrix)


@pytest.mark.parametrize(
    ("laplacian", "masses", "k", "message"),
    [
        (GOOD[:10], ONES, 2, "L must be square"),
        (spoiled(1j), ONES, 2, "L must be real"),
        (spoiled(np.nan), ONES, 2, "not finite"),
        (spoiled(7.0), ONES, 2, "L must be symmetric"),
        (sparse.csc_array(-GOOD), ONES, 2, "negative eigenvalues"),
        (GOOD, ONES[:5], 2, r"masses must have the shape \(20,\)"),
        (GOOD, 0.0 * ONES, 2, "masses must be positive"),
        (GOOD, np.full(20, np.inf), 2, "masses must be positive and finite"),
        (GOOD, sparse.eye_array(19), 2, r"M must have the shape \(20, 20\)"),
        (GOOD, sparse.csc_array(GOOD), 2, "M must be diagonal: lump"),
        (GOOD, ONES, 0, "k must be a whole number from 1"),
        (GOOD, ONES, 21, "k must be a whole number from 1 to the 20"),
        (GOOD, ONES, 2.5, "k must be a whole number"),
        (GOOD, ONES, None, "k must be a whole number"),
    ],
)
def test_what_has_no_eigenpairs_is_refused_in_one_line(laplacian, masses, k, message):
    with pytest.raises(ValueError, match=message) as error:
        eigenpairs(laplacian, masses, k)
    assert "\n" not in str(error.value)


def test_a_large_operator_with_negative_eigenvalues_is_refused():
    laplacian, masses = operator_of(MESH)
    with pytest.raises(ValueError, match="negative eigenvalues"):
        eigenpairs(sparse.csc_array(-laplacian), masses, 5)
