"""Distances in a mesh before its eigenpairs are known: those of a simplified mesh, and their error."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array

from idviewer.core.arrays import Floats, Ints, as_points
from idviewer.core.distances import Distance
from idviewer.core.interior.barycentroid import Barycentroid, Evaluate, barycentroid_steps
from idviewer.core.interior.equations import extent
from idviewer.core.interior.solver import InteriorDistance
from idviewer.core.shapes.closest_points import ClosestPointProjection
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.shape import Shape
from idviewer.core.shapes.simplification import Simplified, simplification_steps
from idviewer.core.spectrum.eigen_solver import Spectrum, eigenpair_steps
from idviewer.core.spectrum.laplacian import masses_of

Made = TypeVar("Made")

SMALLEST = 12_000
"""Meshes with fewer vertices have no preview: their own eigenpairs take little longer."""

VERTICES, FEWER = 6000, 1500
"""Of the simplified mesh, and of a still simpler one that tells how much simplifying costs."""

SIMPLIFYING, COARSE = "Simplifying the mesh", "Computing coarse eigenpairs"

NEGLIGIBLE = 0.01
"""Modes that weigh less than this share of the heaviest are left out."""

MARGIN = 0.02
"""Share of itself by which a mode may move across the bound when the mesh is simplified."""

COARSER_VALUES = 1.1
"""Eigenvalues of the simpler mesh are larger by less than this."""

OF_DIFFERENCE = 2.0 / 3.0
"""Share of the difference between the two simplified meshes that stands for the error."""

LAST_RADIUS = 1e-3
"""Share of the diagonal within which the barycentroid is looked for."""

PAIRS = 4000
"""Of vertices between which the error is looked at."""

LOOKED_AT = 5000
"""So many vertices tell how far the mesh lies from the simplified one."""

SLACK = 2.0
"""Points so many times as far off the simplified mesh as those vertices may still be in the full one."""

Steps = Generator[tuple[str, float | None], None, "Preview | None"]


@dataclass(frozen=True, eq=False)
class Preview:
    """Eigenpairs of a simplified mesh in the place of a mesh's own.

    Attributes:
        full: the mesh, of n vertices.
        small: the simplified mesh, of c vertices, and where those of the full one went.
        wide: of the simplified mesh, with the modes just beyond the bound too.
        coarser: as many eigenvalues of a still simpler mesh, its eigenvectors carried to the simplified one.
        bound: where the modes end that are used.
        gap: how far vertices of the full mesh lie from the simplified one.
    """

    full: Mesh
    small: Simplified
    wide: Spectrum
    coarser: Spectrum
    bound: float
    gap: float

    @cached_property
    def ground(self) -> ClosestPointProjection:
        """Where points are landed."""
        return ClosestPointProjection(self.small.mesh)

    @cached_property
    def spectrum(self) -> Spectrum:
        """Of the simplified mesh, c values a vector."""
        return _below(self.wide, self.bound)

    def serves(self, distance: Distance) -> bool:
        """Whether it has the modes that count for a distance of the same basis."""
        return self.spectrum.bound >= (1.0 - 1e-9) * preview_cutoff(distance)(float(self.spectrum.values[0]))

    def error(self, distance: Distance) -> float:
        """Estimated largest error of a spectral distance, as a share of the largest distance on the boundary.

        Errors fall with the square of the edges' length, so those of four times fewer vertices are four
        times as large, and the difference of the two is three times the error; of which two are taken, to be
        safe. To it comes what the modes count that may lie on either side of the bound.
        """
        first, second = np.random.default_rng(0).integers(0, len(self.small.mesh.vertices), (2, PAIRS))

        def apart(spectrum: Spectrum) -> Floats:
            rows = spectrum.vectors * distance.scale(spectrum)
            return np.linalg.norm(rows[first] - rows[second], axis=1)

        wide = apart(self.wide)
        simplifying = OF_DIFFERENCE * np.abs(wide - apart(self.coarser)).max()
        cutting = np.abs(wide - apart(_below(self.wide, (1.0 - MARGIN) * self.bound))).max()
        largest = extent(self.wide.vectors * distance.scale(self.wide))
        return float((simplifying + cutting) / largest) + NEGLIGIBLE**2

    def carrier(self, vertices: Ints | None = None) -> csr_array:
        """(v, c) from values at the simplified mesh's vertices to those at some or all of the full one's."""
        chosen = np.arange(len(self.full.vertices)) if vertices is None else vertices
        landings = self.ground.project(self.full.vertices[chosen], self.small.parents[chosen])
        return landings.matrix(self.small.mesh)

    def carried(self) -> Spectrum:
        """The spectrum with its vectors carried to the full mesh, (n, k): orthonormal up to the error."""
        vectors = self.carrier() @ self.spectrum.vectors
        return replace(self.spectrum, vectors=vectors, masses=masses_of(self.full))


def is_worth_previewing(shape: Shape) -> bool:
    """Whether a shape's eigenpairs take so long that a picture without them is welcome."""
    return isinstance(shape, Mesh) and len(shape.vertices) >= SMALLEST


def preview_cutoff(distance: Distance) -> Callable[[float], float]:
    """From lambda_2 to where the modes end that count in a picture."""

    def bound(lambda_2: float) -> float:
        last = distance.cutoff(lambda_2)
        values = np.geomspace(lambda_2, max(last, lambda_2), 200)
        empty = np.empty((0, len(values)))
        weights = np.abs(distance.scale(Spectrum(values, empty, np.empty(0), 0.0, last)))
        counting = np.flatnonzero(weights >= NEGLIGIBLE * weights.max())
        return last if len(counting) == 0 else float(values[min(counting[-1] + 1, len(values) - 1)])

    return bound


def preview_steps(mesh: Mesh, cutoff: Callable[[float], float]) -> Steps:
    """A preview of a mesh, or None where it would not pay or not be right.

    Yields the stage, and the share of it that is done or None, every few milliseconds.

    Args:
        mesh: n vertices.
        cutoff: from lambda_2 to the bound of the eigenvalues kept.
    """
    if not is_worth_previewing(mesh):
        return None
    small = yield from _telling(SIMPLIFYING, simplification_steps(mesh, VERTICES))
    if len(small.mesh.vertices) > 0.75 * len(mesh.vertices):
        return None
    wide = yield from _telling(
        COARSE, eigenpair_steps(small.mesh, lambda lambda_2: (1.0 + MARGIN) * cutoff(lambda_2))
    )
    fewer = yield from _telling(COARSE, simplification_steps(small.mesh, FEWER))
    most = COARSER_VALUES * float(wide.values[-1])
    coarse = yield from _telling(COARSE, eigenpair_steps(fewer.mesh, lambda _: most))
    landings, count = (
        ClosestPointProjection(fewer.mesh).project(small.mesh.vertices, fewer.parents),
        len(wide.values),
    )
    coarser = replace(
        coarse,
        values=coarse.values[:count],
        vectors=landings.matrix(fewer.mesh) @ coarse.vectors[:, :count],
    )
    preview = Preview(mesh, small, wide, coarser, cutoff(float(wide.values[0])), 0.0)
    some = np.arange(0, len(mesh.vertices), -(-len(mesh.vertices) // LOOKED_AT))
    off = preview.carrier(some) @ small.mesh.vertices - mesh.vertices[some]
    return replace(preview, gap=float(np.linalg.norm(off, axis=1).max()))


def _below(spectrum: Spectrum, bound: float) -> Spectrum:
    """The modes of a spectrum below a bound."""
    count = int(np.searchsorted(spectrum.values, bound))
    return replace(
        spectrum,
        values=spectrum.values[:count],
        vectors=np.ascontiguousarray(spectrum.vectors[:, :count]),
        bound=bound,
    )


def _telling(
    stage: str, steps: Generator[float | None, None, Made]
) -> Generator[tuple[str, float | None], None, Made]:
    while True:
        try:
            share = next(steps)
        except StopIteration as stop:
            return stop.value
        yield stage, share


class PreviewDistance(InteriorDistance):
    """An interior distance of a simplified mesh that answers for the full one.

    Points between the surfaces of the two count as their closest points on the simplified one.

    Args:
        preview: of the full mesh.
        distance: a spectral one.
        coordinates: the name of the barycentric coordinates.
    """

    def __init__(self, preview: Preview, distance: Distance, coordinates: str = "mean_value") -> None:
        super().__init__(preview.small.mesh, distance, coordinates, spectrum=preview.spectrum)
        self.preview = preview

    @property
    def full_shape(self) -> Mesh:
        """The full mesh."""
        return self.preview.full

    @property
    def approximates(self) -> bool:
        """It does not: sampling a mesh so small exactly takes less than preparing a tree."""
        return False

    @property
    def description(self) -> str:
        """As of `InteriorDistance`, but for the modes that are left out, which the error knows."""
        return self.distance_kind.describe(replace(self.spectrum, bound=math.inf))

    def rows_between(self, ends: Ints, shares: Floats) -> Floats:
        """The basis at points of the full mesh's edges, (q, k); see `EmbeddedBoundary.rows_between`."""
        vertices, places = np.unique(ends, return_inverse=True)
        rows = self.preview.carrier(vertices) @ self.basis
        return (shares[:, :, None] * rows[places.reshape(ends.shape)]).sum(axis=1)

    def sample_steps(
        self, points: ArrayLike, rtol: float | None = None, weights: Floats | None = None
    ) -> Generator[float, None, Floats]:
        """As of `InteriorDistance`, and exact; (p, k), NaN for points outside both meshes."""
        points = as_points(points, 3)
        rows = yield from super().sample_steps(points, 0.0)
        missing = np.flatnonzero(~np.isfinite(rows).all(axis=1))
        if len(missing):
            matrix = self.preview.ground.project(points[missing]).matrix(self.shape)  # type: ignore[arg-type]
            off = np.linalg.norm(matrix @ self.shape.vertices - points[missing], axis=1)
            near = off <= SLACK * self.preview.gap
            rows[missing[near]] = (matrix @ self.basis)[near]
        return rows

    def barycentroid_steps(
        self, surrogate: Evaluate | None = None
    ) -> Generator[float | None, None, Barycentroid]:
        """As of `InteriorDistance`, to within a thousandth of the diagonal."""
        return barycentroid_steps(self.shape, self.potential_steps, LAST_RADIUS, surrogate)

    def keeps_inside(self, point: ArrayLike) -> bool:
        """Whether a point inside the simplified mesh is safely inside the full one."""
        landed = self.preview.ground.project([point]).matrix(self.shape) @ self.shape.vertices  # type: ignore[arg-type]
        return math.dist(landed[0], point) > SLACK * self.preview.gap  # type: ignore[arg-type]
