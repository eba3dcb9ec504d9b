"""From a request to results, coarse to fine. Runs in the compute thread, or in the caller's own."""

from __future__ import annotations

from collections.abc import Generator, Hashable
from contextlib import closing
from dataclasses import replace
from time import perf_counter
from typing import TypeVar

import numpy as np

from idviewer.core import Distance, Polygon, Shape, Spectrum, read_shape
from idviewer.core.interior import solver_steps
from idviewer.core.memory import release_free_memory
from idviewer.core.sampling.plane_samples import PlaneSamples
from idviewer.core.spectrum.memory_estimate import check_room
from idviewer.core.threads import few_threads, small_products
from idviewer.session.cached_view import default_plane
from idviewer.session.eigenpair_source import REFINING, CacheHit, EigenpairSource
from idviewer.session.frame_builder import FrameBuilder
from idviewer.session.kernels import Kernels
from idviewer.session.previews import Previews
from idviewer.session.progress import with_progress
from idviewer.session.shape_context import SOURCE, ShapeContext
from idviewer.session.spectrum_cache import SpectrumCache
from idviewer.session.state import (
    DropRequest,
    Failure,
    Frame,
    FrameRequest,
    Opened,
    OpenRequest,
    Point,
    Progress,
    Query,
    Ready,
    Request,
    Result,
)

Results = Generator[Result | None, None, None]
Made = TypeVar("Made")

SEARCHING = "Finding the barycentroid"
PATIENCE = 0.3
"""Seconds for which a polygon's progress is not told."""


class Pipeline:
    """Answers requests; keeps what a later request can use again.

    Half-done preparation of a shape is kept when a newer query arrives, so moving a plane meanwhile does
    not start it anew. One thread at a time may use a pipeline.

    Args:
        cache: where eigenpairs are kept from one run of the program to the next; None for nowhere.
        previews: whether frames of a large mesh begin with previews, for somebody who looks on.
    """

    def __init__(self, cache: SpectrumCache | None = None, previews: bool = False) -> None:
        self._kernels = Kernels()
        self._eigenpairs = EigenpairSource(cache)
        self._previews = Previews() if previews else None
        self._recalled: tuple[Hashable, CacheHit] | None = None
        self._prepared: ShapeContext | None = None
        self._preparing: tuple[Shape, Hashable, Generator[Progress, None, ShapeContext]] | None = None
        self._told: tuple[ShapeContext, int] | None = None

    def results(self, request: Request) -> Results:
        """What a request asks for, piece by piece; None is a checkpoint at which to stop or go on."""
        try:
            match request:
                case OpenRequest():
                    yield Progress(f"Reading {request.path.name}")
                    shape = read_shape(request.path, component=request.component)
                    check_room(shape)  # what is open stays
                    yield Opened(shape, request.path)
                case FrameRequest():
                    with few_threads(len(request.shape.vertices), len(request.shape.facets)):
                        yield from _patiently(request.shape, self._frames(request))
                case DropRequest():
                    self._preparing = self._recalled = None
                    self._kernels.drop()
                    if self._previews is not None:
                        self._previews.drop()
                    if self._prepared is not None:
                        self._prepared.forget_search()
        except (
            ValueError,
            OSError,
            MemoryError,
            np.linalg.LinAlgError,
        ) as error:  # a ShapeError is a ValueError
            self._preparing = None
            yield Failure(error)

    def _frames(self, request: FrameRequest) -> Results:
        query = request.query
        prepared = self._prepared
        if (
            prepared is None
            or prepared.shape is not request.shape
            or prepared.lacks_eigenpairs(query.distance)
        ):
            recalled = yield from self._recall(request)
            if recalled.spectrum is None and self._previews is not None:
                yield from self._kernels.steps(query.coordinates, request.shape)
                yield from self._previews.picture_steps(request.shape, query)
            prepared = yield from self._prepare(request, recalled)
            self._recalled = None
            if self._previews is not None:
                self._previews.forget()
        if prepared.opened is None:  # otherwise there is something to show first
            # Others than those it was prepared with.
            yield from self._kernels.steps(query.coordinates, prepared.shape)
        yield from with_progress(_stage(query.distance), prepared.basis_steps(query))
        solver = prepared.sampled(query).solver
        modes = len(solver.spectrum.values) if query.distance.spectral else 0
        if self._told != (prepared, modes):
            self._told = (prepared, modes)
            place = np.array(prepared.barycentroid(query))
            yield Ready(request.shape, modes, place, plane=prepared.opened)
            if prepared.opened is not None and query.planes == (default_plane(request.shape),):
                # Who gets to know the barycentroid asks for the plane through it next, and that is there.
                yield from self._refined(prepared, replace(query, planes=(prepared.opened,)))
        yield from self._refined(prepared, query)
        yield from self._keep_opening(prepared, query)
        # For slices to come, which somebody now has time to wait for.
        yield from self._kernels.steps(query.coordinates, request.shape)
        yield from with_progress("Preparing slices", prepared.sampled(query).sampler.prepare_steps(True))

    def _refined(self, prepared: ShapeContext, query: Query) -> Results:
        """The frames of a query whose shape is prepared."""
        framing = FrameBuilder(prepared, query)
        if not framing.is_there:
            yield from self._kernels.steps(query.coordinates, prepared.shape)
        samples = yield from with_progress("Preparing slices", framing.prepare_steps())
        with small_products():
            yield from self._eigenpairs.kept_after(_coarse_to_fine(prepared, framing, samples))

    def _keep_opening(self, prepared: ShapeContext, query: Query) -> Generator[None, None, None]:
        """Writes what a first view shows for the next run of the program."""
        spectrum = prepared.spectrum
        opening = prepared.opening(query)
        if opening is not None and spectrum is not None:
            yield from self._eigenpairs.keep_opening_steps(prepared.shape, spectrum, query, opening)

    def _recall(self, request: FrameRequest) -> Generator[Progress, None, CacheHit]:
        """What is kept of a shape from an earlier run; looked for once."""
        shape, query = request.shape, request.query
        key = shape, query.distance, query.coordinates
        if self._recalled is None or self._recalled[0] != key:
            self._recalled = key, (yield from self._eigenpairs.recall_steps(shape, query))
        return self._recalled[1]

    def _prepare(self, request: FrameRequest, recalled: CacheHit) -> Generator[Progress, None, ShapeContext]:
        shape, key = request.shape, (request.query.distance.basis_key, request.query.coordinates)
        if self._preparing is None or self._preparing[:2] != (shape, key):
            known = self._prepared if self._prepared is not None and self._prepared.shape is shape else None
            self._preparing = (shape, key, self._preparation(request, known, recalled))
        steps = self._preparing[2]
        # Not `yield from`: that would close the preparation together with this request.
        while True:
            try:
                progress = next(steps)
            except StopIteration as stop:
                self._prepared, self._preparing = stop.value, None
                return stop.value
            yield progress

    def _preparation(
        self, request: FrameRequest, known: ShapeContext | None, recalled: CacheHit
    ) -> Generator[Progress, None, ShapeContext]:
        """What a query needs of its shape before a first frame: all, or the eigenpairs that are not known."""
        shape, query = request.shape, request.query
        spectrum, opening = recalled
        if opening is None:
            yield from self._kernels.steps(query.coordinates, shape)
        if query.distance.spectral and spectrum is None:
            spectrum = yield from self._computed(shape, query.distance)
        if shape.dimension == 3:  # a polygon leaves nothing that is worth the time
            release_free_memory()
        if known is not None:
            known.spectrum = spectrum
            return known
        steps = solver_steps(shape, query.distance, query.coordinates, spectrum)
        solver = yield from with_progress(_stage(query.distance), steps)
        prepared = ShapeContext(solver, self._centre(request))
        if opening is not None:
            prepared.restore(query, opening)
        if not prepared.has_centre:
            yield Progress(SEARCHING)
            with small_products():
                for _ in prepared.find_barycentroid_steps(solver):
                    yield Progress(SEARCHING)
        return prepared

    def _centre(self, request: FrameRequest) -> Point | None:
        """What stands for the barycentroid until it is found."""
        if _holds(request.shape, request.centre):
            return request.centre
        return None if self._previews is None else self._previews.centre(request.shape)

    def _computed(self, shape: Shape, distance: Distance) -> Generator[Progress, None, Spectrum]:
        """Eigenpairs by the solver, which is told what a preview knows of them."""
        preview = None if self._previews is None else self._previews.spectrum_of(shape)
        if preview is None:
            return (yield from self._eigenpairs.compute_steps(shape, distance))
        guess = float(preview.values[0])
        return (yield from self._eigenpairs.compute_steps(shape, distance, REFINING, guess))


def _holds(shape: Shape, point: Point | None) -> bool:
    return isinstance(shape, Polygon) and point is not None and bool(shape.contains([point[:2]])[0])


def _patiently(shape: Shape, results: Results) -> Results:
    """Results without the progress that nobody has to wait for.

    A request is left for a newer one where it reports progress. A polygon takes milliseconds: one whose
    vertices are dragged had better be shown.
    """
    began = perf_counter()
    with closing(results):
        for result in results:
            soon = shape.dimension == 2 and perf_counter() - began < PATIENCE
            yield None if soon and isinstance(result, Progress) else result


def _coarse_to_fine(prepared: ShapeContext, framing: FrameBuilder, samples: list[PlaneSamples]) -> Results:
    """The frames of a query. The first needs nothing but samples, so that a slider's drag is followed; where
    the distance's own barycentroid is not known yet, the one shown before stands for it meanwhile. Nor does
    the first wait for the exact sample of a new source."""
    levels = max((one.levels for one in samples), default=1)
    first = min((one.start for one in samples), default=0)
    for level in range(first, levels):
        slices = []
        for one in samples:
            slices.append((yield from one.level_steps(level)))
        if level == first and not framing.has_exact_points:
            yield (yield from framing.frame_steps(slices, level, SOURCE))
            if level < levels - 1 and framing.settled:
                continue
        yield (yield from framing.frame_steps(slices, level))
        if not framing.settled and (framing.shows_barycentroid or level == levels - 1):
            yield Progress(SEARCHING)
            yield from prepared.find_barycentroid_steps(framing.solver)
            yield (yield from framing.frame_steps(slices, level))


def _stage(distance: Distance) -> str:
    return f"Preparing the {distance.title.lower()}"


def run_to_end(shape: Shape, query: Query, pipeline: Pipeline | None = None) -> Frame:
    """The finest, exact frame of a query, computed in this thread.

    Args:
        shape: a mesh or a polygon.
        query: what to compute.
        pipeline: one that may know something of the shape already; a new one by default.

    Raises:
        ValueError: the shape cannot carry the distance, or the coordinates do not work on it.
        QueryError: the source lies outside the shape.
    """
    last: Frame | None = None
    for result in (pipeline or Pipeline()).results(FrameRequest(shape, query)):
        if isinstance(result, Failure):
            raise result.error
        if isinstance(result, Frame):
            last = result
        if last is not None and last.exact and last.query == query and isinstance(result, Progress):
            break  # what follows is for frames to come
    assert last is not None
    return last
