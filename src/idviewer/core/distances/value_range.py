"""The range of distances: their squares have to stay within that of floating-point numbers."""

from __future__ import annotations

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.distances.registry import Distance
from idviewer.core.errors import DistanceError
from idviewer.core.spectrum.eigen_solver import Spectrum

SMALLEST_DISTANCE, LARGEST_DISTANCE = 1e-130, 1e130
"""Between them, squares of distances, and of those between points 1e-10 as far apart, are ordinary floats."""


def check_range(distance: Distance, scale: Floats, reach: Floats, spectrum: Spectrum | None) -> None:
    """Refuse a distance whose values vanish, or overflow.

    Args:
        distance: on the boundary.
        scale: (k,) or (1,) factors of the columns of its basis.
        reach: (k,) largest absolute entry of each column.
        spectrum: of the shape, where the distance is spectral.

    Raises:
        DistanceError: it says how large the distances are, and what to do.

    >>> from idviewer.core import Euclidean
    >>> check_range(Euclidean(), np.ones(1), np.array([1e200]), None)
    Traceback (most recent call last):
    idviewer.core.errors.DistanceError: euclidean distance: distances reach about 1e+200, and their squares \
leave the range of floating-point numbers; scale the shape to another unit
    """
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        largest = float(np.max(np.abs(scale) * reach, initial=0.0))
    if SMALLEST_DISTANCE <= largest <= LARGEST_DISTANCE or not reach.any():
        return
    if largest == 0.0:
        size = "distances are 0 to every digit"
    else:
        range_left = "and their squares leave the range of floating-point numbers"
        size = f"distances reach about {largest:.0e}, {range_left}"
    raise DistanceError(f"{distance.title.lower()}: {size}; {distance.range_remedy(spectrum, largest)}")
