"""Krylov basis: orthonormal vectors by the hundred, each of them long, that others are made orthogonal to."""

from __future__ import annotations

from collections.abc import Generator, Iterator

import numpy as np

from idviewer.core._kernels import LANES
from idviewer.core._kernels.linear_algebra.tall_skinny import (
    ROW_RANGES,
    inner_products,
    subtract_combinations,
    subtract_products,
)
from idviewer.core.arrays import Floats, Ints

BLOCKS_PER_ARRAY = 8
"""Blocks that are kept in one array, so that the basis grows without being copied."""


class KrylovBasis:
    """Orthonormal vectors of length n in blocks (n, LANES), C-contiguous; iteration gives some at a time.

    Args:
        count: n.

    >>> basis = KrylovBasis(50)
    >>> block = np.random.default_rng(0).standard_normal((50, LANES))
    >>> _ = basis.append(block)
    >>> len(basis), bool(abs(basis[0].T @ basis[0] - np.eye(LANES)).max() < 1e-14)
    (1, True)
    """

    def __init__(self, count: int) -> None:
        self._count = count
        self._chunks: list[Floats] = []
        self._blocks = 0

    def __len__(self) -> int:
        return self._blocks

    def __getitem__(self, index: int) -> Floats:
        return self._chunks[index // BLOCKS_PER_ARRAY][index % BLOCKS_PER_ARRAY]

    def __iter__(self) -> Iterator[Floats]:
        """All blocks, (b, n, LANES) at a time."""
        for start, chunk in zip(range(0, self._blocks, BLOCKS_PER_ARRAY), self._chunks, strict=True):
            yield chunk[: self._blocks - start]

    def append(self, block: Floats) -> Floats:
        """Add the orthonormal Q of block = Q R, which is orthogonal to the others; R, and the block is lost.

        By Cholesky factors twice, or by reflections where it is nearly singular.
        """
        if self._blocks % BLOCKS_PER_ARRAY == 0:
            self._chunks.append(np.empty((BLOCKS_PER_ARRAY, self._count, LANES)))
        self._blocks += 1
        result = self[self._blocks - 1]
        upper = np.eye(LANES)
        try:
            for out in (block, result):
                factor = np.linalg.cholesky(inner(block[None], block)).T
                subtract_products(block[None], 1, -np.linalg.inv(factor), 0.0, block, out)
                upper = factor @ upper
        except np.linalg.LinAlgError:
            result[:], factor = np.linalg.qr(block)
            upper = factor @ upper
        return upper

    def combination_steps(self, coefficients: Floats, order: Ints) -> Generator[None, None, Floats]:
        """Vectors (n, k) with the given coefficients (m, k) of the first m vectors, as a generator.

        Row i of them goes to order[i].
        """
        known, width = coefficients.shape
        blocks = -(-width // LANES)
        padded = np.zeros((len(self) * LANES, blocks * LANES))
        padded[:known, :width] = -coefficients
        result = np.zeros((self._count, width))
        for start, some in zip(range(0, len(padded), BLOCKS_PER_ARRAY * LANES), self, strict=True):
            rows = padded[start : start + len(some) * LANES].reshape(-1, blocks, LANES)
            subtract_combinations(some, len(some), np.ascontiguousarray(rows.swapaxes(0, 1)), order, result)
            yield
        return result


def make_orthogonal(block: Floats, vectors: Floats) -> Floats:
    """Take the part of a block (n, LANES) that lies in orthonormal vectors (b, n, LANES) out of it, in place.

    Returns:
        (b * LANES, LANES) the coefficients of that part.
    """
    coefficients = inner(vectors, block)
    subtract_products(vectors, len(vectors), coefficients, 1.0, block, block)
    return coefficients


def inner(vectors: Floats, block: Floats) -> Floats:
    """Inner products (b * LANES, LANES) of vectors (b, n, LANES) with a block (n, LANES)."""
    sums = np.zeros((ROW_RANGES, len(vectors) * LANES, LANES))
    inner_products(vectors, len(vectors), block, sums)
    total: Floats = sums.sum(axis=0)
    return total
