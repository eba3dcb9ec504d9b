"""A mesh seen before its own eigenpairs are there: what is known of it by those of a simplified one."""

from __future__ import annotations

from collections.abc import Generator

from idviewer.core import Mesh, Shape, Spectrum
from idviewer.core.distances import percentage
from idviewer.core.interior import (
    Preview,
    is_worth_previewing,
    preview_cutoff,
    preview_solver,
    preview_steps,
)
from idviewer.core.steps import Resumable, beside, map_steps
from idviewer.session.progress import PREPARING_SLICES, with_progress
from idviewer.session.shape_context import ShapeContext
from idviewer.session.state import Point, Progress, Query

SEARCHING_PREVIEW = "Finding the barycentroid of the preview"

PREVIEW_NODES = 1600
"""Of a slice's second level; the first, which alone is shown, has 400, and the worst midpoints of edges."""


class PreviewSource:
    """Makes the context of a preview of a shape; what is half done is kept."""

    def __init__(self) -> None:
        self._shape: Shape | None = None
        self._making: Resumable[Progress, ShapeContext | None] = Resumable()
        self._context: ShapeContext | None = None

    def context_steps(self, shape: Shape, query: Query) -> Generator[Progress, None, ShapeContext | None]:
        """Make what a query needs of a preview; None where there is none.

        Raises:
            ShapeError: the distance does not work on the simplified mesh.
            LinAlgError: its eigenpairs could not be computed.
        """
        if not (query.distance.spectral and isinstance(shape, Mesh) and is_worth_previewing(shape)):
            return None
        if self._shape is not shape:
            self.forget()
            self._shape = shape
        known = self._preview
        if known is None or not known.serves(query.distance):
            made = yield from self._making.run(query.distance, lambda: _make(shape, query))
            self._context = made or self._context
        return self._context

    def centre(self, shape: Shape) -> Point | None:
        """The barycentroid shown last of a shape, if there is one."""
        return (
            self._context.latest_barycentroid if self._context is not None and self._shape is shape else None
        )

    def spectrum_of(self, shape: Shape) -> Spectrum | None:
        """The coarse eigenpairs, while a shape has a preview."""
        preview = self._preview
        return preview.spectrum if preview is not None and self._shape is shape else None

    @property
    def _preview(self) -> Preview | None:
        return None if self._context is None else self._context.preview

    def forget_half_done(self) -> None:
        """Drop what was closed half-way."""
        self._making.forget()
        if self._context is not None:
            self._context.forget_half_done()

    def forget(self) -> None:
        """Drop everything."""
        self._making.forget()
        self._shape = self._context = None


def _make(shape: Mesh, query: Query) -> Generator[Progress, None, ShapeContext | None]:
    steps = preview_steps(shape, preview_cutoff(query.distance))
    preview = yield from map_steps(lambda told: Progress(*told), steps)
    if preview is None:
        return None
    # Which the first section needs.
    yield from with_progress(PREPARING_SLICES, beside(lambda: shape.patches))
    solver = preview_solver(preview, query.distance, query.coordinates)
    context = ShapeContext(solver, nodes=PREVIEW_NODES, preview=preview)
    yield from map_steps(lambda _: Progress(SEARCHING_PREVIEW), context.find_barycentroid_steps(solver))
    return context if preview.keeps_inside(context.barycentroid(query)) else None


def describe_preview(share: float) -> str:
    """Say in words how wrong a preview is.

    >>> describe_preview(0.0163), describe_preview(0.38)
    ('Preview, error about 1.6%', 'Preview, error about 38%')
    """
    return f"Preview, error about {percentage(share)}"
