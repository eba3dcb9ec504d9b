"""From a file to its first colours and to the final ones, each body in a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from statistics import median

import pyvista as pv
from bodies import pebble
from settings import Settings
from table import Bar, Row

TITLE = "Opening: first colours, final ones, and a mesh seen before"
NOTE = (
    "A pebble, which is a bumpy ellipsoid, read from a binary PLY file; kernels are "
    "loaded before. First colours are a preview where the mesh is large; their error is its largest change "
    "of a distance until the final one, as a share of the largest. Final is the first frame with the mesh's "
    "own eigenpairs within 1e-3; beside it when every value is exact. Memory is the largest resident set of "
    "the pipeline, which has no window."
)
PROGRAM = Path(__file__).with_name("opening_process.py")
TIMEOUT = 1800
TURNS, ONCE = 3, 100_000

FIRST = {27_000: Bar(1.0, 0.02), 134_000: Bar(2.5, 0.02), 537_000: Bar(8.0, 0.02)}
FINAL = {27_000: Bar(2.0)}
AGAIN = {43_000: Bar(0.7)}
MEMORY = {537_000: Bar(6000.0)}


def rows(settings: Settings) -> Iterator[Row]:
    for vertices in settings.sizes:
        mesh = pebble(vertices)
        on = f"{mesh.name}, {len(mesh.vertices) / 1000:,.1f}K vertices"
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"{mesh.name}.ply"
            pv.PolyData.from_regular_faces(mesh.vertices, mesh.faces).save(path)
            turns = 1 if vertices > ONCE else min(settings.turns, TURNS)
            runs = [_opened(path, Path(folder) / str(turn)) for turn in range(turns)]
            seen = [_opened(path, Path(folder) / str(turn)) for turn in range(turns)]
        told = {name: median(run[name] for run in runs) for name in runs[0]}
        again = median(run["exact"] for run in seen)
        kept = vertices in FIRST or vertices in AGAIN
        yield Row(
            "first colours",
            on,
            told["first"],
            "s",
            error=told["change"],
            bar=FIRST.get(vertices),
            readme=kept,
        )
        yield Row(
            "final", on, told["final"], "s", ("exact", told["exact"]), bar=FINAL.get(vertices), readme=kept
        )
        yield Row("seen before, exact", on, again, "s", bar=AGAIN.get(vertices), readme=kept)
        yield Row(
            "memory", on, told["peak"] / 1000.0, "MB", bar=MEMORY.get(vertices), readme=vertices in MEMORY
        )


def _opened(path: Path, cache: Path) -> dict[str, float]:
    done = subprocess.run(
        [sys.executable, PROGRAM, path, cache],
        env=os.environ,
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
    )
    if done.returncode != 0:
        raise RuntimeError(f"opening {path} ended with status {done.returncode}: {done.stderr[-2000:]}")
    return json.loads(done.stdout)
