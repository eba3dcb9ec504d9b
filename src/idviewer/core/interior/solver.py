"""The interior distance: a boundary embedding interpolated inside by barycentric coordinates."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from idviewer.core.arrays import Floats
from idviewer.core.coordinates import Coordinates, coordinates_of
from idviewer.core.distances import Diffusion, Distance
from idviewer.core.interior.assembly import part_steps, serves
from idviewer.core.interior.barycentroid import Barycentroid, Evaluate, barycentroid_steps
from idviewer.core.interior.embedding import EmbeddedBoundary
from idviewer.core.interior.interpolation import BasisInterpolation
from idviewer.core.interior.point_placement import evaluate_placed, place_points
from idviewer.core.shapes.shape import Shape, ShapeLike
from idviewer.core.spectrum.eigen_solver import Spectrum
from idviewer.core.spectrum.resolution import Refine, Resolved
from idviewer.core.steps import finish


class InteriorDistance:
    """Distances between points inside a shape.

    The vertices are embedded so that their distances become Euclidean, v_i -> v_i*; an inner point goes
    to p* = sum_i w_i(p) v_i* with barycentric coordinates w; and d(p, q) = |p* - q*|. Source: Rustamov,
    Lipman and Funkhouser 2009, eq. 1; for eq. 2, 4 and 5 see `idviewer.core.interior.equations`.

    Args:
        shape: n vertices, in 2 or 3 dimensions, or its arrays (see `idviewer.core.shapes.shape`).
        distance: the boundary distance, the diffusion distance by default.
        coordinates: the name of the barycentric coordinates.
        rtol: largest error of distances between embedded points, as a share of the largest boundary
            distance; 0 is exact, and so are coordinates without an approximation. See docs/treecode.md.
        spectrum: eigenpairs computed before, to save computing them again; nothing is refined then.
        refine: "auto" cuts edges that are too long for the modes that count (see
            `idviewer.core.spectrum.resolution`), without moving the boundary; "no" leaves it as it is; or the
            longest edge allowed; or what `boundary_steps` made of the shape, with the spectrum of that.
            Euclidean and given distances need none of it.

    Attributes:
        boundary: the embedded vertices, with .distance, .basis (n, k), .scale (k,), .embedding (n, k), and
            .full_shape, the shape that was given.
        interpolation: of the basis inside, with steps for work that is to be interrupted.

    Raises:
        ValueError: unknown coordinates, a negative rtol, or what does not fit the shape.
        ShapeError: the distance asks for more eigenpairs than the shape has.

    >>> from idviewer.core import Euclidean, Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> solver = InteriorDistance(tetrahedron, distance=Euclidean())
    >>> solver.distance([[0.1, 0.1, 0.1]], [[0.4, 0.5, 0.1]]).round(12).tolist()
    [0.5]
    >>> solver.boundary.basis.shape, solver.interpolation.rtol
    ((4, 3), 0.0)
    """

    def __init__(
        self,
        shape: ShapeLike,
        distance: Distance | None = None,
        coordinates: str = "mean_value",
        rtol: float = 0.0,
        spectrum: Spectrum | None = None,
        refine: Refine | Resolved = "auto",
    ) -> None:
        distance = Diffusion() if distance is None else distance
        parts = finish(part_steps(shape, distance, coordinates, rtol, spectrum, refine))
        self.boundary: EmbeddedBoundary
        self.interpolation: BasisInterpolation
        self.boundary, self.interpolation = parts
        if self.boundary.form is None:
            finish(self.boundary.prepare_steps())

    @property
    def shape(self) -> Shape:
        """The shape that is computed on: the given one, refined where need be; a preview's is simplified.

        >>> from idviewer.core import Euclidean, Polygon
        >>> InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean()).shape.dimension
        2
        """
        return self.boundary.shape

    @property
    def coordinates(self) -> Coordinates:
        """The barycentric coordinates, which have weights, and how negative they are.

        >>> from idviewer.core import Euclidean, Polygon
        >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
        >>> solver.coordinates.weights([[2.0, 2.0]]).round(12).tolist()
        [[0.25, 0.25, 0.25, 0.25]]
        """
        return self.interpolation.coordinates

    @property
    def spectrum(self) -> Spectrum:
        """The eigenpairs used: .values (k,), .vectors (n, k).

        Raises:
            ValueError: the distance uses none.

        >>> from idviewer.core import read_mesh, sample_path
        >>> InteriorDistance(read_mesh(sample_path("hand_2k"))).spectrum.vectors.shape
        (2500, 77)
        """
        return self.boundary.spectrum

    @property
    def description(self) -> str:
        """The distance's name and parameters in words, and a remark on its embedding.

        >>> from idviewer.core import Euclidean, Polygon
        >>> InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean()).description
        'Euclidean distance'
        """
        return self.boundary.description

    def with_distance(self, distance: Distance) -> InteriorDistance:
        """The same interior with another distance, which shares whatever it can.

        Distances with the same basis (all spectral ones) differ in the scale alone, so samples taken for
        one serve the others. Eigenpairs that are there are used again, also where a shorter diffusion time
        asks for more of them: the description then says what is missing.

        Raises:
            ValueError: the distance does not fit the shape.

        >>> from idviewer.core import Biharmonic, read_mesh, sample_path
        >>> solver = InteriorDistance(read_mesh(sample_path("hand_2k")))
        >>> solver.with_distance(Biharmonic()).boundary.basis is solver.boundary.basis
        True
        """
        old = self.boundary
        if not serves(old, distance):
            name, rtol = self.coordinates.name, self.interpolation.rtol
            return InteriorDistance(old.full_shape, distance, name, rtol, refine=old.resolved.option)
        boundary = old.with_distance(distance)
        if boundary.form is None:
            finish(boundary.prepare_steps())
        _ = boundary.scale  # refuses parameters that do not fit the eigenpairs
        return solver_of_parts(boundary, self.interpolation.with_boundary(boundary))

    def with_coordinates(self, name: str) -> InteriorDistance:
        """The same embedded boundary with the coordinates of that name.

        Raises:
            ValueError: there are none of that name, or they do not work in the shape's dimension.

        >>> from idviewer.core import Euclidean, Polygon
        >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
        >>> solver.with_coordinates("shepard").coordinates.name
        'shepard'
        """
        coordinates = coordinates_of(self.shape, name)
        return solver_of_parts(self.boundary, self.interpolation.with_coordinates(coordinates))

    def embed(self, points: ArrayLike) -> Floats:
        """Map points into the embedding, p* = sum_i w_i(p) v_i*.

        Args:
            points: (p, dimension).

        Returns:
            (p, k), NaN for points outside the shape.

        Raises:
            ValueError: the points have another dimension.

        >>> from idviewer.core import Euclidean, Polygon
        >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
        >>> solver.embed([[1, 2], [5, 5]]).round(12).tolist()
        [[-1.0, 0.0], [nan, nan]]
        """
        samples = evaluate_placed(self.coordinates, self.interpolation.sample_steps, points)
        return samples * self.boundary.scale

    def distance(self, p: ArrayLike, q: ArrayLike) -> Floats:
        """Interior distance by eq. 1, |p* - q*|; where the distance knows a way past p*, by that.

        Args:
            p, q: (p, dimension) or (1, dimension).

        Returns:
            (p,), NaN where a point is outside the shape.

        Raises:
            ValueError: the points have another dimension, or there are not as many of both.

        >>> from idviewer.core import CommuteTime, Polygon
        >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), CommuteTime())
        >>> solver.distance([[2, 2]], [[2, 2], [5, 5]]).tolist()
        [0.0, nan]
        """
        return evaluate_placed(self.coordinates, self.interpolation.distance_steps, p, q)

    def field(self, source: ArrayLike, points: ArrayLike) -> Floats:
        """Distances from one source to many points.

        Args:
            source: (dimension,).
            points: (p, dimension).

        Returns:
            (p,), NaN for points outside the shape.

        Raises:
            ValueError: the points have another dimension.

        >>> from idviewer.core import Euclidean, Polygon
        >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
        >>> solver.field([1, 1], [[3, 1], [1, 2]]).round(12).tolist()
        [2.0, 1.0]
        """
        return self.distance(points, np.atleast_2d(source))

    def potential(self, points: ArrayLike) -> Floats:
        """U(p), whose smallest value marks the barycentroid.

        The area-weighted mean of d^2(p, v_i) is U^2(p) plus a constant. U^2 = |p* - c|^2, c the
        area-weighted mean of the v_i*; for spectral distances c = 0 and U^2 = w^T A w. Source: section 7.

        Args:
            points: (p, dimension).

        Returns:
            (p,), NaN for points outside the shape.

        Raises:
            ValueError: the points have another dimension.

        >>> from idviewer.core import Euclidean, Polygon
        >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
        >>> solver.potential([[2, 2], [2, 3]]).round(12).tolist()
        [0.0, 1.0]
        """
        return evaluate_placed(self.coordinates, self.interpolation.potential_steps, points)

    def barycentroid(self) -> Barycentroid:
        """The point inside where the potential is smallest; see `idviewer.core.interior.barycentroid`.

        Raises:
            ShapeError: no point inside could be found.

        >>> from idviewer.core import Euclidean, Polygon
        >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
        >>> solver.barycentroid().point.round(5).tolist()
        [2.0, 2.0]
        """
        return finish(self.barycentroid_steps())

    def barycentroid_steps(
        self, surrogate: Evaluate | None = None
    ) -> Generator[float | None, None, Barycentroid]:
        """`barycentroid` as a generator that yields the share done, or None; for `surrogate` see there.

        >>> from idviewer.core import Euclidean, Polygon
        >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
        >>> finish(solver.barycentroid_steps()).point.round(5).tolist()
        [2.0, 2.0]
        """
        potential, radius = self.interpolation.potential_steps, self.boundary.position_accuracy
        return barycentroid_steps(self.shape, potential, radius, surrogate)

    def negativity(self, points: ArrayLike) -> Floats:
        """Sum of the negative weights of points (p, dimension), as `Coordinates.negativity` has it, (p,).

        >>> from idviewer.core import Euclidean, Polygon
        >>> InteriorDistance(Polygon([[0, 0], [4, 0], [0, 4]]), Euclidean()).negativity([[1, 2]]).tolist()
        [0.0]
        """
        return self.coordinates.negativity(points)

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Tell which of points (p, dimension) lie inside the shape or on its boundary (1e-5 diagonals), (p,).

        Raises:
            ValueError: the points have another dimension.

        >>> from idviewer.core import Euclidean, Polygon
        >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
        >>> solver.contains([[1, 1], [4, 1], [5, 1]]).tolist()
        [True, True, False]
        """
        placed = place_points(self.coordinates, points)
        contained = np.ones(len(placed.points), dtype=bool)
        contained[placed.outside] = False
        return contained


def solver_of_parts(boundary: EmbeddedBoundary, interpolation: BasisInterpolation) -> InteriorDistance:
    """Assemble a solver of a boundary and an interpolation that are there already; prepares nothing."""
    solver = InteriorDistance.__new__(InteriorDistance)
    solver.boundary, solver.interpolation = boundary, interpolation
    return solver
