"""Descriptors of shapes: some numbers by which shapes are told apart, wherever and however large they are.

They do not change where a shape is moved, turned or scaled, and little where it is meshed anew. Eigenvalues
do not change under isometric deformation of the boundary either; the others measure the inside.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import pdist

from idviewer.core.arrays import Floats
from idviewer.core.errors import ShapeError
from idviewer.core.interior.random_points import random_interior_points
from idviewer.core.interior.solver import InteriorDistance
from idviewer.core.spectrum.eigen_solver import eigenpairs
from idviewer.core.spectrum.resolution import resolved_steps
from idviewer.core.steps import finish

PARTS = ("eigenvalues", "distances", "potential")
"""Parts of which a difference of two shapes is the sum."""


@dataclass(frozen=True)
class DescriptorSettings:
    """Sizes of the descriptors; only shapes described with the same ones can be compared.

    Attributes:
        eigenvalues: how many.
        points: inside the shape, random ones.
        costly_points: likewise, where there is no embedding and each distance takes a solve.
        seed: of their random numbers.
        bins: of the histogram of distances.
        widest: distance at which the histogram ends, in mean distances; what is farther is in the last bin.
        quantiles: of the potential at the points, evenly spaced, without the smallest and the largest value.
        halvings: of the points, which tell the error of sampling.
        error_factor: of the errors stated, in mean differences of halves.
        shifts: of the list of points against itself, where there is no embedding to take all pairs of.
    """

    eigenvalues: int = 20
    points: int = 1000
    seed: int = 0
    bins: int = 32
    widest: float = 3.0
    quantiles: int = 9
    costly_points: int = 250
    shifts: int = 4
    halvings: int = 8
    error_factor: float = 2.0


DESCRIPTORS = DescriptorSettings()


@dataclass(frozen=True, eq=False)
class ShapeDescriptors:
    """Descriptors of one shape, without units.

    Attributes:
        dimension: of the space, 2 or 3.
        eigenvalues: lambda_2 and the next ones times the boundary's area, or its length squared in the plane;
            NaN where there are no more. Source: Reuter, Wolter and Peinecke 2006, "Laplace-Beltrami spectra
            as Shape-DNA of surfaces and solids".
        boundary_size: area, or length in the plane, that they were multiplied by, in the shape's unit.
        distances: histogram of interior distances between random points inside, in mean distances; the shares
            sum to 1. Source: Osada et al. 2002, "Shape distributions", there D2 of Euclidean distances.
        mean_distance: the unit of the histogram and of the potential.
        widest: distance at which the histogram ends, in mean distances.
        potential: quantiles of the potential U at these points, in mean distances.
        distances_error: largest difference of "distances" between two drawings of points, as halves tell it.
        potential_error: likewise of "potential".
    """

    dimension: int
    eigenvalues: Floats
    boundary_size: float
    distances: Floats
    mean_distance: float
    widest: float
    potential: Floats
    distances_error: float
    potential_error: float

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers and lists, for JSON; NaN stands for what is not there."""
        return {
            name: value.tolist() if isinstance(value, np.ndarray) else value
            for name, value in vars(self).items()
        }

    @classmethod
    def from_dict(cls, stored: Mapping[str, Any]) -> ShapeDescriptors:
        """Make descriptors of what `as_dict` gave; None, as JSON has it, stands for NaN.

        Args:
            stored: the plain numbers and lists.

        Raises:
            ValueError: something is missing, or is no such thing.
        """
        try:
            return cls(
                dimension=int(stored["dimension"]),
                eigenvalues=_floats(stored["eigenvalues"]),
                boundary_size=float(stored["boundary_size"]),
                distances=_floats(stored["distances"]),
                mean_distance=float(stored["mean_distance"]),
                widest=float(stored["widest"]),
                potential=_floats(stored["potential"]),
                distances_error=float(stored["distances_error"]),
                potential_error=float(stored["potential_error"]),
            )
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"these are no descriptors of a shape ({error!r})") from error


def _floats(numbers: Iterable[float | None]) -> Floats:
    return np.array([math.nan if one is None else float(one) for one in numbers])


def shape_descriptors(
    solver: InteriorDistance, settings: DescriptorSettings = DESCRIPTORS
) -> ShapeDescriptors:
    """Describe a shape by its eigenvalues and by the interior distances in it.

    Args:
        solver: the shape with its distance and coordinates.
        settings: sizes of the descriptors.

    Raises:
        ShapeError: too few points inside the shape have a distance.

    >>> from idviewer.core import Euclidean, Polygon
    >>> found = shape_descriptors(InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean()))
    >>> found.eigenvalues[:3].round(1).tolist(), round(float(found.distances.sum()), 9)
    ([39.5, 39.5, 157.8], 1.0)
    """
    shape = solver.boundary.full_shape  # whose facets are as they were given
    count = settings.points if solver.boundary.form is None else settings.costly_points
    points = random_interior_points(shape, count, settings.seed)
    heights = solver.potential(points)
    points, heights = points[np.isfinite(heights)], heights[np.isfinite(heights)]
    if len(points) < count // 2:
        raise ShapeError(
            f"{shape.name or 'the shape'}: only {len(points)} of {count} random points inside it "
            "have a distance, too few to describe it; `idviewer info` may tell why"
        )
    pairs = _pairs(solver, points, settings)
    mean = float(pairs.lengths.mean())
    inner = np.arange(1, settings.quantiles + 1) / (settings.quantiles + 1)
    size = float(solver.boundary.masses.sum())
    return ShapeDescriptors(
        shape.dimension,
        _eigenvalues(solver, settings.eigenvalues) * size ** (2.0 / (shape.dimension - 1)),
        size,
        _histogram(pairs.lengths / mean, settings),
        mean,
        settings.widest,
        np.quantile(heights, inner) / mean,
        *_sampling_errors(pairs, heights, inner, settings),
    )


def _eigenvalues(solver: InteriorDistance, count: int) -> Floats:
    """The lowest so many eigenvalues (count,) but 0; NaN where the shape has no more.

    Where the distance keeps fewer modes, or none, the boundary is refined for as many as that.
    """
    found = solver.spectrum.values if solver.boundary.distance.spectral else np.empty(0)
    if len(found) < count:
        given, option = solver.boundary.full_shape, solver.boundary.resolved.option
        # No boundary's eigenvalues grow faster than a needle's.
        resolved = finish(resolved_steps(given, option, lambda lambda_2: count**2 * lambda_2))
        found = eigenpairs(resolved.shape, k=min(count, len(resolved.shape.vertices) - 1)).values
    result = np.full(count, np.nan)
    result[: len(found[:count])] = found[:count]
    return result


class _Pairs(NamedTuple):
    """Distances (d,) between points, and the numbers (d,) of both points of each."""

    lengths: Floats
    one: NDArray[np.intp]
    other: NDArray[np.intp]


def _pairs(solver: InteriorDistance, points: Floats, settings: DescriptorSettings) -> _Pairs:
    """Distances between all pairs of points, or some pairs where each takes a solve."""
    count = len(points)
    if solver.boundary.form is None:
        return _Pairs(pdist(solver.embed(points)), *np.triu_indices(count, 1))
    shifts = np.arange(1, settings.shifts + 1)
    rows = [solver.distance(points, np.roll(points, -shift, axis=0)) for shift in shifts]
    numbers = np.tile(np.arange(count), len(shifts))
    return _Pairs(np.concatenate(rows), numbers, (numbers + np.repeat(shifts, count)) % count)


def _sampling_errors(
    pairs: _Pairs, heights: Floats, inner: Floats, settings: DescriptorSettings
) -> tuple[float, float]:
    """Errors of distances and potential: what two drawings of points differ by at most in 19 cases of 20.

    Halves have twice the variance, so they differ by 1.4 times as much in the mean as two drawings; twice
    that covers most pairs of drawings, as tests find.
    """
    rng = np.random.default_rng(settings.seed)
    found = []
    for _ in range(settings.halvings):
        chosen = rng.permutation(len(heights)) < len(heights) // 2
        both, neither = chosen[pairs.one] & chosen[pairs.other], ~(chosen[pairs.one] | chosen[pairs.other])
        below = [
            np.cumsum(_histogram(pairs.lengths[part] / pairs.lengths[part].mean(), settings))
            for part in (both, neither)
        ]
        quantiles = [
            np.quantile(heights[half], inner) / pairs.lengths[part].mean()
            for half, part in ((chosen, both), (~chosen, neither))
        ]
        found.append(
            (
                np.abs(below[0] - below[1]).mean() * settings.widest,
                np.abs(quantiles[0] - quantiles[1]).mean(),
            )
        )
    distances, potential = (settings.error_factor * np.mean(found, axis=0)).tolist()
    return distances, potential


def _histogram(lengths: Floats, settings: DescriptorSettings) -> Floats:
    edges = np.linspace(0.0, settings.widest, settings.bins + 1)
    counts, _ = np.histogram(np.minimum(lengths, settings.widest), edges)
    return counts / counts.sum()


def descriptor_differences(
    described: Sequence[ShapeDescriptors], with_size: bool = False
) -> dict[str, Floats]:
    """Differences (s, s) of all pairs of s shapes, by each part of their descriptors.

    "eigenvalues": the mean of |log(lambda_k / lambda'_k)| over those that both have. "distances": earth
    mover's distance of the two histograms, in mean distances. "potential": mean absolute difference of the
    quantiles. The size of a shape counts nothing. Among shapes with equally many eigenvalues each is a
    metric, and so is the sum.

    Args:
        described: the shapes' descriptors.
        with_size: whether it does: eigenvalues are then compared as they are, in one over the unit squared.

    Raises:
        ValueError: one is of a polygon and another of a mesh, or they were made in other ways.

    >>> from idviewer.core import Euclidean, Polygon
    >>> squares = [[[0, 0], [a, 0], [a, a], [0, a]] for a in (1.0, 4.0)]
    >>> made = [shape_descriptors(InteriorDistance(Polygon(one), Euclidean())) for one in squares]
    >>> {part: float(between[0, 1].round(9)) for part, between in descriptor_differences(made).items()}
    {'eigenvalues': 0.0, 'distances': 0.0, 'potential': 0.0}
    >>> float((descriptor_differences(made, with_size=True)["eigenvalues"][0, 1] / math.log(16.0)).round(9))
    1.0
    """
    if len({one.dimension for one in described}) > 1:
        raise ValueError("a polygon and a mesh cannot be compared: their boundaries have other dimensions")
    if len({(one.widest, *(len(getattr(one, part)) for part in PARTS)) for one in described}) > 1:
        raise ValueError("descriptors of other sizes cannot be compared; describe all shapes in the same way")
    logarithms = [np.log(one.eigenvalues) for one in described]
    if with_size:
        logarithms = [
            values - 2.0 / (one.dimension - 1) * math.log(one.boundary_size)
            for values, one in zip(logarithms, described, strict=True)
        ]
    below = [np.cumsum(one.distances) for one in described]
    widths = [one.widest for one in described[:1]]
    return {
        "eigenvalues": _mean_differences(logarithms),
        "distances": _mean_differences(below) * (widths[0] if widths else 1.0),
        "potential": _mean_differences([one.potential for one in described]),
    }


def _mean_differences(rows: Sequence[Floats]) -> Floats:
    """Mean absolute differences (s, s) of rows, over the entries that are numbers in both."""
    result = np.zeros((len(rows), len(rows)))
    table = np.array(rows)
    for number, row in enumerate(rows):
        result[number] = np.nanmean(np.abs(table - row), axis=1)
    return result
