"""Eigenpairs of the Laplace-Beltrami operator, as many as a spectral distance of mesh or polygon needs."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy import sparse

from idviewer.core._polygon_spectrum import low_pairs
from idviewer.core.block_lanczos import BLOCK, BlockLanczos
from idviewer.core.laplacian import laplacian_of, masses_of
from idviewer.core.mesh import MeshError
from idviewer.core.polygon import Polygon, PolygonError
from idviewer.core.shape import Shape, ShapeError
from idviewer.core.steps import finish
from idviewer.core.symmetric_factor import SymmetricFactor

Floats = NDArray[np.float64]
Steps = Generator[float | None, None, "Spectrum"]

SOLVER_VERSION = 1
"""To be raised when the eigenpairs of a shape change by more than rounding: kept ones are then not used."""

SMALLEST_KEPT = 1e-6
"""The paper keeps the modes with exp(-lambda t) above this (Rustamov et al. 2009, appendix)."""

DENSE = 700
"""Shapes of up to so many vertices are left to a dense solver, which knows no limit to the modes."""

DENSE_POLYGON = 250
"""Polygons of up to so many vertices likewise; above, iterating for the lowest twenty modes is faster."""

RESIDUAL = 1e-6
FIRST_BLOCKS = 4
VECTORS_OF_A_MODE = 2.3
"""Fewer vectors in the basis for each mode have not been seen to suffice."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Eigenpairs L phi = lambda M phi without the constant mode, which cancels in every distance.

    Attributes:
        values: (k,) eigenvalues in ascending order, 1 / unit^2; values[0] is the paper's lambda_2.
        vectors: (n, k) eigenvectors, one column each, with vectors^T M vectors = 1.
        masses: (n,) the diagonal of M: mixed Voronoi areas of a mesh, lengths of a polygon.
        residual: the largest residual |C x - theta x| / theta of the shift-inverted problem.
        bound: every eigenvalue below it is among the values; infinite where the shape has no others.
    """

    values: Floats
    vectors: Floats
    masses: Floats
    residual: float
    bound: float


def paper_time(lambda_2: float) -> float:
    """The paper's diffusion time t = 1 / (8 lambda_2), in the shape's unit squared (appendix).

    >>> paper_time(2.0)
    0.0625
    """
    return 1.0 / (8.0 * lambda_2)


def paper_cutoff(lambda_2: float) -> float:
    """Largest eigenvalue kept by the paper's rule, with the diffusion time t = 1 / (8 lambda_2).

    >>> round(paper_cutoff(1.0), 1)
    110.5
    """
    return -math.log(SMALLEST_KEPT) / paper_time(lambda_2)


def eigenpairs(shape: Shape, cutoff: Callable[[float], float] = paper_cutoff) -> Spectrum:
    """All eigenpairs with 0 < lambda < cutoff(lambda_2).

    Args:
        shape: mesh or polygon of n vertices.
        cutoff: from lambda_2 to the bound of the eigenvalues kept.

    Returns:
        The spectrum; eigenvalues have relative errors below 1e-10.

    Raises:
        ShapeError: the cut-off asks for more modes than a large shape carries (a MeshError or PolygonError).

    >>> import numpy as np
    >>> from idviewer.core import read_mesh, sample_path
    >>> spectrum = eigenpairs(read_mesh(sample_path("hand_2k")))
    >>> gram = spectrum.vectors.T @ (spectrum.masses[:, None] * spectrum.vectors)
    >>> bool(abs(gram - np.eye(len(spectrum.values))).max() < 1e-10)
    True
    """
    return finish(eigenpair_steps(shape, cutoff))


def eigenpair_steps(shape: Shape, cutoff: Callable[[float], float] = paper_cutoff) -> Steps:
    """`eigenpairs` as a generator that yields the share done, or None, every few milliseconds."""
    masses = masses_of(shape)
    yield 0.0
    if isinstance(shape, Polygon):
        return (yield from _polygon_steps(shape, masses, cutoff))
    if len(masses) <= DENSE:
        return _all_pairs(laplacian_of(shape), masses, cutoff)
    return (yield from _krylov_steps(shape, masses, cutoff))


def _polygon_steps(polygon: Polygon, masses: Floats, cutoff: Callable[[float], float]) -> Steps:
    """The kept pairs of a polygon: a few of many by iteration, all others by a dense solver."""
    if len(masses) > DENSE_POLYGON:
        try:
            return (yield from _krylov_steps(polygon, masses, cutoff))
        except PolygonError:
            if len(masses) > DENSE:
                raise
    values, vectors, bound = low_pairs(polygon, masses, cutoff)
    return Spectrum(values, vectors, masses, 0.0, bound)


def _krylov_steps(shape: Shape, masses: Floats, cutoff: Callable[[float], float]) -> Steps:
    """The kept pairs of a large shape, by block Lanczos."""
    weyl = _Weyl(shape.dimension, float(masses.sum()))
    roots = np.sqrt(masses)
    over = sparse.diags_array(1.0 / roots)
    shifted = over @ laplacian_of(shape) @ over + weyl.shift * sparse.eye_array(len(masses))
    krylov = BlockLanczos(SymmetricFactor(sparse.csc_array(shifted), shape.vertices), weyl.shift, roots)
    yield 0.05
    expected = math.inf
    while True:
        for _ in range(min(krylov.room, _blocks_to_add(krylov.size, expected))):
            yield from krylov.expand()
        values, coefficients, residuals = krylov.ritz_pairs()
        bound = cutoff(values[0])
        kept = int(np.count_nonzero(values < bound))
        # One converged value beyond the bound shows that none below it is still to come.
        if kept < len(values) and residuals[: kept + 1].max() < RESIDUAL:
            break
        expected = max(weyl.modes(bound), kept)  # which never counts too many: Ritz values come from above
        if krylov.room == 0 or (residuals[0] < 1e-3 and expected > 0.5 * len(masses)):
            raise _too_many(shape, expected)
        yield min(0.95, 0.05 + 0.9 * krylov.size / (3.0 * expected + 4 * BLOCK))
    vectors = krylov.vectors(coefficients[:, :kept])
    vectors /= roots[:, None]
    return Spectrum(values[:kept], vectors, masses, float(residuals[:kept].max()), bound)


def _blocks_to_add(size: int, expected: float) -> int:
    """How far a Krylov space is to grow until it is looked at again, which costs as much as a block."""
    if size == 0:
        return FIRST_BLOCKS
    goal = max(1.15 * size, min(VECTORS_OF_A_MODE * expected, 2.0 * size))
    return max(1, round((goal - size) / BLOCK))


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
        """An eighth of the spacing: near enough to zero to favour low modes, far enough to factor well."""
        return 0.5 * math.pi**2 / self.size**2 if self.dimension == 2 else 0.5 * math.pi / self.size


def _too_many(shape: Shape, expected: float) -> ShapeError:
    kind, error = ("polygon", PolygonError) if shape.dimension == 2 else ("mesh", MeshError)
    return error(
        f"the distance asks for about {expected:.0f} modes, more than a {kind} of {len(shape.vertices)} "
        f"vertices can carry; choose a longer diffusion time or a finer {kind}"
    )


def _all_pairs(laplacian: sparse.csc_array, masses: Floats, cutoff: Callable[[float], float]) -> Spectrum:
    """The kept pairs of a small mesh, by a dense solver."""
    roots = np.sqrt(masses)
    values, vectors = scipy.linalg.eigh(laplacian.toarray() / roots[:, None] / roots)
    bound = cutoff(float(values[1]))
    kept = int(np.searchsorted(values, bound))
    vectors = np.ascontiguousarray(vectors[:, 1:kept] / roots[:, None])
    return Spectrum(values[1:kept], vectors, masses, 0.0, bound if kept < len(values) else math.inf)
