"""Eigenpairs of the Laplace-Beltrami operator, as many as a spectral distance of mesh or polygon needs."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass
from typing import Any, cast, overload

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike
from scipy import sparse

from idviewer.core.arrays import Floats
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.polygon import Polygon, PolygonError
from idviewer.core.shapes.shape import Shape, ShapeLike, as_shape
from idviewer.core.shapes.simplification import simplification_steps
from idviewer.core.spectrum.krylov_eigenpairs import Cutoff, LowPairs, krylov_steps
from idviewer.core.spectrum.laplacian import laplacian_of, masses_of
from idviewer.core.spectrum.memory_estimate import check_memory
from idviewer.core.spectrum.operator_eigenpairs import check_operator, operator_pairs
from idviewer.core.spectrum.polygon_eigenpairs import low_pairs
from idviewer.core.steps import finish, without_shares
from idviewer.core.threads import small_products

Steps = Generator[float | None, None, "Spectrum"]

SOLVER_VERSION = 1
"""To be raised when the eigenpairs of a shape change by more than rounding: kept ones are then not used."""

SMALLEST_KEPT = 1e-6
"""The paper keeps the modes with exp(-lambda t) above this (Rustamov et al. 2009, appendix)."""


@dataclass(frozen=True)
class EigenSolverSettings:
    """Numbers of vertices up to which shapes are left to each solver.

    Attributes:
        dense_vertices: up to so many a dense solver is taken, which knows no limit to the modes.
        dense_polygon_vertices: likewise of polygons; above, iterating for the lowest twenty modes is faster.
        estimated_from_vertices: meshes of so many are simplified, to know beforehand where lambda_2 is about.
        estimate_vertices: of the simplified mesh.
    """

    dense_vertices: int = 700
    dense_polygon_vertices: int = 250
    estimated_from_vertices: int = 6000
    estimate_vertices: int = 2000


EIGEN_SOLVER = EigenSolverSettings()


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Eigenpairs L phi = lambda M phi without the constant mode, which cancels in every distance.

    Attributes:
        values: (k,) eigenvalues in ascending order, 1 / unit^2; values[0] is the paper's lambda_2.
        vectors: (n, k) eigenvectors, one column each, with vectors^T M vectors = 1.
        masses: (n,) the diagonal of M: mixed Voronoi areas of a mesh, lengths of a polygon.
        residual: the largest relative residual of an eigenvalue, see `BlockLanczos.ritz_pairs`.
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


@overload
def eigenpairs(shape: ShapeLike, /, *, k: int | None = None, cutoff: Cutoff = paper_cutoff) -> Spectrum: ...


@overload
def eigenpairs(
    vertices: ArrayLike, faces: ArrayLike, /, k: int | None = None, *, cutoff: Cutoff = paper_cutoff
) -> Spectrum: ...


@overload
def eigenpairs(laplacian: sparse.sparray, masses: sparse.sparray | ArrayLike, /, k: int) -> Spectrum: ...


def eigenpairs(
    shape: ShapeLike | sparse.sparray,
    faces: Any = None,
    /,
    k: int | None = None,
    *,
    cutoff: Cutoff = paper_cutoff,
) -> Spectrum:
    """Eigenpairs L phi = lambda M phi with lambda > 0: of a shape's boundary, or of a given operator.

    The null space of L, which cancels in every distance, is left out, however many dimensions it has: of a
    shape, and of each component of a graph, the constants. With Dirichlet conditions it has none.

    - `eigenpairs(shape)` gives all with lambda < cutoff(lambda_2), by the paper's rule;
    - `eigenpairs(shape, k=20)`, `eigenpairs(vertices, faces, k=20)` give the lowest 20;
    - `eigenpairs(L, M, 20)` gives the lowest 20 of your own operator.

    Args:
        shape: mesh or polygon of n vertices, or its arrays (see `idviewer.core.shapes.shape`); or L (n, n),
            sparse, symmetric and positive semi-definite.
        faces: (m, 3) where vertices were given; the mass matrix M where L was: diagonal and sparse, or its
            diagonal (n,), positive.
        k: how many; those of the cut-off by default.
        cutoff: from lambda_2 to the bound of the eigenvalues kept.

    Returns:
        The spectrum; eigenvalues have relative errors below 1e-9. Those of a given operator are as accurate
        as its entries allow, some 1e-15 of its largest eigenvalue.

    Raises:
        ShapeError: the arrays are no shape; the cut-off asks for more modes than a large shape carries; or a
            mesh does not fit into memory (a MeshError or PolygonError).
        ValueError: L or M is not of that kind, or L has fewer than k positive eigenvalues.

    >>> import numpy as np
    >>> from idviewer.core import laplacian_of, masses_of, read_mesh, sample_path
    >>> hand = read_mesh(sample_path("hand_2k"))
    >>> spectrum = eigenpairs(hand)
    >>> gram = spectrum.vectors.T @ (spectrum.masses[:, None] * spectrum.vectors)
    >>> bool(abs(gram - np.eye(len(spectrum.values))).max() < 1e-10)
    True
    >>> given = eigenpairs(laplacian_of(hand), masses_of(hand), 10)
    >>> bool(abs(given.values / spectrum.values[:10] - 1.0).max() < 1e-9)
    True
    """
    if sparse.issparse(shape):
        laplacian, masses = check_operator(shape, faces, cast(int, k))
        return _spectrum(operator_pairs(laplacian, masses, cast(int, k)), masses)
    known = as_shape(shape if faces is None else cast(ShapeLike, (shape, faces)))
    return finish(eigenpair_steps(known, cutoff)) if k is None else _lowest_of(known, k)


def _lowest_of(shape: Shape, k: int) -> Spectrum:
    """The k lowest pairs of a shape."""
    check_memory(shape)
    laplacian, masses = check_operator(laplacian_of(shape), masses_of(shape), k)
    if isinstance(shape, Polygon) and len(masses) <= EIGEN_SOLVER.dense_vertices:
        values, vectors, _ = low_pairs(shape, masses, lambda _: math.inf)
        if k <= len(values):
            bound = math.inf if k == len(masses) - 1 else float(values[k - 1])
            return Spectrum(values[:k], np.ascontiguousarray(vectors[:, :k]), masses, 0.0, bound)
    return _spectrum(operator_pairs(laplacian, masses, k, shape.vertices), masses)


def _spectrum(pairs: LowPairs, masses: Floats) -> Spectrum:
    return Spectrum(pairs.values, pairs.vectors, masses, pairs.residual, pairs.bound)


def eigenpair_steps(shape: Shape, cutoff: Cutoff = paper_cutoff, estimate: float | None = None) -> Steps:
    """`eigenpairs` as a generator that yields the share done, or None, every few milliseconds.

    Args:
        shape, cutoff: as there.
        estimate: lambda_2 within some percent where it is known, which saves a third of the work.
    """
    with small_products():
        return (yield from _pair_steps(shape, cutoff, estimate))


def _pair_steps(shape: Shape, cutoff: Cutoff, estimate: float | None) -> Steps:
    check_memory(shape)
    masses = masses_of(shape)
    yield 0.0
    if isinstance(shape, Polygon):
        return (yield from _polygon_steps(shape, masses, cutoff))
    if len(masses) <= EIGEN_SOLVER.dense_vertices:
        return _all_pairs(laplacian_of(shape), masses, cutoff)
    if estimate is None and isinstance(shape, Mesh) and len(masses) >= EIGEN_SOLVER.estimated_from_vertices:
        estimate = yield from _estimate_steps(shape)
    return (yield from _krylov_steps(shape, masses, cutoff, estimate))


def _estimate_steps(mesh: Mesh) -> Generator[float | None, None, float | None]:
    """lambda_2 of a mesh within some percent, from a simplified one."""
    steps = simplification_steps(mesh, EIGEN_SOLVER.estimate_vertices)
    small = (yield from without_shares(steps)).mesh
    if len(small.vertices) > 0.5 * len(mesh.vertices):
        return None
    masses = masses_of(small)
    spectrum = yield from without_shares(_krylov_steps(small, masses, lambda lambda_2: 1.01 * lambda_2))
    return float(spectrum.values[0])


def _polygon_steps(polygon: Polygon, masses: Floats, cutoff: Cutoff) -> Steps:
    """The kept pairs of a polygon: a few of many by iteration, all others by a dense solver."""
    if len(masses) > EIGEN_SOLVER.dense_polygon_vertices:
        try:
            return (yield from _krylov_steps(polygon, masses, cutoff))
        except PolygonError:
            if len(masses) > EIGEN_SOLVER.dense_vertices:
                raise
    values, vectors, bound = low_pairs(polygon, masses, cutoff)
    return Spectrum(values, vectors, masses, 0.0, bound)


def _krylov_steps(shape: Shape, masses: Floats, cutoff: Cutoff, estimate: float | None = None) -> Steps:
    """The kept pairs of a large shape, by iteration."""
    pairs = yield from krylov_steps(shape, laplacian_of(shape), masses, cutoff, estimate)
    return _spectrum(pairs, masses)


def _all_pairs(laplacian: sparse.csc_array, masses: Floats, cutoff: Cutoff) -> Spectrum:
    """The kept pairs of a small mesh, by a dense solver."""
    roots = np.sqrt(masses)
    values, vectors = scipy.linalg.eigh(laplacian.toarray() / roots[:, None] / roots)
    bound = cutoff(float(values[1]))
    kept = int(np.searchsorted(values, bound))
    vectors = np.ascontiguousarray(vectors[:, 1:kept] / roots[:, None])
    return Spectrum(values[1:kept], vectors, masses, 0.0, bound if kept < len(values) else math.inf)
