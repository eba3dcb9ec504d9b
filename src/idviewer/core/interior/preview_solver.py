"""The interior distance of a preview: a solver of the simplified mesh that answers for the full one."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Floats, Ints, as_points
from idviewer.core.coordinates import Coordinates, coordinates_of
from idviewer.core.coordinates.mean_value import MeanValueCoordinates
from idviewer.core.distances import Distance
from idviewer.core.interior.embedding import EmbeddedBoundary, PreparedBasis
from idviewer.core.interior.interpolation import BasisInterpolation
from idviewer.core.interior.preview import PREVIEW_SETTINGS, Preview
from idviewer.core.interior.solver import InteriorDistance, solver_of_parts
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.steps import finish


def preview_solver(preview: Preview, distance: Distance, coordinates: str = "mean_value") -> InteriorDistance:
    """The interior distance of a preview's simplified mesh, which answers for the full one.

    Args:
        preview: of the full mesh.
        distance: a spectral one.
        coordinates: the name of the barycentric coordinates.

    Raises:
        ValueError: there are no coordinates of that name.
    """
    boundary = PreviewBoundary(preview, distance)
    finish(boundary.prepare_steps())
    kind = coordinates_of(preview.small.mesh, coordinates)
    return solver_of_parts(boundary, PreviewInterpolation(preview, boundary, kind))


class PreviewBoundary(EmbeddedBoundary):
    """The boundary of a simplified mesh that answers for the full one.

    Args:
        preview: of the full mesh.
        distance: a spectral one.
        prepared: as of `EmbeddedBoundary`.
    """

    position_accuracy = PREVIEW_SETTINGS.position_accuracy

    def __init__(self, preview: Preview, distance: Distance, prepared: PreparedBasis | None = None) -> None:
        super().__init__(preview.small.mesh, distance, preview.spectrum, prepared)
        self._preview = preview

    @property
    def full_shape(self) -> Mesh:
        """The full mesh."""
        return self._preview.full

    @property
    def section_shape(self) -> Mesh:
        """The full mesh."""
        return self._preview.full

    def with_distance(self, distance: Distance) -> PreviewBoundary:
        """The same preview with another distance; see `EmbeddedBoundary.with_distance`."""
        return PreviewBoundary(self._preview, distance, self._prepared_for(distance))

    @property
    def description(self) -> str:
        """The distance's name and parameters in words; modes left out are part of the preview's error."""
        return self.distance.describe(replace(self.spectrum, bound=math.inf))

    def rows_between(self, ends: Ints, shares: Floats) -> Floats:
        """The basis (q, k) at points of the full mesh's edges; see `EmbeddedBoundary.rows_between`.

        Args:
            ends: (q, 2) vertices of the full mesh.
            shares: (q, 2) of each end.
        """
        vertices, places = np.unique(ends, return_inverse=True)
        rows = self._preview.transfer_matrix(vertices) @ self.basis
        return (shares[:, :, None] * rows[places.reshape(ends.shape)]).sum(axis=1)


class PreviewInterpolation(BasisInterpolation):
    """The basis of a simplified mesh at points inside the full one.

    Points between the surfaces of the two count as their closest points on the simplified one. All is exact:
    sampling a mesh so small takes less than preparing a tree.

    Args:
        preview: of the full mesh.
        boundary: the preview's.
        coordinates: the barycentric coordinates of the simplified mesh.
    """

    approximates = False

    def __init__(self, preview: Preview, boundary: EmbeddedBoundary, coordinates: Coordinates) -> None:
        super().__init__(boundary, coordinates)
        self._preview = preview

    def with_boundary(self, boundary: EmbeddedBoundary) -> PreviewInterpolation:
        """The same coordinates with another boundary of the same preview."""
        return PreviewInterpolation(self._preview, boundary, self.coordinates)

    def with_coordinates(self, coordinates: Coordinates) -> PreviewInterpolation:
        """The same boundary with other coordinates of the simplified mesh."""
        return PreviewInterpolation(self._preview, self.boundary, coordinates)

    def sample_steps(
        self, points: ArrayLike, rtol: float | None = None, weights: Floats | None = None
    ) -> Generator[float, None, Floats]:
        """Sample the basis at points, exactly; yields the share done every few milliseconds.

        Args:
            points: (p, 3).
            rtol, weights: not used; samples are exact.

        Returns:
            (p, k), NaN for points outside both meshes.

        Raises:
            ValueError: the points have another dimension.
        """
        points = as_points(points, 3)
        rows = yield from super().sample_steps(points, 0.0)
        missing = np.flatnonzero(~np.isfinite(rows).all(axis=1))
        if self.coordinates.undefined:  # not all are outside
            inside = MeanValueCoordinates(self.coordinates.shape).contains(points[missing])
            missing = missing[~inside]
        if len(missing):
            matrix = self._preview.projection.project(points[missing]).matrix(self._preview.small.mesh)
            off = np.linalg.norm(matrix @ self._preview.small.mesh.vertices - points[missing], axis=1)
            near = off <= PREVIEW_SETTINGS.gap_allowance * self._preview.gap
            rows[missing[near]] = (matrix @ self.boundary.basis)[near]
        return rows
