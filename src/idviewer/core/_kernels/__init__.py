"""Compiled loops of the mean value coordinates; the only place that knows numba.

Notation as in docs/mean_value.md: x a query point, u_i the unit vector from x to vertex i, d_i its
distance; for the triangle (1, 2, 3), s_jk = |u_j - u_k|^2 / 4 and c_jk = |u_j + u_k|^2 / 4 = 1 - s_jk.
Everything is in units of the bounding box's diagonal, about its centre.
"""

from idviewer.core._kernels.blocks import (
    INSIDE,
    ON_SURFACE,
    OUTSIDE,
    interpolate,
    mean_value_weights,
    thread_count,
)
from idviewer.core._kernels.faces import LANES
from idviewer.core._kernels.surface import Surface

__all__ = [
    "INSIDE",
    "LANES",
    "ON_SURFACE",
    "OUTSIDE",
    "Surface",
    "interpolate",
    "mean_value_weights",
    "thread_count",
]
