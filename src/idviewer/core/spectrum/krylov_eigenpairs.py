"""The lowest eigenpairs of a large shape, by block Lanczos about a shift below them or among them."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from idviewer.core.arrays import Floats
from idviewer.core.errors import ShapeError
from idviewer.core.shapes.mesh import MeshError
from idviewer.core.shapes.polygon import PolygonError
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.block_lanczos import BLOCK, BlockLanczos
from idviewer.core.spectrum.ldl_factorization import LDLFactorization

Cutoff = Callable[[float], float]


@dataclass(frozen=True)
class KrylovSettings:
    """Settings by which a Krylov space is large enough.

    Attributes:
        residual: relative, that every pair is to have; eigenvalues err by its square.
        shift_share: where among the eigenvalues the shift is, as a share of their bound: it takes the fewest
            vectors there.
        first_blocks: where nothing is known of the number of modes.
        last_blocks: beyond those that all modes come into sight with; with fewer none has been seen to end.
        interior_vectors: for each mode, until all are in sight, with the shift among the eigenvalues.
        exterior_vectors: likewise with the shift below them.
        rate: how much better the worst of them then gets with each block: five to seven times.
        factored_share: of the work that is done once the matrix is factored, which cannot be interrupted.
    """

    residual: float = 1e-6
    shift_share: float = 0.6
    first_blocks: int = 4
    last_blocks: int = 7
    interior_vectors: float = 1.45
    exterior_vectors: float = 2.5
    rate: float = 6.0
    factored_share: float = 0.05


KRYLOV = KrylovSettings()


class LowPairs(NamedTuple):
    """Eigenpairs up to a bound; the attributes are those of `Spectrum`."""

    values: Floats
    vectors: Floats
    residual: float
    bound: float


def krylov_steps(
    shape: Shape, laplacian: sparse.csc_array, masses: Floats, cutoff: Cutoff, estimate: float | None
) -> Generator[float | None, None, LowPairs]:
    """All pairs with 0 < lambda < cutoff(lambda_2) of a shape of n vertices; yields the share done, or None.

    Args:
        shape: it knows where the vertices are.
        laplacian: (n, n).
        masses: (n,) the diagonal of M.
        cutoff: from lambda_2 to the bound of the eigenvalues kept.
        estimate: lambda_2 within some percent, where it is known.

    Raises:
        ShapeError: the cut-off asks for more modes than the shape carries.
    """
    weyl = _Weyl(shape.dimension, float(masses.sum()))
    roots = np.sqrt(masses)
    inverse_roots = sparse.diags_array(1.0 / roots)
    bound = math.inf if estimate is None else cutoff(estimate)
    matrix = sparse.csc_array(inverse_roots @ laplacian @ inverse_roots)
    shift, factor = yield from _factored(matrix, shape.vertices, bound, weyl)
    krylov = BlockLanczos(factor, shift, roots)
    yield KRYLOV.factored_share
    interior = factor.negative > 0
    expected = (factor.negative - 1) / KRYLOV.shift_share if interior else weyl.modes(bound)
    missing = _first_blocks(interior, expected)
    while True:
        for _ in range(min(krylov.remaining_blocks, missing)):
            yield from krylov.expand()
        values, coefficients, residuals = krylov.ritz_pairs()
        bound = cutoff(values[0])
        kept = int(np.count_nonzero(values < bound))
        if _complete(values < shift, residuals[: kept + 1], kept, factor.negative):
            break
        expected = max(expected if interior else weyl.modes(bound), kept)
        if krylov.remaining_blocks == 0 or (residuals[0] < 1e-3 and expected > 0.5 * len(masses)):
            raise _too_many(shape, expected)
        missing = _more_blocks(krylov.size, _first_blocks(interior, expected), residuals[: kept + 1].max())
        yield min(0.95, KRYLOV.factored_share + 0.9 * krylov.size / (krylov.size + missing * BLOCK))
    vectors = yield from krylov.vector_steps(coefficients[:, :kept])
    vectors /= roots[:, None]
    return LowPairs(values[:kept], vectors, float(residuals[:kept].max()), bound)


def _factored(
    matrix: sparse.csc_array, points: Floats, bound: float, weyl: _Weyl
) -> Generator[None, None, tuple[float, LDLFactorization]]:
    """A shift and the factor of the matrix less the shift: one among the eigenvalues up to a bound that is
    about known, if that can be factored, or else one below all of them."""
    identity = sparse.eye_array(len(points))
    if math.isfinite(bound):
        shift = KRYLOV.shift_share * bound
        try:
            steps = LDLFactorization.steps(
                sparse.csc_array(matrix - shift * identity), points, definite=False
            )
            return shift, (yield from steps)
        except np.linalg.LinAlgError:
            pass
    matrix = sparse.csc_array(matrix - weyl.shift * identity)
    return weyl.shift, (yield from LDLFactorization.steps(matrix, points))


def _complete(below: NDArray[np.bool_], residuals: Floats, kept: int, negative: int) -> bool:
    """Whether all values up to the bound are there.

    Above the shift one converged value beyond the bound shows that none within is still to come; below it
    the inertia tells how many there are, with the constant that was left out.
    """
    enough = np.count_nonzero(below) >= negative - 1
    return bool(enough and kept < len(below) and residuals.max() < KRYLOV.residual)


def _first_blocks(interior: bool, expected: float) -> int:
    """Size of a Krylov space, in blocks, before its end is looked for."""
    if not math.isfinite(expected):
        return KRYLOV.first_blocks
    vectors = KRYLOV.interior_vectors if interior else KRYLOV.exterior_vectors
    return KRYLOV.last_blocks + math.ceil(vectors * expected / BLOCK)


def _more_blocks(size: int, goal: int, worst: float) -> int:
    """Number of blocks before the worst residual is looked at again, which costs as much as a block.

    One is seen too late rather than too early, for each is to be made orthogonal to all others.
    """
    blocks = size // BLOCK
    if blocks < goal:
        return min(goal - blocks, blocks)  # as little is known of the number of modes yet
    return max(1, int(math.log(max(worst / KRYLOV.residual, 1.0)) / math.log(KRYLOV.rate)))


@dataclass(frozen=True)
class _Weyl:
    """Weyl's law: how many eigenvalues a boundary of that size has.

    Attributes:
        dimension: of the space, one more than the boundary's.
        size: the boundary's area or length.
    """

    dimension: int
    size: float

    def modes(self, bound: float) -> float:
        """Number of eigenvalues below a bound, about."""
        if self.dimension == 2:
            return self.size * math.sqrt(bound) / math.pi
        return self.size * bound / (4.0 * math.pi)

    @property
    def shift(self) -> float:
        """An eighth of the spacing below zero: near enough to favour low modes, far enough to factor well."""
        return -0.5 * math.pi**2 / self.size**2 if self.dimension == 2 else -0.5 * math.pi / self.size


def _too_many(shape: Shape, expected: float) -> ShapeError:
    kind, error = ("polygon", PolygonError) if shape.dimension == 2 else ("mesh", MeshError)
    count = f"about {expected:.0f}" if expected < 1e9 else "billions of"
    return error(
        f"the distance asks for {count} modes, more than a {kind} of {len(shape.vertices)} "
        f"vertices can carry; choose a longer diffusion time or a finer {kind}"
    )
