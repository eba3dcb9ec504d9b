"""One basis sampled at points, for every distance that it serves, as accurately as a slice needs it."""

from __future__ import annotations

from collections.abc import Generator
from functools import cached_property, partial

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Floats, in_space
from idviewer.core.distances import DISTANCES, Distance, Number, parameters_of
from idviewer.core.interior.barycentroid import Evaluate
from idviewer.core.interior.solver import InteriorDistance
from idviewer.core.memory import release_free_memory

QUICK_FACES = 4000
"""On shapes up to so large, sampling exactly takes no longer than within a tolerance."""

COARSE, FINE = 2.5e-3, 3.5e-4
"""Tolerances of samples, in largest distances on the slice."""

LOOSEST = 1.9e-3
"""A larger tolerance would take one more tree, and its memory, and save little. One serves down to `FINE`."""

WIDE = 400
"""Columns from which on the moments of clusters take more memory and time than they save."""

TELLING = 0.03
"""Columns that weigh less than this share of the heaviest do not tell where errors are large."""

ENOUGH = 200
"""So many points of an outline tell how large the distances on a slice are."""

AFFORDABLE = 4e7
"""Facets times columns up to which there is memory (a gigabyte) for the tree of the smallest tolerance."""

OF_THE_BODY = 5000
"""So many vertices tell how large they are on the whole shape."""

FINEST = 2e-5
"""The smallest tolerance there is a tree for, in largest distances on the shape."""


class Sampler:
    """Samples a solver's basis within tolerances that hold for all its distances.

    Args:
        solver: whose basis is sampled.
    """

    def __init__(self, solver: InteriorDistance) -> None:
        self.solver = solver
        wide, small = solver.boundary.basis.shape[1] > WIDE, len(solver.shape.facets) <= QUICK_FACES
        self.exact_always = wide or small or not solver.interpolation.approximates
        self.ready = self.complete = self.exact_always
        common = [solver, *(solver.with_distance(kind) for kind in _common(solver))]
        self._scales = np.stack(
            [one.boundary.scale * np.ones(solver.boundary.basis.shape[1]) for one in common], axis=1
        )
        self._radii = self._radii_of(solver.boundary.basis[:: -(-len(solver.boundary.basis) // OF_THE_BODY)])
        self._preparation = self._prepare()
        sizes = np.abs(self._scales[:, 0]) * np.linalg.norm(
            solver.boundary.basis[:: max(1, len(solver.boundary.basis) // 500)], axis=0
        )
        self._columns = np.flatnonzero(sizes >= TELLING * sizes.max())

    @cached_property
    def _weights(self) -> Floats:
        # Not needed where all that is shown was sampled before.
        return self.solver.interpolation.error_weights(extremes(self.solver))

    def significant_columns(self, rows: Floats) -> Floats:
        """Of rows (p, k), scaled, the columns that make up most of the solver's own distance."""
        return rows[:, self._columns] * self._scales[self._columns, 0]

    def sample_steps(self, points: ArrayLike, rtol: float) -> Generator[float, None, Floats]:
        """The basis at points (p, 3), within rtol of the largest distance on the shape; 0 is exact.

        A polygon's points lie in the plane z = 0.
        """
        points = np.asarray(points)[:, : self.solver.shape.dimension]
        if self.exact_always or rtol == 0.0:
            return (yield from self.solver.interpolation.sample_steps(points, rtol=0.0))
        return (yield from self.solver.interpolation.sample_steps(points, rtol=rtol, weights=self._weights))

    def surrogate(self, solver: InteriorDistance) -> Evaluate | None:
        """The potential of a solver with this basis, within a tolerance; None where that saves no time."""
        if self.exact_always or not self.ready:
            return None
        return partial(solver.interpolation.potential_steps, rtol=FINE, weights=self._weights)

    def tolerance(self, share: float, outline: Floats) -> float:
        """The rtol that is such a share of the distances on a slice with these rows on its outline."""
        if self.exact_always or len(outline) == 0:
            return 0.0
        some = outline[:: -(-len(outline) // ENOUGH)]
        ratio = float((self._radii_of(some) / self._radii).min())
        return float(np.clip(share * ratio, FINEST, LOOSEST))

    def prepare_steps(self, completely: bool = False) -> Generator[float, None, None]:
        """What sampling needs; goes on where it was left, yields the share done every few milliseconds.

        Args:
            completely: also what only slices need whose distances are small, which takes as long again.
        """
        if not self._has_prepared(completely):
            yield 0.0  # before the first step, which is long
        while not self._has_prepared(completely):
            try:
                share = next(self._preparation)
            except StopIteration:
                return
            except Exception:
                self._preparation = self._prepare()
                raise
            yield share

    def _has_prepared(self, completely: bool) -> bool:
        return self.complete if completely else self.ready

    def _prepare(self) -> Generator[float, None, None]:
        yield from self._prepare_for(LOOSEST, FINE)
        self.ready = True
        yield 1.0
        if self.solver.boundary.basis.shape[1] * len(self.solver.shape.facets) <= AFFORDABLE:
            yield from self._prepare_for(FINEST)
            self.complete = True

    def _prepare_for(self, *tolerances: float) -> Generator[float, None, None]:
        point = in_space(self.solver.shape.vertices[:1])
        for done, rtol in enumerate(tolerances):
            for share in self.sample_steps(point, rtol):
                yield (done + min(share, 1.0)) / len(tolerances)
            release_free_memory()

    def _radii_of(self, rows: Floats) -> Floats:
        """How far the images of rows lie from their mean, for each of the common distances."""
        off = rows - rows.mean(axis=0)
        return np.sqrt(np.max(off**2 @ self._scales**2, axis=0))


def _common(solver: InteriorDistance) -> list[Distance]:
    """The distances of the solver's basis, parameters left to their defaults."""
    return [kind() for kind in DISTANCES.values() if solver.boundary.shares_basis(kind())]


def extremes(solver: InteriorDistance) -> list[Distance]:
    """The distances with the solver's basis, each parameter at its default and at the ends of its span."""
    found: list[Distance] = []
    for distance in _common(solver):
        found.append(distance)
        for name, parameter in parameters_of(distance).items():
            if isinstance(parameter, Number):
                middle = parameter.default(float(solver.spectrum.values[0]))
                found += [type(distance)(**{name: middle * end}) for end in parameter.span]
    return found
