"""Eigenpairs of the Laplace-Beltrami operator, as many as a spectral distance of mesh or polygon needs."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

from idviewer.core._polygon_spectrum import low_pairs
from idviewer.core.laplacian import laplacian_of, masses_of
from idviewer.core.mesh import MeshError
from idviewer.core.polygon import Polygon, PolygonError
from idviewer.core.shape import Shape, ShapeError
from idviewer.core.steps import finish

Floats = NDArray[np.float64]
Steps = Generator[float | None, None, "Spectrum"]

SMALLEST_KEPT = 1e-6
"""The paper keeps the modes with exp(-lambda t) above this (Rustamov et al. 2009, appendix)."""

DENSE = 700
"""Shapes of up to so many vertices are left to a dense solver, which knows no limit to the modes."""

DENSE_POLYGON = 250
"""Polygons of up to so many vertices likewise; above, iterating for the lowest twenty modes is faster."""

BLOCK = 6
"""Vectors at a time. Symmetry makes at most five eigenvalues of a body equal (the largest irreducible
representation of a finite point group, the icosahedron's), and a block finds as many copies as it is wide."""

RESIDUAL = 1e-6
FAR_GROWTH, NEAR_GROWTH = 0.3, 0.1
"""Growth of the basis after which it is looked at again: long before the expected end, and near it."""


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
    krylov = _BlockKrylov(_factor(laplacian_of(shape), weyl.shift * masses), np.sqrt(masses), weyl.shift)
    yield 0.05
    expected = math.inf
    while True:
        growth = FAR_GROWTH if krylov.size < 2.5 * expected else NEAR_GROWTH
        for _ in range(min(krylov.room, max(2, round(growth * krylov.size / BLOCK)))):
            yield from krylov.expand()
        values, coefficients, residuals = krylov.ritz_pairs()
        bound = cutoff(values[0])
        kept = int(np.count_nonzero(values < bound))
        # One converged value beyond the bound shows that none below it is still to come.
        if kept < len(values) and residuals[: kept + 1].max() < RESIDUAL:
            break
        expected = weyl.modes(bound)
        if krylov.room == 0 or (residuals[0] < 1e-3 and expected > 0.5 * len(masses)):
            raise _too_many(shape, expected)
        yield min(0.95, 0.05 + 0.9 * krylov.size / (2.6 * expected + 10 * BLOCK))
    vectors = krylov.vectors(coefficients[:, :kept])
    return Spectrum(values[:kept], vectors, masses, float(residuals[:kept].max()), bound)


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


def _factor(laplacian: sparse.csc_array, diagonal: Floats) -> SuperLU:
    matrix = sparse.csc_array(laplacian + sparse.diags_array(diagonal))
    return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})


class _BlockKrylov:
    """Block Lanczos with full reorthogonalisation on C = M^1/2 (L + shift M)^-1 M^1/2.

    The constant mode is the first basis vector and so is deflated. Blocks find equal eigenvalues, which
    symmetric shapes have; a second pass of Gram-Schmidt keeps the basis orthonormal to rounding.
    """

    def __init__(self, factor: SuperLU, roots: Floats, shift: float) -> None:
        n = len(roots)
        self._factor, self._roots, self._shift = factor, roots, shift
        self._basis = np.empty((n, 1 + 32 * BLOCK), order="F")
        self._projected = np.zeros((1 + 32 * BLOCK, 1 + 32 * BLOCK))
        self._basis[:, 0] = roots / np.linalg.norm(roots)
        start = np.random.default_rng(0).standard_normal((n, BLOCK))
        start -= self._basis[:, :1] @ (self._basis[:, :1].T @ start)
        self._block = np.linalg.qr(start)[0]
        self._coupling = np.zeros((BLOCK, BLOCK))
        self.size = 1

    @property
    def room(self) -> int:
        """How many blocks the space can still hold."""
        return max(0, (len(self._roots) - self.size) // BLOCK - 1)

    def expand(self) -> Generator[None, None, None]:
        """Add one block to the basis."""
        old, new = self.size, self.size + BLOCK
        self._grow(new)
        self._basis[:, old:new] = self._block
        image = np.empty_like(self._block, order="F")
        for column in range(BLOCK):
            image[:, column] = self._roots * self._factor.solve(self._roots * self._block[:, column])
            yield
        local = self._basis[:, max(old - BLOCK, 1) : new]  # all that exact arithmetic would need
        coefficients = local.T @ image
        image -= local @ coefficients
        yield
        everything = self._basis[:, :new]
        image -= everything @ (everything.T @ image)
        self._projected[max(old - BLOCK, 1) : new, old:new] = coefficients
        self._projected[old:new, max(old - BLOCK, 1) : new] = coefficients.T
        self._block, self._coupling = np.linalg.qr(image)
        self.size = new
        yield

    def _grow(self, size: int) -> None:
        if size > self._basis.shape[1]:
            wider = np.empty((len(self._roots), 2 * size), order="F")
            wider[:, : self.size] = self._basis[:, : self.size]
            self._basis = wider
        if size > len(self._projected):
            wider = np.zeros((2 * size, 2 * size))
            wider[: self.size, : self.size] = self._projected[: self.size, : self.size]
            self._projected = wider

    def ritz_pairs(self) -> tuple[Floats, Floats, Floats]:
        """Approximate eigenvalues (ascending), their coefficients in the basis and their residuals."""
        projected = self._projected[1 : self.size, 1 : self.size]
        thetas, coefficients = np.linalg.eigh(0.5 * (projected + projected.T))
        thetas, coefficients = thetas[::-1], coefficients[:, ::-1]
        residuals = np.linalg.norm(self._coupling @ coefficients[-BLOCK:], axis=0) / np.abs(thetas)
        positive = thetas > 0.0
        return 1.0 / thetas[positive] - self._shift, coefficients[:, positive], residuals[positive]

    def vectors(self, coefficients: Floats) -> Floats:
        """Eigenvectors, normalised in the M-norm."""
        return np.ascontiguousarray(self._basis[:, 1 : self.size] @ coefficients / self._roots[:, None])
