"""Where a pipeline's eigenpairs come from: the cache, if they are there, or else the solver."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import closing
from dataclasses import replace
from time import perf_counter
from typing import NamedTuple
from weakref import ref

from idviewer.core import Distance, Shape, Spectrum
from idviewer.core.interior import is_worth_previewing
from idviewer.core.spectrum.eigen_solver import eigenpair_steps
from idviewer.session.cached_view import CachedView
from idviewer.session.progress import with_progress
from idviewer.session.spectrum_cache import SpectrumCache
from idviewer.session.state import Frame, Progress, Query, Result

COMPUTING, REFINING = "Computing eigenpairs", "Refining eigenpairs"
FACTORING = "Factoring (cannot be interrupted)"
READING = "Reading the eigenpairs kept"


class CacheHit(NamedTuple):
    """What is kept of a shape from earlier runs: the eigenpairs asked for, and what a first view showed."""

    spectrum: Spectrum | None
    opening: CachedView | None


class EigenpairSource:
    """Has eigenpairs read or computed, and keeps those that took long once there is something to see.

    Args:
        cache: where they are kept; None for nowhere.
    """

    def __init__(self, cache: SpectrumCache | None) -> None:
        self._cache = cache
        self._remarks: tuple[str, ...] = ()
        self._of: ref[Shape] | None = None
        self._are_kept = self._damaged = self._has_complained = False
        self._keeping: Generator[float | None, None, None] | None = None

    def remarks(self, shape: Shape) -> tuple[str, ...]:
        """What there is to say of a shape's eigenpairs, one sentence each."""
        return self._remarks if self._of is not None and self._of() is shape else ()

    def steps(self, shape: Shape, distance: Distance) -> Generator[Progress, None, Spectrum]:
        """The eigenpairs that a distance needs, read or else computed."""
        known = yield from self._spectrum_steps(shape, distance)
        return (yield from self.compute_steps(shape, distance)) if known is None else known

    def recall_steps(self, shape: Shape, query: Query) -> Generator[Progress, None, CacheHit]:
        """What is kept of a shape that a query's first view needs."""
        spectrum = opening = None
        if query.distance.spectral:
            spectrum = yield from self._spectrum_steps(shape, query.distance)
        if spectrum is not None:
            opening = yield from self._opening_steps(shape, spectrum, query)
        return CacheHit(spectrum, opening)

    def _spectrum_steps(self, shape: Shape, distance: Distance) -> Generator[Progress, None, Spectrum | None]:
        self._of, self._remarks, self._damaged = ref(shape), (), False
        if self._cache is None:
            return None
        steps = self._cache.lookup_steps(shape, distance.cutoff)
        spectrum, complaint = yield from with_progress(READING, steps)
        self._are_kept = spectrum is not None
        if complaint:
            self._damaged = True
            self._remarks = (
                f"The eigenpairs kept of this shape were computed again: their file {complaint}.",
            )
        return spectrum

    def compute_steps(
        self, shape: Shape, distance: Distance, stage: str = COMPUTING, guess: float | None = None
    ) -> Generator[Progress, None, Spectrum]:
        """Those eigenpairs by the solver; they will be kept if that is worth it.

        Args:
            shape, distance: as above.
            stage: what the progress is called.
            guess: lambda_2, where it is about known.
        """
        yield Progress(stage, 0.0)
        share, spent = 0.0, 0.0
        steps = eigenpair_steps(shape, distance.cutoff, guess)
        while True:
            began = perf_counter()
            try:
                share = max(share, next(steps) or 0.0)
            except StopIteration as stop:
                spent += perf_counter() - began
                if self._cache is not None and (self._damaged or spent >= self._cache.worth):
                    self._are_kept = True
                    self._keeping = self._cache.store_steps(shape, stop.value)
                return stop.value
            spent += perf_counter() - began
            # The large factorisation comes first, and is a single step.
            yield Progress(FACTORING if share == 0.0 and is_worth_previewing(shape) else stage, share)

    def keep_steps(self) -> Generator[None, None, None]:
        """Writes what is to be kept; goes on where it was left when closed. That it cannot is a remark."""
        while self._keeping is not None:
            try:
                next(self._keeping)
            except StopIteration:
                self._keeping = None
            except OSError as error:
                self._keeping = None
                self._complain(error)
            yield

    def _opening_steps(
        self, shape: Shape, spectrum: Spectrum, query: Query
    ) -> Generator[Progress, None, CachedView | None]:
        if self._cache is None or shape.dimension == 2:
            return None
        steps = self._cache.lookup_opening_steps(shape, spectrum, query)
        opening, complaint = yield from with_progress(READING, steps)
        if complaint:
            told = f"The view kept of this shape was sampled again: its file {complaint}."
            self._remarks = (*self._remarks, told)
        return opening

    def keep_opening_steps(
        self, shape: Shape, spectrum: Spectrum, query: Query, opening: CachedView
    ) -> Generator[None, None, None]:
        """Writes what the first view of a shape shows, unless its eigenpairs are not kept."""
        if self._cache is None or not self._are_kept:
            return
        try:
            for _ in self._cache.store_opening_steps(shape, spectrum, query, opening):
                yield
        except OSError as error:
            self._complain(error)

    def kept_after(
        self, results: Generator[Result | None, None, None]
    ) -> Generator[Result | None, None, None]:
        """Results, frames with the remarks; what is to be kept is written when the first frame is out."""
        with closing(results):
            for result in results:
                if not isinstance(result, Frame):
                    yield result
                    continue
                yield replace(result, remarks=(*self.remarks(result.shape), *result.remarks))
                yield from self.keep_steps()

    def _complain(self, error: OSError) -> None:
        # Where nothing can be kept, once is enough to say so.
        if not self._has_complained and self._cache is not None:
            self._has_complained = True
            told = f"The eigenpairs were not kept in {self._cache.folder} ({error.strerror or error})."
            self._remarks = (*self._remarks, told)
