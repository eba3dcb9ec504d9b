"""A pipeline run to its end in the caller's own thread: for scripts and tests."""

from __future__ import annotations

from idviewer.core import Shape
from idviewer.session.pipeline import Pipeline
from idviewer.session.state import Failure, Frame, FrameRequest, Progress, Query


def run_to_end(shape: Shape, query: Query, pipeline: Pipeline | None = None) -> Frame:
    """Compute the finest, exact frame of a query, in this thread.

    Args:
        shape: a mesh or a polygon.
        query: what to compute.
        pipeline: one that may know something of the shape already; a new one by default.

    Raises:
        ValueError: the shape cannot carry the distance, or the coordinates do not work on it.
        SourceError: the source lies outside the shape.
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
