"""theta / sin(theta) as a polynomial in sin^2(theta / 2), so that kernels need no trigonometry."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

DEGREE = 20
"""Enough for full double precision: the fit's error is 5e-16."""


def fit_angle_ratio(degree: int = DEGREE) -> NDArray[np.float64]:
    """Coefficients, lowest first, of the polynomial q on [0, 1/2] with theta / sin(theta) = 1 + s q(s).

    The fit interpolates the power series (q_0 = 2/3, q_k = q_(k-1) (2k+2) / (2k+3)) at Chebyshev nodes.
    """
    nodes = 0.25 + 0.25 * np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    term = np.full_like(nodes, 2.0 / 3.0)
    series = term.copy()
    for k in range(1, 80):
        term = term * nodes * (2.0 * k + 2.0) / (2.0 * k + 3.0)
        series += term
    fit = np.polynomial.Chebyshev.fit(nodes, series, degree, domain=[0.0, 0.5])
    return np.asarray(fit.convert(kind=np.polynomial.Polynomial).coef, dtype=np.float64)


COEFFICIENTS = tuple(float(coefficient) for coefficient in fit_angle_ratio())
