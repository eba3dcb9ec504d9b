"""What is different about polygons: they lie in the plane z = 0 and are looked straight down on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from idviewer.core import Shape

DOWN, NORTH = np.array((0.0, 0.0, -1.0)), np.array((0.0, 1.0, 0.0))
"""Where one looks to, and what is at the picture's upper edge."""


def is_flat(shape: Shape | None) -> bool:
    """Whether it is a polygon."""
    return shape is not None and shape.dimension == 2
