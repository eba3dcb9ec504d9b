"""Eigenpairs of shapes seen before, in files of the user's cache folder."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Generator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import platformdirs

from idviewer.core import Shape, Spectrum
from idviewer.core.spectrum import SOLVER_VERSION
from idviewer.core.steps import finish
from idviewer.session.array_cache import ArrayCache
from idviewer.session.array_files import DamagedError, Header

FORMAT_VERSION = 2
"""Of the files; to be raised when what they hold, or its meaning, changes."""

LIMIT_BYTES = 2 * 10**9
"""That all files together may take."""

WORTH_SECONDS = 0.2
"""Of computing from which on eigenpairs are kept; reading them takes a hundredth to a tenth of it."""

BLOCK_BYTES = 2**22
"""Hashed between two checkpoints: some 5 ms."""

Cutoff = Callable[[float], float]


class Lookup(NamedTuple):
    """Result of looking for eigenpairs.

    Attributes:
        spectrum: all eigenpairs asked for and no others; None if they are not there.
        complaint: what was wrong with the file that should hold them, to end the sentence "the file ...";
            empty if nothing was.
    """

    spectrum: Spectrum | None
    complaint: str = ""


class SpectrumCache(ArrayCache):
    """Keeps eigenpairs, by the content of their shapes and the version of the solver.

    Args:
        folder: where the files are; it is made when something is stored.
        limit: bytes that all of them may take.
        worth: seconds of computing from which on eigenpairs had better be stored.

    >>> import tempfile
    >>> from idviewer.core import Polygon, eigenpairs
    >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> with tempfile.TemporaryDirectory() as name:
    ...     cache = SpectrumCache(Path(name))
    ...     cache.store(square, eigenpairs(square))
    ...     found = cache.lookup(square, lambda lambda_2: 1.5 * lambda_2)
    >>> found.values.round(9).tolist()
    [2.0, 2.0]
    """

    def __init__(self, folder: Path, limit: int = LIMIT_BYTES, worth: float = WORTH_SECONDS) -> None:
        super().__init__(folder, limit)
        self.worth = worth

    @classmethod
    def of_user(cls) -> SpectrumCache:
        """The one in the user's own cache folder, which XDG_CACHE_HOME can move."""
        return cls(platformdirs.user_cache_path("idviewer", appauthor=False) / "eigenpairs")

    def lookup(self, shape: Shape, cutoff: Cutoff) -> Spectrum | None:
        """All eigenpairs with 0 < lambda < cutoff(lambda_2), if they are there; None otherwise."""
        return finish(self.lookup_steps(shape, cutoff)).spectrum

    def lookup_steps(self, shape: Shape, cutoff: Cutoff) -> Generator[float, None, Lookup]:
        """`lookup` as a generator that yields the share read every few milliseconds; tells what was wrong."""
        key = yield from key_steps(shape)

        def reaches(header: Header) -> bool:
            if header["key"] != key:
                raise DamagedError("was of another shape or version")
            # Reading what does not reach far enough would take as long as reading what does.
            return header["bound"] is None or header["bound"] >= cutoff(header["lambda_2"])

        header, arrays, complaint = yield from self.load_steps(key, reaches)
        if arrays is None:
            return Lookup(None, complaint)
        bound = math.inf if header["bound"] is None else header["bound"]
        found = Spectrum(arrays["values"], arrays["vectors"], arrays["masses"], header["residual"], bound)
        return Lookup(cut_down(found, cutoff))

    def store(self, shape: Shape, spectrum: Spectrum) -> None:
        """Keep eigenpairs; those of a shape that is there are replaced. Too many are not kept.

        Raises:
            OSError: they cannot be written.
        """
        finish(self.save_steps(shape, spectrum))

    def save_steps(self, shape: Shape, spectrum: Spectrum) -> Generator[float | None, None, None]:
        """`store` as a generator that yields every few milliseconds."""
        key = yield from key_steps(shape)
        header = {
            "key": key,
            "lambda_2": float(spectrum.values[0]),
            "bound": spectrum.bound if math.isfinite(spectrum.bound) else None,
            "residual": spectrum.residual,
        }
        arrays = {"values": spectrum.values, "vectors": spectrum.vectors, "masses": spectrum.masses}
        yield from self.store_steps(key, header, arrays)


def cut_down(spectrum: Spectrum, cutoff: Cutoff) -> Spectrum:
    """The spectrum without the eigenpairs that were not asked for; it must hold all that were."""
    wanted = cutoff(float(spectrum.values[0]))
    kept = int(np.searchsorted(spectrum.values, wanted))
    if kept == len(spectrum.values):
        return replace(spectrum, bound=wanted) if math.isfinite(spectrum.bound) else spectrum
    vectors = spectrum.vectors[:, :kept].copy(order="K")
    return replace(spectrum, values=spectrum.values[:kept].copy(), vectors=vectors, bound=wanted)


def key_steps(shape: Shape) -> Generator[float, None, str]:
    """Key that tells a shape from all others, whatever its name, and this solver from others."""
    digest = hashlib.blake2b(f"{FORMAT_VERSION} {SOLVER_VERSION} {shape.dimension}".encode(), digest_size=20)
    for array, kind in ((shape.vertices, "<f8"), (shape.facets, "<i8")):
        digest.update(f" {array.shape}".encode())
        data = np.ascontiguousarray(array, dtype=kind).reshape(-1).view(np.uint8)
        for start in range(0, len(data), BLOCK_BYTES):
            digest.update(data[start : start + BLOCK_BYTES].data)
            yield 0.0
    return digest.hexdigest()
