"""Spectral filters: the named ones again, and that expressions are arithmetic and nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.test_distances_spectral import stretched

from idviewer.core import GPS, Biharmonic, Diffusion, DistanceError, SpectralFilter, eigenpairs
from idviewer.core.distances.expressions import Expression


@pytest.fixture(scope="module")
def spectrum():
    return eigenpairs(stretched(3))


@pytest.mark.parametrize(
    ("text", "function", "same"),
    [
        ("exp(-lambda / (8 * lambda_2))", None, Diffusion()),
        ("exp(-0.3*x)", lambda x: np.exp(-0.3 * x), Diffusion(time=0.3)),
        ("lambda ** -0.5", lambda x: x**-0.5, GPS()),
        ("1 / sqrt(λ)", lambda x: 1 / np.sqrt(x), GPS()),
        ("1/lambda", lambda x: 1 / x, Biharmonic()),
        ("  +exp(-log(lambda)) ", lambda x: 1 / x, Biharmonic()),
    ],
)
def test_named_distances_are_filters(spectrum, text, function, same):
    np.testing.assert_allclose(SpectralFilter(text).scale(spectrum), same.scale(spectrum), rtol=1e-12)
    if function is not None:
        np.testing.assert_allclose(SpectralFilter(function).scale(spectrum), same.scale(spectrum), rtol=1e-12)
    assert SpectralFilter(text).basis_key == same.basis_key


def test_the_description_says_what_the_first_mode_left_out_weighs(spectrum):
    assert "left out" not in SpectralFilter("exp(-lambda)").describe(spectrum)
    heaviest, beyond = 1 / spectrum.values[0], 1 / spectrum.bound
    told = SpectralFilter("1/lambda").describe(spectrum)
    assert told.endswith(f"modes; the first left out weighs {100 * beyond / heaviest:.2g}%")


@pytest.mark.parametrize(
    ("filter_", "part"),
    [
        ("lambda - 1e3", "the filter lambda - 1e3: is -"),
        ("log(-lambda)", "is nan at lambda"),
        ("1e308 * 1e308", "is inf at lambda"),
        ("9**9**9**9", "is inf at lambda"),
        ("0", "is 0 at every eigenvalue"),
        (lambda x: x[:2], "gives (2,) numbers for eigenvalues of shape"),
        (lambda x: 1.0, "gives () numbers"),
    ],
)
def test_filters_that_are_none(spectrum, filter_, part):
    with pytest.raises(DistanceError) as error:
        SpectralFilter(filter_).scale(spectrum)
    assert part in str(error.value)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("", "empty"),
        ("1 +", "ends too early"),
        ("1 / (2", "cannot be read"),
        ("2 lambda", "cannot be read"),
        ("2 ^ lambda", "powers are written **"),
        ("__import__('os').system('true')", "\"__import__('os').system('true')\" at character 1 is no part"),
        ("exp(x) + open('f')", "\"open('f')\" at character 10 is no part"),
        ("lambda + y", '"y" at character 10 is no part'),
        ("  λ + ß", '"ß" at character 7 is no part'),
        ("x.real", '"x.real" at character 1'),
        ("exp(x, 2)", '"exp(x, 2)"'),
        ("exp", '"exp" at character 1'),
        ("[x for x in (1,)]", "is no part"),
        ("lambda: 0", "cannot be read"),
        ("True", '"True"'),
        ("'a' * 9", "\"'a'\""),
        ("x if x else x", "is no part"),
        ("x < 1", "is no part"),
        ("x // 2", "is no part"),
        ("(y := 1)", "is no part"),
        ("x\x00", "cannot be read"),
        ("1" * 300, "300 characters; 200 are the most"),
        ("(" * 150 + "x" + ")" * 49, "cannot be read"),
    ],
)
def test_what_is_no_arithmetic_is_refused_at_its_place(text, part):
    with pytest.raises(ValueError) as error:  # noqa: PT011
        SpectralFilter(text)
    assert part in str(error.value)
    assert "\n" not in str(error.value)


def test_a_filter_is_an_expression_or_a_function():
    with pytest.raises(
        ValueError, match=r"the filter must be an expression such as exp\(.*, or a function, not 3"
    ):
        SpectralFilter(3)


def test_precedence_is_that_of_python(rng):
    x = rng.uniform(1, 3, 20)
    text = "-x**2 + 3*x/2 - -exp(x*0.1)**2 * lambda_2"
    np.testing.assert_allclose(Expression(text)(x, 1.7), -(x**2) + 3 * x / 2 + np.exp(x * 0.1) ** 2 * 1.7)
