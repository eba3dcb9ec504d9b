"""The kernels that shapes and coordinates need, compiled before they are used."""

from __future__ import annotations

from collections.abc import Generator
from inspect import GEN_CLOSED, getgeneratorstate

from idviewer.core import Shape
from idviewer.core.compilation import compile_steps
from idviewer.session.state import Progress

COMPILING = "Preparing kernels (compiled once, at the first run)"


class Kernels:
    """Compiles each kind once; what is half done goes on with the next request."""

    def __init__(self) -> None:
        self._compiling: dict[tuple[int, str], Generator[Progress, None, None]] = {}

    def steps(self, coordinates: str, shape: Shape) -> Generator[Progress, None, None]:
        """Those of these coordinates on such shapes, as far as they are still to be compiled."""
        key = shape.dimension, coordinates
        steps = self._compiling.setdefault(key, _compilation(*key))
        # Not `yield from`: that would close it together with this request.
        while (progress := next(steps, None)) is not None:
            yield progress

    def drop(self) -> None:
        """Forget what is half done."""
        self._compiling = {key: one for key, one in self._compiling.items() if _is_done(one)}


def _is_done(steps: Generator[Progress, None, None]) -> bool:
    return getgeneratorstate(steps) == GEN_CLOSED


def _compilation(dimension: int, coordinates: str) -> Generator[Progress, None, None]:
    yield Progress(COMPILING)
    for share in compile_steps(dimension, coordinates):
        yield Progress(COMPILING, share)
