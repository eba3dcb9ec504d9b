"""Compiling the kernels ahead of their first use, where it can be told to the user."""

from __future__ import annotations

from collections.abc import Callable, Generator

import numpy as np

from idviewer.core import _kernels as kernels
from idviewer.core._kernels import LANES, blocks, faces, grazing
from idviewer.core._kernels.surface import patched


def compile_steps() -> Generator[float, None, None]:
    """Compile every kernel, or read it from numba's cache; yields the share done between them."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    surface = patched(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    point = np.full((1, 3, LANES), 0.2)
    view, weights = np.zeros((1, 4, 5 * LANES)), np.zeros((1, 4, LANES))
    grazed, states = np.zeros(LANES), np.zeros((1, LANES), dtype=np.int8)
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    calls: list[Callable[[], object]] = [
        lambda: faces.look_from(point[0], corners, view[0]),
        lambda: faces.add_near_shares(view[0, 0], view[0, 1], view[0, 2], grazed),
        lambda: faces.add_far_shares(view[0, 0], view[0, 1], view[0, 2], grazed),
        lambda: faces.total(grazed),
        lambda: grazing.grazing_shares((0.0, 0.0, 0.0), x, y, z, 0.0),
        lambda: blocks.warm_up(point[0], surface, 0.0, (view[0], weights[0])),
        lambda: kernels.mean_value_weights(
            point, surface, 0.0, (view, weights), np.zeros((1, LANES), dtype=np.int64), np.zeros((1, 4))
        ),
        lambda: kernels.interpolate(
            point, surface, 0.0, (view, weights), corners, np.zeros((1, LANES, 3)), states
        ),
    ]
    for done, call in enumerate(calls):
        call()
        yield (done + 1) / len(calls)
