"""Compiled loops; the only place that imports numba.

`simd` has vectors and numba's options, `parallel` threads. On them stand `mean_value` (coordinates of points,
exactly), `geometry` (closest points, edge collapses) and `linear_algebra` (tall-skinny products, triangular
solves); on `mean_value` stands `treecode` (coordinates within a tolerance).

The coordinates' notation is that of docs/mean_value.md: x a query point, u_i the unit vector from x to vertex
i, d_i its distance; for the triangle (1, 2, 3), s_jk = |u_j - u_k|^2 / 4 and c_jk = |u_j + u_k|^2 / 4 =
1 - s_jk. Their points are in units of the bounding box's diagonal, about its centre.
"""

from importlib import import_module
from pkgutil import walk_packages

from idviewer.core._kernels.machine_code import kept_by_sources

with kept_by_sources():
    for _module in sorted(one.name for one in walk_packages(__path__, f"{__name__}.")):
        import_module(_module)

    from idviewer.core._kernels.mean_value.cache_blocks import Workspace, no_boundary_hits, workspaces_for
    from idviewer.core._kernels.mean_value.packets import thread_count, weigh
    from idviewer.core._kernels.simd.lanes import LANES

__all__ = [
    "LANES",
    "Workspace",
    "no_boundary_hits",
    "thread_count",
    "weigh",
    "workspaces_for",
]
