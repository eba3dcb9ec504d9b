"""Pipeline from a request to results, coarse to fine. Runs in the compute thread, or in the caller's own."""

from __future__ import annotations

from collections.abc import Generator, Hashable
from contextlib import closing
from dataclasses import replace
from functools import partial
from time import perf_counter

import numpy as np

from idviewer.core import Distance, Polygon, Shape, ShapeError, Spectrum
from idviewer.core.interior import solver_steps
from idviewer.core.memory import release_free_memory
from idviewer.core.sampling import SourceError
from idviewer.core.spectrum import Resolved
from idviewer.core.steps import Resumable, map_steps
from idviewer.core.threads import few_threads, small_products
from idviewer.session.body_work import body_results
from idviewer.session.boundary_source import BoundarySource
from idviewer.session.cached_view import CachedView
from idviewer.session.eigenpair_source import READING, REFINING, EigenpairSource
from idviewer.session.frame_builder import SEARCHING, FrameBuilder
from idviewer.session.kernel_compilation import Kernels
from idviewer.session.previews import PreviewSource
from idviewer.session.progress import PREPARING_SLICES, with_progress
from idviewer.session.shape_context import ShapeContext
from idviewer.session.spectrum_cache import SpectrumCache
from idviewer.session.state import (
    DropRequest,
    ExamineRequest,
    Failure,
    Frame,
    FrameRequest,
    OpenRequest,
    Point,
    Progress,
    Query,
    Ready,
    RepairRequest,
    Request,
    Result,
    default_plane,
)

Results = Generator[Result | None, None, None]
Cached = tuple[Spectrum | None, CachedView]
"""Results kept of a shape from earlier runs: the eigenpairs asked for, and its first view."""

ESTIMATING = "Estimating the error of the discretisation"

QUIET_SECONDS = 0.3
"""For which a polygon's progress is not told."""


class Pipeline:
    """Answers requests; keeps what a later request can use again.

    Half-done preparation of a shape is kept when a newer query arrives, so moving a plane meanwhile does
    not start it anew. One thread at a time may use a pipeline.

    A shape goes through `ShapeContext` (what is known of it) and `FrameBuilder` (a query's frames); while
    its context is being prepared, that of its preview goes the same way.

    Args:
        cache: where eigenpairs are kept from one run of the program to the next; None for nowhere.
        previews: whether frames of a large mesh begin with previews, for somebody who looks on.
        errors: whether the error of the discretisation is estimated once all else is there, and told by
            another frame.
    """

    def __init__(
        self, cache: SpectrumCache | None = None, previews: bool = False, errors: bool = False
    ) -> None:
        self._cache = cache
        self._kernels = Kernels()
        self._eigenpairs = EigenpairSource(cache)
        self._boundaries = BoundarySource()
        self._previews = PreviewSource() if previews else None
        self._estimates_errors = errors
        self._looked_up: tuple[Hashable, Cached] | None = None
        self._context: ShapeContext | None = None
        self._view: CachedView | None = None
        self._preparing: Resumable[Progress, ShapeContext] = Resumable()
        self._last_reported: tuple[ShapeContext, int] | None = None

    def results(self, request: Request) -> Results:
        """Answer a request piece by piece; None is a checkpoint at which to stop or go on."""
        try:
            match request:
                case FrameRequest():
                    yield from _throttled(request.shape, self._answers(request))
                case OpenRequest() | ExamineRequest() | RepairRequest():
                    yield from body_results(request)
                case DropRequest():
                    self._forget_half_done()
        except (
            ValueError,
            OSError,
            MemoryError,
            np.linalg.LinAlgError,
        ) as error:  # a ShapeError is a ValueError
            self._preparing.forget()
            yield Failure(error)

    def _forget_half_done(self) -> None:
        self._looked_up = None
        self._preparing.forget()
        self._kernels.forget_half_done()
        self._boundaries.forget_half_done()
        if self._previews is not None:
            self._previews.forget_half_done()
        if self._context is not None:
            self._context.forget_half_done()

    def _answers(self, request: FrameRequest) -> Results:
        """Refine the boundary where need be; whatever is computed on it is told of the shape asked for."""
        resolved = yield from self._boundaries.steps(request.shape, request.query)
        computed = resolved.shape
        with few_threads(len(computed.vertices), len(computed.facets)):
            frames = self._frames(replace(request, shape=computed), resolved)
            yield from map_steps(partial(_of_given_shape, resolved), frames)

    def _frames(self, request: FrameRequest, resolved: Resolved) -> Results:
        shape, query, context = request.shape, request.query, self._context
        if context is None or context.shape is not shape or context.lacks_eigenpairs(query.distance):
            cached = yield from self._look_up_steps(shape, query)
            if cached[0] is None and self._previews is not None:
                yield from self._preview_frames(self._previews, shape, query)
            context = yield from self._prepare_steps(request, cached, resolved)
        yield from self._answer(context, query, self._view)
        yield from self._keep_view_steps(context, query)
        # For slices to come, which somebody now has time to wait for.
        yield from self._kernels.steps(query.coordinates, shape)
        completing = context.samples(query).sampler.prepare_steps(completely=True)
        yield from with_progress(PREPARING_SLICES, completing)
        if self._estimates_errors and query.distance.needs_resolution:
            yield from self._error_frames(context, query)

    def _error_frames(self, context: ShapeContext, query: Query) -> Results:
        """Estimate the error of the discretisation, where it is not known, and show what is shown with it."""
        if context.discretisation(query) is not None:
            return
        try:
            with small_products():
                yield from with_progress(ESTIMATING, context.discretisation_steps(query))
        except (ShapeError, np.linalg.LinAlgError):
            return  # the picture stays as it is
        yield from self._coarse_to_fine(context, query)

    def _preview_frames(self, previews: PreviewSource, shape: Shape, query: Query) -> Results:
        """Show what a preview has to show; nothing where there is none, or where it has no answer."""
        yield from self._kernels.steps(query.coordinates, shape)
        try:
            with small_products():
                context = yield from previews.context_steps(shape, query)
                if context is not None:
                    yield from self._answer(context, query)
        except (SourceError, ShapeError, np.linalg.LinAlgError):
            return  # the mesh itself will answer, or tell what is wrong

    def _answer(self, context: ShapeContext, query: Query, view: CachedView | None = None) -> Results:
        """Make the frames of a query and tell before them, where it is news, that the shape is ready."""
        opened = None if view is None else view.plane
        if opened is None:  # otherwise there is something to show first
            # Others than those it was prepared with.
            yield from self._kernels.steps(query.coordinates, context.shape)
        yield from with_progress(_stage(query.distance), context.basis_steps(query))
        solver = context.samples(query).solver
        modes = len(solver.spectrum.values) if query.distance.spectral else 0
        if self._last_reported != (context, modes):
            self._last_reported = (context, modes)
            place = np.array(context.barycentroid(query))
            yield Ready(context.shape, modes, place, preview=context.preview is not None, plane=opened)
            if opened is not None and query.planes == (default_plane(context.shape),):
                # Who gets to know the barycentroid asks for the plane through it next, and that is there.
                yield from self._coarse_to_fine(context, replace(query, planes=(opened,)))
        yield from self._coarse_to_fine(context, query)

    def _coarse_to_fine(self, context: ShapeContext, query: Query) -> Results:
        """Make the frames of a query whose basis is there."""
        builder = FrameBuilder(context, query)
        if not builder.is_there:
            yield from self._kernels.steps(query.coordinates, context.shape)
        samples = yield from with_progress(PREPARING_SLICES, builder.prepare_steps())
        with small_products():
            yield from self._eigenpairs.with_deferred_writes(builder.coarse_to_fine(samples))

    def _look_up_steps(self, shape: Shape, query: Query) -> Generator[Progress, None, Cached]:
        """Look, once, for what is kept of a shape from an earlier run."""
        key = shape, query.distance, query.coordinates
        if self._looked_up is None or self._looked_up[0] != key:
            spectrum = yield from self._eigenpairs.look_up_steps(shape, query.distance)
            view = CachedView(self._cache, shape)
            if spectrum is not None:
                complaint = yield from with_progress(READING, view.look_up_steps(spectrum, query))
                if complaint:
                    told = f"The view kept of this shape was sampled again: its file {complaint}."
                    self._eigenpairs.remark(told)
            self._looked_up = key, (spectrum, view)
        return self._looked_up[1]

    def _keep_view_steps(self, context: ShapeContext, query: Query) -> Generator[None, None, None]:
        """Write what a first view shows for the next run, unless its eigenpairs are not kept."""
        if self._view is not None and self._eigenpairs.are_kept:
            try:
                yield from map_steps(lambda _: None, self._view.keep_steps(context, query))
            except OSError as error:
                self._eigenpairs.remark_unwritten(error)

    def _prepare_steps(
        self, request: FrameRequest, cached: Cached, resolved: Resolved
    ) -> Generator[Progress, None, ShapeContext]:
        """Prepare a shape, or go on with it; from then on its context is the pipeline's."""
        query = request.query
        key = request.shape, query.distance.basis_key, query.coordinates
        begin = partial(self._preparation, request, cached, resolved)
        context = yield from self._preparing.run(key, begin)
        self._context, self._view, self._looked_up = context, cached[1], None
        if self._previews is not None:
            self._previews.forget()
        return context

    def _preparation(
        self, request: FrameRequest, cached: Cached, resolved: Resolved
    ) -> Generator[Progress, None, ShapeContext]:
        """Make what a query needs before a first frame: all, or the eigenpairs that are not known."""
        shape, query = request.shape, request.query
        spectrum, view = cached
        if not view.is_there:
            yield from self._kernels.steps(query.coordinates, shape)
        if query.distance.spectral and spectrum is None:
            spectrum = yield from self._compute_steps(shape, query.distance, resolved.lambda_2)
        if shape.dimension == 3:  # a polygon leaves nothing that is worth the time
            release_free_memory()
        if self._context is not None and self._context.shape is shape:
            self._context.spectrum = spectrum
            return self._context
        steps = solver_steps(resolved.given, query.distance, query.coordinates, spectrum, resolved)
        solver = yield from with_progress(_stage(query.distance), steps)
        context = ShapeContext(solver, self._centre(request))
        view.restore(context, query)
        if context.latest_barycentroid is None:
            yield Progress(SEARCHING)
            with small_products():
                searching = context.find_barycentroid_steps(solver)
                yield from map_steps(lambda _: Progress(SEARCHING), searching)
        return context

    def _centre(self, request: FrameRequest) -> Point | None:
        """The point that stands for the barycentroid until it is found."""
        if _contains(request.shape, request.centre):
            return request.centre
        return None if self._previews is None else self._previews.centre(request.shape)

    def _compute_steps(
        self, shape: Shape, distance: Distance, lambda_2: float | None
    ) -> Generator[Progress, None, Spectrum]:
        """Compute eigenpairs; the solver is told what a preview, or refining the boundary, knows of them."""
        preview = None if self._previews is None else self._previews.spectrum_of(shape)
        if preview is None:
            return (yield from self._eigenpairs.compute_steps(shape, distance, guess=lambda_2))
        estimate = float(preview.values[0])
        return (yield from self._eigenpairs.compute_steps(shape, distance, REFINING, estimate))


def _of_given_shape(resolved: Resolved, result: Result | None) -> Result | None:
    """What was computed on a refined boundary, as a result of the shape that was given."""
    if isinstance(result, Frame):
        modes = result.modes
        return replace(result, shape=resolved.given, refinement=resolved.remark(modes))
    return replace(result, shape=resolved.given) if isinstance(result, Ready) else result


def _contains(shape: Shape, point: Point | None) -> bool:
    return isinstance(shape, Polygon) and point is not None and bool(shape.contains([point[:2]])[0])


def _throttled(shape: Shape, results: Results) -> Results:
    """Results without the progress that nobody has to wait for.

    A request is left for a newer one where it reports progress. A polygon takes milliseconds: one whose
    vertices are dragged had better be shown.
    """
    began = perf_counter()
    with closing(results):
        for result in results:
            soon = shape.dimension == 2 and perf_counter() - began < QUIET_SECONDS
            yield None if soon and isinstance(result, Progress) else result


def _stage(distance: Distance) -> str:
    return f"Preparing the {distance.title.lower()}"
