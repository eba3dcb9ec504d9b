"""One basis sampled at points, for every distance that it serves, as accurately as a slice needs it."""

from __future__ import annotations

from collections.abc import Generator
from functools import cached_property, partial

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Bools, Floats, in_space
from idviewer.core.distances import DISTANCES, Distance, Number, parameters_of
from idviewer.core.interior.barycentroid import Evaluate
from idviewer.core.interior.solver import InteriorDistance
from idviewer.core.memory import release_free_memory
from idviewer.core.sampling import settings as defaults
from idviewer.core.sampling.settings import SamplingSettings
from idviewer.core.steps import Resumable


class Sampler:
    """Samples a solver's basis within tolerances that hold for all its distances.

    Args:
        solver: whose basis is sampled.
        settings: `SAMPLING` by default.

    Attributes:
        exact_always: whether tolerances save no time, so that every sample is exact.
        ready: whether the first levels of slices can be sampled without more preparation.
        complete: whether everything can.

    >>> from idviewer.core import Euclidean, Polygon
    >>> from idviewer.core.steps import finish
    >>> sampler = Sampler(InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean()))
    >>> finish(sampler.sample_steps([[3.0, 2.0, 0.0]], 0.0)).round(12).tolist()
    [[1.0, 0.0]]
    """

    def __init__(self, solver: InteriorDistance, settings: SamplingSettings | None = None) -> None:
        self.solver = solver
        self.settings = defaults.SAMPLING if settings is None else settings
        basis = solver.boundary.basis
        wide = basis.shape[1] > self.settings.exact_columns
        small = len(solver.shape.facets) <= self.settings.exact_facets
        self.exact_always = wide or small or not solver.interpolation.approximates
        self.ready = self.complete = self.exact_always
        common = [solver, *(solver.with_distance(kind) for kind in _common(solver))]
        self._scales = np.stack([one.boundary.scale * np.ones(basis.shape[1]) for one in common], axis=1)
        self._radii = self._radii_of(basis[:: -(-len(basis) // self.settings.boundary_vertices)])
        self._preparing: Resumable[float, None] = Resumable()
        sizes = np.abs(self._scales[:, 0]) * np.linalg.norm(basis[:: max(1, len(basis) // 500)], axis=0)
        self._columns = np.flatnonzero(sizes >= self.settings.significant_share * sizes.max())

    @cached_property
    def _weights(self) -> Floats:
        # Not needed where all that is shown was sampled before.
        return self.solver.interpolation.error_weights(extremes(self.solver))

    def significant_columns(self, rows: Floats) -> Floats:
        """The columns of rows (p, k), scaled, that make up most of the solver's own distance."""
        return rows[:, self._columns] * self._scales[self._columns, 0]

    def sample_steps(self, points: ArrayLike, rtol: float) -> Generator[float, None, Floats]:
        """Sample the basis at points (p, 3), within rtol of the largest distance on the shape; 0 is exact.

        A polygon's points lie in the plane z = 0.
        """
        points = np.asarray(points)[:, : self.solver.shape.dimension]
        if self.exact_always or rtol == 0.0:
            return (yield from self.solver.interpolation.sample_steps(points, rtol=0.0))
        return (yield from self.solver.interpolation.sample_steps(points, rtol=rtol, weights=self._weights))

    @property
    def may_lack_values(self) -> bool:
        """Whether points inside may have no value, since the shape overlaps itself."""
        return bool(getattr(self.solver.shape, "self_intersections", False))

    def have_values(self, points: Floats) -> Bools:
        """Tell which of points (p, 3) inside have values, (p,)."""
        return self.solver.coordinates.have_values(points[:, : self.solver.shape.dimension])

    def negativity_steps(self, points: Floats) -> Generator[float, None, Floats]:
        """Bound how negative the weights of points (p, 3) are; see `Coordinates.negativity_bound_steps`."""
        flat = points[:, : self.solver.shape.dimension]
        return (yield from self.solver.coordinates.negativity_bound_steps(flat))

    def surrogate(self, solver: InteriorDistance) -> Evaluate | None:
        """The potential of a solver with this basis, within a tolerance; None where that saves no time."""
        if self.exact_always or not self.ready:
            return None
        return partial(
            solver.interpolation.potential_steps, rtol=self.settings.fine_rtol, weights=self._weights
        )

    def tolerance(self, share: float, outline: Floats) -> float:
        """The rtol that is a share of the distances on a slice.

        Args:
            share: of the largest distance on the slice.
            outline: (s, k) rows of the basis on its outline.

        Returns:
            In largest distances on the boundary; 0 where every sample is exact.
        """
        if self.exact_always or len(outline) == 0:
            return 0.0
        some = outline[:: -(-len(outline) // self.settings.outline_points)]
        ratio = float((self._radii_of(some) / self._radii).min())
        return float(np.clip(share * ratio, self.settings.finest_rtol, self.settings.loosest_rtol))

    def prepare_steps(self, completely: bool = False) -> Generator[float, None, None]:
        """Prepare what sampling needs, or go on with it; yields the share done every few milliseconds.

        Args:
            completely: also what only slices need whose distances are small, which takes as long again.
        """
        if not self.ready:
            yield 0.0  # before the first step, which is long
            first = self.settings.loosest_rtol, self.settings.fine_rtol
            yield from self._preparing.run("ready", lambda: self._prepare_for(*first))
            self.ready = True
        affordable = (
            self.solver.boundary.basis.shape[1] * len(self.solver.shape.facets) <= self.settings.tree_products
        )
        if completely and affordable and not self.complete:
            yield 1.0
            yield from self._preparing.run("complete", lambda: self._prepare_for(self.settings.finest_rtol))
            self.complete = True

    def _prepare_for(self, *tolerances: float) -> Generator[float, None, None]:
        point = in_space(self.solver.shape.vertices[:1])
        for done, rtol in enumerate(tolerances):
            for share in self.sample_steps(point, rtol):
                yield (done + min(share, 1.0)) / len(tolerances)
            release_free_memory()

    def _radii_of(self, rows: Floats) -> Floats:
        """Largest distances of the images of rows from their mean, for each of the common distances."""
        off = rows - rows.mean(axis=0)
        return np.sqrt(np.max(off**2 @ self._scales**2, axis=0))


def _common(solver: InteriorDistance) -> list[Distance]:
    """The distances of the solver's basis, parameters left to their defaults."""
    return [kind() for kind in DISTANCES.values() if solver.boundary.shares_basis(kind())]


def extremes(solver: InteriorDistance) -> list[Distance]:
    """The distances with the solver's basis, each parameter at its default and at the ends of its span.

    >>> from idviewer.core import Euclidean, Polygon
    >>> extremes(InteriorDistance(Polygon([[0, 0], [1, 0], [0, 1]]), Euclidean()))
    [Euclidean()]
    """
    found: list[Distance] = []
    for distance in _common(solver):
        found.append(distance)
        for name, parameter in parameters_of(distance).items():
            if isinstance(parameter, Number):
                middle = parameter.default(float(solver.spectrum.values[0]))
                found += [type(distance)(**{name: middle * end}) for end in parameter.span]
    return found
