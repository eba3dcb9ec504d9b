"""Vectors in compiled kernels: every operation against numpy's, in both precisions."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from idviewer.core._kernels.simd.lanes import (
    LANES,
    any_of,
    at,
    bits,
    choose,
    larger,
    load,
    root,
    smaller,
    splat,
    store,
    total,
    transpose,
    widened,
)


@numba.njit(error_model="numpy")
def by_lanes(array, out):
    """Each operation once; the results go to the rows of out."""
    a, b = load(array, 0), load(array, LANES)
    store(out, 0, a + b)
    store(out, LANES, 2 - a * b)
    store(out, 2 * LANES, a / b - 0.5)
    store(out, 3 * LANES, root(a) * at(array, 3))
    store(out, 4 * LANES, choose(a < b, a, 7.0))
    store(out, 5 * LANES, smaller(a, b) + 10 * larger(a, 0.5))
    store(out, 6 * LANES, splat(at(array, LANES)))
    out[7, 0] = total(a)
    return (
        bits(a < b),
        bits(a <= 0.5),
        bits(b > a),
        bits(a >= splat(at(array, 0))),
        any_of(a > 2.0),
        any_of(a < b),
    )


@pytest.mark.slow
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_the_operations_are_those_of_numpy(dtype, rng):
    array = rng.uniform(0.1, 1, (2, LANES)).astype(dtype)
    array[0, 5] = 0.5
    a, b = array
    out = np.zeros((8, LANES), dtype)
    found = by_lanes(array, out)
    expected = [
        a + b,
        2 - a * b,
        a / b - 0.5,
        np.sqrt(a) * a[3],
        np.where(a < b, a, 7),
        np.minimum(a, b) + 10 * np.maximum(a, 0.5),
        np.full(LANES, b[0]),
    ]
    rounding = 8 * float(np.finfo(dtype).eps)
    np.testing.assert_allclose(out[:7], np.array(expected, dtype), rtol=rounding, atol=rounding)
    assert out[7, 0] == pytest.approx(a.sum(dtype=np.float64), rel=rounding)
    masks = (a < b, a <= 0.5, b > a, a >= a[0])
    assert found[:4] == tuple(sum(1 << i for i in np.flatnonzero(mask)) for mask in masks)
    assert found[4:] == (False, bool((a < b).any()))


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_square_is_transposed_in_place(dtype, rng):
    array = rng.random((2 + LANES, LANES)).astype(dtype)
    expected = array.copy()
    expected[2:] = array[2:].T
    turned(array, 2 * LANES)
    np.testing.assert_array_equal(array, expected)


@numba.njit
def turned(array, offset):
    transpose(array, offset)


@numba.njit
def mixed(array, other):
    return total(load(array, 0) + load(other, 0))


def test_vectors_of_two_precisions_do_not_mix():
    with pytest.raises(numba.TypingError):
        mixed(np.zeros(LANES), np.zeros(LANES, np.float32))


@pytest.mark.slow
def test_widened_numbers_are_the_same(rng):
    @numba.njit
    def widen(array, out):
        store(out, 0, widened(load(array, 0)))

    array, out = rng.normal(size=LANES).astype(np.float32), np.empty(LANES)
    widen(array, out)
    np.testing.assert_array_equal(out, array)
