"""The interior distance: a boundary embedding carried inside by barycentric coordinates."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from copy import copy
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from idviewer.core.approximation import Approximation
from idviewer.core.barycentroid import Barycentroid, barycentroid_steps
from idviewer.core.coordinates import coordinates_of
from idviewer.core.distances import Diffusion, Distance
from idviewer.core.laplacian import masses_of
from idviewer.core.mesh import Mesh
from idviewer.core.shape import as_points
from idviewer.core.spectrum import Spectrum, eigenpairs
from idviewer.core.steps import finish

Floats = NDArray[np.float64]

OF_A_POINT = 0.5
"""Part of a distance's error that each of its ends may cause."""


class InteriorDistance:
    """Distances between points inside a mesh.

    The vertices are embedded so that their distances become Euclidean, v_i -> v_i*; an inner point goes
    to p* = sum_i w_i(p) v_i* with barycentric coordinates w; and d(p, q) = |p* - q*|. Source: Rustamov,
    Lipman and Funkhouser 2009, eq. 1.

    Args:
        mesh: n vertices.
        distance: the boundary distance, the diffusion distance by default.
        coordinates: the name of the barycentric coordinates.
        rtol: largest error of distances between embedded points, as a share of the largest boundary
            distance; 0 is exact, and so are coordinates without an approximation. See docs/cluster_tree.md.
        spectrum: eigenpairs computed before, to save computing them again.

    Raises:
        ValueError: unknown coordinates, or ones for another dimension, or a negative rtol.
        MeshError: the distance asks for more eigenpairs than the mesh carries.

    >>> from idviewer.core import Euclidean, Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> solver = InteriorDistance(tetrahedron, distance=Euclidean())
    >>> solver.distance([[0.1, 0.1, 0.1]], [[0.4, 0.5, 0.1]]).round(12).tolist()
    [0.5]
    """

    def __init__(
        self,
        mesh: Mesh,
        distance: Distance | None = None,
        coordinates: str = "mean_value",
        rtol: float = 0.0,
        spectrum: Spectrum | None = None,
    ) -> None:
        if not 0.0 <= rtol < 1.0:
            raise ValueError(f"rtol must lie in [0, 1), not {rtol}")
        self.mesh = mesh
        self.distance_kind: Distance = Diffusion() if distance is None else distance
        self.rtol = rtol
        self.coordinates = coordinates_of(mesh, coordinates)
        if spectrum is None and self.distance_kind.spectral:
            spectrum = eigenpairs(mesh, self.distance_kind.cutoff)
        self._spectrum = spectrum
        self.basis = self.distance_kind.basis(mesh, spectrum)
        self.basis.setflags(write=False)
        masses = masses_of(mesh) if spectrum is None else spectrum.masses
        self._mean = (masses @ self.basis) / masses.sum()
        self._approximations: dict[bytes, Approximation | None] = {}
        self.scale = self.distance_kind.scale(spectrum)
        self.centre = self._mean * self.scale

    def with_distance(self, distance: Distance) -> InteriorDistance:
        """The same interior with another distance, which shares whatever it can.

        Distances with the same basis (all spectral ones) differ in the scale alone, so samples taken for
        one serve the others. Eigenpairs that are there are used again, also where a shorter diffusion time
        asks for more of them: the description then says what is missing.

        Args:
            distance: the boundary distance of the result.

        >>> from idviewer.core import Biharmonic, read_mesh, sample_path
        >>> solver = InteriorDistance(read_mesh(sample_path("hand_2k")))
        >>> solver.with_distance(Biharmonic()).basis is solver.basis
        True
        """
        if not self.shares_basis(distance):
            return InteriorDistance(self.mesh, distance, self.coordinates.name, self.rtol, self._spectrum)
        other = copy(self)
        other.distance_kind = distance
        other.scale = distance.scale(self._spectrum)
        other.centre = self._mean * other.scale
        other.__dict__.pop("_own_weights", None)
        return other

    def shares_basis(self, distance: Distance) -> bool:
        """Whether samples of the basis serve another distance too."""
        if self._spectrum is None and distance.spectral:
            return False
        basis = distance.basis(self.mesh, self._spectrum)
        return basis is self.basis or np.array_equal(basis, self.basis)

    @property
    def spectrum(self) -> Spectrum:
        """The eigenpairs used: .values (k,), .vectors (n, k)."""
        if self._spectrum is None or not self.distance_kind.spectral:
            raise ValueError(f"the {self.distance_kind.title.lower()} uses no eigenpairs")
        return self._spectrum

    @property
    def description(self) -> str:
        """The distance's name and parameters in words."""
        return self.distance_kind.describe(self._spectrum)

    @property
    def vertex_embedding(self) -> Floats:
        """(n, k) the embedded vertices v_i*."""
        return self.basis * self.scale

    def embed(self, points: ArrayLike) -> Floats:
        """Points carried into the embedding, p* = sum_i w_i(p) v_i*.

        Args:
            points: (p, 3).

        Returns:
            (p, k), NaN for points outside the mesh.
        """
        return finish(self.sample_steps(points)) * self.scale

    def sample_steps(
        self, points: ArrayLike, rtol: float | None = None, weights: Floats | None = None
    ) -> Generator[float, None, Floats]:
        """The basis at points before it is scaled; yields the share done every few milliseconds.

        Args:
            points: (p, 3).
            rtol: as for the class; the solver's own by default.
            weights: from `error_weights`; the solver's own distance by default.

        Returns:
            (p, k), NaN for points outside the mesh.
        """
        points, rtol = as_points(points, self.mesh.dimension), self.rtol if rtol is None else rtol
        approximation = None if rtol == 0.0 else self._approximation(weights)
        if approximation is None:
            return (yield from self.coordinates.interpolate_steps(points, self.basis))
        return (yield from approximation.interpolate_steps(points, OF_A_POINT * rtol))

    def error_weights(self, distances: Iterable[Distance] = ()) -> Floats:
        """What an error of each column of the basis counts, (k,), in largest boundary distances.

        Args:
            distances: others with the same basis that samples are to serve as well.
        """
        scales = [self.scale, *(distance.scale(self._spectrum) for distance in distances)]
        return np.max([np.abs(scale) / extent(self.basis * scale) for scale in scales], axis=0)

    def _approximation(self, weights: Floats | None) -> Approximation | None:
        weights = self._own_weights if weights is None else weights
        key = weights.tobytes()
        if key not in self._approximations:
            full = np.broadcast_to(weights, self.basis.shape[1:])
            self._approximations[key] = self.coordinates.approximation(self.basis, full)
        return self._approximations[key]

    @cached_property
    def _own_weights(self) -> Floats:
        return self.error_weights()

    def distance(self, p: ArrayLike, q: ArrayLike) -> Floats:
        """Interior distance by eq. 1, |p* - q*|.

        Args:
            p: (p, 3) or (1, 3).
            q: (p, 3) or (1, 3).

        Returns:
            (p,), NaN where a point is outside the mesh.
        """
        return np.linalg.norm(self.embed(p) - self.embed(q), axis=1)

    def gram_distance(self, p: ArrayLike, q: ArrayLike) -> Floats:
        """Interior distance by eq. 2, the quadratic form of w(p) - w(q) with the Gram matrix A = Y^T Y.

        The same number as `distance` by another route. A is applied, never formed.

        Args:
            p: (p, 3) or (1, 3).
            q: (p, 3) or (1, 3).

        Returns:
            (p,), NaN where a point is outside the mesh.
        """
        difference = self.coordinates.weights(p) - self.coordinates.weights(q)
        columns = self.vertex_embedding
        applied = (difference @ columns) @ columns.T
        return np.sqrt(np.maximum(np.einsum("pn,pn->p", difference, applied), 0.0))

    def field(self, source: ArrayLike, points: ArrayLike) -> Floats:
        """Distances from one source to many points.

        Args:
            source: (3,).
            points: (p, 3).

        Returns:
            (p,), NaN for points outside the mesh.
        """
        return np.linalg.norm(self.embed(points) - self.embed(np.reshape(source, (1, 3))), axis=1)

    def potential(self, points: ArrayLike) -> Floats:
        """U(p), whose smallest value marks the barycentroid; section 7 of the paper.

        The area-weighted mean of d^2(p, v_i) is U^2(p) plus a constant. U^2 = |p* - c|^2, c the
        area-weighted mean of the v_i*; for spectral distances c = 0 and U^2 = w^T A w.

        Args:
            points: (p, 3).

        Returns:
            (p,), NaN for points outside the mesh.
        """
        return finish(self.potential_steps(points))

    def potential_steps(self, points: ArrayLike) -> Generator[float, None, Floats]:
        """`potential` as a generator that yields the share done every few milliseconds."""
        samples = yield from self.sample_steps(points)
        return np.linalg.norm(samples * self.scale - self.centre, axis=1)

    def negativity(self, points: ArrayLike) -> Floats:
        """sum_i max(0, -w_i(p)): 0 where all weights are non-negative, so that the maximum principle holds.

        Args:
            points: (p, 3).

        Returns:
            (p,), NaN for points outside the mesh.
        """
        return finish(self.coordinates.negativity_steps(points))

    def barycentroid(self) -> Barycentroid:
        """The point inside where the potential is smallest; see `idviewer.core.barycentroid`."""
        return finish(self.barycentroid_steps())

    def barycentroid_steps(self) -> Generator[float | None, None, Barycentroid]:
        """`barycentroid` as a generator that yields every few milliseconds."""
        return barycentroid_steps(self.mesh, self.potential_steps)


def extent(points: Floats) -> float:
    """Nearly the largest distance between two of the points (p, k), never more.

    >>> extent(np.array([[0.0], [1.0], [3.0]]))
    3.0
    """
    farthest = points.mean(axis=0)
    for _ in range(3):
        distances = np.linalg.norm(points - farthest, axis=1)
        farthest = points[np.argmax(distances)]
    return float(distances.max())


def interior_distance(mesh: Mesh, p: ArrayLike, q: ArrayLike, distance: Distance | None = None) -> Floats:
    """Interior distances of point pairs; for many calls on one mesh keep an `InteriorDistance`.

    Args:
        mesh: n vertices.
        p: (p, 3) or (1, 3).
        q: (p, 3) or (1, 3).
        distance: the boundary distance, the diffusion distance by default.

    Returns:
        (p,), NaN where a point is outside the mesh.

    >>> from idviewer.core import read_mesh, sample_path
    >>> hand = read_mesh(sample_path("hand_2k"))
    >>> interior_distance(hand, hand.vertices[:1], hand.vertices[:1]).tolist()
    [0.0]
    """
    points = np.concatenate([as_points(p, mesh.dimension), as_points(q, mesh.dimension)])
    images = InteriorDistance(mesh, distance).embed(points)
    count = len(as_points(p, mesh.dimension))
    return np.linalg.norm(images[:count] - images[count:], axis=1)
