"""The first non-zero eigenvalue alone, within some percent: it says how fine a boundary has to be."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import eigsh

from idviewer.core.arrays import Floats
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.polygon import Polygon
from idviewer.core.shapes.shape import Shape
from idviewer.core.shapes.simplification import simplification_steps
from idviewer.core.spectrum.laplacian import laplacian_of, masses_of
from idviewer.core.steps import beside, without_shares

LARGE_VERTICES, SIMPLIFIED_VERTICES = 12_000, 3000
"""Meshes of more vertices than the one are simplified to the other."""

ACCURACY = 1e-4
"""Relative, of the eigenvalue of the shape that it is computed of."""

SHIFT = 0.1
"""Below 0, as a share of the bound of lambda_2: near enough to tell it from the others."""


def largest_lambda_2(shape: Mesh | Polygon) -> float:
    """A bound from above of lambda_2, in one over the unit squared: that of the best linear function.

    Linear functions of the position are linear on faces, so it holds whatever the triangles are. On a sphere
    it is lambda_2.

    Args:
        shape: n vertices.

    >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> round(largest_lambda_2(square), 9)  # lambda_2 is pi^2 / 4
    3.0
    """
    centred = shape.vertices - shape.vertices.mean(axis=0)
    corners = centred[shape.facets] / shape.diagonal
    sides = corners[:, 1:] - corners[:, :1]
    if isinstance(shape, Polygon):
        sizes = np.linalg.norm(sides[:, 0], axis=1)
        tangents = sides[:, 0] / sizes[:, None]
        energy = np.einsum("m,mi,mj->ij", sizes, tangents, tangents)
    else:
        normals = np.cross(sides[:, 0], sides[:, 1])
        doubled = np.linalg.norm(normals, axis=1)
        sizes, normals = 0.5 * doubled, normals / doubled[:, None]
        energy = sizes.sum() * np.eye(3) - np.einsum("m,mi,mj->ij", sizes, normals, normals)
    # Over a simplex the integral of x is the mean of its corners, and that of x x^T theirs and the sum's.
    count, sums = corners.shape[1], corners.sum(axis=1)
    mean = sizes @ sums / (count * sizes.sum())
    squares = np.einsum("m,mci,mcj->ij", sizes, corners, corners) + np.einsum(
        "m,mi,mj->ij", sizes, sums, sums
    )
    moments = squares / (count * (count + 1)) - sizes.sum() * np.outer(mean, mean)
    return float(1.0 / np.linalg.eigvals(np.linalg.solve(energy, moments)).real.max()) / shape.diagonal**2


def lowest_eigenvalue_steps(shape: Mesh | Polygon) -> Generator[None, None, float]:
    """lambda_2 within some percent, with checkpoints; large meshes are simplified.

    Args:
        shape: n vertices.

    >>> from idviewer.core.steps import finish
    >>> loop = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]]).refined(0.05)
    >>> round(finish(lowest_eigenvalue_steps(loop)), 2)  # about pi^2 / 4
    2.47
    """
    smaller: Shape = shape
    if isinstance(shape, Mesh) and len(shape.vertices) > LARGE_VERTICES:
        smaller = (yield from without_shares(simplification_steps(shape, SIMPLIFIED_VERTICES))).mesh
    laplacian, masses = laplacian_of(smaller), masses_of(smaller)
    yield
    shift = -SHIFT * largest_lambda_2(shape)
    return (yield from beside(lambda: _second(laplacian, masses, shift)))


def _second(laplacian: sparse.csc_array, masses: Floats, shift: float) -> float:
    start = np.cos(np.arange(len(masses)))  # the same each time, and orthogonal to nothing
    if len(masses) < 20:
        roots = np.sqrt(masses)
        return float(np.linalg.eigvalsh(laplacian.toarray() / roots[:, None] / roots)[1])
    # Powers of two, which round nothing, near the size of either: squares of masses then stay floats.
    stiffness, mass = (2.0 ** np.frexp(abs(one).max())[1] for one in (laplacian, masses))
    values = eigsh(
        laplacian / stiffness,
        2,
        sparse.csc_array(sparse.diags_array(masses / mass)),
        sigma=shift * (mass / stiffness),
        return_eigenvectors=False,
        tol=ACCURACY,
        v0=start,
    )
    return float(values.max()) * float(stiffness / mass)
