"""Session: the state before the user, what may be done to it, and who is told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from weakref import WeakSet

from numpy.typing import ArrayLike

from idviewer.core import Shape
from idviewer.core.shapes import Ray
from idviewer.core.validation import ComponentChoice
from idviewer.session.carried_query import (
    frames_of,
    is_complete,
    query_on_another,
    query_on_repaired,
    state_reshaped,
    state_through_centre,
)
from idviewer.session.picking import FramePicker, Probe, Target, pick
from idviewer.session.pipeline import Pipeline
from idviewer.session.runner import Runner, Work
from idviewer.session.signal import Signal
from idviewer.session.spectrum_cache import SpectrumCache
from idviewer.session.state import (
    BodyRequest,
    DropRequest,
    Examined,
    ExamineRequest,
    Failure,
    Finished,
    Foretold,
    Frame,
    FrameRequest,
    Opened,
    OpenRequest,
    Progress,
    Ready,
    Repaired,
    RepairRequest,
    Request,
    Result,
    Snapshot,
    State,
)

Post = Callable[[Callable[[], None]], None]


class Session:
    """Holds the state and has it computed. Every method and signal belongs to the owner's thread.

    Args:
        post: has a callable run in the owner's thread; called from the compute thread.
        work: answers requests in the compute thread; a `Pipeline` by default.
        cache: where that keeps eigenpairs; None for nowhere.

    Attributes:
        state: the shape, the query and the display.
        cache: where eigenpairs are kept from one run to the next; None for nowhere.
        path: of the file that the shape was read from; None for a shape handed over.
        frame: the last frame of this shape; None until there is one. While vertices are dragged, its shape
            may still be the one before.
        ready: modes and barycentroid of this shape; None until they are known.
        busy: whether something is being computed or read.
        stopped: whether computing was cancelled, so that nothing is computed until it is resumed.
        changed: Signal(old, new) after each change of the state.
        opened: Signal(shape, path), after `changed`; path is None for a shape handed over.
        prepared: Signal(ready), once for each shape, and again when another distance uses other modes.
        frame_ready: Signal(frame) for each frame to draw.
        progressed: Signal(progress) while work goes on, Signal(None) when it ends.
        answered: Signal(request, result) of what was asked by `ask`.
        failed: Signal(error) when something asked for could not be done.
    """

    def __init__(self, post: Post, work: Work | None = None, cache: SpectrumCache | None = None) -> None:
        self.cache = cache
        self.state = State()
        self.frame: Frame | None = None
        self.ready: Ready | None = None
        self.busy = False
        self.changed, self.opened, self.prepared = Signal(), Signal(), Signal()
        self.frame_ready, self.progressed, self.failed, self.answered = (Signal() for _ in range(4))
        self._picker: FramePicker | None = None
        self.path: Path | None = None
        self._reading: BodyRequest | None = None
        self._pending: FrameRequest | None = None
        self._revisions: WeakSet[Shape] = WeakSet()
        """The shape that was opened, and what became of it by moving its vertices."""
        self.stopped = False
        self._closed = False
        self._runner = Runner(work or Pipeline(cache, previews=True).results, self._receive, post)

    def open(
        self, path: str | Path, component: ComponentChoice | None = None, part: str | None = None
    ) -> None:
        """Read a shape in the compute thread and show it; on failure everything stays as it was."""
        self._reading = OpenRequest(Path(path), component, part)
        self._start(self._reading)

    def show(self, shape: Shape, path: Path | None = None) -> None:
        """Show a shape in memory; planes, source and the distance's parameters become the defaults."""
        self._reading = None
        self._show(shape, path)

    def set(self, **fields: object) -> None:
        """Change fields of the query or the display, by name; equal values do nothing.

        Raises:
            TypeError: neither a query nor a display has such a field.
        """
        self._change(self.state.with_(**fields))

    def reshape(self, vertices: ArrayLike) -> None:
        """Move the vertices of the polygon shown; a source that this leaves outside becomes the barycentroid.

        The query stays, and so does the last frame until the first of the new polygon: each started one goes
        out, also if the vertices have been moved again meanwhile.

        Args:
            vertices: (n, 2), as many as there are.

        Raises:
            PolygonError: they make no simple polygon; the state stays as it was.
            ValueError: what is shown is no polygon.
        """
        new = state_reshaped(self.state, vertices)
        if new is not self.state and new.shape is not None:
            self._revisions.add(new.shape)
            self._change(new)

    def ask(self, request: ExamineRequest | RepairRequest) -> bool:
        """Have a body examined or repaired, and `answered` tell; return whether no file is being read."""
        if isinstance(self._reading, OpenRequest):
            return False
        self._reading = request
        self._start(request)
        return True

    def swap(self, shape: Shape, path: Path | None) -> None:
        """Show the shape shown after its repair; of the query, all stays that means something on it."""
        self._reading = None
        self._forget_frames(shape)
        self.path = path
        self._change(replace(self.state, shape=shape, query=query_on_repaired(self.state.query, shape)))

    def snapshot(self) -> Snapshot:
        """Everything that is shown, to come back to by `restore`."""
        return Snapshot(self.state, self.path, self.frame, self.ready)

    def restore(self, snapshot: Snapshot) -> None:
        """Show again what was shown; it is computed where it was not ready."""
        self._reading = self._pending = None
        self._runner.submit(DropRequest())
        self._forget_frames(snapshot.state.shape)
        self.path = snapshot.path
        old, self.state = self.state, snapshot.state
        self.changed.emit(old, self.state)
        if snapshot.ready is not None:
            self.ready = snapshot.ready
            self.prepared.emit(snapshot.ready)
        if snapshot.frame is not None:
            self._accept(snapshot.frame)
        self._go_on()

    def click(self, ray: Ray, target: Target = "slice-or-body") -> None:
        """Set the source where the ray meets a slice or the body; nothing happens where it misses."""
        if self.state.shape is None:
            return
        point = pick(self.state.shape, self._picker, ray, target)
        if point is not None:
            x, y, z = point.tolist()
            self._change(self.state.with_(source=(x, y, z)))

    def probe(self, ray: Ray) -> Probe | None:
        """The point of a slice under the ray and the value shown there."""
        return self._picker.probe(ray) if self._picker is not None else None

    def cancel(self) -> None:
        """Stop computing or reading at the next checkpoint; what is shown stays."""
        if self.busy:
            self.stopped = self.stopped or self._reading is None
            self._reading = None
            self._pending = None
            self._runner.submit(DropRequest())
            self._finish()

    def resume(self) -> None:
        """Compute what the state asks for and is not there."""
        self.stopped = False
        self._compute()

    def close(self) -> None:
        """End the compute thread; nothing is told afterwards. Idempotent."""
        self._closed = True
        self._runner.close()

    def _show(self, shape: Shape, path: Path | None) -> None:
        self._forget_frames(shape)
        self.path = path
        query = query_on_another(self.state.query, shape)
        display = replace(self.state.display, active_plane=0)
        shown = self.state.shape, self.state.query
        self._change(State(shape, query, display))
        if shown == (shape, query):  # shown again: nothing has changed, and there is no frame any more
            self._compute()
        self.opened.emit(shape, path)

    def _forget_frames(self, shape: Shape | None) -> None:
        self.frame = self.ready = self._picker = None
        self.stopped = False
        self._revisions = WeakSet([] if shape is None else [shape])

    def _change(self, new: State) -> None:
        old, self.state = self.state, new
        if old == new:
            return
        self.changed.emit(old, new)
        if (old.shape, old.query) != (new.shape, new.query) and not self.stopped:
            self._compute()

    def _compute(self) -> None:
        # While a shape is being read, its request must not be replaced; afterwards the state is computed.
        if self.state.shape is not None and self._reading is None:
            self._pending = frames_of(self.state, self.frame)
            self._start(self._pending)

    def _start(self, request: Request) -> None:
        self.busy = True
        self._runner.submit(request)

    def _receive(self, request: Request, result: Result) -> None:
        """Take a result from the compute thread; results of what nobody waits for any more are dropped."""
        if self._closed or not self._awaits(request):
            return
        match result:
            case Progress():
                self.progressed.emit(result)
            case Examined() | Foretold() | Repaired():
                self._reading = None
                self.answered.emit(request, result)
                if self._reading is None:
                    self._go_on()
            case Opened():
                self._reading = None
                self._show(result.shape, result.path)
            case Ready():
                self._accept_ready(result)
            case Frame():
                self._accept(result)
            case Failure():
                self._fail(request, result.error)
            case Finished():
                if request is self._pending:
                    self._finish()

    def _awaits(self, request: Request) -> bool:
        if isinstance(request, BodyRequest):
            return request is self._reading
        # A frame of an older query is still wanted: it is all there is to see during a fast drag.
        wanted = isinstance(request, FrameRequest) and request.shape in self._revisions
        return wanted and self._pending is not None

    def _accept_ready(self, ready: Ready) -> None:
        if not ready.preview:
            self.ready = ready
            self.prepared.emit(ready)
        self._change(state_through_centre(self.state, ready))

    def _accept(self, frame: Frame) -> None:
        self.frame = frame
        self._picker = FramePicker(frame)
        self.frame_ready.emit(frame)

    def _fail(self, request: Request, error: Exception) -> None:
        reading = request is self._reading
        if not reading and request is not self._pending:
            return
        self._reading = self._pending = None
        self._finish()
        self.failed.emit(error)
        if reading:
            self._go_on()
        elif self.frame is not None:  # return to the query whose frame is shown
            self._change(replace(self.state, query=self.frame.query))

    def _go_on(self) -> None:
        """Compute what is shown where that is not done, or else rest."""
        if self.state.shape is not None and not self.stopped and not is_complete(self.frame, self.state):
            self._compute()
        else:
            self._pending = None
            self._finish()

    def _finish(self) -> None:
        self.busy = False
        self.progressed.emit(None)
