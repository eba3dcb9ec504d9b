"""The embedding sampled on one plane's section, coarse to fine; no sample is ever taken twice."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints
from idviewer.core.sampling.edge_midpoints import EdgeMidpoints, interpolated
from idviewer.core.sampling.point_norms import PointNorms
from idviewer.core.sampling.sample_store import SampleStore
from idviewer.core.sampling.sampler import COARSE, FINE, Sampler
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.plane import Plane
from idviewer.core.shapes.polygon import Polygon
from idviewer.core.shapes.shape import Shape
from idviewer.core.slices.mesh_sections import Section, section
from idviewer.core.slices.polygon_sections import polygon_section
from idviewer.core.slices.triangulation import STEPS, SliceMesh, edges_of, slice_mesh, spacing_for, split
from idviewer.core.steps import without_shares

Ints32 = NDArray[np.int32]

COARSEST = 400
"""Lattice nodes of the first frame of a moved plane."""

LEVELS = 3
"""Levels with a lattice of their own, each half as wide as the one before."""

EXTRA = 320
"""Middles of edges sampled for the first frame besides, where interpolating would be worst."""

CHECKED = 30
"""Of these, those taken at random among the others: they tell what interpolating costs elsewhere."""

NEIGHBOURS = 0.2
"""How much the error expected at an edge's neighbours counts where edges are chosen."""

NODE_BITS = 24
"""Enough to number the points sampled."""

LONGEST = 0.6
"""Edges of a polygon are divided into parts of at most so many of the coarsest lattice's constants."""

BAND_SHARE = 0.15
"""Finer levels sample up to so many middles of band edges for each node."""


@dataclass(frozen=True, eq=False)
class SampledSlice:
    """A triangulated section with the distance's basis at its points.

    Attributes:
        points: (p, 3).
        triangles: (t, 3).
        outline: loops of indices into points.
        cloud: the basis at the points.
        probed_error: (q, k) sampled minus interpolated basis at a few points; empty where every row is
            sampled.
        rtol: tolerance of the samples, in largest distances on the shape; 0 where they are exact.
        final: whether there is no finer level.
    """

    points: Floats
    triangles: NDArray[np.int32]
    outline: tuple[NDArray[np.int32], ...]
    cloud: PointNorms
    probed_error: Floats
    rtol: float
    final: bool


Steps = Generator[None, None, SampledSlice]


class PlaneSamples:
    """Samples of a basis on a plane's section, at nested levels.

    Args:
        sampler: of the basis.
        plane: where.
        finest: about how many nodes the last level may have.
    """

    def __init__(self, sampler: Sampler, plane: Plane, finest: int) -> None:
        self._sampler = sampler
        self.section, self._spacing = _section(sampler.solver.boundary.full_shape, plane)
        shares = np.stack([1.0 - self.section.fractions, self.section.fractions], axis=1)
        self._outline_rows = sampler.solver.boundary.rows_between(self.section.edges, shares)
        self._lattices = next((n for n in range(1, LEVELS) if COARSEST * 4**n > finest), LEVELS)
        self.levels = self._lattices if sampler.exact_always else self._lattices + 1
        self._linear = sampler.solver.coordinates.linear_on_boundary
        self._outlined = self._linear
        self._kept = SampleStore(0.0, self._outline_rows.shape[1])
        self._done: tuple[int, SampledSlice] | None = None
        self._making: tuple[int, Steps] | None = None

    @property
    def start(self) -> int:
        """The level to show first: the finest that needs no more samples."""
        return 0 if self._done is None else self._done[0]

    @property
    def final(self) -> bool:
        """Whether every sample is there."""
        return self._done is not None and self._done[1].final

    def restore(self, known: SampledSlice) -> None:
        """Takes samples of the last level that were taken before."""
        self._done = self.levels - 1, known

    def level_steps(self, level: int) -> Steps:
        """The slice at a level or, if that is there, a finer one; the last is exact at every point.

        Yields every few milliseconds, and goes on where it was left when closed.
        """
        level = min(level, self.levels - 1)
        while self._done is None or self._done[0] < level:
            if self._making is None or self._making[0] != level:
                self._making = level, self._make(level)
            try:
                next(self._making[1])
            except StopIteration as stop:
                self._done, self._making = (level, stop.value), None
                break
            except Exception:
                self._making = None
                raise
            yield
        assert self._done is not None
        return self._done[1]

    def _make(self, level: int) -> Steps:
        yield from self._outline()
        lattice = min(level, self._lattices - 1)
        exact = level == self.levels - 1
        mesh = slice_mesh(self.section, self._spacing / 2**lattice)
        yield
        rtol = 0.0 if exact else self._sampler.tolerance(COARSE if level < 2 else FINE, self._outline_rows)
        if rtol != self._kept.rtol:
            self._kept = SampleStore(rtol, self._outline_rows.shape[1])
        inner = yield from self._rows_at(mesh.nodes, lattice)
        rows = np.concatenate([self._outline_rows, inner])
        yield
        if level == 0 and not exact:
            return (yield from self._refined(mesh, rows))
        made = yield from self._with_band(mesh, rows, lattice, exact)
        if exact:
            self._kept = SampleStore(0.0, rows.shape[1])
        return made

    def _outline(self) -> Generator[None, None, None]:
        """Samples the outline where the coordinates are not linear on edges and faces."""
        if not self._outlined:
            rows = yield from self._sample(self.section.points)
            self._outline_rows = np.where(np.isfinite(rows), rows, self._outline_rows)
            self._outlined = True

    def _rows_at(self, nodes: Ints, level: int) -> Generator[None, None, Floats]:
        """The basis at lattice nodes of a level, sampling those that have not been."""
        points = nodes * (self._spacing / 2**level)
        return (yield from self._rows_of(_key(nodes, level), points))

    def _rows_of(self, keys: Ints, points: Floats) -> Generator[None, None, Floats]:
        """The basis at points (p, 2) of the plane, sampling those whose keys are not known."""
        missing = ~self._kept.has(keys)
        if missing.any():
            self._kept.add(keys[missing], (yield from self._sample(self.section.lift(points[missing]))))
        return self._kept.rows(keys)

    def _rows_between(
        self, mesh: SliceMesh, middles: EdgeMidpoints, level: int
    ) -> Generator[None, None, Floats]:
        """The basis sampled in middles of edges; where rounding puts one outside, what was interpolated."""
        keys = self._keys_between(mesh, middles.ends, level)
        rows = yield from self._rows_of(keys, _middle(mesh, middles.ends))
        return np.where(np.isfinite(rows), rows, middles.rows)

    def _keys_between(self, mesh: SliceMesh, ends: Ints, level: int) -> Ints:
        """Numbers of the middles of edges: of lattice edges those of nodes, of the others negative ones."""
        count = len(mesh.section.flat)
        lattice, chord = ends[:, 0] >= count, ends[:, 1] < count
        keys = -1 - (ends @ np.array([count, 1]))
        across = ~(lattice | chord)
        heads = self._kept.numbers(_key(mesh.nodes[ends[across, 1] - count], level))
        keys[across] = -1 - count**2 - (ends[across, 0] << NODE_BITS | heads)
        keys[lattice] = _key(mesh.nodes[ends[lattice] - count].sum(axis=1), level + 1)
        return keys

    def _sample(self, points: Floats) -> Generator[None, None, Floats]:
        return without_shares(self._sampler.sample_steps(points, self._kept.rtol))

    def _refined(self, mesh: SliceMesh, rows: Floats) -> Steps:
        """The mesh with the middles of all edges added, sampled where they matter, elsewhere interpolated."""
        ends, sides = edges_of(len(rows), mesh.triangles)
        middles = interpolated(mesh, ends, rows, self._sampler.significant_columns(rows), self._linear)
        yield
        chosen = _worst_and_some(_around(middles.expected, sides) * _lengths(mesh, ends))
        sampled = yield from self._rows_between(mesh, middles.at(chosen), 0)
        # Half of those sampled were the worst: the other half and the random ones tell of what is left.
        errors = (sampled - middles.rows[chosen])[(EXTRA - CHECKED) // 2 :]
        errors = errors[np.isfinite(errors).all(axis=1)]
        middles.rows[chosen] = sampled
        yield
        return self._shown(mesh, rows, middles, split(mesh.triangles, sides + len(rows)), errors, False)

    def _with_band(self, mesh: SliceMesh, rows: Floats, level: int, final: bool) -> Steps:
        """The mesh with the middles of the steepest edges of the band added and sampled."""
        in_band = (mesh.triangles < len(self._outline_rows)).any(axis=1)
        band = mesh.triangles[in_band]
        ends, sides = edges_of(len(rows), band)
        steep = np.flatnonzero(ends[:, 0] < len(self._outline_rows))
        middles = interpolated(mesh, ends[steep], rows, self._sampler.significant_columns(rows), self._linear)
        order = np.argsort(-middles.expected, kind="stable")[: int(BAND_SHARE * len(mesh.nodes))]
        chosen = np.sort(order[middles.expected[order] > 0.0])
        added = middles.at(chosen)
        yield
        added = replace(added, rows=(yield from self._rows_between(mesh, added, level)))
        number = np.full(len(ends), -1)
        number[steep[chosen]] = len(rows) + np.arange(len(chosen))
        triangles = np.concatenate([mesh.triangles[~in_band], split(band, number[sides])])
        return self._shown(mesh, rows, added, triangles, np.empty((0, rows.shape[1])), final)

    def _shown(
        self,
        mesh: SliceMesh,
        rows: Floats,
        middles: EdgeMidpoints,
        triangles: Ints32,
        errors: Floats,
        final: bool,
    ) -> SampledSlice:
        points = np.concatenate([mesh.points, self.section.lift(_middle(mesh, middles.ends))])
        loops = tuple(loop.astype(np.int32) for loop in mesh.section.loops)
        points, triangles, rows = _with_values(points, triangles, np.concatenate([rows, middles.rows]))
        return SampledSlice(points, triangles, loops, PointNorms(rows), errors, self._kept.rtol, final)


def _section(shape: Shape, plane: Plane) -> tuple[Section, float]:
    """What a plane cuts out of a body, and the spacing of the coarsest lattice that fills it.

    Of a polygon, which lies in a plane of its own, it is all; edges are divided, because distances are not
    linear along them even where the basis is.
    """
    if isinstance(shape, Polygon):
        widest = max(math.sqrt(shape.area / COARSEST), shape.perimeter / (STEPS * COARSEST))
        cut = polygon_section(shape, LONGEST * widest)
    else:
        assert isinstance(shape, Mesh)
        cut = section(shape, plane)
    return cut, spacing_for(cut, COARSEST)


def _with_values(points: Floats, triangles: Ints32, rows: Floats) -> tuple[Floats, Ints32, Floats]:
    """A mesh without the inner points whose rows are not known, and without the triangles around them."""
    known = np.logical_and.reduce(np.isfinite(rows), axis=1)
    if known.all():
        return points, triangles, rows
    number = np.cumsum(known, dtype=np.int32) - np.int32(1)
    return points[known], number[triangles[known[triangles].all(axis=1)]], rows[known]


def _key(nodes: Ints, level: int) -> Ints:
    """One number a node, the same at every level at which the node exists."""
    finest = nodes * 2 ** (LEVELS - level)
    return (finest[:, 0] + 2**30) * 2**31 + finest[:, 1] + 2**30


def _middle(mesh: SliceMesh, ends: Ints) -> Floats:
    """(e, 2) the middles of edges in the plane's basis."""
    flat = np.concatenate([mesh.section.flat, mesh.nodes * mesh.spacing])
    return 0.5 * (flat[ends[:, 0]] + flat[ends[:, 1]])


def _lengths(mesh: SliceMesh, ends: Ints) -> Floats:
    """(e,) the edges' lengths in lattice constants, the longest cut to 2."""
    flat = np.concatenate([mesh.section.flat, mesh.nodes * mesh.spacing])
    return np.minimum(np.linalg.norm(flat[ends[:, 1]] - flat[ends[:, 0]], axis=1) / mesh.spacing, 2.0)


def _around(expected: Floats, sides: Ints) -> Floats:
    """Errors expected at edges, a part of the largest among each edge's neighbours added."""
    largest = expected[sides].max(axis=1)
    nearby = np.zeros(len(expected))
    for side in sides.T:
        np.maximum.at(nearby, side, largest)
    return np.where(expected > 0.0, expected + NEIGHBOURS * nearby, 0.0)


def _worst_and_some(expected: Floats) -> Ints:
    """Numbers of the largest errors expected, in descending order, and of some of the others."""
    inexact = int((expected > 0.0).sum())
    order = np.argsort(-expected, kind="stable")[:inexact]
    worst, others = order[: EXTRA - CHECKED], order[EXTRA - CHECKED :]
    return np.concatenate([worst, others[:: max(1, -(-len(others) // CHECKED))]])
