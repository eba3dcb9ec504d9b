"""Functions for a single call, over the objects that are worth keeping for many."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from idviewer.core.distances import Distance
from idviewer.core.interior import InteriorDistance
from idviewer.core.shape import Shape

Floats = NDArray[np.float64]


def interior_distance(mesh: Shape, p: ArrayLike, q: ArrayLike, distance: Distance | None = None) -> Floats:
    """Interior distances of point pairs; for many calls on one mesh keep an `InteriorDistance`.

    Args:
        mesh: n vertices.
        p: (p, 3) or (1, 3).
        q: (p, 3) or (1, 3).
        distance: the boundary distance, the diffusion distance by default.

    Returns:
        (p,), NaN where a point is outside the mesh.

    >>> from idviewer.core import read_mesh, sample_path
    >>> hand = read_mesh(sample_path("hand_2k"))
    >>> interior_distance(hand, hand.vertices[:1], hand.vertices[:1]).tolist()
    [0.0]
    """
    return InteriorDistance(mesh, distance).distance(p, q)
