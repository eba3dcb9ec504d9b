"""Cached first view of a shape: what takes long to sample is kept beside the eigenpairs."""

from __future__ import annotations

import math
import zlib
from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import idviewer
from idviewer.core import Plane, Shape, Spectrum
from idviewer.core.sampling import PointNorms, SampledSlice
from idviewer.session.array_cache import ArrayCache
from idviewer.session.array_files import Arrays, Header
from idviewer.session.shape_context import ShapeContext
from idviewer.session.spectrum_cache import BLOCK_BYTES, key_steps
from idviewer.session.state import Point, Query

VIEW_VERSION = 2
"""To be raised when sampling, coordinates or the search for the barycentroid change between two releases."""

NEAR_DIAGONALS = 0.01
"""Distance within which a plane counts as one through the barycentroid."""

VIEW_STEM_END = "-view"
"""End of a file's stem."""


@dataclass(frozen=True, eq=False)
class FirstView:
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
    def header(self) -> Header:
        """The part of it that JSON can hold."""
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
            "rows": self.section.rows,
            "negativity": self.section.negativity,
        }

    @classmethod
    def of(cls, header: Header, arrays: Arrays) -> FirstView:
        """The one that these are of."""
        outline = tuple(np.split(arrays["outline"], np.cumsum(header["loops"])[:-1]))
        section = SampledSlice(
            arrays["points"],
            arrays["triangles"],
            outline if header["loops"] else (),
            PointNorms(arrays["rows"]),
            np.empty((0, arrays["rows"].shape[1])),
            0.0,
            True,
            arrays["negativity"],
        )
        x, y, z = header["barycentroid"]
        return cls((x, y, z), arrays["row"], Plane(tuple(header["origin"]), tuple(header["normal"])), section)


class CachedView:
    """A shape's first view: looked up, restored, and kept for the next run of the program.

    Args:
        cache: where it is kept; None for nowhere.
        shape: a mesh; polygons take no time.
    """

    def __init__(self, cache: ArrayCache | None, shape: Shape) -> None:
        self._cache = cache if shape.dimension == 3 else None
        self._shape = shape
        self._found: FirstView | None = None
        self._is_kept = False
        self.plane: Plane | None = None
        """That of the view, once it is restored."""

    def look_up_steps(self, spectrum: Spectrum, query: Query) -> Generator[float, None, str]:
        """Look for the view of these eigenpairs; returns what was wrong with its file, or nothing."""
        if self._cache is None:
            return ""
        stem = (yield from key_steps(self._shape)) + VIEW_STEM_END
        kind = yield from _kind_steps(stem, query, spectrum)
        header, arrays, complaint = yield from self._cache.load_steps(
            stem, lambda header: all(header[name] == value for name, value in kind.items())
        )
        if arrays is not None:
            self._found, self._is_kept = FirstView.of(header, arrays), True
        return complaint

    @property
    def is_there(self) -> bool:
        """Whether a view was found."""
        return self._found is not None

    def restore(self, context: ShapeContext, query: Query) -> None:
        """Give a context the samples and the barycentroid of the view, if one was found."""
        found = self._found
        if found is not None:
            context.samples(query).restore(found.plane, found.section, found.barycentroid, found.row)
            context.set_barycentroid(query, found.barycentroid)
            self.plane = found.plane
            self._found = None

    def keep_steps(self, context: ShapeContext, query: Query) -> Generator[float | None, None, None]:
        """Write what a query shows, if that is a first view and all of it is there; once.

        Raises:
            OSError: it cannot be written.
        """
        view = None if self._is_kept else _first_view(context, query)
        if view is None or self._cache is None or context.spectrum is None:
            return
        self._is_kept = True
        stem = (yield from key_steps(self._shape)) + VIEW_STEM_END
        kind = yield from _kind_steps(stem, query, context.spectrum)
        yield from self._cache.store_steps(stem, {**kind, **view.header}, view.arrays)


def _first_view(context: ShapeContext, query: Query) -> FirstView | None:
    """The view of a query, if it is a slice through the barycentroid or next to it, all of which is there."""
    point = context.found_barycentroid(query)
    if point is None or len(query.planes) != 1 or not query.distance.spectral:
        return None
    # A preview puts the plane through its own barycentroid.
    (plane,) = query.planes
    if math.dist(plane.origin, point) > NEAR_DIAGONALS * context.shape.diagonal:
        return None
    finest = context.samples(query).finest(plane, point)
    return None if finest is None else FirstView(point, finest[1], plane, finest[0])


def _kind_steps(key: str, query: Query, spectrum: Spectrum) -> Generator[float, None, dict[str, Any]]:
    """Key of what a view depends on besides its shape: its distance, and the eigenvectors.

    Their signs, and in spaces of equal eigenvalues all of them, are another computation's whim.
    """
    vectors = spectrum.vectors if spectrum.vectors.flags.c_contiguous else spectrum.vectors.T
    data, checksum = np.ascontiguousarray(vectors).reshape(-1).view(np.uint8), 0
    for start in range(0, len(data), BLOCK_BYTES):
        checksum = zlib.crc32(data[start : start + BLOCK_BYTES].data, checksum)
        yield 0.0
    return {
        "key": key,
        "of": [VIEW_VERSION, idviewer.__version__, repr(query.distance), query.coordinates],
        "eigenvectors": [*spectrum.vectors.shape, checksum],
    }
