"""What a frame takes of the window's event loop, in the program's own window."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from memory import screen
from settings import Settings
from table import Bar, Row

TITLE = "A frame in the window's event loop, but for VTK's drawing"
NOTE = (
    "From a new plane to VTK's drawing of its 20,000 values (panel, slice, markers, bar, handle), or from a "
    "dragged vertex of a polygon to that of its frame, and then the value under the mouse. Processor time of "
    "the window's thread, medians; needs a display or Xvfb."
)
BARS = {"plane": Bar(4.0), "look": Bar(4.0), "vertex": Bar(8.0)}
WHAT = {"plane": "a plane moved", "look": "the value under the mouse", "vertex": "a vertex of 200 moved"}
PROGRAM = Path(__file__).with_name("event_loop_process.py")
TIMEOUT = 300
STEPS = 8
"""Frames of each kind, for each turn."""


def rows(settings: Settings) -> Iterator[Row]:
    with screen() as environment, tempfile.TemporaryDirectory() as folder:
        if not environment:
            return
        done = subprocess.run(
            [sys.executable, PROGRAM, str(settings.turns * STEPS)],
            env={**os.environ, **environment, "XDG_CONFIG_HOME": folder, "XDG_CACHE_HOME": folder},
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
        )
    if done.returncode != 0:
        raise RuntimeError(f"the window ended with status {done.returncode}: {done.stderr[-2000:]}")
    for name, told in json.loads(done.stdout).items():
        yield Row(WHAT[name], told["on"], 1e3 * told["seconds"], "ms", bar=BARS[name])
