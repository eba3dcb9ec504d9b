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
from idviewer.core.spectrum.eigen_solver import SOLVER_VERSION
from idviewer.core.steps import finish
from idviewer.session.bounded_folder import BoundedFolder
from idviewer.session.cached_view import CachedView, kind_steps
from idviewer.session.state import Query
from idviewer.session.stored_arrays import Arrays, DamagedError, read_about, read_steps, write_steps

FORMAT = 1
"""Of the files; to be raised when what they hold, or its meaning, changes."""

LIMIT = 2 * 10**9
"""Bytes that all files together may take."""

WORTH = 0.2
"""Seconds of computing from which on eigenpairs are kept; reading them takes a hundredth to a tenth of it."""

SUFFIX, VIEW = ".kept", "-view"
PORTION = 2**22
"""Bytes hashed between two checkpoints: some 5 ms."""

Cutoff = Callable[[float], float]


class Lookup(NamedTuple):
    """What looking for eigenpairs gave.

    Attributes:
        spectrum: all eigenpairs asked for and no others; None if they are not there.
        complaint: what was wrong with the file that should hold them, to end the sentence "the file ...";
            empty if nothing was.
    """

    spectrum: Spectrum | None
    complaint: str = ""


class SpectrumCache:
    """Keeps eigenpairs, by the content of their shapes and the version of the solver.

    Several programs may use one folder at a time. Every file holds one shape's pairs with checksums, and
    takes no more than half of the limit; those used longest ago make room.

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

    def __init__(self, folder: Path, limit: int = LIMIT, worth: float = WORTH) -> None:
        self.worth = worth
        self._files = BoundedFolder(folder, SUFFIX, limit)

    @classmethod
    def of_user(cls) -> SpectrumCache:
        """The one in the user's own cache folder, which XDG_CACHE_HOME can move."""
        return cls(platformdirs.user_cache_path("idviewer", appauthor=False) / "eigenpairs")

    @property
    def folder(self) -> Path:
        """Where the files are."""
        return self._files.path

    @property
    def size(self) -> int:
        """Bytes of all files."""
        return self._files.size

    def clear(self) -> int:
        """Deletes everything; the number of bytes that this freed. Any thread may call it at any time."""
        return self._files.clear()

    def lookup(self, shape: Shape, cutoff: Cutoff) -> Spectrum | None:
        """All eigenpairs with 0 < lambda < cutoff(lambda_2), if they are there; None otherwise."""
        return finish(self.lookup_steps(shape, cutoff)).spectrum

    def lookup_steps(self, shape: Shape, cutoff: Cutoff) -> Generator[float, None, Lookup]:
        """`lookup` as a generator that yields the share read every few milliseconds; tells what was wrong."""
        key = yield from _key_steps(shape)
        try:
            with open(self._files.file(key), "rb", buffering=0) as file:
                about, entries = read_about(file)
                if about["key"] != key:
                    raise DamagedError("was of another shape or version")
                # Reading what does not reach far enough would take as long as reading what does.
                if about["bound"] is not None and about["bound"] < cutoff(about["lambda_2"]):
                    return Lookup(None)
                arrays = yield from read_steps(file, entries)
        except (FileNotFoundError, NotADirectoryError, PermissionError):
            return Lookup(None)
        except OSError as error:
            return Lookup(None, f"could not be read: {error.strerror}")
        except (LookupError, TypeError, ValueError) as error:
            return Lookup(None, _complaint(error))
        self._files.used(key)
        bound = math.inf if about["bound"] is None else about["bound"]
        return Lookup(cut_down(_spectrum_of(arrays, about["residual"], bound), cutoff))

    def lookup_opening_steps(
        self, shape: Shape, spectrum: Spectrum, query: Query
    ) -> Generator[float, None, tuple[CachedView | None, str]]:
        """What the first view of a shape with these eigenpairs showed, if it is there; complaints."""
        key = (yield from _key_steps(shape)) + VIEW
        try:
            with open(self._files.file(key), "rb", buffering=0) as file:
                about, entries = read_about(file)
                expected = {"key": key, **(yield from kind_steps(query, spectrum))}
                if any(about[name] != value for name, value in expected.items()):
                    return None, ""
                opening = CachedView.of(about, (yield from read_steps(file, entries)))
        except OSError:
            return None, ""
        except (LookupError, TypeError, ValueError) as error:
            return None, _complaint(error)
        self._files.used(key)
        return opening, ""

    def store_opening_steps(
        self, shape: Shape, spectrum: Spectrum, query: Query, opening: CachedView
    ) -> Generator[float | None, None, None]:
        """Keeps what the first view of a shape shows; that of another distance is replaced.

        Raises:
            OSError: it cannot be written.
        """
        size = sum(array.nbytes for array in opening.arrays.values())
        if not self._files.takes(size):
            return
        key = (yield from _key_steps(shape)) + VIEW
        about = {"key": key, **(yield from kind_steps(query, spectrum)), **opening.about}
        self._files.make_room(size)
        yield from write_steps(self._files.file(key), about, opening.arrays)

    def store(self, shape: Shape, spectrum: Spectrum) -> None:
        """Keeps eigenpairs; those of a shape that is there are replaced. Too many are not kept.

        Raises:
            OSError: they cannot be written.
        """
        finish(self.store_steps(shape, spectrum))

    def store_steps(self, shape: Shape, spectrum: Spectrum) -> Generator[float | None, None, None]:
        """`store` as a generator that yields every few milliseconds."""
        arrays = {"values": spectrum.values, "vectors": spectrum.vectors, "masses": spectrum.masses}
        size = sum(array.nbytes for array in arrays.values())
        if not self._files.takes(size):
            return
        key = yield from _key_steps(shape)
        about = {
            "key": key,
            "lambda_2": float(spectrum.values[0]),
            "bound": spectrum.bound if math.isfinite(spectrum.bound) else None,
            "residual": spectrum.residual,
        }
        self._files.make_room(size)
        yield from write_steps(self._files.file(key), about, arrays)


def cut_down(spectrum: Spectrum, cutoff: Cutoff) -> Spectrum:
    """A spectrum without the eigenpairs that were not asked for; it must hold all that were."""
    asked = cutoff(float(spectrum.values[0]))
    kept = int(np.searchsorted(spectrum.values, asked))
    if kept == len(spectrum.values):
        return replace(spectrum, bound=asked) if math.isfinite(spectrum.bound) else spectrum
    vectors = spectrum.vectors[:, :kept].copy(order="K")
    return replace(spectrum, values=spectrum.values[:kept].copy(), vectors=vectors, bound=asked)


def _complaint(error: Exception) -> str:
    """What is wrong with a file, to end the sentence "the file ..."."""
    return str(error) if isinstance(error, DamagedError) else "was damaged"


def _spectrum_of(arrays: Arrays, residual: float, bound: float) -> Spectrum:
    return Spectrum(arrays["values"], arrays["vectors"], arrays["masses"], residual, bound)


def _key_steps(shape: Shape) -> Generator[float, None, str]:
    """What tells a shape from all others, whatever its name, and this solver from others."""
    digest = hashlib.blake2b(f"{FORMAT} {SOLVER_VERSION} {shape.dimension}".encode(), digest_size=20)
    for array, kind in ((shape.vertices, "<f8"), (shape.facets, "<i8")):
        digest.update(f" {array.shape}".encode())
        data = np.ascontiguousarray(array, dtype=kind).reshape(-1).view(np.uint8)
        for start in range(0, len(data), PORTION):
            digest.update(data[start : start + PORTION].data)
            yield 0.0
    return digest.hexdigest()
