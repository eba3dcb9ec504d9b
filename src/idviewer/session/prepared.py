"""What stays of a mesh between requests: eigenpairs, barycentroids, and samples that distances share."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Generator, Hashable

import numpy as np
from numpy.typing import NDArray

from idviewer.core import Distance, InteriorDistance, Plane, Spectrum
from idviewer.core.barycentroid import Barycentroid
from idviewer.core.steps import finish
from idviewer.session.cloud import Reach
from idviewer.session.plane_samples import PlaneSamples
from idviewer.session.sampler import Sampler
from idviewer.session.state import Point, QueryError

Floats = NDArray[np.float64]

KEPT_PLANES, KEPT_POINTS, KEPT_BASES = 6, 8, 4
NUMBERS = 3e7
"""Of the basis on the finest level of a slice: 240 MB."""

FACE_VISITS = 1.2e9
"""Work spent on the exact level of a slice: a few seconds on two cores."""

SOURCE = 2e-5
"""Tolerance of a source's own sample while the exact one is not there."""


class Sampled:
    """Samples of one basis, on planes and at points; they serve every distance with that basis.

    Args:
        solver: whose basis is sampled.
    """

    def __init__(self, solver: InteriorDistance) -> None:
        self.solver = solver
        self.sampler = Sampler(solver)
        self.body = Reach(solver.basis)
        self._planes: OrderedDict[Plane, PlaneSamples] = OrderedDict()
        self._points: OrderedDict[Point, Floats] = OrderedDict()

    def on(self, plane: Plane) -> PlaneSamples:
        """The samples on a plane, those of the planes used last kept."""
        if plane not in self._planes:
            visits = FACE_VISITS / len(self.solver.shape.facets)
            finest = int(min(visits, NUMBERS / self.solver.basis.shape[1]))
            self._planes[plane] = PlaneSamples(self.sampler, plane, finest)
        self._planes.move_to_end(plane)
        while len(self._planes) > KEPT_PLANES:
            self._planes.popitem(last=False)
        return self._planes[plane]

    def is_exact(self, point: Point) -> bool:
        """Whether the exact row of a point is there, or takes no time."""
        return point in self._points or self.sampler.exact_always

    def row_steps(self, point: Point, rtol: float = 0.0) -> Generator[None, None, Floats]:
        """The basis at a point, (k,), before it is scaled; exact unless that takes time and rtol is given.

        Raises:
            QueryError: the point lies outside the mesh.
        """
        if rtol and not self.is_exact(point):
            return _inside(finish(self.sampler.sample_steps(np.array([point]), rtol))[0], point)
        if point not in self._points:
            yield
            self._points[point] = _inside(finish(self.sampler.sample_steps(np.array([point]), 0.0))[0], point)
        self._points.move_to_end(point)
        while len(self._points) > KEPT_POINTS:
            self._points.popitem(last=False)
        return self._points[point]


def _inside(row: Floats, point: Point) -> Floats:
    if not np.isfinite(row).all():
        place = ", ".join(f"{value:.6g}" for value in point)
        raise QueryError(f"the source ({place}) lies outside the mesh; choose a point inside or on it")
    return row


class Prepared:
    """A mesh with all that was computed of it and does not depend on the query's distance.

    Args:
        solver: of the first distance asked for.
        barycentroid: of that distance.
    """

    def __init__(self, solver: InteriorDistance, barycentroid: Barycentroid) -> None:
        self.shape = solver.shape
        self.spectrum: Spectrum | None = solver.spectrum if solver.distance_kind.spectral else None
        self._sampled = [Sampled(solver)]
        self._found: dict[Distance, Barycentroid] = {solver.distance_kind: barycentroid}
        self._latest = barycentroid
        self._building: tuple[Hashable, Generator[float | None, None, InteriorDistance]] | None = None
        self._search: tuple[Distance, Generator[float | None, None, Barycentroid]] | None = None

    def lacks_eigenpairs(self, distance: Distance) -> bool:
        """Whether they have to be computed for this distance."""
        return distance.spectral and self.spectrum is None

    def sampled(self, distance: Distance) -> Sampled:
        """The samples of the distance's basis, which must be there."""
        return next(one for one in self._sampled if one.solver.shares_basis(distance))

    def basis_steps(self, distance: Distance) -> Generator[float | None, None, None]:
        """Makes the distance's basis where it is not there; goes on where a closed attempt stopped.

        Yields the share done, or None, every few milliseconds.
        """
        if any(one.solver.shares_basis(distance) for one in self._sampled):
            return
        if self._building is None or self._building[0] != distance.basis_key:
            steps = InteriorDistance.steps(self.shape, distance, spectrum=self.spectrum)
            self._building = (distance.basis_key, steps)
        while True:
            try:
                share = next(self._building[1])
            except StopIteration as stop:
                self._building = None
                self._keep(Sampled(stop.value))
                return
            except Exception:
                self._building = None
                raise
            yield share

    def _keep(self, sampled: Sampled) -> None:
        """Beside the first ones; those used longest ago make room."""
        self._sampled.append(sampled)
        while len(self._sampled) > KEPT_BASES:
            self._sampled.pop(0)

    def is_settled(self, distance: Distance) -> bool:
        """Whether the distance's own barycentroid is known."""
        return distance in self._found

    def barycentroid(self, distance: Distance) -> Barycentroid:
        """The distance's own, or else the one found last."""
        return self._found.get(distance, self._latest)

    def settle_steps(self, solver: InteriorDistance) -> Generator[None, None, None]:
        """Finds the barycentroid of the solver's distance; goes on where a closed search for it stopped."""
        distance = solver.distance_kind
        if self._search is None or self._search[0] != distance:
            self._search = (distance, solver.barycentroid_steps())
        while True:
            try:
                next(self._search[1])
            except StopIteration as stop:
                self._found[distance] = self._latest = stop.value
                self._search = None
                return
            except Exception:
                self._search = None
                raise
            yield

    def forget_search(self) -> None:
        """Drops what was closed half-way."""
        self._search = self._building = None
