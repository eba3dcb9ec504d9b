"""Where a body that overlaps itself has no values by mean value coordinates."""

from __future__ import annotations

from typing import NamedTuple

from idviewer.core.arrays import Bools, Floats
from idviewer.core.coordinates.weight_sums import WEIGHT_SUMS, WeightSums, WeightSumSettings
from idviewer.core.shapes.winding_numbers import WindingNumbers


class OverlapGuard(NamedTuple):
    """Tells the points of a body that overlaps itself which have no value.

    What the surface covers twice counts negatively beside it: W(p) = integral of (w(p) - w(x)) |x - p|^-4
    over all space, with w the winding number, passes through zero. A point has a value where w(p) > 0,
    W(p) > 0 and the sum of absolute weights is bounded. Source: docs/coordinates.md.

    Attributes:
        winding_numbers: of the surface.
        weight_sums: of the same, in units of its diagonal.
        settings: the bound.
    """

    winding_numbers: WindingNumbers
    weight_sums: WeightSums
    settings: WeightSumSettings = WEIGHT_SUMS

    def without_value(self, points: Floats, places: Floats) -> tuple[Bools, Bools]:
        """Tell which points (p, 3) have no value, and which are inside; points on the surface have one.

        Args:
            points: as they are.
            places: the same in units of the diagonal.
        """
        sums = self.weight_sums.at(places)
        on_surface = (sums == 1.0).all(axis=1)
        inside = on_surface | (self.winding_numbers.at(points) > 0)
        good = (sums[:, 0] > 0.0) & (sums[:, 1] <= self.settings.largest_absolute_sum * sums[:, 0])
        return ~(inside & good), inside


NO_VALUE = (
    "Some points inside have no value: they lie beside a place where the body overlaps itself; "
    "uniting it mends this"
)
"""The reason why, in one sentence."""
