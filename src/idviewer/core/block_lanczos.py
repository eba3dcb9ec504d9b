"""Block Lanczos with full reorthogonalisation, for the eigenvalues of a symmetric matrix next to a shift."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.blas import dgemm, dtrsm

from idviewer.core._kernels import LANES
from idviewer.core.steps import finish
from idviewer.core.symmetric_factor import SymmetricFactor

Floats = NDArray[np.float64]

BLOCK = LANES
"""Vectors at a time: as many as a solve takes at once. A block finds as many copies of an eigenvalue as it
is wide, and symmetry makes at most five of a body equal (the largest irreducible representation of a finite
point group, the icosahedron's)."""

CHUNK = 8 * BLOCK
"""Vectors of the basis that are kept in one array, so that it grows without being copied."""

ROWS = 2048
"""Rows of a product that are taken at a time, so that they stay in the processor's cache."""


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

    def __init__(self, factor: SymmetricFactor, shift: float, known: Floats) -> None:
        self._factor, self._shift = factor, shift
        self._chunks: list[Floats] = []
        self._projected = np.zeros((0, 0))
        self._coupling = np.zeros((BLOCK, BLOCK))
        # All vectors are in the factor's order.
        self._constant = (known / np.linalg.norm(known))[factor.order, None]
        start = np.random.default_rng(0).standard_normal((len(known), BLOCK))
        self._block, _ = orthonormal(start - self._constant @ (self._constant.T @ start))
        self.size = 0

    @property
    def room(self) -> int:
        """How many blocks the space can still hold."""
        return max(0, (len(self._constant) - 1 - self.size) // BLOCK - 1)

    def expand(self) -> Generator[None, None, None]:
        """Add one block to the basis."""
        old, new = self.size, self.size + BLOCK
        local = np.column_stack([self._newest(), self._block])
        if old % CHUNK == 0:
            self._chunks.append(np.empty((len(self._constant), CHUNK), order="F"))
        self._chunks[-1][:, old % CHUNK : old % CHUNK + BLOCK] = self._block
        self.size = new
        image = self._factor.solve_ordered(self._block)
        yield
        coefficients = _less(image, local)  # all that exact arithmetic would need
        yield
        _less(image, self._constant)
        for start, chunk in zip(range(0, new, CHUNK), self._chunks, strict=True):
            _less(image, chunk[:, : min(CHUNK, new - start)])
            yield
        wider = np.zeros((new, new))
        wider[:old, :old] = self._projected
        wider[new - local.shape[1] :, old:] = coefficients
        wider[old:, new - local.shape[1] :] = coefficients.T
        self._projected = wider
        self._block, self._coupling = orthonormal(image)
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
        vectors = np.empty((len(self._constant), coefficients.shape[1]))
        for start in range(0, len(vectors), ROWS):
            rows = slice(start, start + ROWS)
            parts = zip(range(0, self.size, CHUNK), self._chunks, strict=True)
            sums = sum(chunk[rows, : self.size - at] @ coefficients[at : at + CHUNK] for at, chunk in parts)
            vectors[self._factor.order[rows]] = sums
            yield
        return vectors

    def _newest(self) -> Floats:
        """The block added last, (n, BLOCK), or nothing."""
        if not self._chunks:
            return self._block[:, :0]
        end = (self.size - 1) % CHUNK + 1
        return self._chunks[-1][:, end - BLOCK : end]


def orthonormal(block: Floats) -> tuple[Floats, Floats]:
    """Q and R of a tall block (n, b), by Cholesky factors twice; by reflections where it is nearly singular.

    In Fortran's order it is overwritten by Q.

    >>> q, r = orthonormal(np.random.default_rng(0).standard_normal((50, 3)))
    >>> bool(abs(q.T @ q - np.eye(3)).max() < 1e-14)
    True
    """
    result, total = np.asfortranarray(block), np.eye(block.shape[1])
    try:
        for _ in range(2):
            upper = np.linalg.cholesky(dgemm(1.0, result, result, trans_a=True)).T
            dtrsm(1.0, upper, result, side=1, overwrite_b=True)
            total = upper @ total
    except np.linalg.LinAlgError:
        result, rest = np.linalg.qr(result)
        result, total = np.asfortranarray(result), rest @ total
    return result, total


def _less(image: Floats, basis: Floats) -> Floats:
    """Take the part of image (n, b) that lies in an orthonormal basis (n, m) out of it; the coefficients."""
    coefficients = dgemm(1.0, basis, image, trans_a=True)
    dgemm(-1.0, basis, coefficients, beta=1.0, c=image, overwrite_c=True)
    return coefficients
