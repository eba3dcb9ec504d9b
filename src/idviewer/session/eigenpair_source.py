"""Source of a pipeline's eigenpairs: the cache, if they are there, or else the solver."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import closing
from dataclasses import replace
from functools import partial
from weakref import ref

from idviewer.core import Distance, Shape, Spectrum
from idviewer.core.interior import is_worth_previewing
from idviewer.core.spectrum import eigenpair_steps
from idviewer.core.steps import Resumable, Timed, map_steps, without_shares
from idviewer.session.progress import with_progress
from idviewer.session.spectrum_cache import SpectrumCache
from idviewer.session.state import Frame, Progress, Result

COMPUTING, REFINING = "Computing eigenpairs", "Refining eigenpairs"
FACTORING = "Factoring (cannot be interrupted)"
READING = "Reading the eigenpairs kept"


class EigenpairSource:
    """Reads eigenpairs or computes them, and keeps those that took long once there is something to see.

    Args:
        cache: where they are kept; None for nowhere.

    Attributes:
        are_kept: whether those of the shape looked at last are kept, or are to be.
    """

    def __init__(self, cache: SpectrumCache | None) -> None:
        self._cache = cache
        self._remarks: tuple[str, ...] = ()
        self._of: ref[Shape] | None = None
        self.are_kept = self._damaged = self._has_complained = False
        self._pending: tuple[Shape, Spectrum] | None = None
        self._writing: Resumable[float | None, None] = Resumable()

    def remarks(self, shape: Shape) -> tuple[str, ...]:
        """Remarks on a shape's eigenpairs, one sentence each."""
        return self._remarks if self._of is not None and self._of() is shape else ()

    def steps(
        self, shape: Shape, distance: Distance, guess: float | None = None
    ) -> Generator[Progress, None, Spectrum]:
        """Read the eigenpairs that a distance needs, or else compute them; for guess see `compute_steps`."""
        known = yield from self.look_up_steps(shape, distance)
        if known is not None:
            return known
        return (yield from self.compute_steps(shape, distance, guess=guess))

    def look_up_steps(self, shape: Shape, distance: Distance) -> Generator[Progress, None, Spectrum | None]:
        """Read the eigenpairs that a distance needs, if they are kept from an earlier run."""
        self._of, self._remarks, self._damaged = ref(shape), (), False
        if self._cache is None or not distance.spectral:
            return None
        steps = self._cache.lookup_steps(shape, distance.cutoff)
        spectrum, complaint = yield from with_progress(READING, steps)
        self.are_kept = spectrum is not None
        if complaint:
            self._damaged = True
            self._remarks = (
                f"The eigenpairs kept of this shape were computed again: their file {complaint}.",
            )
        return spectrum

    def compute_steps(
        self, shape: Shape, distance: Distance, stage: str = COMPUTING, guess: float | None = None
    ) -> Generator[Progress, None, Spectrum]:
        """Compute those eigenpairs; they will be kept if that is worth it.

        Args:
            shape, distance: as above.
            stage: what the progress is called.
            guess: lambda_2, where it is about known.
        """
        yield Progress(stage, 0.0)
        share, factors_long = 0.0, is_worth_previewing(shape)

        def progress(done: float | None) -> Progress:
            nonlocal share
            share = max(share, done or 0.0)
            # The large factorisation comes first, and is a single step.
            return Progress(FACTORING if share == 0.0 and factors_long else stage, share)

        computing = Timed(eigenpair_steps(shape, distance.cutoff, guess))
        spectrum = yield from map_steps(progress, computing)
        if self._cache is not None and (self._damaged or computing.seconds >= self._cache.worth):
            self.are_kept = True
            self._pending = shape, spectrum
            self._writing.forget()
        return spectrum

    def keep_steps(self) -> Generator[None, None, None]:
        """Write what is to be kept; go on where it was left when closed. That it cannot is a remark."""
        if self._cache is None or self._pending is None:
            return
        shape, spectrum = self._pending
        writing = self._writing.run("eigenpairs", partial(self._cache.save_steps, shape, spectrum))
        try:
            yield from without_shares(writing)
        except OSError as error:
            self.are_kept = False
            self.remark_unwritten(error)
        self._pending = None
        yield

    def with_deferred_writes(
        self, results: Generator[Result | None, None, None]
    ) -> Generator[Result | None, None, None]:
        """Results, frames with the remarks; what is to be kept is written when a frame is out."""
        with closing(results):
            for result in results:
                if not isinstance(result, Frame):
                    yield result
                    continue
                yield replace(result, remarks=(*self.remarks(result.shape), *result.remarks))
                yield from self.keep_steps()

    def remark(self, sentence: str) -> None:
        """Add remarks on the shape."""
        self._remarks = (*self._remarks, sentence)

    def remark_unwritten(self, error: OSError) -> None:
        """Add that something cannot be kept; once is enough to say so."""
        if not self._has_complained and self._cache is not None:
            self._has_complained = True
            self.remark(f"The eigenpairs were not kept in {self._cache.folder} ({error.strerror or error}).")
