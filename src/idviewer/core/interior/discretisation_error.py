"""The error of a boundary's discretisation in interior distances, estimated from two levels.

It has two causes, which are estimated apart. Functions are linear on *edges* and faces: the same distances on
a boundary with edges twice as long, or half as long, tell how much that matters, for such errors fall with
the square of the edges' length. And *faces* may stand for a smooth body, whose chords they are: where they
meet at small angles, the same distances in the body that a curved subdivision makes of them tell of that. See
docs/resolution.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from idviewer.core.arrays import Floats, Ints, as_pairs
from idviewer.core.distances import percentage
from idviewer.core.errors import ShapeError
from idviewer.core.interior.barycentroid import interior_samples
from idviewer.core.interior.solver import InteriorDistance


@dataclass(frozen=True)
class DiscretisationSettings:
    """Settings of the estimate.

    Attributes:
        finer_up_to: vertices of the meshes, not refined, that are compared with a finer one; others with a
            simplified one.
        simplified: of the vertices, that the simplified one has.
        most_simplified: vertices that it has at most.
        coarseness: how many times as long edges are on the coarser level of a refined boundary; the second is
            tried where the first is too coarse for as many modes.
        least_ratio: of the finer to the coarser level's vertices.
        safety: factor on what the theory makes of the difference to a coarser level, for boundaries whose
            corners keep errors from falling with the square of the length.
        finer_safety: likewise to a finer level, and to a curved one.
        same_fineness: share of the vertices by which two levels may differ whose edges count as equally long.
        points: whose distances are compared: so many inside, near the surface, and on it.
        depth: of those near the surface, as a share of the way to a point inside.
        pairs: of points, where each pair takes a solve.
        floor: of an estimate for a pair, in units of the typical relative error: two levels may agree by
            chance.
        serious: share of a distance from which on an error is told in words.
    """

    finer_up_to: int = 1500
    simplified: float = 0.25
    most_simplified: int = 6000
    coarseness: tuple[float, ...] = (2.0, 1.4)
    least_ratio: float = 1.5
    safety: float = 2.0
    finer_safety: float = 1.25
    same_fineness: float = 0.2
    points: int = 16
    depth: float = 0.1
    pairs: int = 60
    floor: float = 0.5
    serious: float = 0.05


DISCRETISATION = DiscretisationSettings()


@dataclass(frozen=True)
class DiscretisationError:
    """Estimated errors by a boundary's discretisation.

    Attributes:
        lambda_2: relative, by edges that are too long; 0 for distances without eigenpairs.
        distances: largest one of a distance by the same cause, as a share of the largest distance.
        faces_lambda_2: relative, by faces that stand for a smooth body; 0 where all of them are sharp.
        faces_distances: largest one of a distance by the same cause, as a share of the largest distance.
        largest: the largest distance among the samples.
    """

    lambda_2: float = 0.0
    distances: float = 0.0
    faces_lambda_2: float = 0.0
    faces_distances: float = 0.0
    largest: float = 0.0

    @property
    def total_lambda_2(self) -> float:
        """Of lambda_2 by both causes, relative."""
        return self.lambda_2 + self.faces_lambda_2

    @property
    def total_distances(self) -> float:
        """Of distances by both causes, as a share of the largest."""
        return self.distances + self.faces_distances

    def scaled(self, factor: float) -> DiscretisationError:
        """The errors of a finer level.

        Args:
            factor: how much smaller they are there.

        >>> DiscretisationError(0.01, 0.02, 0.0, 0.01, 1.0).scaled(0.5).distances
        0.01
        """
        return DiscretisationError(
            factor * self.lambda_2,
            factor * self.distances,
            factor * self.faces_lambda_2,
            factor * self.faces_distances,
            self.largest,
        )

    @property
    def serious(self) -> bool:
        """Whether it has to be told in words.

        >>> DiscretisationError(0.01, 0.02, 0.0, 0.01, 1.0).serious
        False
        """
        return max(self.total_distances, self.total_lambda_2) > DISCRETISATION.serious

    @property
    def remark(self) -> str:
        """The errors in words, one sentence; empty where there are none.

        >>> DiscretisationError(0.01, 0.02, 0.0, 0.01, 1.0).remark
        'Discretisation: distances within about 3% of the largest, lambda_2 within 1%'
        """
        if self.largest == 0.0:
            return ""
        told = f"Discretisation: distances within about {percentage(self.total_distances)} of the largest"
        if self.total_lambda_2:
            told += f", lambda_2 within {percentage(self.total_lambda_2)}"
        if self.faces_distances > 0.5 * self.total_distances:
            told += ", if the faces stand for a smooth body"
        if self.serious:
            told += "; results may be off by more than 5%: take a finer shape, or let it be refined"
        return told


@dataclass(frozen=True, eq=False)
class Comparison:
    """Two levels of a boundary, whose difference tells an error.

    Attributes:
        other: the solver on the other level.
        base: the one that it is compared with.
        factor: from their difference to the error.
    """

    other: InteriorDistance
    base: InteriorDistance
    factor: float

    def errors(self, first: Floats, second: Floats) -> Floats:
        """Errors (p,) of distances between points (p, dimension); NaN where one level has no value.

        Args:
            first, second: the ends of each pair.
        """
        return self.factor * np.abs(self.other.distance(first, second) - self.base.distance(first, second))

    def errors_of_pairs(self, points: Floats, pairs: Ints) -> Floats:
        """Likewise of pairs (q, 2) of points (p, dimension)."""
        there, here = (distances_of_pairs(one, points, pairs) for one in (self.other, self.base))
        return self.factor * np.abs(there - here)

    @property
    def lambda_2(self) -> float:
        """Relative error of lambda_2; 0 for distances without eigenpairs."""
        if not self.base.boundary.distance.spectral:
            return 0.0
        here, there = float(self.base.spectrum.values[0]), float(self.other.spectrum.values[0])
        return self.factor * abs(there / here - 1.0)


def distances_of_pairs(solver: InteriorDistance, points: Floats, pairs: Ints) -> Floats:
    """Distances (q,) of pairs of points, each of which is embedded once.

    Args:
        solver: of the distances.
        points: (p, dimension).
        pairs: (q, 2) of their numbers.

    >>> from idviewer.core import Euclidean, Polygon
    >>> solver = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
    >>> distances_of_pairs(solver, np.array([[1.0, 1], [3, 1]]), np.array([[0, 1]])).round(12).tolist()
    [2.0]
    """
    if solver.boundary.form is not None:
        return solver.distance(points[pairs[:, 0]], points[pairs[:, 1]])
    rows = solver.embed(points)
    return np.asarray(np.linalg.norm(rows[pairs[:, 0]] - rows[pairs[:, 1]], axis=1))


class Discretisation:
    """Estimates of a solver's errors by the discretisation of its boundary.

    Args:
        solver: whose errors they are.
        edges: the comparison with longer or shorter edges; None where the distance is exact.
        faces: the comparison with a curved boundary; None where all faces are sharp, or where the other
            comparison tells of both causes.

    >>> from idviewer.core import Euclidean, Polygon
    >>> exact = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
    >>> Discretisation(exact, None).errors([[1, 1]], [[3, 1]]).tolist()
    [0.0]
    """

    def __init__(
        self, solver: InteriorDistance, edges: Comparison | None, faces: Comparison | None = None
    ) -> None:
        self._solver = solver
        self._causes = [one for one in (edges, faces) if one is not None]
        self._typical = 0.0
        self.summary = DiscretisationError()
        """Errors anywhere in the body."""
        if edges is not None:
            self.summary = self._summary(edges, faces)

    def _summary(self, edges: Comparison, faces: Comparison | None) -> DiscretisationError:
        points = sample_points(self._solver)
        pairs = np.column_stack(np.triu_indices(len(points), 1))
        if self._solver.boundary.form is not None:
            pairs = pairs[:: -(-len(pairs) // DISCRETISATION.pairs)]
        distances = distances_of_pairs(self._solver, points, pairs)
        by_cause = [one.errors_of_pairs(points, pairs) for one in self._causes]
        known = np.isfinite(distances) & np.isfinite(by_cause).all(axis=0)
        if not known.any():
            raise ShapeError("the error of the discretisation cannot be told: the levels share no point")
        largest = float(distances[known].max())
        shares = np.sum(by_cause, axis=0)[known] / np.maximum(distances[known], 1e-3 * largest)
        self._typical = float(np.median(shares))
        worst = [float(one[known].max()) / largest for one in by_cause]
        return DiscretisationError(
            edges.lambda_2,
            worst[0],
            0.0 if faces is None else faces.lambda_2,
            0.0 if faces is None else worst[1],
            largest,
        )

    def errors(self, p: ArrayLike, q: ArrayLike) -> Floats:
        """Estimated errors of distances, by both causes together.

        Args:
            p, q: (p, dimension) or (1, dimension).

        Returns:
            (p,) in the distances' unit; where a level has no value at a point, the largest found anywhere.

        Raises:
            ValueError: the points have another dimension, or there are not as many of both.
        """
        first, second = np.broadcast_arrays(*as_pairs(p, q, self._solver.shape.dimension))
        if not self._causes:
            return np.zeros(len(first))
        found = np.sum([one.errors(first, second) for one in self._causes], axis=0)
        # Two levels may agree by chance.
        least = DISCRETISATION.floor * self._typical * self._solver.distance(first, second)
        most = self.summary.total_distances * self.summary.largest
        return np.where(np.isfinite(found), np.fmax(found, least), most)


def sample_points(solver: InteriorDistance) -> Floats:
    """Points (p, dimension) inside a shape, near its surface, and on it: vertices.

    Args:
        solver: on a mesh or a polygon.
    """
    given = solver.boundary.full_shape
    inside = interior_samples(given)
    chosen = np.linspace(0, len(given.vertices) - 1, DISCRETISATION.points).astype(int)
    on = given.vertices[np.unique(chosen)]
    if len(inside) == 0:
        return on
    near = cKDTree(inside).query(on)[1]
    beside = on + DISCRETISATION.depth * (inside[near] - on)
    some = np.unique(np.linspace(0, len(inside) - 1, DISCRETISATION.points).astype(int))
    return np.concatenate([inside[some], beside, on])
