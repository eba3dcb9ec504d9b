"""Frames of one query, made from samples: columns are scaled, norms taken, nothing is sampled but points."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.interior import ERROR_SHARE_OF_AN_END
from idviewer.core.sampling.plane_samples import PlaneSamples, SampledSlice
from idviewer.core.sampling.point_norms import squares_of
from idviewer.session.shape_context import ShapeContext
from idviewer.session.state import FLAT, Frame, Point, Query, Slice

PROBE_SAFETY = 1.5
"""The largest error of all is taken to be so many times the largest probed."""


class FrameBuilder:
    """Makes the frames of a query.

    Args:
        prepared: what is known of the shape; samples and a barycentroid must be there.
        query: what to show.
    """

    def __init__(self, prepared: ShapeContext, query: Query) -> None:
        self._prepared, self._query = prepared, query
        self._sampled = prepared.sampled(query)
        self._planes = (FLAT,) if prepared.shape.dimension == 2 else query.planes
        self.solver = self._sampled.solver.with_distance(query.distance)

    def prepare_steps(self) -> Generator[float, None, list[PlaneSamples]]:
        """What sampling needs, if there is something to sample, and the samples on the planes to show."""
        if not self.is_there:
            yield from self._sampled.sampler.prepare_steps()
        return [self._sampled.on(plane) for plane in self._planes]

    @property
    def is_there(self) -> bool:
        """Whether nothing has to be sampled for the exact frame."""
        final = all(self._sampled.on(plane).final for plane in self._planes)
        return final and self.settled and self.has_exact_points

    @property
    def settled(self) -> bool:
        """Whether the query's own barycentroid is known."""
        return self._prepared.is_settled(self._query)

    @property
    def shows_barycentroid(self) -> bool:
        """Whether the values depend on it."""
        return self._query.source is None or self._query.quantity == "potential"

    @property
    def has_exact_points(self) -> bool:
        """Whether the points that the values depend on need no sampling that takes time."""
        return all(self._sampled.is_exact(point) for point in self._points_needed())

    def frame_steps(
        self, slices: list[SampledSlice], level: int, rtol: float = 0.0
    ) -> Generator[None, None, Frame]:
        """The picture of the query at a level.

        Args:
            slices: one for each plane.
            level: of the finest of them that is not finer than the others.
            rtol: of the source's sample, if it has to be taken.
        """
        query, solver, spectrum = self._query, self.solver, self._prepared.spectrum
        source, barycentroid = self._places()
        exact_points = rtol == 0.0 or self.has_exact_points
        potential = query.quantity == "potential"
        # The source is looked at also where it does not count: it may lie outside.
        measured_from = yield from self._image(source, rtol)
        origin = solver.boundary.centre if potential else measured_from
        lowest = 0.0
        if potential:
            lowest = float(np.linalg.norm((yield from self._image(barycentroid, rtol)) - origin))
        drawn = tuple(
            Slice(
                plane,
                one.points,
                one.triangles,
                one.cloud.distances(solver.boundary.scale, origin),
                one.outline,
            )
            for plane, one in zip(self._planes, slices, strict=True)
        )
        yield
        highest = self._sampled.body.farthest(solver.boundary.scale, origin)
        of_source = 0.0 if exact_points or potential else rtol
        sampled_within = (
            ERROR_SHARE_OF_AN_END * (of_source + max(one.rtol for one in slices)) if slices else 0.0
        )
        frame = Frame(
            shape=self._prepared.shape,
            query=query,
            slices=drawn,
            level=level,
            exact=all(one.final for one in slices) and self.settled and exact_points,
            error=sampled_within * highest + PROBE_SAFETY * max(map(self._probed, slices), default=0.0),
            source=np.array(source),
            barycentroid=np.array(barycentroid),
            value_range=(lowest, highest),
            title=f"Potential U ({self._description})" if potential else self._description,
            lambda_2=None if spectrum is None else float(spectrum.values[0]),
            remarks=self._sampled.remarks,
        )
        return _frozen(frame)

    def _places(self) -> tuple[Point, Point]:
        """The source and the barycentroid."""
        barycentroid = self._prepared.barycentroid(self._query)
        return (barycentroid if self._query.source is None else self._query.source), barycentroid

    @property
    def _description(self) -> str:
        """The distance in words, and the coordinates where they are not the usual ones."""
        if self._query.coordinates == Query.coordinates:
            return self.solver.description
        return f"{self.solver.description}; {self.solver.coordinates.title.lower()}"

    def _points_needed(self) -> tuple[Point, ...]:
        source, barycentroid = self._places()
        return (source, barycentroid) if self._query.quantity == "potential" else (source,)

    def _image(self, point: Point, rtol: float) -> Generator[None, None, Floats]:
        return (yield from self._sampled.row_steps(point, rtol)) * self.solver.boundary.scale

    def _probed(self, one: SampledSlice) -> float:
        return float(np.sqrt(squares_of(one.probed_error, self.solver.boundary.scale, 0.0).max(initial=0.0)))


def _frozen(frame: Frame) -> Frame:
    """The frame with its arrays read-only, so that any thread may keep it."""
    arrays: list[np.ndarray] = [frame.source, frame.barycentroid]
    for one in frame.slices:
        arrays += [one.points, one.triangles, one.values, *one.outline]
    for array in arrays:
        array.setflags(write=False)
    return frame
