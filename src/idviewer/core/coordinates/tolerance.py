"""Mean value interpolation within a tolerance that it checks itself."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from idviewer.core._kernels.treecode.normalize import Target
from idviewer.core.arrays import Floats, Ints
from idviewer.core.coordinates.treecode import Treecode


@dataclass(frozen=True)
class ApproximationSettings:
    """Settings by which an approximation meets its tolerance.

    Attributes:
        finest_tolerance: for smaller ones the exact loop over all faces is about as quick, and single
            precision ends.
        aims: shares of the tolerance that are aimed at, one after the other; points that fail all checks are
            evaluated exactly.
        negligible_share: share of the tolerance up to which columns that count little are left out, as zeros.
    """

    finest_tolerance: float = 5e-6
    aims: tuple[float, ...] = (0.7, 0.07)
    negligible_share: float = 0.2


class ExactCoordinates(Protocol):
    """Exact coordinates of a mesh, on which an approximation falls back.

    Attributes:
        tolerance: distance from the surface below which a point lies on it, in diagonals.
    """

    tolerance: float

    @property
    def normalised_mesh(self) -> tuple[Floats, Ints]:
        """Vertices (n, 3) about the bounding box's centre, in its diagonals, and faces (m, 3)."""

    def normalise(self, points: Floats) -> Floats:
        """Points (p, 3) about the bounding box's centre, in its diagonals."""

    def interpolate_steps(self, points: Floats, values: Floats) -> Generator[float, None, Floats]:
        """Values (p, k) at points (p, 3) of values (n, k) at the vertices."""

    def blank(self, points: Floats, rows: Floats, chosen: Ints | None = None) -> None:
        """Set rows (p, k) of points (p, 3) to NaN where a surface that overlaps itself leaves no value.

        Args:
            points, rows: of all points.
            chosen: numbers of the points to look at; all by default.
        """


class Approximation:
    """Values given at the vertices, carried to inner points within a tolerance.

    Far faces act through the moments of clusters (docs/treecode.md). The positions are carried along
    with the values: how well they come back is the check of each point.

    Args:
        coordinates: of the mesh.
        values: (n, k).
        weights: (k,) an error e (k,) of a point's values is measured as |weights * e|.

    >>> from idviewer.core import MeanValueCoordinates, read_mesh, sample_path
    >>> from idviewer.core.steps import finish
    >>> hand = read_mesh(sample_path("hand_2k"))
    >>> heights, centre = hand.vertices[:, 2:], hand.vertices.mean(axis=0)[None]
    >>> approximation = MeanValueCoordinates(hand).approximation(heights, np.ones(1))
    >>> height = finish(approximation.interpolate_steps(centre, 1e-3))
    >>> bool(abs(height - centre[:, 2]) < 1e-3)
    True
    """

    settings: ClassVar[ApproximationSettings] = ApproximationSettings()

    def __init__(self, coordinates: ExactCoordinates, values: Floats, weights: Floats) -> None:
        self._coordinates, self._values, self._weights = coordinates, values, weights
        self._trees: dict[int, tuple[Treecode, Ints]] = {}

    def interpolate_steps(self, points: Floats, tolerance: float) -> Generator[float, None, Floats]:
        """Values at points; yields the share done every few milliseconds.

        Args:
            points: (p, 3).
            tolerance: error allowed.

        Returns:
            (p, k), NaN for points outside the mesh.
        """
        if tolerance < self.settings.finest_tolerance:
            return (yield from self._coordinates.interpolate_steps(points, self._values))
        tree, columns = yield from self.prepare_steps(tolerance)
        result = np.zeros((len(points), self._values.shape[1]))
        places = self._coordinates.normalise(points)
        # All that is farther out than the corners of the bounding box is outside.
        near = np.abs(places).max(axis=1, initial=0.0) <= 0.5
        result[~near] = np.nan
        left = np.flatnonzero(near)
        for aim in self.settings.aims:
            doubtful = np.zeros(len(left), dtype=np.bool_)
            target = Target(left, columns, result, doubtful)
            yield from tree.interpolate_steps(places[left], aim * tolerance, tolerance, target)
            left = left[doubtful]
            if len(left) == 0:
                break
        approximated = np.setdiff1d(np.flatnonzero(near), left)
        self._coordinates.blank(points, result, approximated)
        if len(left):
            result[left] = yield from self._coordinates.interpolate_steps(points[left], self._values)
        return result

    def prepare_steps(self, tolerance: float) -> Generator[float, None, tuple[Treecode, Ints]]:
        """Prepare the tree for a tolerance, where none serves: one for each power of ten.

        Args:
            tolerance: error allowed.

        Returns:
            The tree, and the numbers of the columns of values that it holds.
        """
        power = math.floor(math.log10(tolerance) + 1e-9)
        if power not in self._trees:
            columns = self._columns_that_count(10.0**power)
            tree = yield from Treecode.build_steps(
                self._coordinates.normalised_mesh,
                self._values[:, columns],
                self._weights[columns],
                10.0**power,
                self._coordinates.tolerance,
            )
            self._trees[power] = tree, columns
        return self._trees[power]

    def _columns_that_count(self, tolerance: float) -> Ints:
        """All but the columns that together stay below a part of the tolerance."""
        largest = np.abs(self._weights) * np.abs(self._values).max(axis=0, initial=0.0)
        order = np.argsort(largest, kind="stable")
        dropped = np.sqrt(np.cumsum(largest[order] ** 2)) <= self.settings.negligible_share * tolerance
        return np.sort(order[~dropped])
