"""What is different about polygons: they lie in the plane z = 0 and are looked straight down on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from idviewer.core.polygon_section import spatial

if TYPE_CHECKING:
    from idviewer.core import Shape

DOWN, NORTH = np.array((0.0, 0.0, -1.0)), np.array((0.0, 1.0, 0.0))
"""Where one looks to, and what is at the picture's upper edge."""


def is_flat(shape: Shape | None) -> bool:
    """Whether it is a polygon."""
    return shape is not None and shape.dimension == 2


def in_space(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(p, 3) positions as they are, and those of a polygon, (p, 2), in the plane z = 0.

    >>> in_space(np.array([[1.0, 2.0]])).tolist()
    [[1.0, 2.0, 0.0]]
    """
    return spatial(positions) if positions.shape[1] == 2 else positions
