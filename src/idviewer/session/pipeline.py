"""From a request to results, coarse to fine. Runs in the compute thread, or in the caller's own."""

from __future__ import annotations

from collections.abc import Generator, Hashable, Iterator
from typing import TypeVar

import numpy as np

from idviewer.core import Distance, InteriorDistance, Shape, Spectrum, read_mesh
from idviewer.core.compilation import compile_steps
from idviewer.core.spectrum import eigenpair_steps
from idviewer.session.framing import Framing
from idviewer.session.memory import give_back
from idviewer.session.plane_samples import PlaneSamples
from idviewer.session.prepared import SOURCE, Prepared
from idviewer.session.state import (
    DropRequest,
    Failure,
    Frame,
    FrameRequest,
    Opened,
    OpenRequest,
    Progress,
    Query,
    Ready,
    Request,
    Result,
)

Results = Iterator[Result | None]
Made = TypeVar("Made")


class Pipeline:
    """Answers requests; keeps what a later request can use again.

    Half-done preparation of a mesh is kept when a newer query arrives, so moving a plane meanwhile does
    not start it anew. One thread at a time may use a pipeline.
    """

    def __init__(self) -> None:
        self._prepared: Prepared | None = None
        self._preparing: tuple[Shape, Hashable, Generator[Progress, None, Prepared]] | None = None
        self._told: tuple[Prepared, int] | None = None

    def results(self, request: Request) -> Results:
        """What a request asks for, piece by piece; None is a checkpoint at which to stop or go on."""
        try:
            match request:
                case OpenRequest():
                    yield Progress(f"Reading {request.path.name}")
                    yield Opened(read_mesh(request.path, component=request.component), request.path)
                case FrameRequest():
                    yield from self._frames(request)
                case DropRequest():
                    self._preparing = None
                    if self._prepared is not None:
                        self._prepared.forget_search()
        except (
            ValueError,
            OSError,
            MemoryError,
            np.linalg.LinAlgError,
        ) as error:  # MeshError is a ValueError
            self._preparing = None
            yield Failure(error)

    def _frames(self, request: FrameRequest) -> Results:
        distance = request.query.distance
        prepared = self._prepared
        if prepared is None or prepared.shape is not request.shape or prepared.lacks_eigenpairs(distance):
            prepared = yield from self._prepare(request)
        yield from _with_progress(_stage(distance), prepared.basis_steps(distance))
        framing = Framing(prepared, request.query)
        modes = len(framing.solver.spectrum.values) if distance.spectral else 0
        if self._told != (prepared, modes):
            self._told = (prepared, modes)
            yield Ready(request.shape, modes, prepared.barycentroid(distance).point)
        samples = yield from _with_progress("Preparing slices", framing.prepare_steps())
        yield from _coarse_to_fine(prepared, framing, samples)

    def _prepare(self, request: FrameRequest) -> Generator[Progress, None, Prepared]:
        mesh, key = request.shape, request.query.distance.basis_key
        if self._preparing is None or self._preparing[:2] != (mesh, key):
            known = self._prepared if self._prepared is not None and self._prepared.shape is mesh else None
            self._preparing = (mesh, key, _preparation(mesh, request.query.distance, known))
        steps = self._preparing[2]
        # Not `yield from`: that would close the preparation together with this request.
        while True:
            try:
                progress = next(steps)
            except StopIteration as stop:
                self._prepared, self._preparing = stop.value, None
                return stop.value
            yield progress


def _coarse_to_fine(prepared: Prepared, framing: Framing, samples: list[PlaneSamples]) -> Results:
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
            yield Progress("Finding the barycentroid")
            yield from prepared.settle_steps(framing.solver)
            yield (yield from framing.frame_steps(slices, level))


def _stage(distance: Distance) -> str:
    return f"Preparing the {distance.title.lower()}"


def _with_progress(stage: str, steps: Generator[float | None, None, Made]) -> Generator[Progress, None, Made]:
    """Runs steps to their end and tells of them."""
    while True:
        try:
            share = next(steps)
        except StopIteration as stop:
            return stop.value
        yield Progress(stage, share)


def run_to_end(mesh: Shape, query: Query) -> Frame:
    """The finest, exact frame of a query, computed in this thread.

    Raises:
        MeshError: the mesh cannot carry the distance.
        QueryError: the source lies outside the mesh.
    """
    last: Frame | None = None
    for result in Pipeline().results(FrameRequest(mesh, query)):
        if isinstance(result, Failure):
            raise result.error
        if isinstance(result, Frame):
            last = result
    assert last is not None
    return last


def _preparation(
    mesh: Shape, distance: Distance, known: Prepared | None
) -> Generator[Progress, None, Prepared]:
    """What the distance needs of the mesh before a first frame: all, or the eigenpairs that are not known."""
    if known is None:
        yield Progress("Preparing kernels (compiled once, at the first run)")
        for share in compile_steps():
            yield Progress("Preparing kernels (compiled once, at the first run)", share)
    spectrum = (yield from _eigenpairs(mesh, distance)) if distance.spectral else None
    give_back()
    if known is not None:
        known.spectrum = spectrum
        return known
    solver = yield from _with_progress(
        _stage(distance), InteriorDistance.steps(mesh, distance, spectrum=spectrum)
    )
    yield Progress("Finding the barycentroid")
    descent = solver.barycentroid_steps()
    while True:
        try:
            next(descent)
        except StopIteration as stop:
            return Prepared(solver, stop.value)
        yield Progress("Finding the barycentroid")


def _eigenpairs(mesh: Shape, distance: Distance) -> Generator[Progress, None, Spectrum]:
    yield Progress("Computing eigenpairs", 0.0)
    share = 0.0
    steps = eigenpair_steps(mesh, distance.cutoff)
    while True:
        try:
            share = max(share, next(steps) or 0.0)
        except StopIteration as stop:
            return stop.value
        yield Progress("Computing eigenpairs", share)
