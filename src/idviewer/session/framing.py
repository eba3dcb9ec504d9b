"""Frames of one query, made from samples: columns are scaled, norms taken, nothing is sampled but points."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from idviewer.session.plane_samples import SampledSlice
from idviewer.session.prepared import Prepared
from idviewer.session.state import Frame, Point, Query, Slice

Floats = NDArray[np.float64]

PROBE_SAFETY = 2.0
"""The sampled errors are few; the largest of all is taken to be at most so many times theirs."""

ROWS_AT_A_TIME = 2048
"""Small enough for the scaled rows to stay in the processor's cache."""


class Framing:
    """Makes the frames of a query.

    Args:
        prepared: what is known of the mesh.
        query: with a distance whose eigenpairs, if it needs any, are there.
    """

    def __init__(self, prepared: Prepared, query: Query) -> None:
        self._prepared, self._query = prepared, query
        self._sampled = prepared.sampled(query.distance)
        self.solver = self._sampled.solver.with_distance(query.distance)
        self.samples = [self._sampled.on(plane) for plane in query.planes]

    @property
    def settled(self) -> bool:
        """Whether the distance's own barycentroid is known."""
        return self._prepared.is_settled(self._query.distance)

    @property
    def shows_barycentroid(self) -> bool:
        """Whether the values depend on it."""
        return self._query.source is None or self._query.quantity == "potential"

    def frame_steps(self, slices: list[SampledSlice], level: int) -> Generator[None, None, Frame]:
        """The picture of the query at a level."""
        query, solver, spectrum = self._query, self.solver, self._prepared.spectrum
        barycentroid = _point(self._prepared.barycentroid(query.distance).point)
        source = barycentroid if query.source is None else query.source
        potential = query.quantity == "potential"
        measured_from = yield from self._image(source)
        origin = solver.centre if potential else measured_from
        lowest = float(np.linalg.norm((yield from self._image(barycentroid)) - origin)) if potential else 0.0
        errors = np.concatenate([np.zeros(0), *(distances(s.probed_error, solver.scale) for s in slices)])
        drawn = tuple(
            Slice(plane, one.points, one.triangles, distances(one.rows, solver.scale, origin), one.outline)
            for plane, one in zip(query.planes, slices, strict=True)
        )
        yield
        frame = Frame(
            mesh=solver.mesh,
            query=query,
            slices=drawn,
            level=level,
            exact=len(errors) == 0 and self.settled,
            error=PROBE_SAFETY * float(errors.max(initial=0.0)),
            source=np.array(source),
            barycentroid=np.array(barycentroid),
            value_range=(lowest, float(distances(solver.basis, solver.scale, origin).max())),
            title=f"Potential U ({solver.description})" if potential else solver.description,
            lambda_2=None if spectrum is None else float(spectrum.values[0]),
        )
        return _frozen(frame)

    def _image(self, point: Point) -> Generator[None, None, Floats]:
        return (yield from self._sampled.row_steps(point)) * self.solver.scale


def distances(rows: Floats, scale: Floats, origin: Floats | float = 0.0) -> Floats:
    """|row * scale - origin| of each row.

    >>> distances(np.array([[3.0, 2.0]]), np.array([1.0, 2.0])).tolist()
    [5.0]
    """
    result = np.empty(len(rows))
    for start in range(0, len(rows), ROWS_AT_A_TIME):
        chunk = rows[start : start + ROWS_AT_A_TIME] * scale
        chunk -= origin
        result[start : start + ROWS_AT_A_TIME] = np.sqrt(np.einsum("pk,pk->p", chunk, chunk))
    return result


def _point(values: Floats) -> Point:
    x, y, z = values.tolist()
    return x, y, z


def _frozen(frame: Frame) -> Frame:
    """The frame with its arrays read-only, so that any thread may keep it."""
    arrays: list[np.ndarray] = [frame.source, frame.barycentroid]
    for one in frame.slices:
        arrays += [one.points, one.triangles, one.values, *one.outline]
    for array in arrays:
        array.setflags(write=False)
    return frame
