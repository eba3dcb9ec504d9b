"""Triangle quality: how far thin triangles spoil the cotangent Laplacian. Measured in docs/decisions.md."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.validation.soup_repairs import side_vectors


@dataclass(frozen=True)
class TriangleQualityLimits:
    """Up to which triangles the cotangent Laplacian is used.

    Attributes:
        stiffness: up to it, the cotangent Laplacian's fortieth eigenvalue is as good as that of an intrinsic
            Delaunay triangulation; beyond, its relative excess is some 25 times the stiffness.
        rounding: up to which a bound on relative errors by cancellation in the lowest eigenvalue may go. The
            errors are ten to two hundred times smaller, about as large as those of an intrinsic
            triangulation, which lengthens needles.
        fewest_vertices: smaller surfaces have no fortieth eigenvalue to speak of, by whatever Laplacian.
        needle_share: needles are the triangles that have a cotangent of more than this share of the largest.
    """

    stiffness: float = 2e-3
    rounding: float = 1e-3
    fewest_vertices: int = 100
    needle_share: float = 1e-3


LIMITS = TriangleQualityLimits()


@dataclass(frozen=True)
class TriangleQuality:
    """Faults of the cotangent Laplacian of a surface.

    Attributes:
        stiffness: how much of their freedom the functions that are linear on each triangle lose; see
            `triangle_quality_of`. 0 where it is small enough for certain.
        rounding: bound of the relative rounding error of the lowest eigenvalue.
        thin_triangles: how many triangles do the harm; 0 if it is acceptable.
        worst_vertex: a vertex of one of them.
    """

    stiffness: float
    rounding: float
    thin_triangles: int
    worst_vertex: int

    @property
    def acceptable(self) -> bool:
        """Whether the cotangent Laplacian can be used."""
        return self.stiffness <= LIMITS.stiffness and self.rounding <= LIMITS.rounding

    @property
    def description(self) -> str:
        """The effect of thin triangles on the cotangent Laplacian, with the figure that decides."""
        if self.stiffness > LIMITS.stiffness:
            what = f"{self.thin_triangles:,} thin obtuse triangles, which stiffen"
            figure, limit = self.stiffness, LIMITS.stiffness
        else:
            what = f"{self.thin_triangles:,} needle{'s' if self.thin_triangles > 1 else ''}, which round"
            figure, limit = self.rounding, LIMITS.rounding
        return f"{what} the cotangent Laplacian by {figure:.2g} ({limit:g} is bearable),"


def triangle_quality_of(vertices: Floats, faces: Ints) -> TriangleQuality:
    """Measure how far the triangles of a closed surface spoil the cotangent Laplacian.

    An edge of length l whose opposite angles add up to more than pi has a negative weight w. Across it, a
    function of second derivative u'' has about |w| (l^2 u'')^2 more energy than on a Delaunay triangulation:
    its value at the obtuse corner is tied to the edge. A corner tied to one edge just follows; one tied to
    several holds the function straight. The stiffness is the sum of |w| l^4 / area^2 without the largest
    of each corner. Source: ours; Babuska and Aziz 1976 for why angles near pi do harm, and Rippa 1990
    for the least energy of Delaunay triangulations.

    Args:
        vertices: (n, 3).
        faces: (m, 3), each with an area.

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> triangle_quality_of(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])).acceptable
    True
    """
    sides = side_vectors(vertices, faces)
    squares = np.column_stack([np.einsum("ij,ij->i", side, side) for side in sides])
    areas = np.linalg.norm(np.cross(sides[1], sides[2]), axis=1) / 2.0
    area = float(areas.sum())
    cotangents = (squares.sum(axis=1, keepdims=True) - 2.0 * squares) / (4.0 * areas[:, None])
    # The trace of L is the sum of all cotangents; each number in it is rounded.
    rounding = float(np.finfo(np.float64).eps * cotangents.sum() / (4.0 * np.pi))
    if rounding > LIMITS.rounding:
        needles = np.abs(cotangents).max(axis=1)
        needles = np.flatnonzero(needles > LIMITS.needle_share * needles.max())
        return TriangleQuality(0.0, rounding, len(needles), int(faces[needles[0], 0]))
    obtuse = cotangents < 0.0
    excess = -cotangents * (squares / area) ** 2
    # The excess of an edge is at most half of what its triangles would have alone.
    most = 0.5 * _beyond_largest(excess[obtuse], faces[obtuse], len(vertices)).sum()
    if most <= LIMITS.stiffness or len(vertices) < LIMITS.fewest_vertices:
        return TriangleQuality(0.0, rounding, 0, 0)
    excess = _excess_of_edges(cotangents, squares / area, faces)
    beyond = _beyond_largest(excess[excess > 0.0], faces[excess > 0.0], len(vertices))
    return TriangleQuality(
        float(beyond.sum()), rounding, int(np.count_nonzero(excess.any(axis=1))), int(np.argmax(beyond))
    )


def _beyond_largest(excess: Floats, corners: Ints, count: int) -> Floats:
    """Sums (count,) of the excess energies at each corner, without the largest of each."""
    largest = np.zeros(count)
    np.maximum.at(largest, corners, excess)
    return np.bincount(corners, excess, count) - largest


def _excess_of_edges(cotangents: Floats, squares: Floats, faces: Ints) -> Floats:
    """Excess energy (m, 3) of each corner by the edge opposite, its share in the edge's negative weight."""
    ends = np.sort(np.stack([faces[:, [1, 2, 0]], faces[:, [2, 0, 1]]], axis=-1).reshape(-1, 2), axis=1)
    pairs = np.lexsort(ends.T).reshape(-1, 2)
    weights = 0.5 * cotangents.ravel()[pairs].sum(axis=1)
    negative = np.minimum(cotangents.ravel()[pairs], 0.0)
    # What rounding leaves of angles that add up to pi is no excess.
    beyond_pi = weights < -1e-9
    pairs, negative = pairs[beyond_pi], negative[beyond_pi]
    share = negative / negative.sum(axis=1, keepdims=True)
    result = np.zeros(faces.size)
    result[pairs] = -weights[beyond_pi, None] * share * squares.ravel()[pairs] ** 2
    return result.reshape(faces.shape)
