"""How far thin triangles spoil the cotangent Laplacian. Measured in docs/eigenpairs.md."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.validation.repairs import side_vectors

BEARABLE_STIFFNESS = 2e-3
"""Up to it, the cotangent Laplacian's fortieth eigenvalue is as good as that of an intrinsic Delaunay
triangulation; beyond, its relative excess is some 25 times the stiffness."""

BEARABLE_ROUNDING = 1e-3
"""Of a bound on relative errors by cancellation in the lowest eigenvalue. The errors themselves are ten to
two hundred times smaller, about as large as those of an intrinsic triangulation, which lengthens needles."""

COARSE = 100
"""Surfaces of fewer vertices have no fortieth eigenvalue to speak of, by whatever Laplacian."""

NEEDLE = 1e-3
"""Needles are the triangles that have a cotangent of more than this share of the largest."""


@dataclass(frozen=True)
class TriangleQuality:
    """What is wrong with the cotangent Laplacian of a surface.

    Attributes:
        stiffness: how much of their freedom the functions that are linear on each triangle lose; see
            `triangle_quality_of`. 0 where it is bearable for certain.
        rounding: bound of the relative rounding error of the lowest eigenvalue.
        thin: how many triangles do the harm; 0 if it is bearable.
        worst: a vertex of one of them.
    """

    stiffness: float
    rounding: float
    thin: int
    worst: int

    @property
    def bearable(self) -> bool:
        """Whether the cotangent Laplacian can be used."""
        return self.stiffness <= BEARABLE_STIFFNESS and self.rounding <= BEARABLE_ROUNDING

    @property
    def words(self) -> str:
        """What thin triangles do to the cotangent Laplacian, with the figure that decides."""
        if self.stiffness > BEARABLE_STIFFNESS:
            what = f"{self.thin:,} thin obtuse triangles, which stiffen"
            figure, limit = self.stiffness, BEARABLE_STIFFNESS
        else:
            what = f"{self.thin:,} needle{'s' if self.thin > 1 else ''}, which round"
            figure, limit = self.rounding, BEARABLE_ROUNDING
        return f"{what} the cotangent Laplacian by {figure:.2g} ({limit:g} is bearable),"


def triangle_quality_of(vertices: Floats, faces: Ints) -> TriangleQuality:
    """The unevenness of a closed surface.

    An edge of length l whose opposite angles add up to more than pi has a negative weight w. Across it, a
    function of second derivative u'' pays about |w| (l^2 u'')^2 more energy than on a Delaunay triangulation:
    its value at the obtuse corner is tied to the edge. A corner tied to one edge just follows; one tied to
    several holds the function straight. The stiffness is the sum of |w| l^4 / area^2 without the largest
    of each corner. Source: ours; Babuska and Aziz 1976 for why angles near pi do harm, and Rippa 1990
    for the least energy of Delaunay triangulations.

    Args:
        vertices: (n, 3).
        faces: (m, 3), each with an area.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> triangle_quality_of(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])).bearable
    True
    """
    sides = side_vectors(vertices, faces)
    squares = np.column_stack([np.einsum("ij,ij->i", side, side) for side in sides])
    areas = np.linalg.norm(np.cross(sides[1], sides[2]), axis=1) / 2.0
    area = float(areas.sum())
    cotangents = (squares.sum(axis=1, keepdims=True) - 2.0 * squares) / (4.0 * areas[:, None])
    # The trace of L is the sum of all cotangents; each number in it is rounded.
    rounding = float(np.finfo(np.float64).eps * cotangents.sum() / (4.0 * np.pi))
    if rounding > BEARABLE_ROUNDING:
        needles = np.abs(cotangents).max(axis=1)
        needles = np.flatnonzero(needles > NEEDLE * needles.max())
        return TriangleQuality(0.0, rounding, len(needles), int(faces[needles[0], 0]))
    obtuse = cotangents < 0.0
    paid = -cotangents * (squares / area) ** 2
    # An edge pays half of what its triangles would pay alone, at most.
    most = 0.5 * _beyond_largest(paid[obtuse], faces[obtuse], len(vertices)).sum()
    if most <= BEARABLE_STIFFNESS or len(vertices) < COARSE:
        return TriangleQuality(0.0, rounding, 0, 0)
    paid = _paid_by_edges(cotangents, squares / area, faces)
    beyond = _beyond_largest(paid[paid > 0.0], faces[paid > 0.0], len(vertices))
    return TriangleQuality(
        float(beyond.sum()), rounding, int(np.count_nonzero(paid.any(axis=1))), int(np.argmax(beyond))
    )


def _beyond_largest(paid: Floats, corners: Ints, count: int) -> Floats:
    """(count,) sums of what is paid at each corner, without the largest of each."""
    largest = np.zeros(count)
    np.maximum.at(largest, corners, paid)
    return np.bincount(corners, paid, count) - largest


def _paid_by_edges(cotangents: Floats, squares: Floats, faces: Ints) -> Floats:
    """(m, 3) what each corner pays for the edge opposite, as its share in the edge's negative weight."""
    ends = np.sort(np.stack([faces[:, [1, 2, 0]], faces[:, [2, 0, 1]]], axis=-1).reshape(-1, 2), axis=1)
    pairs = np.lexsort(ends.T).reshape(-1, 2)
    weights = 0.5 * cotangents.ravel()[pairs].sum(axis=1)
    negative = np.minimum(cotangents.ravel()[pairs], 0.0)
    # Angles that add up to pi are told from more by what rounding leaves of them.
    pays = weights < -1e-9
    pairs, negative = pairs[pays], negative[pays]
    share = negative / negative.sum(axis=1, keepdims=True)
    result = np.zeros(faces.size)
    result[pairs] = -weights[pays, None] * share * squares.ravel()[pairs] ** 2
    return result.reshape(faces.shape)
