"""Compiling the kernels ahead of their first use, where it can be told to the user."""

from __future__ import annotations

from collections.abc import Callable, Generator

import numpy as np

from idviewer.core import _kernels as kernels
from idviewer.core._kernels import LANES


def compile_steps() -> Generator[float, None, None]:
    """Compile every kernel, or read it from numba's cache; yields the share done between them."""
    point, view, weights = np.zeros((1, 3, LANES)), np.zeros((1, 3, 4, LANES)), np.zeros((1, 3, LANES))
    corner, share, states = np.ones((3, 3)), np.zeros((4, LANES)), np.zeros((1, LANES), dtype=np.int8)
    faces = np.zeros((1, 3), dtype=np.int32)
    vector = (1.0, 0.0, 0.0)
    calls: list[Callable[[], object]] = [
        lambda: kernels._look_from(point[0], corner, view[0], np.zeros((2, LANES))),
        lambda: kernels._face_shares(view[0, 0], view[0, 1], view[0, 2], share),
        lambda: kernels._accumulate(share[0], share[1], share[2], share),
        lambda: kernels._edge_vector(vector, vector),
        lambda: kernels._edge_flux(vector, vector, vector, 1.0),
        lambda: kernels._grazing_shares(vector, vector, vector, vector, 0.0),
        lambda: kernels._weigh_block(point[0], corner, faces, 0.0, view[0], weights[0]),
        lambda: kernels.mean_value_weights(point, corner, faces, 0.0, view, weights, states),
        lambda: kernels.interpolate(
            point, corner, faces, 0.0, (view, weights), corner, np.zeros((1, LANES, 3)), states
        ),
    ]
    for done, call in enumerate(calls):
        call()
        yield (done + 1) / len(calls)
