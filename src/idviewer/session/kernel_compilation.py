"""The kernels that shapes and coordinates need, compiled before they are used."""

from __future__ import annotations

from collections.abc import Generator

from idviewer.core import Shape
from idviewer.core.compilation import compile_steps
from idviewer.core.steps import Resumable
from idviewer.session.progress import with_progress
from idviewer.session.state import Progress

COMPILING = "Preparing kernels (compiled once, at the first run)"


class Kernels:
    """Compiles each kind once; what is half done goes on with the next request."""

    def __init__(self) -> None:
        self._compiled: set[tuple[int, str]] = set()
        self._compiling: Resumable[Progress, None] = Resumable()

    def steps(self, coordinates: str, shape: Shape) -> Generator[Progress, None, None]:
        """Compile those of these coordinates on such shapes, where they are not compiled yet."""
        key = shape.dimension, coordinates
        if key not in self._compiled:
            yield from self._compiling.run(key, lambda: _compilation(*key))
            self._compiled.add(key)

    def forget_half_done(self) -> None:
        """Drop what was closed half-way."""
        self._compiling.forget()


def _compilation(dimension: int, coordinates: str) -> Generator[Progress, None, None]:
    yield Progress(COMPILING)
    yield from with_progress(COMPILING, compile_steps(dimension, coordinates))
