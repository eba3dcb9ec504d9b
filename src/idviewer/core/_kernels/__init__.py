"""Compiled loops of the mean value coordinates; the only place that knows numba.

Notation as in docs/mean_value.md: x a query point, u_i the unit vector from x to vertex i, d_i its
distance; for the triangle (1, 2, 3), s_jk = |u_j - u_k|^2 / 4 and c_jk = |u_j + u_k|^2 / 4 = 1 - s_jk.
Everything is in units of the bounding box's diagonal, about its centre.
"""

from idviewer.core._kernels.mean_value.blocks import thread_count, weigh
from idviewer.core._kernels.mean_value.patches import Scratch, no_boundary_hits, scratch_for
from idviewer.core._kernels.simd.lanes import LANES

__all__ = [
    "LANES",
    "Scratch",
    "no_boundary_hits",
    "scratch_for",
    "thread_count",
    "weigh",
]
