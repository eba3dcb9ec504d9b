"""2D view: polygons lie in the plane z = 0 and are seen from straight above."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from idviewer.core import Shape

VIEW_DIRECTION_2D, UP_2D = np.array((0.0, 0.0, -1.0)), np.array((0.0, 1.0, 0.0))
"""Where the camera of a polygon looks to, and what is at the picture's upper edge."""


def is_2d(shape: Shape | None) -> bool:
    """Whether a shape is a polygon."""
    return shape is not None and shape.dimension == 2
