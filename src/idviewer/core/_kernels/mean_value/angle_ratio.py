"""theta / sin(theta) as near-minimax polynomials in s = sin^2(theta / 2): kernels need no trigonometry."""

from __future__ import annotations

import numpy as np

LIMIT_TO_29_DEGREES = 1.0 / 16.0
"""Up to this s a short polynomial does: angles below 29 degrees."""

LIMIT_TO_10_DEGREES = 1.0 / 128.0
"""Up to this s a still shorter one does: angles below 10 degrees."""


def fit_angle_ratio(highest: float, degree: int) -> tuple[float, ...]:
    """Coefficients, lowest first, of the polynomial q on [0, highest] with theta / sin(theta) = 1 + s q(s).

    The fit interpolates the power series (q_0 = 2/3, q_k = q_(k-1) (2k+2) / (2k+3)) at Chebyshev nodes.
    """
    nodes = 0.5 * highest * (1.0 + np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1)))
    term = np.full_like(nodes, 2.0 / 3.0)
    series = term.copy()
    for k in range(1, 80):
        term = term * nodes * (2.0 * k + 2.0) / (2.0 * k + 3.0)
        series += term
    fit = np.polynomial.Chebyshev.fit(nodes, series, degree, domain=[0.0, highest])
    return tuple(float(value) for value in fit.convert(kind=np.polynomial.Polynomial).coef)


RATIO_TO_90_DEGREES = fit_angle_ratio(0.5, 20)
"""On [0, 1/2], with an error of 5e-16."""

RATIO_TO_29_DEGREES = fit_angle_ratio(LIMIT_TO_29_DEGREES, 8)
"""On [0, LIMIT_TO_29_DEGREES], with an error of 1e-17 in theta / sin(theta)."""

RATIO_TO_10_DEGREES = fit_angle_ratio(LIMIT_TO_10_DEGREES, 4)
"""On [0, LIMIT_TO_10_DEGREES], likewise."""
