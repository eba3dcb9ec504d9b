"""Maximum entropy coordinates: never negative, and linearly precise, on convex and concave shapes."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core._kernels.mean_value.maximum_entropy import maximum_entropy
from idviewer.core.arrays import Floats, Ints, as_points, in_space
from idviewer.core.coordinates.mean_value import mean_value_on
from idviewer.core.coordinates.registry import Coordinates, Property, register_coordinates
from idviewer.core.shapes.shape import ShapeLike


@dataclass(frozen=True)
class MaximumEntropySettings:
    """Convergence criterion of maximum entropy coordinates.

    Attributes:
        largest_residual: of weights that are given out, the largest |sum w_i v_i - p| in diagonals of the
            bounding box.
    """

    largest_residual: float = 1e-11


class ConvergenceWarning(RuntimeWarning):
    """Weights of some points were not found; their rows are NaN."""


@register_coordinates
class MaximumEntropyCoordinates(Coordinates):
    """Evaluates maximum entropy coordinates of one shape.

    Of all weights that are not negative, add up to 1 and reproduce the point, they are those nearest to given
    priors m_i in the sense of relative entropy: w_i = m_i exp(-lambda . (v_i - p)) / Z with the lambda that
    minimises log Z. Priors that vanish on every edge or face away from its own vertices make them
    interpolate on the boundary. Source: Hormann and Sukumar 2008; priors in docs/coordinates.md.

    A point whose lambda is not found (none is known) gets a row of NaN, a `ConvergenceWarning` says so, and
    `unconverged` counts it. Others reproduce their point to `settings.largest_residual` diagonals.

    Args:
        shape: n vertices.

    Attributes:
        unconverged: how many points, of all so far, found no weights.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> MaximumEntropyCoordinates(tetrahedron).weights([[0.1, 0.2, 0.3]]).round(9).tolist()
    [[0.4, 0.1, 0.2, 0.3]]
    """

    name = "maximum_entropy"
    title = "Maximum entropy coordinates"
    menu_order = 20
    properties = frozenset(Property)
    pairs_per_step: ClassVar[float] = 1e5
    settings: ClassVar[MaximumEntropySettings] = MaximumEntropySettings()

    def __init__(self, shape: ShapeLike) -> None:
        super().__init__(shape)
        shape = self.shape
        self.unconverged = 0
        self._boundary = mean_value_on(shape)
        positions = self._boundary.normalise(shape.vertices)
        self._elements = self._boundary.elements
        constants = face_constants if shape.dimension == 3 else edge_constants
        self._constants = constants(positions, self._elements)
        self._vertices = np.ascontiguousarray(in_space(positions).T)

    def weights(self, points: ArrayLike) -> Floats:
        """Coordinates of points with respect to every vertex.

        Args:
            points: (p, dimension).

        Returns:
            (p, n) rows that sum to 1; NaN for points outside, and where none were found, which is told.

        Raises:
            ConvergenceWarning: some were not found, where warnings are errors.
        """
        places, classified, result = self._boundary.rows(as_points(points, self.shape.dimension))
        residuals, steps = np.empty(len(classified.inside)), np.empty(len(classified.inside), dtype=np.int64)
        maximum_entropy(
            np.ascontiguousarray(in_space(places)),
            classified.inside,
            self._vertices,
            self._elements,
            self._constants,
            result,
            residuals,
            steps,
        )
        self._check(residuals, classified.inside, result)
        return result

    def _check(self, residuals: Floats, inside: Ints, result: Floats) -> None:
        failed = ~(residuals <= self.settings.largest_residual)
        if failed.any():
            result[inside[failed]] = np.nan
            self.unconverged += int(failed.sum())
        if failed.any() and self.warns:
            worst = np.nanmax(residuals[failed], initial=0.0)
            warnings.warn(
                f"maximum entropy coordinates of {failed.sum()} points not found (sum w v misses p by up to "
                f"{worst:.0e} diagonals); their weights are NaN",
                ConvergenceWarning,
                stacklevel=3,
            )


def edge_constants(positions: Floats, edges: Ints) -> Floats:
    """Lengths (1, e) of a polygon's edges, given positions (n, 2) and edges (e, 2).

    >>> edge_constants(np.array([[0.0, 0.0], [3.0, 4.0]]), np.array([[0, 1]])).tolist()
    [[5.0]]
    """
    return np.linalg.norm(positions[edges[:, 1]] - positions[edges[:, 0]], axis=1)[None]


def face_constants(positions: Floats, faces: Ints) -> Floats:
    """Constants (20, m) of a mesh's faces for the kernel, given positions (n, 3) and faces (m, 3).

    The plane's normal and height; for each edge the plane across it in which the signed area of a projected
    triangle is linear, by normal and height; |e|^2 / 4 of each edge; and the area.

    >>> corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    >>> face_constants(corners, np.array([[0, 1, 2]]))[[2, -1], 0].tolist()
    [1.0, 0.5]
    """
    corners = positions[faces]
    sides = np.roll(corners, -1, axis=1) - corners
    normals = np.cross(sides[:, 0], -sides[:, 2])
    doubled = np.linalg.norm(normals, axis=1)
    # Faces without area have no weight, whatever their normal.
    normals /= np.where(doubled > 0.0, doubled, 1.0)[:, None]
    inward = 0.5 * np.cross(normals[:, None], sides)
    rows = [normals.T, np.einsum("fi,fi->f", normals, corners[:, 0])[None]]
    for k in range(3):
        rows += [inward[:, k].T, np.einsum("fi,fi->f", inward[:, k], corners[:, k])[None]]
    quarters = 0.25 * np.einsum("fki,fki->kf", sides, sides)
    return np.ascontiguousarray(np.concatenate([*rows, quarters, 0.5 * doubled[None]]))
