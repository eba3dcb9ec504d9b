"""The embedding sampled on one plane's section, coarse to fine; no sample is ever taken twice."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from idviewer.core import InteriorDistance, Plane, section
from idviewer.core.slice_mesh import SliceMesh, refined, slice_mesh, spacing_for

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

COARSEST = 60
"""Nodes of the first frame of a moved plane."""

LEVELS = 5
PROBES = 16
SHOWN_POINTS = 4000
"""A coarse mesh is cut finer until it has so many points, the embedding interpolated between its nodes."""


@dataclass(frozen=True, eq=False)
class SampledSlice:
    """A triangulated section with the distance's basis at its points.

    Attributes:
        points: (p, 3).
        triangles: (t, 3).
        outline: loops of indices into points.
        rows: (p, k) the basis, before it is scaled.
        probed_error: (q, k) sampled minus interpolated basis at a few points between those sampled;
            empty where every row is a direct computation.
    """

    points: Floats
    triangles: NDArray[np.int32]
    outline: tuple[NDArray[np.int32], ...]
    rows: Floats
    probed_error: Floats


class PlaneSamples:
    """Samples of a solver's basis on a plane's section, at nested levels.

    Args:
        solver: whose basis is sampled.
        plane: where.
        finest: about how many nodes the last level may have.
    """

    def __init__(self, solver: InteriorDistance, plane: Plane, finest: int) -> None:
        self._solver = solver
        self.section = section(solver.mesh, plane)
        self.levels = next((n for n in range(1, LEVELS) if COARSEST * 4**n > finest), LEVELS)
        self._spacing = spacing_for(self.section, COARSEST)
        self._keys: Ints = np.empty(0, dtype=np.int64)
        self._rows: Floats = np.empty((0, solver.basis.shape[1]))
        self._done: dict[int, SampledSlice] = {}
        self._outline_rows = self.section.interpolate(solver.basis)

    @property
    def start(self) -> int:
        """The level to show first: the finest that needs no more samples."""
        return max(self._done, default=0)

    def level_steps(self, level: int) -> Generator[None, None, SampledSlice]:
        """The slice at a level, the last of which is exact at every point; yields every few milliseconds."""
        level = min(level, self.levels - 1)
        if level not in self._done:
            self._done[level] = yield from self._make(level)
        return self._done[level]

    def _make(self, level: int) -> Generator[None, None, SampledSlice]:
        mesh = slice_mesh(self.section, self._spacing / 2**level)
        yield
        exact = level == self.levels - 1
        inner = yield from self._rows_at(mesh.nodes, level)
        rows = np.concatenate([self._outline_rows, inner])
        errors = np.empty((0, rows.shape[1]))
        if not exact and len(mesh.triangles):
            lattice = yield from self._probe_lattice(mesh.nodes, inner, level)
            band = yield from self._probe_band(mesh, rows)
            errors = np.concatenate([lattice, band])
        yield
        return _shown(mesh, rows, errors, exact)

    def _rows_at(self, nodes: Ints, level: int) -> Generator[None, None, Floats]:
        """The basis at lattice nodes of a level, sampling those that have not been."""
        keys = self._key(nodes, level)
        missing = ~np.isin(keys, self._keys)
        if missing.any():
            points = self.section.lift(nodes[missing] * (self._spacing / 2**level))
            self._remember(keys[missing], (yield from self._sample(points)))
        return self._rows[np.searchsorted(self._keys, keys)]

    def _sample(self, points: Floats) -> Generator[None, None, Floats]:
        steps = self._solver.sample_steps(points)
        while True:
            try:
                next(steps)
            except StopIteration as stop:
                return stop.value
            yield

    def _probe_band(self, mesh: SliceMesh, rows: Floats) -> Generator[None, None, Floats]:
        """Sampled minus interpolated basis in the middles of the largest triangles at the outline."""
        outline = len(self._outline_rows)
        band = mesh.triangles[(mesh.triangles < outline).any(axis=1)]
        corners = mesh.points[band]
        sizes = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        chosen = band[np.argsort(-sizes, kind="stable")[:PROBES]]
        sampled = yield from self._sample(mesh.points[chosen].mean(axis=1))
        return sampled - rows[chosen].mean(axis=1)

    def _probe_lattice(self, nodes: Ints, rows: Floats, level: int) -> Generator[None, None, Floats]:
        """Sampled minus interpolated basis at a few middles of lattice edges, nodes of the next level."""
        keys = self._key(nodes, level)
        ordered = np.argsort(keys)
        right = self._key(nodes + np.array([1, 0]), level)
        place = np.minimum(np.searchsorted(keys, right, sorter=ordered), max(len(keys) - 1, 0))
        has_right = keys[ordered[place]] == right if len(keys) else np.empty(0, dtype=np.bool_)
        chosen = np.flatnonzero(has_right)
        chosen = chosen[:: max(1, len(chosen) // PROBES)][:PROBES]
        middles = 2 * nodes[chosen] + np.array([1, 0])
        sampled = yield from self._rows_at(middles, level + 1)
        return sampled - 0.5 * (rows[chosen] + rows[ordered[place[chosen]]])

    def _key(self, nodes: Ints, level: int) -> Ints:
        """One number a node, the same at every level at which the node exists."""
        finest = nodes * 2 ** (LEVELS - level)
        return (finest[:, 0] + 2**30) * 2**31 + finest[:, 1] + 2**30

    def _remember(self, keys: Ints, rows: Floats) -> None:
        keys = np.concatenate([self._keys, keys])
        order = np.argsort(keys, kind="stable")
        self._keys = keys[order]
        self._rows = np.concatenate([self._rows, rows])[order]


def _shown(mesh: SliceMesh, rows: Floats, errors: Floats, exact: bool) -> SampledSlice:
    """The mesh to draw; a coarse one is cut finer, its embedding (never its distance) interpolated."""
    points, triangles = mesh.points, mesh.triangles
    while not exact and 0 < len(points) < SHOWN_POINTS:
        ends, triangles = refined(points, triangles)
        points = np.concatenate([points, points[ends].mean(axis=1)])
        rows = np.concatenate([rows, rows[ends].mean(axis=1)])
    loops = tuple(loop.astype(np.int32) for loop in mesh.section.loops)
    return SampledSlice(points, triangles, loops, rows, errors)
