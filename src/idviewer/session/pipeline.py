"""From a request to results, coarse to fine. Runs in the compute thread, or in the caller's own."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Generator, Iterator

import numpy as np
from numpy.typing import NDArray

from idviewer.core import InteriorDistance, Mesh, MeshError, Plane, read_mesh
from idviewer.core.barycentroid import Barycentroid
from idviewer.core.compilation import compile_steps
from idviewer.core.spectrum import eigenpair_steps
from idviewer.core.steps import finish
from idviewer.session.plane_samples import PlaneSamples, SampledSlice
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
    QueryError,
    Ready,
    Request,
    Result,
    Slice,
)

Floats = NDArray[np.float64]
Results = Iterator[Result | None]

KEPT_PLANES = 6
FACE_VISITS = 3e8
"""Work spent on the finest level of a slice: about two seconds on two cores."""

PROBE_SAFETY = 2.0
"""The sampled errors are few; the largest of all is taken to be at most so many times theirs."""


class Pipeline:
    """Answers requests; keeps what a later request can use again.

    Half-done preparation of a mesh is kept when a newer query arrives, so moving a plane meanwhile does
    not start it anew. One thread at a time may use a pipeline.
    """

    def __init__(self) -> None:
        self._prepared: _Prepared | None = None
        self._preparing: tuple[Mesh, object, Generator[Progress, None, _Prepared]] | None = None

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
        except (MeshError, ValueError, MemoryError, np.linalg.LinAlgError) as error:
            self._preparing = None
            yield Failure(error)

    def _frames(self, request: FrameRequest) -> Results:
        query = request.query
        prepared = self._prepared
        if prepared is None or not prepared.serves(request):
            prepared = yield from self._prepare(request)
            yield Ready(request.mesh, prepared.modes, prepared.barycentroid.point)
        source = yield from prepared.source_row(query.source)
        samples = [prepared.samples(plane) for plane in query.planes]
        levels = max((one.levels for one in samples), default=1)
        for level in range(min((one.start for one in samples), default=0), levels):
            slices = []
            for one in samples:
                slices.append((yield from one.level_steps(max(level, one.start))))
            yield prepared.frame(query, source, slices, level)

    def _prepare(self, request: FrameRequest) -> Generator[Progress, None, _Prepared]:
        mesh, distance = request.mesh, request.query.distance
        if self._preparing is None or self._preparing[:2] != (mesh, distance):
            self._preparing = (mesh, distance, _preparation(request))
        steps = self._preparing[2]
        # Not `yield from`: that would close the preparation together with this request.
        while True:
            try:
                progress = next(steps)
            except StopIteration as stop:
                self._prepared, self._preparing = stop.value, None
                return stop.value
            yield progress


def run_to_end(mesh: Mesh, query: Query) -> Frame:
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


def _preparation(request: FrameRequest) -> Generator[Progress, None, _Prepared]:
    """Everything that depends on the mesh and the distance alone."""
    mesh, distance = request.mesh, request.query.distance
    yield Progress("Preparing kernels (compiled once, at the first run)")
    for share in compile_steps():
        yield Progress("Preparing kernels (compiled once, at the first run)", share)
    spectrum = None
    if distance.spectral:
        yield Progress("Computing eigenpairs", 0.0)
        share = 0.0
        steps = eigenpair_steps(mesh, distance.cutoff)
        while True:
            try:
                share = max(share, next(steps) or 0.0)
            except StopIteration as stop:
                spectrum = stop.value
                break
            yield Progress("Computing eigenpairs", share)
    solver = InteriorDistance(mesh, distance, spectrum=spectrum)
    yield Progress("Finding the barycentroid")
    descent = solver.barycentroid_steps()
    while True:
        try:
            next(descent)
        except StopIteration as stop:
            return _Prepared(solver, stop.value)
        yield Progress("Finding the barycentroid")


class _Prepared:
    """A solver with its barycentroid, and samples that later queries use again."""

    def __init__(self, solver: InteriorDistance, barycentroid: Barycentroid) -> None:
        self.solver = solver
        self.barycentroid = barycentroid
        self.modes = len(solver.spectrum.values) if solver.distance_kind.spectral else 0
        self._vertices = solver.vertex_embedding
        self._samples: OrderedDict[Plane, PlaneSamples] = OrderedDict()
        self._source: tuple[Point | None, Floats] | None = None

    def serves(self, request: FrameRequest) -> bool:
        """Whether this is the mesh and the distance asked for."""
        return self.solver.mesh is request.mesh and self.solver.distance_kind == request.query.distance

    def source_row(self, source: Point | None) -> Generator[None, None, Floats]:
        """(k,) the source's embedding."""
        if self._source is None or self._source[0] != source:
            point = self.barycentroid.point if source is None else np.array(source)
            steps = self.solver.sample_steps(point[None])
            yield
            row = finish(steps)[0] * self.solver.scale
            if not np.isfinite(row).all():
                place = ", ".join(f"{value:.6g}" for value in point)
                raise QueryError(
                    f"the source ({place}) lies outside the mesh; choose a point inside or on it"
                )
            self._source = (source, row)
        return self._source[1]

    def samples(self, plane: Plane) -> PlaneSamples:
        """The samples on a plane, those of the planes used last kept."""
        if plane not in self._samples:
            finest = int(np.clip(FACE_VISITS / len(self.solver.mesh.faces), 2000, 16000))
            self._samples[plane] = PlaneSamples(self.solver, plane, finest)
        self._samples.move_to_end(plane)
        while len(self._samples) > KEPT_PLANES:
            self._samples.popitem(last=False)
        return self._samples[plane]

    def frame(self, query: Query, source: Floats, slices: list[SampledSlice], level: int) -> Frame:
        """The picture of the query at a level."""
        potential = query.quantity == "potential"
        origin = self.solver.centre if potential else source
        drawn = tuple(
            Slice(plane, one.points, one.triangles, self._values(one.rows, origin), one.outline)
            for plane, one in zip(query.planes, slices, strict=True)
        )
        errors = np.concatenate([self._norms(one.probed_error) for one in slices]) if slices else np.empty(0)
        lowest = self.barycentroid.potential if potential else 0.0
        highest = float(np.linalg.norm(self._vertices - origin, axis=1).max())
        described = self.solver.description
        frame = Frame(
            mesh=self.solver.mesh,
            query=query,
            slices=drawn,
            level=level,
            exact=len(errors) == 0,
            error=PROBE_SAFETY * float(errors.max(initial=0.0)),
            source=self.barycentroid.point if query.source is None else np.array(query.source),
            barycentroid=self.barycentroid.point,
            value_range=(lowest, highest),
            title=f"Potential U ({described})" if potential else described,
        )
        return _frozen(frame)

    def _values(self, rows: Floats, origin: Floats) -> Floats:
        return np.linalg.norm(rows * self.solver.scale - origin, axis=1)

    def _norms(self, rows: Floats) -> Floats:
        return np.linalg.norm(rows * self.solver.scale, axis=1)


def _frozen(frame: Frame) -> Frame:
    """The frame with its arrays read-only, so that any thread may keep it."""
    arrays: list[np.ndarray] = [frame.source, frame.barycentroid]
    for one in frame.slices:
        arrays += [one.points, one.triangles, one.values, *one.outline]
    for array in arrays:
        array.setflags(write=False)
    return frame
