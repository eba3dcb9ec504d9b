"""Frames of one query, coarse to fine: columns of samples are scaled, and norms taken."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.distances import percentage
from idviewer.core.sampling import (
    POLYGON_PLANE,
    PlaneSamples,
    SampledSlice,
    SliceValues,
    error_bound,
    remarks_on_negativity,
    squares_of,
)
from idviewer.session.shape_context import ShapeContext
from idviewer.session.state import Frame, Point, Progress, Query, Result

PROBE_SAFETY = 1.5
"""The largest error of all is taken to be so many times the largest probed."""

SEARCHING = "Finding the barycentroid"


class FrameBuilder:
    """Makes the frames of a query.

    Args:
        context: what is known of the shape; samples and a barycentroid must be there.
        query: what to show.
    """

    def __init__(self, context: ShapeContext, query: Query) -> None:
        self._context, self._query = context, query
        self._samples = context.samples(query)
        self._planes = (POLYGON_PLANE,) if context.shape.dimension == 2 else query.planes
        self.solver = self._samples.solver.with_distance(query.distance)

    @property
    def is_there(self) -> bool:
        """Whether nothing has to be sampled for the exact frame."""
        final = all(self._samples.on(plane).final for plane in self._planes)
        return final and self._knows_barycentroid and self._has_exact_points

    def prepare_steps(self) -> Generator[float, None, list[PlaneSamples]]:
        """Prepare sampling, if there is something to sample; return the samples on the planes to show."""
        if not self.is_there:
            yield from self._samples.sampler.prepare_steps()
        return [self._samples.on(plane) for plane in self._planes]

    def coarse_to_fine(self, samples: list[PlaneSamples]) -> Generator[Result | None, None, None]:
        """Make the frames.

        The first needs nothing but samples, so that a slider's drag is followed; where the distance's own
        barycentroid is not known yet, the one shown before stands for it meanwhile. Nor does the first wait
        for the exact sample of a new source. Of a preview it is the only one.

        Args:
            samples: of each plane, from `prepare_steps`.
        """
        levels = max((one.levels for one in samples), default=1)
        first = min((one.start for one in samples), default=0)
        for level in range(first, levels if self._context.preview is None else 1):
            slices = []
            for one in samples:
                slices.append((yield from one.level_steps(level)))
            if level == first and not self._has_exact_points:
                source_rtol = self._samples.sampler.settings.source_rtol
                yield (yield from self._frame_steps(slices, level, source_rtol))
                if level < levels - 1 and self._knows_barycentroid:
                    continue
            yield (yield from self._frame_steps(slices, level))
            if not self._knows_barycentroid and (self._shows_barycentroid or level == levels - 1):
                yield Progress(SEARCHING)
                yield from self._context.find_barycentroid_steps(self.solver)
                yield (yield from self._frame_steps(slices, level))

    @property
    def _knows_barycentroid(self) -> bool:
        """Whether the query's own barycentroid is known."""
        return self._context.found_barycentroid(self._query) is not None

    @property
    def _shows_barycentroid(self) -> bool:
        """Whether the values depend on it."""
        return self._query.source is None or self._query.quantity == "potential"

    @property
    def _remarks(self) -> tuple[str, ...]:
        """Remarks on the barycentroid, where values depend on it."""
        remark = self.solver.boundary.barycentroid_remark if self._shows_barycentroid else ""
        return (remark,) if remark else ()

    @property
    def _has_exact_points(self) -> bool:
        """Whether the points that the values depend on need no sampling that takes time."""
        return all(self._samples.is_exact(point) for point in self._points_needed())

    def _frame_steps(
        self, slices: list[SampledSlice], level: int, source_rtol: float = 0.0
    ) -> Generator[None, None, Frame]:
        """Make the picture of the query at a level.

        Args:
            slices: one for each plane.
            level: of the finest of them that is not finer than the others.
            source_rtol: of the source's sample, if it has to be taken.
        """
        query, solver, spectrum = self._query, self.solver, self._context.spectrum
        source, barycentroid = self._places()
        exact_points = source_rtol == 0.0 or self._has_exact_points
        potential = query.quantity == "potential"
        # The source is looked at also where it does not count: it may lie outside.
        measured_from = yield from self._image(source, source_rtol)
        origin = solver.boundary.centre if potential else measured_from
        lowest = 0.0
        if potential:
            lowest = float(np.linalg.norm((yield from self._image(barycentroid, source_rtol)) - origin))
        scale = solver.boundary.scale
        drawn = tuple(
            one.values(plane, scale, origin) for plane, one in zip(self._planes, slices, strict=True)
        )
        yield
        highest = self._samples.boundary.farthest(scale, origin)
        of_source = 0.0 if exact_points or potential else source_rtol
        sampled_within = error_bound(of_source, max(one.rtol for one in slices)) if slices else 0.0
        frame = Frame(
            shape=self._context.shape,
            query=query,
            slices=drawn,
            level=level,
            exact=all(one.final for one in slices) and self._knows_barycentroid and exact_points,
            error=sampled_within * highest + PROBE_SAFETY * max(map(self._probed, slices), default=0.0),
            source=np.array(source),
            barycentroid=np.array(barycentroid),
            value_range=(lowest, highest),
            title=self._title(potential),
            lambda_2=None if spectrum is None else float(spectrum.values[0]),
            modes=0 if spectrum is None else len(spectrum.values),
            remarks=(*self._samples.remarks, *_on_negativity(drawn), *self._remarks, *self._warnings()),
            discretisation=self._context.discretisation(query),
        )
        return _frozen(frame if self._context.preview is None else self._as_preview(frame))

    def _as_preview(self, frame: Frame) -> Frame:
        """The frame with the error of what it was made from."""
        share, largest = self._context.preview_error(self.solver)
        title = f"{frame.title}; preview (error about {percentage(share)})"
        return replace(frame, exact=False, error=frame.error + share * largest, preview=share, title=title)

    def _title(self, potential: bool) -> str:
        """The quantity in words, and how far it may be off by the discretisation of the boundary."""
        words = f"Potential U ({self._description})" if potential else self._description
        found = self._context.discretisation(self._query)
        if found is None or not found.largest:
            return words
        return f"{words}; discretisation within {percentage(found.total_distances)}"

    def _warnings(self) -> tuple[str, ...]:
        found = self._context.discretisation(self._query)
        return (found.remark,) if found is not None and found.serious else ()

    def _places(self) -> tuple[Point, Point]:
        """The source and the barycentroid."""
        barycentroid = self._context.barycentroid(self._query)
        return (barycentroid if self._query.source is None else self._query.source), barycentroid

    @property
    def _description(self) -> str:
        """The distance in words, its unit if it is a length, and coordinates that are not the usual ones."""
        words, unit = self.solver.description, self._context.shape.unit
        if unit and self.solver.boundary.distance.is_length:
            words = f"{words} in {unit}"
        if self._query.coordinates == Query.coordinates:
            return words
        return f"{words}; {self.solver.coordinates.title.lower()}"

    def _points_needed(self) -> tuple[Point, ...]:
        source, barycentroid = self._places()
        return (source, barycentroid) if self._query.quantity == "potential" else (source,)

    def _image(self, point: Point, rtol: float) -> Generator[None, None, Floats]:
        return (yield from self._samples.row_steps(point, rtol)) * self.solver.boundary.scale

    def _probed(self, one: SampledSlice) -> float:
        return float(np.sqrt(squares_of(one.probed_error, self.solver.boundary.scale, 0.0).max(initial=0.0)))


def _on_negativity(drawn: tuple[SliceValues, ...]) -> tuple[str, ...]:
    """What the user has to know of negative weights on slices."""
    known = [one.negativity for one in drawn if len(one.negativity)]
    return remarks_on_negativity(np.concatenate(known)) if known else ()


def _frozen(frame: Frame) -> Frame:
    """The frame with its arrays read-only, so that any thread may keep it."""
    arrays: list[np.ndarray] = [frame.source, frame.barycentroid]
    for one in frame.slices:
        arrays += [one.points, one.triangles, one.values, one.negativity, *one.outline]
    for array in arrays:
        array.setflags(write=False)
    return frame
