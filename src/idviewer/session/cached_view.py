"""What a shape's first view shows and takes long to sample: it is kept beside the eigenpairs."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import idviewer
from idviewer.core import Plane, Shape, Spectrum
from idviewer.core.sampling.plane_samples import SampledSlice
from idviewer.core.sampling.point_norms import PointNorms
from idviewer.core.shapes.plane import AXES
from idviewer.session.state import Point, Query
from idviewer.session.stored_arrays import Arrays, checksum_steps

VERSION = 1
"""To be raised when sampling, coordinates or the search for the barycentroid change between two releases."""


@dataclass(frozen=True, eq=False)
class CachedView:
    """The exact slice through a shape's barycentroid.

    Attributes:
        barycentroid: of the query's distance and coordinates.
        row: (k,) the exact basis there, before it is scaled.
        plane: through it.
        section: the samples on that plane's finest level, which are exact.
    """

    barycentroid: Point
    row: NDArray[np.float64]
    plane: Plane
    section: SampledSlice

    @property
    def about(self) -> dict[str, Any]:
        """What JSON can hold of it."""
        return {
            "barycentroid": self.barycentroid,
            "origin": self.plane.origin,
            "normal": self.plane.normal,
            "loops": [len(loop) for loop in self.section.outline],
        }

    @property
    def arrays(self) -> Arrays:
        """All else."""
        loops = [np.empty(0, dtype=np.int32), *self.section.outline]
        return {
            "row": self.row,
            "points": self.section.points,
            "triangles": self.section.triangles.astype(np.int32, copy=False),
            "outline": np.concatenate(loops).astype(np.int32, copy=False),
            "rows": self.section.cloud.rows,
        }

    @classmethod
    def of(cls, about: dict[str, Any], arrays: Arrays) -> CachedView:
        """The one that these are of."""
        outline = tuple(np.split(arrays["outline"], np.cumsum(about["loops"])[:-1]))
        columns = arrays["rows"].shape[1]
        section = SampledSlice(
            arrays["points"],
            arrays["triangles"],
            outline if about["loops"] else (),
            PointNorms(arrays["rows"]),
            np.empty((0, columns)),
            0.0,
            True,
        )
        x, y, z = about["barycentroid"]
        return cls((x, y, z), arrays["row"], Plane(tuple(about["origin"]), tuple(about["normal"])), section)


def kind_steps(query: Query, spectrum: Spectrum) -> Generator[float, None, dict[str, Any]]:
    """What an opening depends on besides its shape: of what distance, and of which eigenvectors.

    Their signs, and in spaces of equal eigenvalues all of them, are another computation's whim.
    """
    vectors = spectrum.vectors if spectrum.vectors.flags.c_contiguous else spectrum.vectors.T
    checksum = yield from checksum_steps(np.ascontiguousarray(vectors).reshape(-1).view(np.uint8))
    return {
        "of": [VERSION, idviewer.__version__, repr(query.distance), query.coordinates],
        "eigenvectors": [*spectrum.vectors.shape, checksum],
    }


def default_plane(shape: Shape) -> Plane:
    """The plane through the middle of a shape's bounding box, across its shortest side: the broadest view.

    Its normal points to where shapes are looked at from: -y is the front of one that stands on z.
    """
    axis = list(AXES)[int(np.argmin(np.ptp(shape.bounds, axis=0)))]
    plane = Plane.along(axis, 0.5, shape.bounds)
    return Plane(plane.origin, (0.0, -1.0, 0.0)) if axis == "y" else plane
