"""Functions for a single call, over the objects that are worth keeping for many."""

from __future__ import annotations

from numpy.typing import ArrayLike

from idviewer.core.arrays import Floats
from idviewer.core.distances import Distance
from idviewer.core.interior.solver import InteriorDistance
from idviewer.core.shapes.shape import ShapeLike
from idviewer.core.spectrum.resolution import Refine


def interior_distance(
    shape: ShapeLike,
    p: ArrayLike,
    q: ArrayLike,
    distance: Distance | None = None,
    refine: Refine = "auto",
) -> Floats:
    """Interior distances of point pairs; for many calls on one shape keep an `InteriorDistance`.

    Source: Rustamov, Lipman and Funkhouser 2009, eq. 1.

    Args:
        shape: n vertices, in 2 or 3 dimensions, or its arrays (see `idviewer.core.shapes.shape`).
        p, q: (p, dimension) or (1, dimension).
        distance: the boundary distance, the diffusion distance by default.
        refine: as of `InteriorDistance`.

    Returns:
        (p,), NaN where a point is outside the shape.

    Raises:
        ValueError: the points have another dimension, or the distance cannot be had on this shape.

    >>> from idviewer.core import read_mesh, sample_path
    >>> hand = read_mesh(sample_path("hand_2k"))
    >>> interior_distance(hand, hand.vertices[:1], hand.vertices[:1]).tolist()
    [0.0]
    """
    return InteriorDistance(shape, distance, refine=refine).distance(p, q)
