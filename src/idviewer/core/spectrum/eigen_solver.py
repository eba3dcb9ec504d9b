"""Eigenpairs of the Laplace-Beltrami operator, as many as a spectral distance of mesh or polygon needs."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from scipy import sparse

from idviewer.core.arrays import Floats
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.polygon import Polygon, PolygonError
from idviewer.core.shapes.shape import Shape, ShapeLike, as_shape
from idviewer.core.shapes.simplification import simplification_steps
from idviewer.core.spectrum.krylov_eigenpairs import krylov_steps
from idviewer.core.spectrum.laplacian import laplacian_of, masses_of
from idviewer.core.spectrum.memory_estimate import check_room
from idviewer.core.spectrum.polygon_eigenpairs import low_pairs
from idviewer.core.steps import finish, without_shares
from idviewer.core.threads import small_products

Steps = Generator[float | None, None, "Spectrum"]

SOLVER_VERSION = 1
"""To be raised when the eigenpairs of a shape change by more than rounding: kept ones are then not used."""

SMALLEST_KEPT = 1e-6
"""The paper keeps the modes with exp(-lambda t) above this (Rustamov et al. 2009, appendix)."""

DENSE = 700
"""Shapes of up to so many vertices are left to a dense solver, which knows no limit to the modes."""

GUESSED_FROM, COARSE = 6000, 2000
"""Meshes of so many vertices are simplified to so many, to know beforehand where lambda_2 is about."""

DENSE_POLYGON = 250
"""Polygons of up to so many vertices likewise; above, iterating for the lowest twenty modes is faster."""


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


def eigenpairs(shape: ShapeLike, cutoff: Callable[[float], float] = paper_cutoff) -> Spectrum:
    """All eigenpairs with 0 < lambda < cutoff(lambda_2).

    Args:
        shape: mesh or polygon of n vertices.
        cutoff: from lambda_2 to the bound of the eigenvalues kept.

    Returns:
        The spectrum; eigenvalues have relative errors below 1e-9.

    Raises:
        ShapeError: the cut-off asks for more modes than a large shape carries (a MeshError or PolygonError),
            or a mesh does not fit into memory (see `idviewer.core.spectrum.memory_estimate`).

    >>> import numpy as np
    >>> from idviewer.core import read_mesh, sample_path
    >>> spectrum = eigenpairs(read_mesh(sample_path("hand_2k")))
    >>> gram = spectrum.vectors.T @ (spectrum.masses[:, None] * spectrum.vectors)
    >>> bool(abs(gram - np.eye(len(spectrum.values))).max() < 1e-10)
    True
    """
    return finish(eigenpair_steps(as_shape(shape), cutoff))


def eigenpair_steps(
    shape: Shape, cutoff: Callable[[float], float] = paper_cutoff, guess: float | None = None
) -> Steps:
    """`eigenpairs` as a generator that yields the share done, or None, every few milliseconds.

    Args:
        shape, cutoff: as there.
        guess: lambda_2 within some percent where it is known, which saves a third of the work.
    """
    with small_products():
        return (yield from _pair_steps(shape, cutoff, guess))


def _pair_steps(shape: Shape, cutoff: Callable[[float], float], guess: float | None) -> Steps:
    check_room(shape)
    masses = masses_of(shape)
    yield 0.0
    if isinstance(shape, Polygon):
        return (yield from _polygon_steps(shape, masses, cutoff))
    if len(masses) <= DENSE:
        return _all_pairs(laplacian_of(shape), masses, cutoff)
    if guess is None and isinstance(shape, Mesh) and len(masses) >= GUESSED_FROM:
        guess = yield from _guess_steps(shape)
    return (yield from _krylov_steps(shape, masses, cutoff, guess))


def _guess_steps(mesh: Mesh) -> Generator[float | None, None, float | None]:
    """lambda_2 of a mesh within some percent, from a simplified one."""
    steps = simplification_steps(mesh, COARSE)
    small = (yield from without_shares(steps)).mesh
    if len(small.vertices) > 0.5 * len(mesh.vertices):
        return None
    masses = masses_of(small)
    spectrum = yield from without_shares(_krylov_steps(small, masses, lambda lambda_2: 1.01 * lambda_2))
    return float(spectrum.values[0])


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


def _krylov_steps(
    shape: Shape, masses: Floats, cutoff: Callable[[float], float], guess: float | None = None
) -> Steps:
    """The kept pairs of a large shape, by iteration."""
    pairs = yield from krylov_steps(shape, laplacian_of(shape), masses, cutoff, guess)
    return Spectrum(pairs.values, pairs.vectors, masses, pairs.residual, pairs.bound)


def _all_pairs(laplacian: sparse.csc_array, masses: Floats, cutoff: Callable[[float], float]) -> Spectrum:
    """The kept pairs of a small mesh, by a dense solver."""
    roots = np.sqrt(masses)
    values, vectors = scipy.linalg.eigh(laplacian.toarray() / roots[:, None] / roots)
    bound = cutoff(float(values[1]))
    kept = int(np.searchsorted(values, bound))
    vectors = np.ascontiguousarray(vectors[:, 1:kept] / roots[:, None])
    return Spectrum(values[1:kept], vectors, masses, 0.0, bound if kept < len(values) else math.inf)
