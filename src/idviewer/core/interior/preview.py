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

from idviewer.core.arrays import Floats, Ints
from idviewer.core.distances import Distance
from idviewer.core.interior.embedded_points import extent
from idviewer.core.shapes.closest_points import ClosestPointProjection
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.shape import Shape
from idviewer.core.shapes.simplification import Simplified, simplification_steps
from idviewer.core.spectrum.eigen_solver import Spectrum, eigenpair_steps
from idviewer.core.steps import map_steps

Made = TypeVar("Made")

SIMPLIFYING_STAGE, EIGENPAIRS_STAGE = "Simplifying the mesh", "Computing coarse eigenpairs"


@dataclass(frozen=True)
class PreviewSettings:
    """Settings of previews: their coarseness, and the safety of the estimate of their error.

    Attributes:
        least_vertices: meshes with fewer have no preview: their own eigenpairs take little longer.
        vertices: of the simplified mesh.
        coarser_vertices: of a still simpler mesh, which tells how much simplifying costs.
        negligible_weight: modes that weigh less than this share of the heaviest are left out.
        bound_margin: share of itself by which a mode may move across the bound when the mesh is simplified.
        coarser_values: eigenvalues of the simpler mesh are larger by less than this factor.
        error_share: share of the difference between the two simplified meshes that stands for the error.
        position_accuracy: share of the diagonal within which the barycentroid is looked for.
        error_pairs: pairs of vertices that tell the error.
        gap_vertices: vertices that tell how far the mesh lies from the simplified one.
        gap_allowance: points so many times as far off the simplified mesh as those vertices may still be in
            the full one.
    """

    least_vertices: int = 12_000
    vertices: int = 6000
    coarser_vertices: int = 1500
    negligible_weight: float = 0.01
    bound_margin: float = 0.02
    coarser_values: float = 1.1
    error_share: float = 2.0 / 3.0
    position_accuracy: float = 1e-3
    error_pairs: int = 4000
    gap_vertices: int = 5000
    gap_allowance: float = 2.0


PREVIEW_SETTINGS = PreviewSettings()

Steps = Generator[tuple[str, float | None], None, "Preview | None"]


@dataclass(frozen=True, eq=False)
class Preview:
    """Eigenpairs of a simplified mesh in the place of a mesh's own.

    Attributes:
        full: the mesh, of n vertices.
        small: the simplified mesh, of c vertices, and where those of the full one went.
        wide: of the simplified mesh, with the modes just beyond the bound too.
        coarser: as many eigenvalues of a still simpler mesh, its eigenvectors taken to the simplified one.
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
    def projection(self) -> ClosestPointProjection:
        """Closest-point projection of points near the simplified mesh onto it."""
        return ClosestPointProjection(self.small.mesh)

    @cached_property
    def spectrum(self) -> Spectrum:
        """Eigenpairs of the simplified mesh, c values a vector."""
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
        first, second = np.random.default_rng(0).integers(
            0, len(self.small.mesh.vertices), (2, PREVIEW_SETTINGS.error_pairs)
        )

        def apart(spectrum: Spectrum) -> Floats:
            rows = spectrum.vectors * distance.scale(spectrum)
            return np.linalg.norm(rows[first] - rows[second], axis=1)

        wide = apart(self.wide)
        simplifying = PREVIEW_SETTINGS.error_share * np.abs(wide - apart(self.coarser)).max()
        cutting = np.abs(
            wide - apart(_below(self.wide, (1.0 - PREVIEW_SETTINGS.bound_margin) * self.bound))
        ).max()
        largest = extent(self.wide.vectors * distance.scale(self.wide))
        return float((simplifying + cutting) / largest) + PREVIEW_SETTINGS.negligible_weight**2

    def transfer_matrix(self, vertices: Ints | None = None) -> csr_array:
        """Transfer matrix (v, c) from the simplified mesh's vertices to some or all of the full one's."""
        chosen = np.arange(len(self.full.vertices)) if vertices is None else vertices
        closest = self.projection.project(self.full.vertices[chosen], self.small.parents[chosen])
        return closest.matrix(self.small.mesh)

    def keeps_inside(self, point: ArrayLike) -> bool:
        """Whether a point inside the simplified mesh, (3,), is safely inside the full one."""
        mesh, row = self.small.mesh, np.reshape(point, (1, 3))
        closest = self.projection.project(row).matrix(mesh) @ mesh.vertices
        return math.dist(closest[0], row[0]) > PREVIEW_SETTINGS.gap_allowance * self.gap


def is_worth_previewing(shape: Shape) -> bool:
    """Whether a shape's eigenpairs take so long that a picture without them is welcome.

    >>> from idviewer.core import Polygon
    >>> is_worth_previewing(Polygon([[0, 0], [1, 0], [0, 1]]))
    False
    """
    return isinstance(shape, Mesh) and len(shape.vertices) >= PREVIEW_SETTINGS.least_vertices


def preview_cutoff(distance: Distance) -> Callable[[float], float]:
    """The bound of the eigenvalues that count in a picture, as a function of lambda_2.

    >>> from idviewer.core import Diffusion
    >>> preview_cutoff(Diffusion())(1.0) < Diffusion().cutoff(1.0)
    True
    """

    def bound(lambda_2: float) -> float:
        last = distance.cutoff(lambda_2)
        values = np.geomspace(lambda_2, max(last, lambda_2), 200)
        empty = np.empty((0, len(values)))
        weights = np.abs(distance.scale(Spectrum(values, empty, np.empty(0), 0.0, last)))
        counting = np.flatnonzero(weights >= PREVIEW_SETTINGS.negligible_weight * weights.max())
        return last if len(counting) == 0 else float(values[min(counting[-1] + 1, len(values) - 1)])

    return bound


def preview_steps(mesh: Mesh, cutoff: Callable[[float], float]) -> Steps:
    """Make a preview of a mesh, or None where it would not pay or not be right.

    Yields the stage, and the share of it that is done or None, every few milliseconds.

    Args:
        mesh: n vertices.
        cutoff: from lambda_2 to the bound of the eigenvalues kept.
    """
    if not is_worth_previewing(mesh):
        return None
    small = yield from _with_stage(SIMPLIFYING_STAGE, simplification_steps(mesh, PREVIEW_SETTINGS.vertices))
    if len(small.mesh.vertices) > 0.75 * len(mesh.vertices):
        return None
    wide = yield from _with_stage(
        EIGENPAIRS_STAGE,
        eigenpair_steps(
            small.mesh, lambda lambda_2: (1.0 + PREVIEW_SETTINGS.bound_margin) * cutoff(lambda_2)
        ),
    )
    fewer = yield from _with_stage(
        EIGENPAIRS_STAGE, simplification_steps(small.mesh, PREVIEW_SETTINGS.coarser_vertices)
    )
    most = PREVIEW_SETTINGS.coarser_values * float(wide.values[-1])
    coarse = yield from _with_stage(EIGENPAIRS_STAGE, eigenpair_steps(fewer.mesh, lambda _: most))
    closest = ClosestPointProjection(fewer.mesh).project(small.mesh.vertices, fewer.parents)
    count = len(wide.values)
    coarser = replace(
        coarse,
        values=coarse.values[:count],
        vectors=closest.matrix(fewer.mesh) @ coarse.vectors[:, :count],
    )
    preview = Preview(mesh, small, wide, coarser, cutoff(float(wide.values[0])), 0.0)
    some = np.arange(0, len(mesh.vertices), -(-len(mesh.vertices) // PREVIEW_SETTINGS.gap_vertices))
    off = preview.transfer_matrix(some) @ small.mesh.vertices - mesh.vertices[some]
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


def _with_stage(
    stage: str, steps: Generator[float | None, None, Made]
) -> Generator[tuple[str, float | None], None, Made]:
    return map_steps(lambda share: (stage, share), steps)
