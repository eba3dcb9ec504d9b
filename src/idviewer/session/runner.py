"""One compute thread with one pending slot: a newer request replaces the one that waits."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator

from idviewer.core.memory import release_free_memory
from idviewer.session.state import (
    BodyRequest,
    DropRequest,
    Failure,
    Finished,
    Frame,
    FrameRequest,
    Progress,
    Request,
    Result,
)

Work = Callable[[Request], Iterator[Result | None]]
Post = Callable[[Callable[[], None]], None]
Deliver = Callable[[Request, Result], None]


class Runner:
    """Runs requests one at a time in its own thread and delivers what they yield.

    Between two yields it looks for a newer request. A request for frames is left for a newer one only
    while it reports progress or after its first frame, or a fast drag would freeze the picture; for
    opening, examining, repairing, dropping and closing it is left at once.

    Args:
        work: from a request to its results; called and iterated in the compute thread only.
        deliver: what to do with a result; called through post.
        post: has a callable run in the owner's thread. May be called from any thread.
    """

    def __init__(self, work: Work, deliver: Deliver, post: Post) -> None:
        self._work, self._deliver, self._post = work, deliver, post
        self._changed = threading.Condition()
        self._pending: Request | None = None
        self._closing = False
        self._thread = threading.Thread(target=self._run, name="idviewer-compute", daemon=True)
        self._thread.start()

    def submit(self, request: Request) -> None:
        """Ask for something; a request that still waits is replaced. Any thread; returns at once."""
        with self._changed:
            self._pending = request
            self._changed.notify()

    def close(self) -> None:
        """Stop at the next checkpoint and join the thread; nothing is delivered afterwards. Idempotent."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        if self._thread is not threading.current_thread():
            self._thread.join()

    def _run(self) -> None:
        while (request := self._next()) is not None:
            self._serve(request)
            if self._pending is None:
                release_free_memory()

    def _next(self) -> Request | None:
        with self._changed:
            self._changed.wait_for(lambda: self._closing or self._pending is not None)
            request, self._pending = self._pending, None
            return None if self._closing else request

    def _serve(self, request: Request) -> None:
        results = self._work(request)
        shown = not isinstance(request, FrameRequest)
        try:
            for result in results:
                if result is not None:
                    self._send(request, result)
                shown = shown or isinstance(result, Frame)
                if self._leave(shown or isinstance(result, Progress)):
                    return
            self._send(request, Finished())
        except Exception as error:  # a defect in the work must not end the thread
            self._send(request, Failure(error))
            self._send(request, Finished())
        finally:
            close = getattr(results, "close", None)
            if close is not None:
                close()

    def _leave(self, interruptible: bool) -> bool:
        """Whether to stop working on the present request."""
        with self._changed:
            urgent = isinstance(self._pending, BodyRequest | DropRequest)
            return self._closing or urgent or (interruptible and self._pending is not None)

    def _send(self, request: Request, result: Result) -> None:
        if not self._closing:
            self._post(lambda: self._deliver(request, result))
