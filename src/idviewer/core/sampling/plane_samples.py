"""The embedding sampled on one plane's section, coarse to fine; no sample is ever taken twice."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from idviewer.core.arrays import Floats, Ints
from idviewer.core.sampling.edge_midpoints import (
    EdgeMidpoints,
    around,
    interpolated,
    lengths,
    midpoints_of,
    worst_and_some,
)
from idviewer.core.sampling.point_norms import PointNorms
from idviewer.core.sampling.sample_store import SampleStore
from idviewer.core.sampling.sampled_slice import SampledSlice
from idviewer.core.sampling.sampler import Sampler
from idviewer.core.sampling.settings import SamplingSettings
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.plane import Plane
from idviewer.core.shapes.polygon import Polygon
from idviewer.core.shapes.shape import Shape
from idviewer.core.slices.mesh_sections import Section, section
from idviewer.core.slices.polygon_sections import polygon_section
from idviewer.core.slices.triangulation import (
    OUTLINE_STEPS_PER_SAMPLE,
    SliceMesh,
    edges_of,
    slice_mesh,
    spacing_for,
    split,
)
from idviewer.core.steps import Resumable, without_shares

Ints32 = NDArray[np.int32]

NODE_NUMBER_BITS = 24
"""Enough to number the points sampled."""

Steps = Generator[None, None, SampledSlice]


class PlaneSamples:
    """Samples of a basis on a plane's section, at nested levels.

    Args:
        sampler: of the basis.
        plane: where.
        finest: about how many nodes the last level may have.

    >>> from idviewer.core import Euclidean, InteriorDistance, Polygon
    >>> from idviewer.core.sampling.sampled_slice import POLYGON_PLANE
    >>> from idviewer.core.sampling.sampler import Sampler
    >>> from idviewer.core.steps import finish
    >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
    >>> samples = PlaneSamples(Sampler(solver), POLYGON_PLANE, 100)
    >>> first = finish(samples.level_steps(samples.start))
    >>> bool(np.allclose(first.rows + 2.0, first.points[:, :2]))
    True
    """

    def __init__(self, sampler: Sampler, plane: Plane, finest: int) -> None:
        self._sampler = sampler
        self._settings = sampler.settings
        self.section, self._spacing = _section(sampler.solver.boundary.section_shape, plane, self._settings)
        self._outline_rows = sampler.solver.boundary.rows_between(*self.section.stencil)
        self._lattices = next(
            (n for n in range(1, self._settings.lattices) if self._settings.coarsest_nodes * 4**n > finest),
            self._settings.lattices,
        )
        self.levels = self._lattices if sampler.exact_always else self._lattices + 1
        self._linear = sampler.solver.coordinates.linear_on_boundary
        self._outlined = self._linear
        self._kept = SampleStore(0.0, self._outline_rows.shape[1])
        self._done: tuple[int, SampledSlice] | None = None
        self._making: Resumable[None, SampledSlice] = Resumable()

    @property
    def start(self) -> int:
        """The level to show first: the finest that needs no more samples."""
        return 0 if self._done is None else self._done[0]

    @property
    def final(self) -> bool:
        """Whether every sample is there."""
        return self._done is not None and self._done[1].final

    def restore(self, known: SampledSlice) -> None:
        """Take samples of the last level that were taken before."""
        self._done = self.levels - 1, known

    def level_steps(self, level: int) -> Steps:
        """Sample the slice at a level or, if that is there, take a finer one; the last is exact.

        Yields every few milliseconds, and goes on where it was left when closed.
        """
        level = min(level, self.levels - 1)
        while self._done is None or self._done[0] < level:
            self._done = level, (yield from self._making.run(level, partial(self._make, level)))
        return self._done[1]

    def _make(self, level: int) -> Steps:
        yield from self._outline()
        lattice = min(level, self._lattices - 1)
        last = level == self.levels - 1
        mesh = slice_mesh(self.section, self._spacing / 2**lattice)
        yield
        share = self._settings.coarse_rtol if level < 2 else self._settings.fine_rtol
        rtol = self._settings.final_rtol if last else self._sampler.tolerance(share, self._outline_rows)
        if rtol != self._kept.rtol:
            self._kept = SampleStore(rtol, self._outline_rows.shape[1])
        inner = yield from self._rows_at(mesh.nodes, lattice)
        rows = np.concatenate([self._outline_rows, inner])
        yield
        if level == 0 and not last:
            return (yield from self._with_midpoints(mesh, rows))
        made = yield from self._with_band(mesh, rows, lattice, last)
        if last:
            self._kept = SampleStore(rtol, rows.shape[1])
        return made

    def _outline(self) -> Generator[None, None, None]:
        """Sample the outline where the coordinates are not linear on edges and faces."""
        if not self._outlined:
            rows = yield from self._sample(self.section.points)
            self._outline_rows = np.where(np.isfinite(rows), rows, self._outline_rows)
            self._outlined = True

    def _rows_at(self, nodes: Ints, level: int) -> Generator[None, None, Floats]:
        """The basis at lattice nodes of a level, sampling those that have not been."""
        points = nodes * (self._spacing / 2**level)
        return (yield from self._rows_of(_key(nodes, self._settings.lattices - level), points))

    def _rows_of(self, keys: Ints, points: Floats) -> Generator[None, None, Floats]:
        """The basis at points (p, 2) of the plane, sampling those whose keys are not known."""
        missing = ~self._kept.has(keys)
        if missing.any():
            self._kept.add(keys[missing], (yield from self._sample(self.section.lift(points[missing]))))
        return self._kept.rows(keys)

    def _rows_between(
        self, mesh: SliceMesh, midpoints: EdgeMidpoints, level: int
    ) -> Generator[None, None, Floats]:
        """The basis sampled in midpoints of edges; where rounding puts one outside, what was interpolated."""
        keys, places = self._keys_between(mesh, midpoints.ends, level), midpoints_of(mesh, midpoints.ends)
        rows = yield from self._rows_of(keys, places)
        known = np.logical_and.reduce(np.isfinite(rows), axis=1)
        if self._sampler.solver.coordinates.undefined:
            known[~known] = self._sampler.solver.contains(self.section.lift(places[~known]))
        return np.where(known[:, None], rows, midpoints.rows)

    def _keys_between(self, mesh: SliceMesh, ends: Ints, level: int) -> Ints:
        """Numbers of the midpoints of edges: of lattice edges those of nodes, of the others negative ones."""
        count, finer = len(mesh.section.in_plane), self._settings.lattices - level
        lattice, chord = ends[:, 0] >= count, ends[:, 1] < count
        keys = -1 - (ends @ np.array([count, 1]))
        across = ~(lattice | chord)
        heads = self._kept.numbers(_key(mesh.nodes[ends[across, 1] - count], finer))
        keys[across] = -1 - count**2 - (ends[across, 0] << NODE_NUMBER_BITS | heads)
        keys[lattice] = _key(mesh.nodes[ends[lattice] - count].sum(axis=1), finer - 1)
        return keys

    def _sample(self, points: Floats) -> Generator[None, None, Floats]:
        return without_shares(self._sampler.sample_steps(points, self._kept.rtol))

    def _with_midpoints(self, mesh: SliceMesh, rows: Floats) -> Steps:
        """Add the midpoints of all edges, sampled where they matter, elsewhere interpolated."""
        ends, sides = edges_of(len(rows), mesh.triangles)
        midpoints = interpolated(mesh, ends, rows, self._sampler.significant_columns(rows), self._linear)
        yield
        nearby = around(midpoints.expected, sides, self._settings.neighbour_weight)
        extra, checked = self._settings.extra_midpoints, self._settings.checked_midpoints
        chosen = worst_and_some(nearby * lengths(mesh, ends), extra, checked)
        sampled = yield from self._rows_between(mesh, midpoints.at(chosen), 0)
        # Half of those sampled were the worst: the other half and those chosen evenly tell of what is left.
        errors = (sampled - midpoints.rows[chosen])[(extra - checked) // 2 :]
        errors = errors[np.isfinite(errors).all(axis=1)]
        midpoints.rows[chosen] = sampled
        yield
        triangles = split(mesh.triangles, sides + len(rows))
        return (yield from self._shown(mesh, rows, midpoints, triangles, errors, False))

    def _with_band(self, mesh: SliceMesh, rows: Floats, level: int, final: bool) -> Steps:
        """Add the midpoints of the steepest edges of the band, sampled."""
        in_band = (mesh.triangles < len(self._outline_rows)).any(axis=1)
        band = mesh.triangles[in_band]
        ends, sides = edges_of(len(rows), band)
        steep = np.flatnonzero(ends[:, 0] < len(self._outline_rows))
        midpoints = interpolated(
            mesh, ends[steep], rows, self._sampler.significant_columns(rows), self._linear
        )
        order = np.argsort(-midpoints.expected, kind="stable")[
            : int(self._settings.band_midpoints * len(mesh.nodes))
        ]
        chosen = np.sort(order[midpoints.expected[order] > 0.0])
        added = midpoints.at(chosen)
        yield
        added = replace(added, rows=(yield from self._rows_between(mesh, added, level)))
        number = np.full(len(ends), -1)
        number[steep[chosen]] = len(rows) + np.arange(len(chosen))
        triangles = np.concatenate([mesh.triangles[~in_band], split(band, number[sides])])
        return (yield from self._shown(mesh, rows, added, triangles, np.empty((0, rows.shape[1])), final))

    def _shown(
        self,
        mesh: SliceMesh,
        rows: Floats,
        midpoints: EdgeMidpoints,
        triangles: Ints32,
        errors: Floats,
        final: bool,
    ) -> Steps:
        points = np.concatenate([mesh.points, self.section.lift(midpoints_of(mesh, midpoints.ends))])
        loops = tuple(loop.astype(np.int32) for loop in mesh.section.loops)
        points, triangles, rows = _with_values(points, triangles, np.concatenate([rows, midpoints.rows]))
        negativity = np.empty(0)
        if self._sampler.may_lack_values:
            # Next to the outline, whose values are there in any case, a triangle may span what has none.
            middles = points[triangles].mean(axis=1)
            beside = np.logical_or.reduce(triangles < len(self._outline_rows), axis=1)
            beside[beside] = ~self._sampler.have_values(middles[beside])
            triangles = triangles[~beside]
            yield
        if final:
            negativity = yield from without_shares(self._sampler.negativity_steps(points))
            if self._linear:
                negativity[: len(self._outline_rows)] = 0.0
        sampled = PointNorms(rows)
        return SampledSlice(points, triangles, loops, sampled, errors, self._kept.rtol, final, negativity)


def _section(shape: Shape, plane: Plane, settings: SamplingSettings) -> tuple[Section, float]:
    """The section of a body by a plane, and the spacing of the coarsest lattice that fills it.

    Of a polygon, which lies in a plane of its own, it is all; edges are divided, because distances are not
    linear along them even where the basis is.
    """
    nodes = settings.coarsest_nodes
    if isinstance(shape, Polygon):
        widest = max(math.sqrt(shape.area / nodes), shape.perimeter / (OUTLINE_STEPS_PER_SAMPLE * nodes))
        cut = polygon_section(shape, settings.longest_part * widest)
    else:
        assert isinstance(shape, Mesh)
        cut = section(shape, plane)
    return cut, spacing_for(cut, nodes)


def _with_values(points: Floats, triangles: Ints32, rows: Floats) -> tuple[Floats, Ints32, Floats]:
    """A mesh without the inner points whose rows are not known, and without the triangles around them."""
    known = np.logical_and.reduce(np.isfinite(rows), axis=1)
    if known.all():
        return points, triangles, rows
    number = np.cumsum(known, dtype=np.int32) - np.int32(1)
    return points[known], number[triangles[known[triangles].all(axis=1)]], rows[known]


def _key(nodes: Ints, halvings: int) -> Ints:
    """One number a node, the same at every level at which it exists: so many are finer than that of nodes."""
    finest = nodes * 2**halvings
    return (finest[:, 0] + 2**30) * 2**31 + finest[:, 1] + 2**30
