"""Block Lanczos with full reorthogonalisation, for the eigenvalues of a symmetric matrix next to a shift."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from idviewer.core._kernels import LANES
from idviewer.core.arrays import Floats
from idviewer.core.spectrum.krylov_basis import KrylovBasis, make_orthogonal
from idviewer.core.spectrum.ldl_factorization import LDLFactorization
from idviewer.core.steps import finish

BLOCK = LANES
"""Vectors at a time: as many as a solve takes at once. A block finds as many copies of an eigenvalue as it
is wide, and symmetry makes at most five of a body equal (the largest irreducible representation of a finite
point group, the icosahedron's)."""


class BlockLanczos:
    """A Krylov space of (A - shift)^-1, whose largest eigenvalues belong to those of A next to the shift.

    One known eigenvector is left out from the start. A second pass of Gram-Schmidt keeps the basis
    orthonormal to rounding. Source: Golub and Underwood 1977, "The block Lanczos method for computing
    eigenvalues".

    Args:
        factor: of A - shift.
        shift: see above.
        known: (n,) the eigenvector to leave out.
    """

    def __init__(self, factor: LDLFactorization, shift: float, known: Floats) -> None:
        self._factor, self._shift = factor, shift
        self._basis = KrylovBasis(len(known))  # with one block more than the space
        self._projected = np.zeros((0, 0))
        # All vectors are in the factor's order.
        self._constant = np.zeros((1, len(known), LANES))
        self._constant[0, :, 0] = known[factor.order] / np.linalg.norm(known)
        start = np.random.default_rng(0).standard_normal((len(known), BLOCK))
        make_orthogonal(start, self._constant)
        self._coupling = self._basis.append(start)

    @property
    def size(self) -> int:
        """How many vectors the space has."""
        return len(self._projected)

    @property
    def room(self) -> int:
        """How many blocks the space can still hold."""
        return max(0, (self._constant.shape[1] - 1 - self.size) // BLOCK - 1)

    def expand(self) -> Generator[None, None, None]:
        """Add one block to the space."""
        old, blocks = self.size, len(self._basis)
        image = self._factor.solve_ordered(self._basis[blocks - 1])
        yield
        wider = np.zeros((old + BLOCK, old + BLOCK))
        wider[:old, :old] = self._projected
        for block in range(max(0, blocks - 2), blocks):  # all that exact arithmetic would need
            coefficients, rows = make_orthogonal(image, self._basis[block][None]), block * BLOCK
            wider[rows : rows + BLOCK, old:] = coefficients
            wider[old:, rows : rows + BLOCK] = coefficients.T
        yield
        make_orthogonal(image, self._constant)
        for some in self._basis:
            make_orthogonal(image, some)
            yield
        self._projected, self._coupling = wider, self._basis.append(image)
        yield

    def ritz_pairs(self) -> tuple[Floats, Floats, Floats]:
        """Approximate positive eigenvalues of A, their coefficients (size, k), and residuals.

        They are in ascending order. Those of A above the shift cannot lie above their approximations. The
        residuals are |C x - theta x| / theta of the inverse C, for eigenvalues much smaller than the shift
        times |lambda - shift| / lambda, which is what an error of theta becomes in lambda.
        """
        thetas, coefficients = np.linalg.eigh(0.5 * (self._projected + self._projected.T))
        with np.errstate(divide="ignore"):
            values = self._shift + 1.0 / thetas
        order = np.argsort(values)
        order = order[np.searchsorted(values[order], 0.0, side="right") :]
        order = order[np.isfinite(values[order])]
        residuals = np.linalg.norm(self._coupling @ coefficients[-BLOCK:, order], axis=0)
        inverse = np.abs(thetas[order])
        residuals /= inverse * np.minimum(1.0, inverse * values[order])
        return values[order], coefficients[:, order], residuals

    def vectors(self, coefficients: Floats) -> Floats:
        """Vectors (n, k) of the space from their coefficients (size, k)."""
        return finish(self.vector_steps(coefficients))

    def vector_steps(self, coefficients: Floats) -> Generator[None, None, Floats]:
        """`vectors` as a generator."""
        return (yield from self._basis.combination_steps(coefficients, self._factor.order))
