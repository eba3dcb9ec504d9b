"""Table 1: seconds by size."""

from __future__ import annotations

import importlib.util
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from types import ModuleType

from figures.registry import Run, Table, figure
from figures.shapes import TINY, bundled, inner_points, simplified, tiny_body
from idviewer.core import InteriorDistance, Mesh

PAPER = (
    (2_500, 66, 3.52, 0.008),
    (4_300, 104, 7.53, 0.018),
    (7_900, 112, 11.96, 0.034),
    (16_000, 82, 45.47, 0.059),
    (26_800, 93, 151.63, 0.120),
)
"""Vertices, eigenpairs, seconds before, seconds a distance: the paper's table 1, on a 2.2 GHz Opteron 875."""

PAIRS, TURNS = 200, 3


@figure("table1", "seconds by size", drawn=False)
def seconds(run: Run) -> Table:
    """Bodies of the paper's five sizes: preparation, and the distance of a pair of points inside."""
    fine, sizes = (tiny_body("human"), PAPER[:1]) if run.tiny else (bundled("human_27k"), PAPER)
    rows = []
    for vertices, eigenpairs, before, each in sizes:
        mesh = simplified(fine, TINY - 50 if run.tiny else vertices)
        prepared, pairs, ours = measured(mesh, PAIRS if not run.tiny else 2)
        sizes_of = [f"{len(mesh.vertices):,}", f"{len(mesh.faces):,}"]
        told = [f"{ours}", f"{prepared:.2f}", f"{1e3 * median(pairs):.2f} ({1e3 * min(pairs):.2f})"]
        rows.append([*sizes_of, *told, f"{eigenpairs}", f"{before:.2f}", f"{1e3 * each:.0f}"])
    header = (
        "vertices",
        "faces",
        "eigenpairs",
        "before, s",
        "a distance, ms",
        "paper: eigenpairs",
        "before, s",
        "a distance, ms",
    )
    note = (
        f"Ours on {machine().description()}, other work beside it. Medians of {TURNS} "
        f"preparations and {PAIRS} pairs, each asked for alone; in brackets the fastest pair. "
        "The paper's, of other bodies, on one 2.2 GHz AMD Opteron 875, in MATLAB and C++."
    )
    return Table(header, rows, note)


def measured(mesh: Mesh, pairs: int) -> tuple[float, list[float], int]:
    """Seconds until the first distance can be asked for, seconds of each, and the number of eigenpairs."""
    # A new mesh each time: what belongs to one is kept with it.
    before = [took(lambda: InteriorDistance(Mesh(mesh.vertices, mesh.faces))) for _ in range(TURNS)]
    solver = InteriorDistance(mesh)
    points = inner_points(mesh, 2 * pairs).reshape(pairs, 2, 3)
    solver.distance(points[0, :1], points[0, 1:])
    each = [took(lambda pair=pair: solver.distance(pair[:1], pair[1:])) for pair in points]
    return median(before), each, len(solver.spectrum.values)


def took(call: Callable[[], object]) -> float:
    """Seconds that a call takes."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def machine() -> ModuleType:
    """benchmarks/machine.py, which names processor and versions."""
    path = Path(__file__).resolve().parents[2] / "benchmarks" / "machine.py"
    spec = importlib.util.spec_from_file_location("idviewer_benchmarks_machine", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
