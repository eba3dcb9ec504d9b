"""Compiling the kernels ahead of their first use, where it can be told to the user."""

from __future__ import annotations

from collections.abc import Callable, Generator

import numpy as np

from idviewer.core import _kernels as kernels
from idviewer.core._kernels import LANES, patches
from idviewer.core._kernels.ears import cut_ears
from idviewer.core._kernels.surface import patched


def compile_steps() -> Generator[float, None, None]:
    """Compile every kernel, or read it from numba's cache; yields the share done between them."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    surface = patched(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    points, weights = np.full((1, 3, LANES), 0.2), np.zeros((1, 4, LANES))
    scratch, landing = kernels.scratch_for(surface, 1), kernels.no_landing(1)
    calls: list[Callable[[], object]] = [
        lambda: cut_ears(corners[:3, :2].copy(), np.array([0, 3])),
        lambda: patches.warm_up(points, surface, scratch, weights, landing),
        lambda: kernels.weigh(
            points,
            surface,
            0.0,
            scratch,
            landing,
            np.zeros((1, 1, LANES)),
            weights,
            (np.zeros((1, 4, LANES)), np.zeros((1, 1, LANES, LANES))),
            (np.zeros((1, LANES), dtype=np.int64), np.zeros((1, 4))),
        ),
    ]
    for done, call in enumerate(calls):
        call()
        yield (done + 1) / len(calls)
