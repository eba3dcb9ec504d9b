"""Triangulated slices: with the basis at their points, and with values there."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats
from idviewer.core.interior.interpolation import ERROR_SHARE_OF_AN_END
from idviewer.core.sampling.point_norms import PointNorms
from idviewer.core.shapes.plane import Plane

POLYGON_PLANE = Plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
"""Where a polygon lies: the plane z = 0."""


@dataclass(frozen=True, eq=False)
class SliceValues:
    """Values on a plane's section of a shape, triangulated.

    Attributes:
        plane: the plane it lies in; `POLYGON_PLANE` of a polygon, which is one slice.
        points: (p, 3) positions on the plane, z = 0 in a polygon; empty where the plane misses the body.
        triangles: (t, 3) indices into points, facing along the plane's normal.
        values: (p,) at the points.
        outline: index arrays into points, one closed loop each (the first index is not repeated).
        negativity: (p,) a bound, or nearly, of how negative the weights are there, as
            `InteriorDistance.negativity` tells it; empty on levels before the last.
    """

    plane: Plane
    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    values: NDArray[np.float64]
    outline: tuple[NDArray[np.int32], ...]
    negativity: NDArray[np.float64] = field(default_factory=partial(np.empty, 0))


def error_bound(source_rtol: float, rtol: float) -> float:
    """Largest error of distances from a source to points sampled within tolerances, in their unit.

    Args:
        source_rtol: of the source's sample, in largest distances on the boundary; 0 where it is exact.
        rtol: of the points' samples.

    >>> error_bound(0.0, 2e-3)
    0.001
    """
    return ERROR_SHARE_OF_AN_END * (source_rtol + rtol)


@dataclass(frozen=True, eq=False)
class SampledSlice:
    """A triangulated section with the distance's basis at its points.

    Attributes:
        points: (p, 3).
        triangles: (t, 3) indices into points.
        outline: loops of indices into points.
        norms: of the basis at the points.
        probed_error: (q, k) sampled minus interpolated basis at a few points; empty where every row is
            sampled.
        rtol: tolerance of the samples, in largest distances on the boundary; 0 where they are exact.
        final: whether there is no finer level.
        negativity: (p,) of the weights at the points, as for `SliceValues`.
    """

    points: Floats
    triangles: NDArray[np.int32]
    outline: tuple[NDArray[np.int32], ...]
    norms: PointNorms
    probed_error: Floats
    rtol: float
    final: bool
    negativity: Floats = field(default_factory=partial(np.empty, 0))

    @property
    def rows(self) -> Floats:
        """Basis (p, k) at the points, before it is scaled."""
        return self.norms.rows

    def values(self, plane: Plane, scale: Floats, origin: Floats) -> SliceValues:
        """The distances of the points' images, rows * scale, from the image of a point.

        Args:
            plane: the one that was cut with.
            scale: (k,) or (1,).
            origin: (k,).
        """
        distances = self.norms.distances(scale, origin)
        return SliceValues(plane, self.points, self.triangles, distances, self.outline, self.negativity)
