"""Block Lanczos with full reorthogonalisation, for the eigenvalues of a symmetric matrix next to a shift."""

from __future__ import annotations

import math
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

DEPENDENCE = 1e-10
"""A block that is longer than the space by less than this, in largest eigenvalues, adds nothing to it."""


class BlockLanczos:
    """A Krylov space of (A - shift)^-1, whose largest eigenvalues belong to those of A next to the shift.

    Known eigenvectors are left out from the start. A second pass of Gram-Schmidt keeps the basis
    orthonormal to rounding. Source: Golub and Underwood 1977, "The block Lanczos method for computing
    eigenvalues".

    Args:
        factor: of A - shift.
        shift: see above.
        known: (n, d) eigenvectors to leave out, orthogonal to each other, or (n,) a single one.
        seed: of the random block that the space begins with.
        stops: whether the space ends, `exhausted`, where its next block would be dependent: it then holds
            as many copies of each eigenvalue as a block is wide. Those of shapes never end before they are
            complete.

    Attributes:
        exhausted: whether the space cannot grow any more.
    """

    def __init__(
        self, factor: LDLFactorization, shift: float, known: Floats, seed: int = 0, stops: bool = False
    ) -> None:
        self._factor, self._shift, self._stops = factor, shift, stops
        self._basis = KrylovBasis(len(known))  # with one block more than the space
        self._projected = np.zeros((0, 0))
        self.exhausted = False
        # All vectors are in the factor's order.
        columns = known.reshape(len(known), -1)
        self._left_out = columns.shape[1]
        self._known = np.zeros((-(-self._left_out // LANES), len(known), LANES))
        for index, vector in enumerate(columns.T):
            unit = vector[factor.order] / np.linalg.norm(vector)
            self._known[index // LANES, :, index % LANES] = unit
        start = np.random.default_rng(seed).standard_normal((len(known), BLOCK))
        self._leave_out_known(start)
        self._coupling = self._basis.append(start)

    def _leave_out_known(self, block: Floats) -> None:
        if len(self._known):
            make_orthogonal(block, self._known)

    @property
    def size(self) -> int:
        """The number of vectors of the space."""
        return len(self._projected)

    @property
    def remaining_blocks(self) -> int:
        """The number of blocks that the space can still hold."""
        if self.exhausted:
            return 0
        return max(0, (self._known.shape[1] - self._left_out - self.size) // BLOCK - 1)

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
        self._leave_out_known(image)
        for some in self._basis:
            make_orthogonal(image, some)
            yield
        self._projected = wider
        if self._stops and self._is_dependent(image):
            self.exhausted, self._coupling = True, np.asarray(np.linalg.qr(image, mode="r"))
        else:
            self._coupling = self._basis.append(image)
        yield

    def _is_dependent(self, block: Floats) -> bool:
        largest = np.abs(np.linalg.eigvalsh(0.5 * (self._projected + self._projected.T))).max()
        return bool(np.abs(np.diag(np.linalg.qr(block, mode="r"))).min() < DEPENDENCE * largest)

    def ritz_pairs(self, null: float = 0.0) -> tuple[Floats, Floats, Floats]:
        """Approximate positive eigenvalues of A, their coefficients (size, k), and residuals.

        Args:
            null: values of up to this size count as zero, and are given too where it is not 0.

        They are in ascending order. Those of A above the shift cannot lie above their approximations. The
        residuals are |C x - theta x| / theta of the inverse C, for eigenvalues much smaller than the shift
        times |lambda - shift| / lambda, which is what an error of theta becomes in lambda.
        """
        thetas, coefficients = np.linalg.eigh(0.5 * (self._projected + self._projected.T))
        with np.errstate(divide="ignore"):
            values = self._shift + 1.0 / thetas
        order = np.argsort(values)
        order = order[np.searchsorted(values[order], -null, side="right") :]
        order = order[np.isfinite(values[order])]
        residuals = np.linalg.norm(self._coupling @ coefficients[-BLOCK:, order], axis=0)
        inverse = np.abs(thetas[order])
        above = np.where(values[order] > null, values[order], math.inf)
        residuals /= inverse * np.minimum(1.0, inverse * above)
        return values[order], coefficients[:, order], residuals

    def vectors(self, coefficients: Floats) -> Floats:
        """Vectors (n, k) of the space from their coefficients (size, k)."""
        return finish(self.vector_steps(coefficients))

    def vector_steps(self, coefficients: Floats) -> Generator[None, None, Floats]:
        """`vectors` as a generator."""
        return (yield from self._basis.combination_steps(coefficients, self._factor.order))
