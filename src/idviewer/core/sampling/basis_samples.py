"""Samples of one basis, kept: on planes and at points, for all distances that share it."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Generator
from functools import cached_property

import numpy as np

from idviewer.core.arrays import Floats, in_space
from idviewer.core.coordinates import Coordinates
from idviewer.core.coordinates.overlap_guard import NO_VALUE
from idviewer.core.coordinates.weight_sums import WEIGHT_SUMS
from idviewer.core.interior.point_placement import place_points
from idviewer.core.interior.solver import InteriorDistance
from idviewer.core.sampling.plane_samples import PlaneSamples
from idviewer.core.sampling.point_norms import MaxNorm
from idviewer.core.sampling.sampled_slice import SampledSlice
from idviewer.core.sampling.sampler import Sampler
from idviewer.core.sampling.settings import SamplingSettings
from idviewer.core.shapes.plane import Plane
from idviewer.core.steps import finish

Point = tuple[float, float, float]


class SourceError(ValueError):
    """A source that has no distances: it lies outside, or has no weights. One line says what to do."""


class BasisSamples:
    """Samples of one basis, on planes and at points; they serve every distance with that basis.

    Args:
        solver: whose basis is sampled.
        nodes: about how many points of a lattice the last level of a plane may have inside; by default what
            takes seconds.
        settings: `SAMPLING` by default.

    >>> from idviewer.core import Euclidean, Polygon
    >>> samples = BasisSamples(InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean()))
    >>> finish(samples.row_steps((3.0, 2.0, 0.0))).round(12).tolist()
    [1.0, 0.0]
    """

    def __init__(
        self, solver: InteriorDistance, nodes: int | None = None, settings: SamplingSettings | None = None
    ) -> None:
        self.solver = solver
        self.sampler = Sampler(solver, settings)
        self._settings = self.sampler.settings
        self._nodes = self._affordable_nodes() if nodes is None else nodes
        self._planes: OrderedDict[Plane, PlaneSamples] = OrderedDict()
        self._points: OrderedDict[Point, Floats] = OrderedDict()

    @cached_property
    def boundary(self) -> MaxNorm:
        """Norms of the basis at all vertices, for the farthest from a point."""
        return MaxNorm(self.solver.boundary.basis)

    def on(self, plane: Plane) -> PlaneSamples:
        """The samples on a plane; those of the planes used last are kept."""
        if plane not in self._planes:
            self._planes[plane] = PlaneSamples(self.sampler, plane, self._nodes)
        self._planes.move_to_end(plane)
        while len(self._planes) > self._settings.kept_planes:
            self._planes.popitem(last=False)
        return self._planes[plane]

    def _affordable_nodes(self) -> int:
        effort = Coordinates.pairs_per_step / self.solver.coordinates.pairs_per_step
        visits = self._settings.facet_visits / (effort * len(self.solver.shape.facets))
        return int(min(visits, self._settings.basis_numbers / self.solver.boundary.basis.shape[1]))

    def restore(self, plane: Plane, known: SampledSlice, point: Point, row: Floats) -> None:
        """Take samples that were taken before: the finest on a plane, and the exact row of a point.

        Args:
            plane: the one that was cut with.
            known: its samples.
            point: a source, with z = 0 in a polygon.
            row: (k,) the exact basis there.
        """
        self.on(plane).restore(known)
        self._points[point] = row

    def finest(self, plane: Plane, point: Point) -> tuple[SampledSlice, Floats] | None:
        """The finest samples on a plane and the exact row of a point, if they are there and took long."""
        there = point in self._points and plane in self._planes and self._planes[plane].final
        if not there or self.sampler.exact_always or self.remarks:
            return None
        return finish(self._planes[plane].level_steps(0)), self._points[point]

    def is_exact(self, point: Point) -> bool:
        """Whether the exact row of a point is there, or takes no time."""
        return point in self._points or self.sampler.exact_always

    @property
    def remarks(self) -> tuple[str, ...]:
        """Remarks for the user on the samples taken so far, one sentence each."""
        return remarks_on(self.solver.coordinates)

    def row_steps(self, point: Point, rtol: float = 0.0) -> Generator[None, None, Floats]:
        """Sample the basis at a point, (k,), before it is scaled; exact unless rtol is given and saves time.

        Raises:
            SourceError: the point lies outside the shape, or has no weights.
        """
        # Until all is prepared, getting ready for a tolerance takes longer than an exact row.
        if rtol and self.sampler.complete and not self.is_exact(point):
            return self._row(point, rtol)
        if point not in self._points:
            yield
            self._points[point] = self._row(point, 0.0)
        self._points.move_to_end(point)
        while len(self._points) > self._settings.kept_points:
            self._points.popitem(last=False)
        return self._points[point]

    def _row(self, point: Point, rtol: float) -> Floats:
        shape, coordinates = self.solver.shape, self.solver.coordinates
        before, undefined = coordinates.unconverged, coordinates.undefined
        row = finish(self.sampler.sample_steps(np.array([point]), rtol))[0]
        if not np.isfinite(row).all():
            placed = place_points(coordinates, [point[: shape.dimension]])
            if len(placed.moved):  # hardly outside, and so on the surface
                row = finish(self.sampler.sample_steps(in_space(placed.points), rtol))[0]
        if np.isfinite(row).all():
            return row
        place = ", ".join(f"{value:.6g}" for value in point[: shape.dimension])
        if coordinates.unconverged > before:
            raise SourceError(
                f"{coordinates.title.lower()} were not found at the source ({place}); move it a little, "
                "or choose other coordinates"
            )
        if coordinates.undefined > undefined:
            raise SourceError(
                f"there is no distance from the source ({place}), which lies beside a place where the mesh "
                "overlaps itself; choose another point, or unite the mesh"
            )
        raise SourceError(
            f"the source ({place}) lies outside the {'polygon' if shape.dimension == 2 else 'mesh'}; "
            "choose a point inside or on it"
        )


def remarks_on(coordinates: Coordinates) -> tuple[str, ...]:
    """Remarks for the user on the weights found so far, one sentence each."""
    remarks, count = [], coordinates.unconverged
    if count:
        points = (
            "one of the points tried; it has" if count == 1 else f"{count} of the points tried; they have"
        )
        remarks.append(f"{coordinates.title} were not found at {points} no value")
    if coordinates.undefined:
        remarks.append(NO_VALUE)
    return tuple(remarks)


def remarks_on_negativity(negativity: Floats) -> tuple[str, ...]:
    """Remarks for the user on weights that are so negative that distances may be too large.

    Args:
        negativity: (p,) of points, as `InteriorDistance.negativity` tells it; NaN where there is no value.

    >>> remarks_on_negativity(np.array([0.1, np.nan])), len(remarks_on_negativity(np.array([0.1, 1.25])))
    ((), 1)
    """
    large = negativity[np.isfinite(negativity) & (negativity > WEIGHT_SUMS.notable_negativity)]
    if len(large) == 0:
        return ()
    share = 100.0 * len(large) / len(negativity)
    return (
        f"At {share:.2g} % of the points negative weights add up to more than "
        f"{WEIGHT_SUMS.notable_negativity:g}, at most {large.max():.2g}: distances may exceed the boundary's "
        "largest by that share",
    )
