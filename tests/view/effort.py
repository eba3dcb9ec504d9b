"""What the event loop is given to do, counted: a clock would tell of the machine and of who else is on it."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from idviewer import app
from idviewer.view import polydata
from idviewer.view.gui_thread import Post
from idviewer.view.viewport import Viewport

CALLS, POSTS, DRAWS, LOOKS, ARRAYS, BYTES = "calls", "posts", "draws", "looks", "arrays", "bytes"


class Effort:
    """Counts what windows made from now on have the event loop do, but for VTK's drawing itself.

    Attributes:
        counts: calls of functions, Python's and others; calls posted by the compute thread; pictures drawn;
            looks at what is under the mouse; arrays handed to VTK, and their bytes.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.counts: Counter[str] = Counter()
        monkeypatch.setattr(app, "Post", lambda: CountedPost(self))
        monkeypatch.setattr(Viewport, "_before_draw", self.around(Viewport._before_draw, DRAWS))
        monkeypatch.setattr(Viewport, "_rest", self.around(Viewport._rest, LOOKS))
        monkeypatch.setattr(polydata, "numpy_to_vtk", self._handing_over(polydata.numpy_to_vtk))

    def around(self, call: Callable[..., None], kind: str = "") -> Callable[..., None]:
        """The call, which counts as one of its kind, and the calls within it."""

        def counted(*arguments: object, **named: object) -> None:
            self.counts[kind] += 1
            outer = sys.getprofile()
            sys.setprofile(self._see)
            try:
                call(*arguments, **named)
            finally:
                sys.setprofile(outer)

        return counted

    def _see(self, _frame: object, event: str, _argument: object) -> None:
        self.counts[CALLS] += event in ("call", "c_call")

    def _handing_over(self, call: Callable[..., Any]) -> Callable[..., Any]:
        def counted(values: np.ndarray, *arguments: object, **named: object) -> Any:
            self.counts[ARRAYS] += 1
            self.counts[BYTES] += values.nbytes
            return call(values, *arguments, **named)

        return counted


class CountedPost(Post):
    """Counts what the compute thread has the event loop do."""

    def __init__(self, effort: Effort) -> None:
        super().__init__()
        self._effort = effort

    def __call__(self, call: Callable[[], None]) -> None:
        super().__call__(self._effort.around(call, POSTS))
