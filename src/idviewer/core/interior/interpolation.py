"""A boundary's embedding interpolated inside by barycentric coordinates, exactly or within a tolerance."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Floats, as_pairs, as_points
from idviewer.core.coordinates import Coordinates
from idviewer.core.coordinates.tolerance import Approximation
from idviewer.core.distances import Distance
from idviewer.core.interior.embedded_points import column_weights
from idviewer.core.interior.embedding import EmbeddedBoundary

ERROR_SHARE_OF_AN_END = 0.5
"""Part of a distance's error that each of its two ends may cause."""


class BasisInterpolation:
    """The basis of an embedded boundary interpolated inside: b(p) = sum_i w_i(p) b_i.

    Args:
        boundary: whose basis is interpolated.
        coordinates: the barycentric coordinates w.
        rtol: largest error of distances between embedded points, as a share of the largest boundary
            distance; 0 is exact.
        approximations: those of another interpolation of the same basis with the same coordinates, to share.

    Raises:
        ValueError: rtol is negative, or 1 or more.

    >>> from idviewer.core import Euclidean, MeanValueCoordinates, Polygon
    >>> from idviewer.core.steps import finish
    >>> square = Polygon([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> inside = BasisInterpolation(EmbeddedBoundary(square, Euclidean()), MeanValueCoordinates(square))
    >>> finish(inside.sample_steps([[1.0, 3.0]])).round(12).tolist()
    [[-1.0, 1.0]]
    """

    weights_per_step: ClassVar[int] = 2**21
    """Weights between two checkpoints where no embedding is interpolated."""

    def __init__(
        self,
        boundary: EmbeddedBoundary,
        coordinates: Coordinates,
        rtol: float = 0.0,
        approximations: dict[bytes, Approximation | None] | None = None,
    ) -> None:
        if not 0.0 <= rtol < 1.0:
            raise ValueError(f"rtol must lie in [0, 1), not {rtol}")
        self.boundary, self.coordinates, self.rtol = boundary, coordinates, rtol
        self._approximations = {} if approximations is None else approximations

    def with_boundary(self, boundary: EmbeddedBoundary) -> BasisInterpolation:
        """The same coordinates with another boundary; approximations are shared where the basis is."""
        shared = self._approximations if self.boundary.shares_basis(boundary.distance) else None
        return BasisInterpolation(boundary, self.coordinates, self.rtol, shared)

    def with_coordinates(self, coordinates: Coordinates) -> BasisInterpolation:
        """The same boundary with other coordinates."""
        return BasisInterpolation(self.boundary, coordinates, self.rtol)

    def sample_steps(
        self, points: ArrayLike, rtol: float | None = None, weights: Floats | None = None
    ) -> Generator[float, None, Floats]:
        """Sample the basis at points, before it is scaled; yields the share done every few milliseconds.

        Args:
            points: (p, dimension).
            rtol: as for the class; the interpolation's own by default.
            weights: from `error_weights`; those of the boundary's own distance by default.

        Returns:
            (p, k), NaN for points outside the shape.

        Raises:
            ValueError: the points have another dimension.
        """
        points = as_points(points, self.boundary.shape.dimension)
        rtol = self.rtol if rtol is None else rtol
        approximation = None if rtol == 0.0 else self._approximation(weights)
        if approximation is None:
            return (yield from self.coordinates.interpolate_steps(points, self.boundary.basis))
        return (yield from approximation.interpolate_steps(points, ERROR_SHARE_OF_AN_END * rtol))

    def distance_steps(self, p: ArrayLike, q: ArrayLike) -> Generator[float, None, Floats]:
        """Interior distances by eq. 1, |p* - q*|, or by eq. 2 where the distance has a quadratic form.

        Source: Rustamov, Lipman and Funkhouser 2009, eq. 1 and 2.

        Args:
            p, q: (p, dimension) or (1, dimension).

        Returns:
            (p,), NaN where a point is outside the shape.

        Raises:
            ValueError: the points have another dimension, or there are not as many of both.
        """
        first, second = as_pairs(p, q, self.boundary.shape.dimension)
        if self.boundary.form is not None:
            few, many = sorted((first, second), key=len)  # symmetric, so the longer list goes in portions
            ends = (lambda part: few) if len(few) == 1 else (lambda part: few[part])
            return (yield from self._form_steps(many, lambda part: self.coordinates.weights(ends(part))))
        start = (yield from self.sample_steps(first)) * self.boundary.scale
        end = (yield from self.sample_steps(second)) * self.boundary.scale
        return np.linalg.norm(start - end, axis=1)

    def potential_steps(
        self, points: ArrayLike, rtol: float | None = None, weights: Floats | None = None
    ) -> Generator[float, None, Floats]:
        """The potential U(p) = |p* - c|, c the mass-weighted mean of the v_i*; yields the share done.

        Source: Rustamov, Lipman and Funkhouser 2009, section 7.

        Args:
            points: (p, dimension).
            rtol, weights: as for `sample_steps`.

        Returns:
            (p,), NaN for points outside the shape.
        """
        if self.boundary.form is not None and not self.boundary.prepared:
            mean = self.boundary.masses / self.boundary.masses.sum()
            return (yield from self._form_steps(points, lambda part: mean))
        rows = yield from self.sample_steps(points, rtol=rtol, weights=weights)
        return np.linalg.norm(rows * self.boundary.scale - self.boundary.centre, axis=1)

    def _form_steps(
        self, points: ArrayLike, others: Callable[[slice], Floats]
    ) -> Generator[float, None, Floats]:
        """Eq. 2, sqrt(z^T A z), where z is the weights of points (p, dimension), less those of others."""
        shape, form = self.boundary.shape, self.boundary.form
        assert form is not None
        points = as_points(points, shape.dimension)
        size = max(1, self.weights_per_step // len(shape.vertices))
        squares = [np.empty(0)]
        for start in range(0, len(points), size):
            part = slice(start, start + size)
            differences = self.coordinates.weights(points[part]) - others(part)
            squares.append((yield from form.squares_steps(differences)))
        return np.sqrt(np.maximum(np.concatenate(squares), 0.0))

    def error_weights(self, distances: Iterable[Distance] = ()) -> Floats:
        """Weights (k,) of errors of the basis's columns, in largest boundary distances.

        Args:
            distances: others with the same basis that samples are to serve as well.
        """
        others = (self.boundary.with_distance(distance).scale for distance in distances)
        return column_weights(self.boundary.basis, (self.boundary.scale, *others))

    @property
    def approximates(self) -> bool:
        """Whether the coordinates can be evaluated within a tolerance."""
        basis = self.boundary.basis
        return self.coordinates.approximation(basis, np.ones(basis.shape[1])) is not None

    def _approximation(self, weights: Floats | None) -> Approximation | None:
        weights = self._own_weights if weights is None else weights
        key = weights.tobytes()
        if key not in self._approximations:
            basis = self.boundary.basis
            full = np.broadcast_to(weights, basis.shape[1:])
            self._approximations[key] = self.coordinates.approximation(basis, full)
        return self._approximations[key]

    @cached_property
    def _own_weights(self) -> Floats:
        return self.error_weights()
