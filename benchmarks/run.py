"""Times idviewer beside its peers in the same run: python benchmarks/run.py [MESH ...]

Peers: vtkMeanValueCoordinatesInterpolator for the weights, and the recipe that a user would write in ten
lines (SciPy's eigsh in shift-invert mode on SuperLU) for the preprocess. Ours and theirs take turns, and the
medians of several turns are compared, so that a busy machine disturbs both alike. The table goes to standard
output, everything measured to benchmarks/results/latest.json.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np
import peers

from idviewer.core import MeanValueCoordinates, Mesh, eigenpairs, read_mesh, sample_path
from idviewer.core.barycentroid import interior_samples
from idviewer.core.compilation import compile_steps
from idviewer.core.steps import finish
from idviewer.session.pipeline import Pipeline
from idviewer.session.session import default_plane
from idviewer.session.state import Frame, FrameRequest, Progress, Query

SAMPLES = ("hand_2k", "hand", "hand_27k")
RESULTS = Path(__file__).parent / "results"
Row = dict[str, float | int | str]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", nargs="*", type=Path, help="more meshes to measure on")
    parser.add_argument("--turns", type=int, default=5, help="repetitions; the median counts")
    arguments = parser.parse_args()
    paths = [sample_path(name) for name in SAMPLES] + [path for path in arguments.meshes if path.exists()]
    finish(compile_steps())
    meshes = [read_mesh(path) for path in paths]
    tables = {
        "Exact weights, per inner point": [weights_row(mesh, arguments.turns) for mesh in meshes],
        "Preprocess: eigenpairs by the paper's rule": [
            spectrum_row(mesh, arguments.turns) for mesh in meshes
        ],
        "A moved plane: from pose to frames": [slice_row(mesh, arguments.turns) for mesh in meshes],
    }
    machine = platform.processor() or platform.machine()
    print(f"{machine}, {os.cpu_count()} cores, Python {platform.python_version()}")
    for title, rows in tables.items():
        show(title, rows)
    RESULTS.mkdir(exist_ok=True)
    beside = RESULTS / "latest.json.part"
    beside.write_text(json.dumps({"machine": platform.platform(), "tables": tables}, indent=2))
    beside.replace(RESULTS / "latest.json")
    print(f"\nwritten: {RESULTS / 'latest.json'}")


def weights_row(mesh: Mesh, turns: int) -> Row:
    """Time of one point's weights, VTK's beside ours, and how far the two differ."""
    points = interior_samples(mesh)[:128]
    few = points[:: max(1, len(points) // 8)][:8]
    ours, theirs = MeanValueCoordinates(mesh), peers.VtkWeights(mesh)
    own, peer = take_turns(turns, lambda: ours.weights(points), lambda: theirs(few))
    weights, reference = ours.weights(few), theirs(few)
    return {
        "mesh": mesh.name,
        "faces": len(mesh.faces),
        "ours us": own / len(points) * 1e6,
        "VTK us": peer / len(few) * 1e6,
        "ratio": (peer / len(few)) / (own / len(points)),
        "ours ns/face": own / len(points) / len(mesh.faces) * 1e9,
        "difference": float(np.abs(weights - reference).max()),
        "our linear error": linear_error(mesh, few, weights),
        "VTK linear error": linear_error(mesh, few, reference),
    }


def linear_error(mesh: Mesh, points: np.ndarray, weights: np.ndarray) -> float:
    """How well the weights reproduce the points, in bounding boxes."""
    return float(np.abs(weights @ mesh.vertices - points).max() / mesh.diagonal)


def spectrum_row(mesh: Mesh, turns: int) -> Row:
    """Time of all eigenpairs below the cut-off; the recipe is told how many to ask for, which helps it."""
    count = len(eigenpairs(mesh).values)
    own, peer = take_turns(turns, lambda: eigenpairs(mesh), lambda: peers.recipe(mesh, count))
    values, reference = eigenpairs(mesh).values, peers.recipe(mesh, count)
    return {
        "mesh": mesh.name,
        "vertices": len(mesh.vertices),
        "modes": count,
        "ours s": own,
        "recipe s": peer,
        "ratio": peer / own,
        "difference": float(np.abs(values / reference - 1).max()),
    }


def slice_row(mesh: Mesh, turns: int) -> Row:
    """Time from a plane's new pose to its first and its exact frame, and of a source move."""
    pipeline = Pipeline()
    plane = default_plane(mesh)
    for _ in pipeline.results(FrameRequest(mesh, Query(planes=(plane,)))):
        pass
    first, last, error = [], [], 0.0
    for turn in range(turns):
        shift = (turn + 1) / (20 * turns) * float(np.ptp(mesh.bounds @ np.array(plane.normal)))
        start, seen = time.perf_counter(), 0
        for result in pipeline.results(FrameRequest(mesh, Query(planes=(plane.moved(shift),)))):
            if isinstance(result, Frame):
                if not seen:
                    first.append(time.perf_counter() - start)
                    error = max(error, result.error / result.value_range[1])
                seen += 1
        last.append(time.perf_counter() - start)
    moved = Query(planes=(plane.moved(shift),), source=tuple(mesh.vertices[0].tolist()))
    start = time.perf_counter()
    results = [one for one in pipeline.results(FrameRequest(mesh, moved)) if one is not None]
    assert not any(isinstance(one, Progress) for one in results)
    return {
        "mesh": mesh.name,
        "faces": len(mesh.faces),
        "first frame ms": median(first) * 1e3,
        "its error": error,
        "exact frame s": median(last),
        "source move ms": (time.perf_counter() - start) * 1e3,
        "samples": sum(len(one.points) for one in results[-1].slices),
    }


def take_turns(turns: int, ours: Callable[[], object], theirs: Callable[[], object]) -> tuple[float, float]:
    """Median seconds of each, measured alternately."""
    spent: tuple[list[float], list[float]] = ([], [])
    for _ in range(turns):
        for seconds, call in zip(spent, (ours, theirs), strict=True):
            start = time.perf_counter()
            call()
            seconds.append(time.perf_counter() - start)
    return median(spent[0]), median(spent[1])


def show(title: str, rows: list[Row]) -> None:
    """Print rows as a Markdown table."""
    print(f"\n### {title}\n")
    print("| " + " | ".join(rows[0]) + " |")
    print("|" + "--:|" * len(rows[0]))
    for row in rows:
        cells = [f"{cell:.3g}" if isinstance(cell, float) else str(cell) for cell in row.values()]
        print("| " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
