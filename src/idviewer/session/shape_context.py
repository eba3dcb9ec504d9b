"""What stays of a shape between requests: eigenpairs, barycentroids, and samples that distances share."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Generator, Hashable

import numpy as np

from idviewer.core import Coordinates, Distance, InteriorDistance, Plane, Spectrum
from idviewer.core.arrays import Floats, in_space
from idviewer.core.interior import Barycentroid, solver_steps
from idviewer.core.sampling.plane_samples import PlaneSamples
from idviewer.core.sampling.point_norms import MaxNorm
from idviewer.core.sampling.sampler import Sampler
from idviewer.core.steps import finish
from idviewer.session.cached_view import CachedView
from idviewer.session.state import Point, Query, QueryError

Kind = tuple[Distance, str]
"""A distance and the name of coordinates: what a barycentroid belongs to."""


KEPT_PLANES, KEPT_POINTS, KEPT_SAMPLED = 6, 8, 4
NUMBERS = 3e7
"""Of the basis on the finest level of a slice: 240 MB."""

FACE_VISITS = 1.2e9
"""Work spent on the exact level of a slice: a few seconds on two cores, with mean value coordinates."""

BESIDE = 0.01
"""Share of the diagonal within which a plane counts as one through the barycentroid."""

SOURCE = 2e-5
"""Tolerance of a source's own sample while the exact one is not there."""


class BasisSamples:
    """Samples of one basis, on planes and at points; they serve every distance with that basis.

    Args:
        solver: whose basis is sampled.
        finest: about how many nodes the last level of a plane may have; by default what takes seconds.
    """

    def __init__(self, solver: InteriorDistance, finest: int | None = None) -> None:
        self.solver, self._finest = solver, finest
        # A warning would be lost in the compute thread; `remarks` tells instead.
        solver.coordinates.warns = False
        self.sampler = Sampler(solver)
        self.body = MaxNorm(solver.boundary.basis)
        self._planes: OrderedDict[Plane, PlaneSamples] = OrderedDict()
        self._points: OrderedDict[Point, Floats] = OrderedDict()

    def on(self, plane: Plane) -> PlaneSamples:
        """The samples on a plane, those of the planes used last kept."""
        if plane not in self._planes:
            finest = self._affordable() if self._finest is None else self._finest
            self._planes[plane] = PlaneSamples(self.sampler, plane, finest)
        self._planes.move_to_end(plane)
        while len(self._planes) > KEPT_PLANES:
            self._planes.popitem(last=False)
        return self._planes[plane]

    def _affordable(self) -> int:
        effort = Coordinates.pairs_in_a_step / self.solver.coordinates.pairs_in_a_step
        visits = FACE_VISITS / (effort * len(self.solver.shape.facets))
        return int(min(visits, NUMBERS / self.solver.boundary.basis.shape[1]))

    def restore(self, opening: CachedView) -> None:
        """Takes samples that were taken before."""
        self.on(opening.plane).restore(opening.section)
        self._points[opening.barycentroid] = opening.row

    def opening(self, plane: Plane, point: Point) -> CachedView | None:
        """The finest samples on a plane and at a point, if they are there and took long."""
        there = point in self._points and plane in self._planes and self._planes[plane].final
        if not there or self.sampler.exact_always or self.remarks:
            return None
        return CachedView(point, self._points[point], plane, finish(self._planes[plane].level_steps(0)))

    def is_exact(self, point: Point) -> bool:
        """Whether the exact row of a point is there, or takes no time."""
        return point in self._points or self.sampler.exact_always

    @property
    def remarks(self) -> tuple[str, ...]:
        """What there is to say of the samples taken so far, one sentence each."""
        return remarks_on(self.solver.coordinates)

    def row_steps(self, point: Point, rtol: float = 0.0) -> Generator[None, None, Floats]:
        """The basis at a point, (k,), before it is scaled; exact unless rtol is given and saves time.

        Raises:
            QueryError: the point lies outside the shape, or has no weights.
        """
        # Until all is prepared, getting ready for a tolerance takes longer than an exact row.
        if rtol and self.sampler.complete and not self.is_exact(point):
            return self._row(point, rtol)
        if point not in self._points:
            yield
            self._points[point] = self._row(point, 0.0)
        self._points.move_to_end(point)
        while len(self._points) > KEPT_POINTS:
            self._points.popitem(last=False)
        return self._points[point]

    def _row(self, point: Point, rtol: float) -> Floats:
        shape, coordinates = self.solver.shape, self.solver.coordinates
        before = coordinates.unconverged
        row = finish(self.sampler.sample_steps(np.array([point]), rtol))[0]
        if np.isfinite(row).all():
            return row
        place = ", ".join(f"{value:.6g}" for value in point[: shape.dimension])
        if coordinates.unconverged > before:
            raise QueryError(
                f"{coordinates.title.lower()} were not found at the source ({place}); move it a little, "
                "or choose other coordinates"
            )
        raise QueryError(
            f"the source ({place}) lies outside the {'polygon' if shape.dimension == 2 else 'mesh'}; "
            "choose a point inside or on it"
        )


def remarks_on(coordinates: Coordinates) -> tuple[str, ...]:
    """What there is to say of the weights found so far, one sentence each."""
    count = coordinates.unconverged
    if count == 0:
        return ()
    points = "one of the points tried; it has" if count == 1 else f"{count} of the points tried; they have"
    return (f"{coordinates.title} were not found at {points} no value",)


class ShapeContext:
    """A shape with all that was computed of it and does not depend on the query's distance or coordinates.

    Args:
        solver: of the first distance and coordinates asked for.
        centre: what stands for the barycentroid until one is found; None if nothing does.
        finest: about how many nodes a slice may have; by default as many as samples are affordable.
    """

    def __init__(
        self, solver: InteriorDistance, centre: Point | None = None, finest: int | None = None
    ) -> None:
        self.shape, self._finest = solver.boundary.full_shape, finest
        self.spectrum: Spectrum | None = solver.spectrum if solver.boundary.distance.spectral else None
        self._sampled = [BasisSamples(solver, finest)]
        self._found: dict[Kind, Point] = {}
        self._latest = centre
        self.has_opening = False
        self.opened: Plane | None = None
        self._building: tuple[Hashable, Generator[float | None, None, InteriorDistance]] | None = None
        self._search: tuple[Kind, Generator[float | None, None, Barycentroid]] | None = None

    def lacks_eigenpairs(self, distance: Distance) -> bool:
        """Whether they have to be computed for this distance."""
        return distance.spectral and self.spectrum is None

    def sampled(self, query: Query) -> BasisSamples:
        """The samples that a query needs: of its distance's basis, by its coordinates. They must be there."""
        found = next(one for one in self._sampled if _serves(one, query))
        self._sampled.remove(found)
        self._sampled.append(found)
        return found

    def basis_steps(self, query: Query) -> Generator[float | None, None, None]:
        """Makes what samples are taken of where it is not there; goes on where a closed attempt stopped.

        Other coordinates share the basis that is there. Yields the share done, or None, every few
        milliseconds.
        """
        if any(_serves(one, query) for one in self._sampled):
            return
        for one in self._sampled:
            if one.solver.boundary.shares_basis(query.distance):
                self._keep(one.solver.with_coordinates(query.coordinates))
                return
        key = query.distance.basis_key, query.coordinates
        if self._building is None or self._building[0] != key:
            self._building = (
                key,
                solver_steps(self.shape, query.distance, query.coordinates, self.spectrum),
            )
        while True:
            try:
                share = next(self._building[1])
            except StopIteration as stop:
                self._building = None
                self._keep(stop.value)
                return
            except Exception:
                self._building = None
                raise
            yield share

    def _keep(self, solver: InteriorDistance) -> None:
        """Samples of a solver beside those that are there; those used longest ago make room."""
        self._sampled.append(BasisSamples(solver, self._finest))
        while len(self._sampled) > KEPT_SAMPLED:
            self._sampled.pop(0)

    def is_settled(self, query: Query) -> bool:
        """Whether the barycentroid of the query's distance and coordinates is known."""
        return _kind(query) in self._found

    @property
    def latest(self) -> Point | None:
        """The barycentroid found last, or what stands for one."""
        return self._latest

    @property
    def has_centre(self) -> bool:
        """Whether there is a barycentroid to show."""
        return self._latest is not None

    def barycentroid(self, query: Query) -> Point:
        """That of the query's distance and coordinates, or else the one found last; there must be one."""
        found = self._found.get(_kind(query), self._latest)
        assert found is not None
        return found

    def find_barycentroid_steps(self, solver: InteriorDistance) -> Generator[None, None, None]:
        """Finds the barycentroid of the solver; goes on where a closed search for it stopped."""
        kind = solver.boundary.distance, solver.coordinates.name
        if self._search is None or self._search[0] != kind:
            sampled = next(one for one in self._sampled if _samples(one, *kind))
            self._search = (kind, solver.barycentroid_steps(sampled.sampler.surrogate(solver)))
        while True:
            try:
                next(self._search[1])
            except StopIteration as stop:
                x, y, z = in_space(stop.value.point[None])[0].tolist()
                self._found[kind] = self._latest = x, y, z
                self._search = None
                return
            except Exception:
                self._search = None
                raise
            yield

    def restore(self, query: Query, opening: CachedView) -> None:
        """Takes what a query's first view shows from an earlier run of the program."""
        self.sampled(query).restore(opening)
        self._found[_kind(query)] = self._latest = opening.barycentroid
        self.has_opening, self.opened = True, opening.plane

    def opening(self, query: Query) -> CachedView | None:
        """What a query shows, if it is a slice through the barycentroid or next to it, all of which is there;
        once."""
        point = self._found.get(_kind(query))
        if self.has_opening or point is None or len(query.planes) != 1 or not query.distance.spectral:
            return None
        # A preview puts the plane through its own barycentroid.
        if math.dist(query.planes[0].origin, point) > BESIDE * self.shape.diagonal:
            return None
        opening = self.sampled(query).opening(query.planes[0], point)
        self.has_opening = opening is not None
        return opening

    def forget_search(self) -> None:
        """Drops what was closed half-way."""
        self._search = self._building = None


def _kind(query: Query) -> Kind:
    return query.distance, query.coordinates


def _serves(sampled: BasisSamples, query: Query) -> bool:
    return _samples(sampled, *_kind(query))


def _samples(sampled: BasisSamples, distance: Distance, coordinates: str) -> bool:
    solver = sampled.solver
    return solver.coordinates.name == coordinates and solver.boundary.shares_basis(distance)
