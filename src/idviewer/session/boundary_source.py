"""Source of the boundaries that a pipeline computes on: the shapes that are shown, refined where need be."""

from __future__ import annotations

from collections.abc import Generator
from functools import partial

from idviewer.core import Shape
from idviewer.core.interior import boundary_steps
from idviewer.core.spectrum import Resolved
from idviewer.core.steps import Resumable, map_steps
from idviewer.session.state import Progress, Query

REFINING_BOUNDARY = "Refining the boundary"


def _told(share: float | None) -> Progress | None:
    return None if share is None else Progress(REFINING_BOUNDARY, share)


class BoundarySource:
    """Refines the boundary of a shape as a query asks; what was made of the last shape is kept.

    One refined boundary serves all distances: with another diffusion time no eigenpairs are computed anew.
    """

    def __init__(self) -> None:
        self._known: Resolved | None = None
        self._making: Resumable[float | None, Resolved] = Resumable()

    def steps(self, shape: Shape, query: Query) -> Generator[Progress | None, None, Resolved]:
        """The boundary that a query of a shape is computed on; progress is told where it is refined.

        Raises:
            ShapeError: the length asked for takes more vertices than there is memory for.
        """
        known = self._known
        if known is not None and known.given is shape and known.option == query.refine:
            return Resolved.unrefined(shape) if query.distance.of_given_vertices else known
        if not query.distance.needs_resolution:
            return Resolved.unrefined(shape)
        begin = partial(boundary_steps, shape, query.distance, query.refine)
        making = self._making.run((shape, query.refine), begin)
        self._known = yield from map_steps(_told, making)
        return self._known

    def forget_half_done(self) -> None:
        """Drop what was closed half-way."""
        self._making.forget()
