"""The vertices of a boundary, embedded so that a distance between them becomes Euclidean."""

from __future__ import annotations

from collections.abc import Generator
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from idviewer.core.arrays import Floats
from idviewer.core.distances import Basis, Distance, QuadraticForm, check_dimension
from idviewer.core.interior.equations import squares_of
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum, eigenpair_steps
from idviewer.core.spectrum.laplacian import masses_of
from idviewer.core.steps import finish


class EmbeddedBoundary:
    """What an interior distance knows of the boundary: eigenpairs, basis and scale, each made when needed.

    Args:
        shape: n vertices, in 2 or 3 dimensions.
        distance: the boundary distance.
        spectrum: eigenpairs computed before, to save computing them again.

    Raises:
        ValueError: the distance does not work in the shape's dimension.
    """

    def __init__(self, shape: Shape, distance: Distance, spectrum: Spectrum | None = None) -> None:
        check_dimension(distance, shape)
        self.shape, self.distance_kind = shape, distance
        self._spectrum = spectrum
        self._basis: Basis | None = None
        self._mean = np.empty(0)

    def prepare_steps(self) -> Generator[float | None, None, None]:
        """Makes the basis where it is not there yet, as a generator.

        Whatever needs the basis does so at its first use.
        """
        if self._basis is not None:
            return
        if self._spectrum is None and self.distance_kind.spectral:
            self._spectrum = yield from eigenpair_steps(self.shape, self.distance_kind.cutoff)
        basis = yield from self.distance_kind.basis_steps(self.shape, self._spectrum)
        basis.columns.setflags(write=False)
        self._mean = (self._masses @ basis.columns) / self._masses.sum()
        self._basis = basis

    @cached_property
    def _masses(self) -> Floats:
        return masses_of(self.shape) if self._spectrum is None else self._spectrum.masses

    @cached_property
    def _form(self) -> QuadraticForm | None:
        return self.distance_kind.form(self.shape)

    @property
    def basis(self) -> Floats:
        """(n, k) what is sampled inside; times `scale` it is the embedding. Read-only."""
        finish(self.prepare_steps())
        assert self._basis is not None
        return self._basis.columns

    @property
    def full_shape(self) -> Shape:
        """The shape that is shown; a preview computes on a simpler one."""
        return self.shape

    def rows_between(self, ends: NDArray[np.int64], shares: Floats) -> Floats:
        """The basis at points of the boundary's edges, (q, k).

        Args:
            ends: (q, 2) vertices of the full shape.
            shares: (q, 2) of each end.
        """
        starts = np.arange(0, ends.size + 1, ends.shape[1])
        matrix = csr_array((shares.ravel(), ends.ravel(), starts), shape=(len(ends), len(self.basis)))
        return matrix @ self.basis

    @cached_property
    def scale(self) -> Floats:
        """(k,) factor of each column of the basis, or (1,) for all of them."""
        finish(self.prepare_steps())
        return self.distance_kind.scale(self._spectrum)

    @property
    def centre(self) -> Floats:
        """(k,) the area-weighted mean of the embedded vertices."""
        scale = self.scale
        return self._mean * scale

    def shares_basis(self, distance: Distance) -> bool:
        """Whether samples of the basis serve another distance too."""
        if self._spectrum is None and distance.spectral:
            return False
        return distance.basis_key == self.distance_kind.basis_key

    @property
    def spectrum(self) -> Spectrum:
        """The eigenpairs used: .values (k,), .vectors (n, k)."""
        if self._spectrum is None or not self.distance_kind.spectral:
            raise ValueError(f"the {self.distance_kind.title.lower()} uses no eigenpairs")
        return self._spectrum

    @property
    def description(self) -> str:
        """The distance's name and parameters in words, and what there is to say about its embedding."""
        words = self.distance_kind.describe(self._spectrum)
        return f"{words}; {self._basis.remark}" if self._basis is not None and self._basis.remark else words

    @property
    def vertex_embedding(self) -> Floats:
        """(n, k) the embedded vertices v_i*."""
        return self.basis * self.scale

    def boundary_squares(self) -> Floats:
        """D (n, n), squared distances between the vertices: given, or else of the embedding."""
        given = self.distance_kind.squares(self.shape)
        return squares_of(self.vertex_embedding) if given is None else given
