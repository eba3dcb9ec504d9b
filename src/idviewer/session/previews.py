"""Pictures of a mesh while its own eigenpairs are being computed, from those of a simplified one."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace
from typing import TypeVar

import numpy as np

from idviewer.core import Distance, Mesh, Shape, ShapeError, Spectrum
from idviewer.core.distances.spectral import percentage
from idviewer.core.interior import (
    EIGENPAIRS_STAGE,
    Preview,
    extent,
    is_worth_previewing,
    preview_cutoff,
    preview_solver,
    preview_steps,
)
from idviewer.core.steps import beside, without_shares
from idviewer.core.threads import small_products
from idviewer.session.frame_builder import FrameBuilder
from idviewer.session.shape_context import ShapeContext
from idviewer.session.state import Frame, Point, Progress, Query, QueryError, Ready

Steps = Generator[Progress, None, None]
Pictures = Generator[Frame | Ready | Progress | None, None, None]

Made = TypeVar("Made")

SEARCHING = "Finding the barycentroid of the preview"

NODES = 1600
"""Of a slice's second level; the first, which alone is shown, has 400, and the worst middles of edges."""


class Previews:
    """Makes a preview of a shape and answers queries with it; what is half done is kept.

    Where there is none, or it has no answer, there are no pictures.
    """

    def __init__(self) -> None:
        self._shape: Shape | None = None
        self._making: tuple[Distance, Steps] | None = None
        self._preview: Preview | None = None
        self._prepared: ShapeContext | None = None
        self._errors: dict[Distance, tuple[float, float]] = {}
        self._told: Preview | None = None

    def picture_steps(self, shape: Shape, query: Query) -> Pictures:
        """Progress, and as soon as the preview is there, where the barycentroid is and a frame."""
        if not (query.distance.spectral and isinstance(shape, Mesh) and is_worth_previewing(shape)):
            return
        if self._shape is not shape:
            self.forget()
            self._shape = shape
        try:
            with small_products():
                yield from self._prepare(shape, query)
                yield from self._pictures(query)
        except (QueryError, ShapeError, np.linalg.LinAlgError):
            return  # the mesh itself will answer, or tell what is wrong

    def centre(self, shape: Shape) -> Point | None:
        """The barycentroid shown last of a shape, if there is one."""
        if self._shape is not shape or self._prepared is None:
            return None
        return self._prepared.latest

    def spectrum_of(self, shape: Shape) -> Spectrum | None:
        """The coarse eigenpairs, while a shape has a preview."""
        return self._preview.spectrum if self._shape is shape and self._preview is not None else None

    def drop(self) -> None:
        """Forget what is half done."""
        self._making = None
        if self._prepared is not None:
            self._prepared.forget_search()

    def forget(self) -> None:
        """Forget everything."""
        self._shape = self._making = self._preview = self._prepared = self._told = None
        self._errors = {}

    def _prepare(self, shape: Mesh, query: Query) -> Steps:
        if self._preview is not None and self._preview.serves(query.distance):
            return
        if self._making is None or self._making[0] != query.distance:
            self._making = query.distance, self._make(shape, query)
        # Not `yield from`: that would close the preparation together with this request.
        while self._making is not None:
            try:
                progress = next(self._making[1])
            except StopIteration:
                self._making = None
                return
            yield progress

    def _make(self, shape: Mesh, query: Query) -> Steps:
        steps = preview_steps(shape, preview_cutoff(query.distance))
        while True:
            try:
                yield Progress(*next(steps))
            except StopIteration as stop:
                preview: Preview | None = stop.value
                break
        if preview is None:
            return
        for _ in beside(lambda: shape.patches):  # which the first section needs
            yield Progress(EIGENPAIRS_STAGE)
        solver = preview_solver(preview, query.distance, query.coordinates)
        prepared = ShapeContext(solver, finest=NODES)
        for _ in prepared.find_barycentroid_steps(solver):
            yield Progress(SEARCHING)
        if preview.keeps_inside(prepared.barycentroid(query)):
            self._preview, self._prepared, self._errors = preview, prepared, {}

    def _pictures(self, query: Query) -> Pictures:
        if self._preview is None or self._prepared is None:
            return
        yield from without_shares(self._prepared.basis_steps(query))
        framing = FrameBuilder(self._prepared, query)
        if self._told is not self._preview:
            self._told = self._preview
            place = np.array(self._prepared.barycentroid(query))
            yield Ready(self._preview.full, len(self._preview.spectrum.values), place, preview=True)
        yield (yield from self._picture(framing, query))
        if framing.shows_barycentroid and not framing.settled:
            yield from self._prepared.find_barycentroid_steps(framing.solver)
            yield (yield from self._picture(framing, query))

    def _picture(self, framing: FrameBuilder, query: Query) -> Generator[None, None, Frame]:
        samples = yield from without_shares(framing.prepare_steps())
        slices = []
        for one in samples:
            slices.append((yield from one.level_steps(0)))
        frame = yield from framing.frame_steps(slices, 0)
        share, largest = self._error(query.distance, framing)
        title = f"{frame.title}; preview (error about {percentage(share)})"
        return replace(frame, exact=False, error=frame.error + share * largest, preview=share, title=title)

    def _error(self, distance: Distance, framing: FrameBuilder) -> tuple[float, float]:
        """Of a distance: the share, and the largest distance on the boundary."""
        assert self._preview is not None
        if distance not in self._errors:
            embedding = framing.solver.boundary.embedding
            self._errors[distance] = self._preview.error(distance), extent(embedding)
        return self._errors[distance]


def in_words(share: float) -> str:
    """What a preview's title and the window say of its error.

    >>> in_words(0.0163), in_words(0.38)
    ('Preview, error about 1.6%', 'Preview, error about 38%')
    """
    return f"Preview, error about {percentage(share)}"
