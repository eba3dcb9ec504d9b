"""What stays of a mesh between requests: eigenpairs, barycentroids, and samples that distances share."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from idviewer.core import Distance, InteriorDistance, Plane, Spectrum
from idviewer.core.barycentroid import Barycentroid
from idviewer.core.steps import finish
from idviewer.session.plane_samples import PlaneSamples
from idviewer.session.state import Point, QueryError

Floats = NDArray[np.float64]

KEPT_PLANES, KEPT_POINTS = 6, 8
FACE_VISITS = 3e8
"""Work spent on the finest level of a slice: about two seconds on two cores."""


class Sampled:
    """Samples of one basis, on planes and at points; they serve every distance with that basis.

    Args:
        solver: whose basis is sampled.
    """

    def __init__(self, solver: InteriorDistance) -> None:
        self.solver = solver
        self._planes: OrderedDict[Plane, PlaneSamples] = OrderedDict()
        self._points: OrderedDict[Point, Floats] = OrderedDict()

    def on(self, plane: Plane) -> PlaneSamples:
        """The samples on a plane, those of the planes used last kept."""
        if plane not in self._planes:
            finest = int(np.clip(FACE_VISITS / len(self.solver.mesh.faces), 2000, 16000))
            self._planes[plane] = PlaneSamples(self.solver, plane, finest)
        self._planes.move_to_end(plane)
        while len(self._planes) > KEPT_PLANES:
            self._planes.popitem(last=False)
        return self._planes[plane]

    def row_steps(self, point: Point) -> Generator[None, None, Floats]:
        """The basis at a point, (k,), before it is scaled.

        Raises:
            QueryError: the point lies outside the mesh.
        """
        if point not in self._points:
            yield
            row = finish(self.solver.sample_steps(np.array([point])))[0]
            if not np.isfinite(row).all():
                place = ", ".join(f"{value:.6g}" for value in point)
                raise QueryError(
                    f"the source ({place}) lies outside the mesh; choose a point inside or on it"
                )
            self._points[point] = row
            while len(self._points) > KEPT_POINTS:
                self._points.popitem(last=False)
        return self._points[point]


class Prepared:
    """A mesh with all that was computed of it and does not depend on the query's distance.

    Args:
        solver: of the first distance asked for.
        barycentroid: of that distance.
    """

    def __init__(self, solver: InteriorDistance, barycentroid: Barycentroid) -> None:
        self.mesh = solver.mesh
        self.spectrum: Spectrum | None = solver.spectrum if solver.distance_kind.spectral else None
        self._sampled = [Sampled(solver)]
        self._found: dict[Distance, Barycentroid] = {solver.distance_kind: barycentroid}
        self._latest = barycentroid
        self._search: tuple[Distance, Generator[float | None, None, Barycentroid]] | None = None

    def lacks_eigenpairs(self, distance: Distance) -> bool:
        """Whether they have to be computed for this distance."""
        return distance.spectral and self.spectrum is None

    def sampled(self, distance: Distance) -> Sampled:
        """The samples of the distance's basis."""
        for one in self._sampled:
            if one.solver.shares_basis(distance):
                return one
        self._sampled.append(Sampled(InteriorDistance(self.mesh, distance, spectrum=self.spectrum)))
        return self._sampled[-1]

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
        """Drops a search that was closed half-way."""
        self._search = None
