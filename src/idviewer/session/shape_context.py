"""Shape context: eigenpairs, barycentroids and samples that stay of a shape between requests."""

from __future__ import annotations

from collections.abc import Generator
from functools import partial

from idviewer.core import (
    Barycentroid,
    Discretisation,
    DiscretisationError,
    Distance,
    InteriorDistance,
    Spectrum,
)
from idviewer.core.arrays import in_space
from idviewer.core.interior import Preview, discretisation_steps, extent, solver_steps
from idviewer.core.sampling import BasisSamples
from idviewer.core.steps import Resumable, without_shares
from idviewer.session.state import Point, Query

Kind = tuple[Distance, str]
"""A distance and the name of coordinates: what a barycentroid belongs to."""


class ShapeContext:
    """A shape with all that was computed of it and does not depend on the query's distance or coordinates.

    Args:
        solver: of the first distance and coordinates asked for.
        centre: what stands for the barycentroid until one is found; None if nothing does.
        nodes: about how many nodes a slice may have; by default as many as samples are affordable.
        preview: what the solver computes on, where that is no more than a preview.
    """

    def __init__(
        self,
        solver: InteriorDistance,
        centre: Point | None = None,
        nodes: int | None = None,
        preview: Preview | None = None,
    ) -> None:
        self.shape, self.preview, self._nodes = solver.boundary.section_shape, preview, nodes
        self._resolved = solver.boundary.resolved
        self.spectrum: Spectrum | None = solver.spectrum if solver.boundary.distance.spectral else None
        self._bases: list[BasisSamples] = []
        self._found: dict[Kind, Point] = {}
        self._latest = centre
        self._errors: dict[Kind, DiscretisationError] = {}
        self._preview_errors: dict[Distance, tuple[float, float]] = {}
        self._building: Resumable[float | None, InteriorDistance] = Resumable()
        self._estimating: Resumable[None, Discretisation] = Resumable()
        self._searching: Resumable[float | None, Barycentroid] = Resumable()
        self._keep(solver)

    def lacks_eigenpairs(self, distance: Distance) -> bool:
        """Whether they have to be computed for this distance."""
        return distance.spectral and self.spectrum is None

    def samples(self, query: Query) -> BasisSamples:
        """The samples that a query needs: of its distance's basis, by its coordinates. They must be there."""
        found = next(one for one in self._bases if _serves(one, *_kind(query)))
        self._bases.remove(found)
        self._bases.append(found)
        return found

    def basis_steps(self, query: Query) -> Generator[float | None, None, None]:
        """Make what samples are taken of where it is not there; go on where a closed attempt stopped.

        Other coordinates share the basis that is there. Yields the share done, or None, every few
        milliseconds.
        """
        if any(_serves(one, *_kind(query)) for one in self._bases):
            return
        for one in self._bases:
            if one.solver.boundary.shares_basis(query.distance):
                self._keep(one.solver.with_coordinates(query.coordinates))
                return
        key = query.distance.basis_key, query.coordinates
        of = query.distance, query.coordinates, self.spectrum, self._resolved
        begin = partial(solver_steps, self._resolved.given, *of)
        self._keep((yield from self._building.run(key, begin)))

    def _keep(self, solver: InteriorDistance) -> None:
        """Keep samples of a solver beside those that are there, in place of those used longest ago."""
        # A warning would be lost in the compute thread; remarks tell instead.
        solver.coordinates.warns = False
        samples = BasisSamples(solver, self._nodes)
        self._bases.append(samples)
        while len(self._bases) > samples.sampler.settings.kept_bases:
            self._bases.pop(0)

    @property
    def latest_barycentroid(self) -> Point | None:
        """The barycentroid found last, or what stands for one."""
        return self._latest

    def found_barycentroid(self, query: Query) -> Point | None:
        """The barycentroid of the query's distance and coordinates, if it is known."""
        return self._found.get(_kind(query))

    def barycentroid(self, query: Query) -> Point:
        """That of the query's distance and coordinates, or else the one found last; there must be one."""
        found = self._found.get(_kind(query), self._latest)
        assert found is not None
        return found

    def set_barycentroid(self, query: Query, point: Point) -> None:
        """Take one that is known."""
        self._found[_kind(query)] = self._latest = point

    def find_barycentroid_steps(self, solver: InteriorDistance) -> Generator[None, None, None]:
        """Find the barycentroid of the solver; go on where a closed search for it stopped."""
        kind = solver.boundary.distance, solver.coordinates.name
        sampler = next(one.sampler for one in self._bases if _serves(one, *kind))
        found = yield from without_shares(
            self._searching.run(kind, lambda: solver.barycentroid_steps(sampler.surrogate(solver)))
        )
        x, y, z = in_space(found.point[None])[0].tolist()
        self._found[kind] = self._latest = x, y, z

    def preview_error(self, solver: InteriorDistance) -> tuple[float, float]:
        """A preview's error of a distance, as a share of the largest on the boundary, and that largest."""
        assert self.preview is not None
        distance = solver.boundary.distance
        if distance not in self._preview_errors:
            largest = extent(solver.boundary.embedding)
            self._preview_errors[distance] = self.preview.error(distance), largest
        return self._preview_errors[distance]

    def discretisation(self, query: Query) -> DiscretisationError | None:
        """The errors by the discretisation of the boundary, where they are known."""
        return self._errors.get(_kind(query))

    def discretisation_steps(self, query: Query) -> Generator[None, None, None]:
        """Estimate the errors by the discretisation of the boundary.

        Raises:
            ShapeError: they cannot be told.
        """
        solver = self.samples(query).solver.with_distance(query.distance)
        estimating = self._estimating.run(_kind(query), partial(discretisation_steps, solver))
        self._errors[_kind(query)] = (yield from estimating).summary

    def forget_half_done(self) -> None:
        """Drop what was closed half-way."""
        self._searching.forget()
        self._building.forget()
        self._estimating.forget()


def _kind(query: Query) -> Kind:
    return query.distance, query.coordinates


def _serves(samples: BasisSamples, distance: Distance, coordinates: str) -> bool:
    solver = samples.solver
    return solver.coordinates.name == coordinates and solver.boundary.shares_basis(distance)
