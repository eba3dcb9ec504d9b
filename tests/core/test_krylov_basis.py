"""Many long orthonormal vectors, against NumPy's products."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from idviewer.core._kernels import LANES
from idviewer.core.spectrum.krylov_basis import BLOCKS_PER_ARRAY, KrylovBasis, inner, make_orthogonal
from idviewer.core.steps import finish

COUNTS = [200, 217, 1501]
"""Rows: none of the parts, some or all of them leave a remainder."""


def filled(rng, count, blocks):
    """A basis of random orthonormal vectors."""
    basis = KrylovBasis(count)
    for _ in range(blocks):
        block = rng.standard_normal((count, LANES))
        for some in basis:
            make_orthogonal(block, some)
            make_orthogonal(block, some)
        basis.append(block)
    return basis


def stacked(basis):
    return np.concatenate([block for some in basis for block in some], axis=1)


@pytest.mark.parametrize("count", [1, 5, *COUNTS])
@pytest.mark.parametrize("blocks", [1, 3])
def test_inner_products_are_those_of_numpy(rng, count, blocks):
    vectors, block = rng.standard_normal((blocks, count, LANES)), rng.standard_normal((count, LANES))
    expected = np.concatenate([some.T @ block for some in vectors])
    np.testing.assert_allclose(inner(vectors, block), expected, atol=1e-11)


@pytest.mark.parametrize("count", COUNTS)
def test_all_blocks_are_orthonormal_across_chunks(rng, count):
    vectors = stacked(filled(rng, count, BLOCKS_PER_ARRAY + 2))
    np.testing.assert_allclose(vectors.T @ vectors, np.eye(vectors.shape[1]), atol=1e-13)


@pytest.mark.parametrize("count", COUNTS)
def test_what_is_taken_out_is_what_the_coefficients_tell(rng, count):
    basis, block = filled(rng, count, 3), rng.standard_normal((count, LANES))
    left, (vectors,) = block.copy(), basis
    coefficients = make_orthogonal(left, vectors)
    np.testing.assert_allclose(left + stacked(basis) @ coefficients, block, atol=1e-12)
    np.testing.assert_allclose(stacked(basis).T @ left, 0.0, atol=1e-12)


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("width", [1, LANES, LANES + 3])
def test_combinations_go_where_the_order_says(rng, count, width):
    basis, order = filled(rng, count, BLOCKS_PER_ARRAY + 1), rng.permutation(count)
    coefficients = rng.standard_normal((BLOCKS_PER_ARRAY * LANES, width))  # none of the last block
    found = finish(basis.combination_steps(coefficients, order))
    np.testing.assert_allclose(
        found[order], stacked(basis)[:, : BLOCKS_PER_ARRAY * LANES] @ coefficients, atol=1e-12
    )


@pytest.mark.parametrize("scale", [1e-150, 1.0, 1e150])
def test_a_block_is_q_r_whatever_its_scale(rng, scale):
    block = scale * rng.standard_normal((100, LANES))
    basis = KrylovBasis(100)
    upper = basis.append(block.copy())
    np.testing.assert_allclose(basis[0].T @ basis[0], np.eye(LANES), atol=1e-14)
    np.testing.assert_allclose(basis[0] @ upper, block, atol=1e-13 * scale)


def test_a_nearly_singular_block_becomes_orthonormal_too(rng):
    block = rng.standard_normal((100, LANES))
    block[:, 3] = block[:, 0] * (1.0 + 1e-15)
    basis = KrylovBasis(100)
    upper = basis.append(block.copy())
    np.testing.assert_allclose(basis[0].T @ basis[0], np.eye(LANES), atol=1e-12)
    np.testing.assert_allclose(basis[0] @ upper, block, atol=1e-12)


def test_sums_do_not_depend_on_the_number_of_threads(rng):
    vectors, block = rng.standard_normal((2, 5000, LANES)), rng.standard_normal((5000, LANES))
    before, found = numba.get_num_threads(), []
    try:
        for threads in (1, before):
            numba.set_num_threads(threads)
            found.append(inner(vectors, block))
    finally:
        numba.set_num_threads(before)
    np.testing.assert_array_equal(*found)
