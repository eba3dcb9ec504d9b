"""The barycentroid: the point inside where the mean squared distance to the surface is smallest."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from idviewer.core.mesh import Mesh, MeshError
from idviewer.core.plane import AXES, Plane
from idviewer.core.slice_mesh import SliceMesh, slice_mesh, spacing_for
from idviewer.core.slices import section
from idviewer.core.steps import finish

Floats = NDArray[np.float64]
Evaluate = Callable[[Floats], Generator[float | None, None, Floats]]

LAYERS = 12
SAMPLES_A_LAYER = 14
STARTS = 3
START_RADIUS = 0.02
LAST_RADIUS = 1e-6
MOST_ROUNDS = 60


@dataclass(frozen=True, eq=False)
class Barycentroid:
    """Where the potential is smallest.

    Attributes:
        point: (3,) the barycentroid, inside the mesh.
        potential: U there.
        path: (s, 3) the descent that ended there, from its start on.
    """

    point: Floats
    potential: float
    path: Floats


def barycentroid_steps(mesh: Mesh, potential: Evaluate) -> Generator[float | None, None, Barycentroid]:
    """Find the barycentroid; yields the share done, or None, every few milliseconds.

    U may have several local minima. The interior is sampled coarsely, descents start from the lowest
    samples that lie well apart, and the lowest end wins; it cannot be higher than any sample. Source:
    Rustamov et al. 2009, section 7.

    Args:
        mesh: where to look.
        potential: U at (p, 3) points, (p,), NaN outside, as a generator.

    Raises:
        MeshError: no point inside the mesh could be found.
    """
    samples = yield from interior_sample_steps(mesh)
    values = yield from potential(samples)
    inside = np.isfinite(values)
    if not inside.any():
        raise MeshError("no point inside the mesh was found; is it thinner than its coordinates' rounding?")
    best: Barycentroid | None = None
    for start in _lowest_apart(samples[inside], values[inside], 0.1 * mesh.diagonal):
        candidate = yield from _descend(potential, start, mesh.diagonal)
        if best is None or candidate.potential < best.potential:
            best = candidate
    assert best is not None
    return best


def interior_samples(mesh: Mesh) -> Floats:
    """(p, 3) points spread evenly over the inside: lattices on planes across the longest axis."""
    return finish(interior_sample_steps(mesh))


def interior_sample_steps(mesh: Mesh) -> Generator[None, None, Floats]:
    """`interior_samples` as a generator that yields between the planes."""
    axis = list(AXES)[int(np.argmax(np.ptp(mesh.bounds, axis=0)))]
    layers = []
    for fraction in (np.arange(LAYERS) + 0.5) / LAYERS:
        cut = section(mesh, Plane.along(axis, float(fraction), mesh.bounds))
        if cut.area > 0.0:
            filled = slice_mesh(cut, spacing_for(cut, SAMPLES_A_LAYER))
            layers.append(filled.node_points if len(filled.nodes) else _largest_triangles(filled))
        yield
    return np.concatenate(layers) if layers else np.empty((0, 3))


def _largest_triangles(filled: SliceMesh) -> Floats:
    """Middles of a section's largest triangles: inner points also where it is thinner than the lattice."""
    corners = filled.points[filled.triangles]
    sizes = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return corners[np.argsort(-sizes, kind="stable")[:SAMPLES_A_LAYER]].mean(axis=1)


def _lowest_apart(points: Floats, values: Floats, apart: float) -> list[Floats]:
    """The lowest points, of those that lie apart from each other by at least so much."""
    chosen: list[Floats] = []
    for point in points[np.argsort(values, kind="stable")]:
        if all(np.linalg.norm(point - other) >= apart for other in chosen):
            chosen.append(point)
        if len(chosen) == STARTS:
            break
    return chosen


def _descend(
    potential: Evaluate, start: Floats, diagonal: float
) -> Generator[float | None, None, Barycentroid]:
    """Follow U^2 downhill by quadratic models fitted within a trust radius.

    Evaluating a block of points costs little more than one, so the model is fitted to a whole stencil,
    and the step is tried at several lengths at once.
    """
    point, radius = start, START_RADIUS * diagonal
    path = [point]
    for _ in range(MOST_ROUNDS):
        if radius < LAST_RADIUS * diagonal:
            break
        values = yield from potential(point + radius * _STENCIL)
        squares = values**2
        if not np.isfinite(squares).all():
            radius *= 0.5
            if np.isfinite(squares[0]):
                continue
            break
        step = _model_step(squares) * radius
        trials = point + np.outer(_LENGTHS, step)
        heights = np.concatenate([values, (yield from potential(trials))])
        candidates = np.concatenate([point + radius * _STENCIL, trials])
        lowest = int(np.nanargmin(heights))
        moved = float(np.linalg.norm(candidates[lowest] - point))
        if lowest > 0:
            point = candidates[lowest]
            path.append(point)
        radius = min(max(2.0 * moved, 0.25 * radius), radius if moved < radius else 2.0 * radius)
    final = yield from potential(point[None])
    return Barycentroid(point, float(final[0]), np.array(path))


def _stencil() -> Floats:
    """The middle, the 6 axis neighbours and 8 of the 12 diagonals: enough for a full quadratic."""
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    diagonals = np.array([[1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]]) / np.sqrt(2.0)
    opposite = -diagonals[[0, 2, 4]]
    return np.concatenate([np.zeros((1, 3)), axes, diagonals, opposite])


def _quadratic_terms(points: Floats) -> Floats:
    x, y, z = points.T
    return np.stack([np.ones_like(x), x, y, z, x * x, y * y, z * z, x * y, x * z, y * z], axis=1)


_STENCIL = _stencil()
_FIT = np.linalg.pinv(_quadratic_terms(_STENCIL))
_LENGTHS = 2.0 ** np.arange(-3.0, 3.0)


def _model_step(squares: Floats) -> Floats:
    """The step, in trust radii, to the minimum of the quadratic fitted to the stencil's values."""
    _, x, y, z, xx, yy, zz, xy, xz, yz = _FIT @ squares
    gradient = np.array([x, y, z])
    hessian = np.array([[2 * xx, xy, xz], [xy, 2 * yy, yz], [xz, yz, 2 * zz]])
    curvatures, directions = np.linalg.eigh(hessian)
    floor = 1e-3 * max(float(np.abs(curvatures).max()), float(np.linalg.norm(gradient)), np.finfo(float).tiny)
    step = -directions @ ((directions.T @ gradient) / np.maximum(np.abs(curvatures), floor))
    length = float(np.linalg.norm(step))
    return step if length <= 2.0 else step * (2.0 / length)
