"""The interior distance: a boundary embedding carried inside by barycentric coordinates."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from copy import copy
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from idviewer.core.arrays import Floats, as_pairs, as_points
from idviewer.core.coordinates import coordinates_of
from idviewer.core.coordinates.mean_value import MeanValueCoordinates
from idviewer.core.coordinates.tolerance import Approximation
from idviewer.core.distances import Diffusion, Distance
from idviewer.core.interior.barycentroid import Barycentroid, Evaluate, barycentroid_steps
from idviewer.core.interior.embedding import EmbeddedBoundary
from idviewer.core.interior.equations import by_expansion, by_form_steps, by_gram, by_squares, column_weights
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum
from idviewer.core.steps import finish

OF_A_POINT = 0.5
"""Part of a distance's error that each of its ends may cause."""

NUMBERS_AT_A_TIME = 2**21
"""Weights between two checkpoints."""


class InteriorDistance(EmbeddedBoundary):
    """Distances between points inside a shape.

    The vertices are embedded so that their distances become Euclidean, v_i -> v_i*; an inner point goes
    to p* = sum_i w_i(p) v_i* with barycentric coordinates w; and d(p, q) = |p* - q*|. Source: Rustamov,
    Lipman and Funkhouser 2009, eq. 1.

    Args:
        shape: n vertices, in 2 or 3 dimensions.
        distance: the boundary distance, the diffusion distance by default.
        coordinates: the name of the barycentric coordinates.
        rtol: largest error of distances between embedded points, as a share of the largest boundary
            distance; 0 is exact, and so are coordinates without an approximation. See docs/treecode.md.
        spectrum: eigenpairs computed before, to save computing them again.

    Raises:
        ValueError: unknown coordinates, a negative rtol, or what does not fit the shape.
        ShapeError: the distance asks for more eigenpairs than the shape carries.

    >>> from idviewer.core import Euclidean, Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> solver = InteriorDistance(tetrahedron, distance=Euclidean())
    >>> solver.distance([[0.1, 0.1, 0.1]], [[0.4, 0.5, 0.1]]).round(12).tolist()
    [0.5]
    """

    def __init__(
        self,
        shape: Shape,
        distance: Distance | None = None,
        coordinates: str = "mean_value",
        rtol: float = 0.0,
        spectrum: Spectrum | None = None,
    ) -> None:
        self._assign(shape, distance, coordinates, rtol, spectrum)
        if self._form is None:
            finish(self.prepare_steps())

    def _assign(
        self, shape: Shape, kind: Distance | None, coordinates: str, rtol: float, spectrum: Spectrum | None
    ) -> None:
        if not 0.0 <= rtol < 1.0:
            raise ValueError(f"rtol must lie in [0, 1), not {rtol}")
        EmbeddedBoundary.__init__(self, shape, Diffusion() if kind is None else kind, spectrum)
        self.rtol = rtol
        self.coordinates = coordinates_of(shape, coordinates)
        self._approximations: dict[bytes, Approximation | None] = {}

    @classmethod
    def steps(
        cls,
        shape: Shape,
        distance: Distance,
        coordinates: str = "mean_value",
        spectrum: Spectrum | None = None,
    ) -> Generator[float | None, None, InteriorDistance]:
        """The constructor as a generator that yields the share done, or None, every few milliseconds."""
        made = cls.__new__(cls)
        made._assign(shape, distance, coordinates, 0.0, spectrum)
        yield from made.prepare_steps()
        return made

    def with_distance(self, distance: Distance) -> InteriorDistance:
        """The same interior with another distance, which shares whatever it can.

        Distances with the same basis (all spectral ones) differ in the scale alone, so samples taken for
        one serve the others. Eigenpairs that are there are used again, also where a shorter diffusion time
        asks for more of them: the description then says what is missing.

        >>> from idviewer.core import Biharmonic, read_mesh, sample_path
        >>> solver = InteriorDistance(read_mesh(sample_path("hand_2k")))
        >>> solver.with_distance(Biharmonic()).basis is solver.basis
        True
        """
        if not self.shares_basis(distance):
            return InteriorDistance(self.shape, distance, self.coordinates.name, self.rtol, self._spectrum)
        other = copy(self)
        other.distance_kind = distance
        for name in ("_form", "_own_weights"):
            other.__dict__.pop(name, None)
        other.scale = distance.scale(self._spectrum)
        return other

    def with_coordinates(self, name: str) -> InteriorDistance:
        """The same embedded boundary with the coordinates of that name.

        Raises:
            ValueError: there are none of that name, or they do not work in the shape's dimension.
        """
        other = copy(self)
        other.coordinates = coordinates_of(self.shape, name)
        other._approximations = {}
        return other

    def embed(self, points: ArrayLike) -> Floats:
        """Points carried into the embedding, p* = sum_i w_i(p) v_i*.

        Args:
            points: (p, dimension).

        Returns:
            (p, k), NaN for points outside the shape.
        """
        return finish(self.sample_steps(points)) * self.scale

    def sample_steps(
        self, points: ArrayLike, rtol: float | None = None, weights: Floats | None = None
    ) -> Generator[float, None, Floats]:
        """The basis at points before it is scaled; yields the share done every few milliseconds.

        Args:
            points: (p, dimension).
            rtol: as for the class; the solver's own by default.
            weights: from `error_weights`; the solver's own distance by default.

        Returns:
            (p, k), NaN for points outside the shape.
        """
        points, rtol = as_points(points, self.shape.dimension), self.rtol if rtol is None else rtol
        approximation = None if rtol == 0.0 else self._approximation(weights)
        if approximation is None:
            return (yield from self.coordinates.interpolate_steps(points, self.basis))
        return (yield from approximation.interpolate_steps(points, OF_A_POINT * rtol))

    def error_weights(self, distances: Iterable[Distance] = ()) -> Floats:
        """What an error of each column of the basis counts, (k,), in largest boundary distances.

        Args:
            distances: others with the same basis that samples are to serve as well.
        """
        scales = (self.scale, *(distance.scale(self._spectrum) for distance in distances))
        return column_weights(self.basis, scales)

    @property
    def approximates(self) -> bool:
        """Whether the coordinates can be evaluated within a tolerance."""
        return self.coordinates.approximation(self.basis, np.ones(self.basis.shape[1])) is not None

    def _approximation(self, weights: Floats | None) -> Approximation | None:
        weights = self._own_weights if weights is None else weights
        key = weights.tobytes()
        if key not in self._approximations:
            full = np.broadcast_to(weights, self.basis.shape[1:])
            self._approximations[key] = self.coordinates.approximation(self.basis, full)
        return self._approximations[key]

    _own_weights = cached_property(error_weights)

    def distance(self, p: ArrayLike, q: ArrayLike) -> Floats:
        """Interior distance by eq. 1, |p* - q*|; where the distance knows a way past p*, by that.

        Args:
            p, q: (p, dimension) or (1, dimension).

        Returns:
            (p,), NaN where a point is outside the shape.
        """
        first, second = as_pairs(p, q, self.shape.dimension)
        if self._form is not None:
            few, many = sorted((first, second), key=len)  # symmetric, so the longer list goes in portions
            ends = (lambda part: few) if len(few) == 1 else (lambda part: few[part])
            return finish(self._form_steps(many, lambda part: self.coordinates.weights(ends(part))))
        return np.linalg.norm(self.embed(first) - self.embed(second), axis=1)

    def gram_distance(self, p: ArrayLike, q: ArrayLike) -> Floats:
        """Interior distance by eq. 2, the quadratic form of w(p) - w(q) with the Gram matrix A = Y^T Y.

        The same number as `distance` by another route. A is applied, never formed.

        Args:
            p, q: (p, dimension) or (1, dimension).

        Returns:
            (p,), NaN where a point is outside the shape.
        """
        first, second = map(self.coordinates.weights, as_pairs(p, q, self.shape.dimension))
        return by_gram(first - second, self.vertex_embedding)

    def pairwise_distance(
        self, p: ArrayLike, q: ArrayLike, squares: Floats | None = None, expanded: bool = False
    ) -> Floats:
        """Interior distance by eq. 4, or eq. 5, from the distances between the vertices and no embedding.

        Args:
            p, q: (p, dimension) or (1, dimension).
            squares: (n, n) squared distances between the vertices; `boundary_squares` by default.
            expanded: eq. 5, the sums written out, instead of eq. 4.

        Returns:
            (p,), NaN where a point is outside the shape, 0 where squares of what does not embed are negative.
        """
        squares = self.boundary_squares() if squares is None else squares
        first, second = map(self.coordinates.weights, as_pairs(p, q, self.shape.dimension))
        if expanded:
            first, second = np.broadcast_arrays(first, second)
            return by_expansion(first, second, squares)
        return by_squares(first - second, squares)

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Which of the points (p, dimension) lie inside the shape or on its boundary."""
        ones, own = np.ones((len(self.shape.vertices), 1)), self.coordinates
        # Others may find no weights at a point inside.
        mean_value = own if isinstance(own, MeanValueCoordinates) else MeanValueCoordinates(self.shape)
        return np.isfinite(finish(mean_value.interpolate_steps(points, ones))[:, 0])

    def field(self, source: ArrayLike, points: ArrayLike) -> Floats:
        """Distances from one source to many points.

        Args:
            source: (dimension,).
            points: (p, dimension).

        Returns:
            (p,), NaN for points outside the shape.
        """
        return self.distance(points, np.atleast_2d(source))

    def potential(self, points: ArrayLike) -> Floats:
        """U(p), whose smallest value marks the barycentroid; section 7 of the paper.

        The area-weighted mean of d^2(p, v_i) is U^2(p) plus a constant. U^2 = |p* - c|^2, c the
        area-weighted mean of the v_i*; for spectral distances c = 0 and U^2 = w^T A w.

        Args:
            points: (p, dimension).

        Returns:
            (p,), NaN for points outside the shape.
        """
        return finish(self.potential_steps(points))

    def potential_steps(
        self, points: ArrayLike, rtol: float | None = None, weights: Floats | None = None
    ) -> Generator[float, None, Floats]:
        """`potential` as a generator that yields the share done every few milliseconds.

        Args:
            points: (p, dimension).
            rtol, weights: as for `sample_steps`.
        """
        if self._form is not None and self._basis is None:
            mean = self._masses / self._masses.sum()
            return (yield from self._form_steps(points, lambda part: mean))
        rows = yield from self.sample_steps(points, rtol=rtol, weights=weights)
        return np.linalg.norm(rows * self.scale - self.centre, axis=1)

    def negativity(self, points: ArrayLike) -> Floats:
        """sum_i max(0, -w_i(p)): 0 where all weights are non-negative, so that the maximum principle holds.

        Args:
            points: (p, dimension).

        Returns:
            (p,), NaN for points outside the shape.
        """
        return finish(self.coordinates.negativity_steps(points))

    def _form_steps(
        self, points: ArrayLike, others: Callable[[slice], Floats]
    ) -> Generator[float, None, Floats]:
        """sqrt(z^T A z) where z is the weights of points (p, dimension), less those of others."""
        points, form = as_points(points, self.shape.dimension), self._form
        assert form is not None
        size = max(1, NUMBERS_AT_A_TIME // len(self.shape.vertices))
        parts = [slice(start, start + size) for start in range(0, len(points), size)]
        differences = (self.coordinates.weights(points[part]) - others(part) for part in parts)
        return (yield from by_form_steps(differences, form))

    def barycentroid(self) -> Barycentroid:
        """The point inside where the potential is smallest; see `idviewer.core.interior.barycentroid`."""
        return finish(self.barycentroid_steps())

    def barycentroid_steps(
        self, surrogate: Evaluate | None = None
    ) -> Generator[float | None, None, Barycentroid]:
        """`barycentroid` as a generator that yields every few milliseconds.

        Args:
            scout: see `idviewer.core.interior.barycentroid`.
        """
        return barycentroid_steps(self.shape, self.potential_steps, surrogate=surrogate)
