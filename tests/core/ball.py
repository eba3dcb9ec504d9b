"""Closed form of the diffusion distance inside the unit ball, by spherical harmonics."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre


def diffusion_distance(a: float, b: float, time: float, degrees: int = 20, nodes: int = 400) -> float:
    """Between (0, 0, a) and (0, 0, b), of the modes l = 1, ..., degrees.

    The mean value interpolation of P_l(cos theta) at (0, 0, a) is the mean of P_l over directions from there,
    weighted by one over the way to the sphere.
    """
    u, weights = legendre.leggauss(nodes)

    def coefficients(height: float) -> np.ndarray:
        way = -height * u + np.sqrt(1.0 - height**2 * (1.0 - u**2))
        z = np.clip(height + way * u, -1.0, 1.0)
        values = legendre.legvander(z, degrees)
        return (weights / way) @ values / (weights / way).sum()

    degree = np.arange(degrees + 1)
    power = np.exp(-2.0 * degree * (degree + 1) * time) * (2 * degree + 1) / (4.0 * np.pi)
    return float(np.sqrt((power * (coefficients(a) - coefficients(b)) ** 2)[1:].sum()))
