"""Compiling the kernels ahead of their first use, where it can be told to the user."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Generator
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from idviewer.core import _kernels as kernels
from idviewer.core._kernels import LANES
from idviewer.core._kernels.mean_value import cache_blocks
from idviewer.core._kernels.mean_value.surface import surface_in_blocks
from idviewer.core.coordinates import coordinates_of
from idviewer.core.coordinates.mean_value import mean_value_on
from idviewer.core.coordinates.mean_value_mesh import MeshMeanValue
from idviewer.core.shapes.closest_points import ClosestPointProjection
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.polygon import Polygon
from idviewer.core.shapes.shape import Shape
from idviewer.core.shapes.simplification import simplified
from idviewer.core.spectrum.krylov_basis import KrylovBasis
from idviewer.core.spectrum.ldl_factorization import LDLFactorization
from idviewer.core.steps import finish

Calls = list[Callable[[], object]]


@dataclass(frozen=True)
class CompilationSettings:
    """Settings of compiling with the help of another process.

    Attributes:
        cold_start_seconds: that the first kernel takes at least where it has to be compiled; from a cache it
            takes a tenth.
        poll_seconds: between two looks at the other process.
    """

    cold_start_seconds: float = 1.0
    poll_seconds: float = 0.05


COMPILATION = CompilationSettings()


def compile_steps(dimension: int, coordinates: str = "mean_value") -> Generator[float, None, None]:
    """Compile every kernel that shapes of a dimension need with these coordinates, or read it from a cache.

    Yields the share done between them.

    Args:
        dimension: 2 or 3.
        coordinates: their name; what all kinds need is always compiled.

    Raises:
        ValueError: there are no such coordinates, or they do not work in this dimension.
    """
    shape: Shape = _triangle() if dimension == 2 else _spindle(LANES)
    kind = coordinates_of(shape, coordinates)
    calls = _flat_calls() if dimension == 2 else _spatial_calls()
    calls.append(lambda: kind.weights(np.full((1, dimension), 0.1)))
    last = _tree_calls() if dimension == 3 else []
    number, helper = len(calls) + len(last), None
    start = time.perf_counter()
    try:
        for done, call in enumerate(calls):
            call()
            if done == 0 and last and time.perf_counter() - start > COMPILATION.cold_start_seconds:
                helper = _compiling_trees()
            yield (done + 1) / number
        while helper is not None and helper.poll() is None:
            time.sleep(COMPILATION.poll_seconds)
            yield len(calls) / number
        for done, call in enumerate(last):
            call()
            yield (len(calls) + done + 1) / number
    finally:
        if helper is not None:
            helper.kill()
            helper.communicate()


def compile_trees() -> None:
    """Compile the kernels of cluster trees alone, as long as there is somebody at the other end of stdin."""
    threading.Thread(target=_end_with_stdin, daemon=True).start()
    for call in _tree_calls():
        call()


def _end_with_stdin() -> None:
    sys.stdin.read()
    os._exit(1)


def _compiling_trees() -> subprocess.Popen[bytes] | None:
    """Another process: one alone compiles on a single core. What it did is in the cache afterwards.

    Where there cannot be one, nothing is lost but time.
    """
    if not sys.executable or getattr(sys, "frozen", False):  # a frozen program's executable is the program
        return None
    command = [sys.executable, "-c", f"from {__name__} import compile_trees; compile_trees()"]
    quiet = subprocess.DEVNULL
    try:
        return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=quiet, stderr=quiet)
    except OSError:
        return None


def _flat_calls() -> Calls:
    triangle = _triangle()
    return [
        lambda: mean_value_on(triangle).weights(np.full((1, 2), 0.2)),
    ]


def _spatial_calls() -> Calls:
    spindle = _spindle(LANES)
    corners, surface = spindle.vertices, surface_in_blocks(spindle.vertices, spindle.faces)
    points, weights = np.full((1, 3, LANES), 0.2), np.zeros((1, len(corners), LANES))
    workspace, hits = kernels.workspaces_for(surface, 1), kernels.no_boundary_hits(1)
    return [
        lambda: cache_blocks.warm_up(points, surface, workspace, weights, hits),
        lambda: kernels.weigh(
            points,
            surface,
            0.0,
            workspace,
            hits,
            np.zeros((1, 1, LANES)),
            weights,
            (np.zeros((1, 4, LANES)), np.zeros((1, 1, LANES, LANES))),
            (np.zeros((1, LANES), dtype=np.int64), np.zeros((1, len(corners)))),
        ),
        lambda: simplified(spindle, len(corners) - 1),
        lambda: ClosestPointProjection(spindle).project(corners),
        lambda: LDLFactorization(sparse.eye_array(len(corners), format="csc"), corners).solve(corners),
        lambda: finish(_unit_basis().combination_steps(np.empty((0, 1)), np.arange(LANES))),
    ]


def _tree_calls() -> Calls:
    spindle = _spindle(LANES)
    mean_value = MeshMeanValue(spindle)
    approximation = mean_value.approximation(spindle.vertices, np.ones(3))
    return [
        lambda: mean_value.weight_sums.at(np.full((1, 3), 0.1)),
        lambda: finish(approximation.prepare_steps(1e-3)),
        lambda: finish(approximation.interpolate_steps(np.full((1, 3), 0.1), 1e-3)),
    ]


def _unit_basis() -> KrylovBasis:
    basis = KrylovBasis(LANES)
    basis.append(np.eye(LANES))
    return basis


def _triangle() -> Polygon:
    return Polygon([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


def _spindle(sides: int) -> Mesh:
    """Two cones of so many sides: more faces than a leaf of a tree holds."""
    angles = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(sides)], axis=1)
    i, j = np.arange(sides), np.roll(np.arange(sides), -1)
    upper = np.stack([i, j, np.full(sides, sides)], axis=1)
    lower = np.stack([j, i, np.full(sides, sides + 1)], axis=1)
    apexes = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
    return Mesh(np.concatenate([ring, apexes]), np.concatenate([upper, lower]))
