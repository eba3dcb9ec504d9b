"""The vertices of a boundary, embedded so that a distance between them becomes Euclidean."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array

from idviewer.core.arrays import Floats, Ints
from idviewer.core.distances import Distance, QuadraticForm, check_dimension
from idviewer.core.distances.value_range import check_range
from idviewer.core.interior.barycentroid import SEARCH
from idviewer.core.interior.embedded_points import squares_of
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum, eigenpair_steps
from idviewer.core.spectrum.laplacian import masses_of
from idviewer.core.spectrum.resolution import Resolved
from idviewer.core.steps import finish


@dataclass(frozen=True, eq=False)
class PreparedBasis:
    """The basis of an embedding, and what is known of it.

    Attributes:
        columns: (n, k), read-only.
        mean: (k,) the area-weighted mean of the rows.
        remark: on the embedding; empty where it is exact.
    """

    columns: Floats
    mean: Floats
    remark: str

    @cached_property
    def reach(self) -> Floats:
        """Largest absolute entry of each column, (k,)."""
        return np.maximum(self.columns.max(axis=0), -self.columns.min(axis=0))


class EmbeddedBoundary:
    """A boundary's vertices embedded by a distance: eigenpairs, basis and scale, each made when needed.

    Args:
        shape: n vertices, in 2 or 3 dimensions.
        distance: the boundary distance.
        spectrum: eigenpairs computed before, to save computing them again.
        prepared: the basis of a boundary that `shares_basis` with this one.
        resolved: how the shape came of the one that was given; it is the given one by default.

    Raises:
        ValueError: the distance does not work in the shape's dimension.

    >>> from idviewer.core import Euclidean, Polygon
    >>> square = Polygon([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> EmbeddedBoundary(square, Euclidean()).embedding.tolist()
    [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]]
    """

    position_accuracy: float = SEARCH.last_radius
    """Share of the diagonal within which the barycentroid is looked for."""

    def __init__(
        self,
        shape: Shape,
        distance: Distance,
        spectrum: Spectrum | None = None,
        prepared: PreparedBasis | None = None,
        resolved: Resolved | None = None,
    ) -> None:
        check_dimension(distance, shape)
        self.shape, self.distance = shape, distance
        self.resolved = Resolved.unrefined(shape) if resolved is None else resolved
        self._spectrum, self._prepared = spectrum, prepared

    @property
    def full_shape(self) -> Shape:
        """The shape that is shown; what is computed on may be finer, or in a preview simpler."""
        return self.resolved.given

    @property
    def section_shape(self) -> Shape:
        """The shape that sections are cut from, whose edges `rows_between` knows."""
        return self.shape

    def with_distance(self, distance: Distance) -> EmbeddedBoundary:
        """The same boundary with another distance, with the same basis where both have it in common."""
        prepared = self._prepared_for(distance)
        return EmbeddedBoundary(self.shape, distance, self._spectrum, prepared, self.resolved)

    def shares_basis(self, distance: Distance) -> bool:
        """Whether samples of the basis serve another distance too."""
        if self._spectrum is None and distance.spectral:
            return False
        return distance.basis_key == self.distance.basis_key

    def _prepared_for(self, distance: Distance) -> PreparedBasis | None:
        return self._prepared if self.shares_basis(distance) else None

    @property
    def prepared(self) -> bool:
        """Whether the basis is there."""
        return self._prepared is not None

    def prepare_steps(self) -> Generator[float | None, None, None]:
        """Make the basis where it is not there yet, as a generator.

        Whatever needs the basis does so at its first use.
        """
        if self._prepared is not None:
            return
        if self._spectrum is None and self.distance.spectral:
            estimate = self.resolved.lambda_2
            self._spectrum = yield from eigenpair_steps(self.shape, self.distance.cutoff, estimate)
        basis = yield from self.distance.basis_steps(self.shape, self._spectrum)
        basis.columns.setflags(write=False)
        mean = (self.masses @ basis.columns) / self.masses.sum()
        self._prepared = PreparedBasis(basis.columns, mean, basis.remark)

    def _basis(self) -> PreparedBasis:
        finish(self.prepare_steps())
        assert self._prepared is not None
        return self._prepared

    @cached_property
    def masses(self) -> Floats:
        """Each vertex's share (n,) of the boundary, in the shape's unit squared, or length in the plane."""
        return masses_of(self.shape) if self._spectrum is None else self._spectrum.masses

    @cached_property
    def form(self) -> QuadraticForm | None:
        """The quadratic form that does without an embedding, where the distance has one."""
        return self.distance.form(self.shape)

    @property
    def basis(self) -> Floats:
        """Columns (n, k) that are sampled inside; times `scale` they are the embedding. Read-only."""
        return self._basis().columns

    @cached_property
    def scale(self) -> Floats:
        """Factors (k,) of the columns of the basis, or (1,) for all of them.

        Raises:
            DistanceError: distances leave the range of floats, or the distance does not fit the eigenpairs.
        """
        if self.distance.spectral:
            finish(self.prepare_steps())
        scale = self.distance.scale(self._spectrum)
        if self._prepared is not None:
            check_range(self.distance, scale, self._prepared.reach, self._spectrum)
        return scale

    @property
    def barycentroid_remark(self) -> str:
        """A sentence where too few modes count for the barycentroid to be found accurately; else empty.

        U^2 is then a valley too flat along to search: see `SearchSettings.least_curvature`.
        """
        if not self.distance.spectral:
            return ""
        weights = np.sort(np.abs(self.scale) * self._basis().reach)[::-1]
        counting = int(np.count_nonzero(weights > np.sqrt(SEARCH.least_curvature) * weights[0]))
        if counting >= self.shape.dimension:
            return ""
        modes = "mode counts" if counting == 1 else "modes count"
        return (
            f"Only {counting} {modes} with these parameters, so the barycentroid is not determined accurately"
        )

    @property
    def embedding(self) -> Floats:
        """Embedded vertices v_i*, (n, k)."""
        return self.basis * self.scale

    @property
    def centre(self) -> Floats:
        """Area-weighted mean (k,) of the embedded vertices."""
        return self._basis().mean * self.scale

    def squares(self) -> Floats:
        """D (n, n), squared distances between the vertices: given, or else of the embedding."""
        given = self.distance.squares(self.shape)
        return squares_of(self.embedding) if given is None else given

    def rows_between(self, ends: Ints, shares: Floats) -> Floats:
        """The basis at points of the boundary's edges, (q, k).

        Args:
            ends: (q, 2) vertices of the section shape.
            shares: (q, 2) of each end.
        """
        count = len(self.basis)
        starts = np.arange(0, ends.size + 1, ends.shape[1])
        matrix = csr_array((shares.ravel(), ends.ravel(), starts), shape=(len(ends), count))
        return matrix @ self.basis

    @property
    def spectrum(self) -> Spectrum:
        """The eigenpairs used: .values (k,), .vectors (n, k).

        Raises:
            ValueError: the distance uses none.
        """
        if self._spectrum is None or not self.distance.spectral:
            raise ValueError(f"the {self.distance.title.lower()} uses no eigenpairs")
        return self._spectrum

    @property
    def description(self) -> str:
        """The distance's name and parameters in words, and a remark on its embedding."""
        words = self.distance.describe(self._spectrum)
        return f"{words}; {self._prepared.remark}" if self._prepared and self._prepared.remark else words
