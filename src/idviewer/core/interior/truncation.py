"""How far the truncated commute time is from the exact one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from idviewer.core.distances import GPS
from idviewer.core.distances.commute_time import CommuteTime
from idviewer.core.interior.barycentroid import interior_samples
from idviewer.core.interior.solver import InteriorDistance
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum


@dataclass(frozen=True)
class TruncationError:
    """Of the distance d over sample pairs, each relative to the exact distance of its pair.

    Attributes:
        largest: the largest relative error.
        mean: the mean relative error.
        modes: how many modes the truncated form has.
    """

    largest: float
    mean: float
    modes: int

    def __str__(self) -> str:
        return f"{self.modes} modes: {self.mean:.1%} on average, {self.largest:.1%} at most"


def truncation_error(
    shape: Shape, spectrum: Spectrum | None = None, pairs: int = 100, on: str = "inside", seed: int = 0
) -> TruncationError:
    """The error of `GPS` against `CommuteTime` on random pairs of points.

    Args:
        shape: n vertices, in 2 or 3 dimensions.
        spectrum: of the truncated form; the paper's cut-off by default.
        pairs: how many.
        on: "inside" the shape, or at its "vertices", where truncation is felt most.
        seed: of the choice.

    Raises:
        ValueError: on is neither.

    >>> from idviewer.core import read_mesh, sample_path
    >>> hand = read_mesh(sample_path("hand_2k"))
    >>> truncation_error(hand).mean < truncation_error(hand, on="vertices").mean
    True
    """
    if on not in ("inside", "vertices"):
        raise ValueError(f'pairs lie "inside" or at "vertices", not {on!r}')
    exact, truncated = (
        InteriorDistance(shape, CommuteTime()),
        InteriorDistance(shape, GPS(), spectrum=spectrum),
    )
    points = shape.vertices if on == "vertices" else interior_samples(shape)
    rng = np.random.default_rng(seed)
    p, q = points[np.array([rng.choice(len(points), 2, replace=False) for _ in range(pairs)]).T]
    wanted, found = exact.distance(p, q), truncated.distance(p, q)
    errors = np.abs(found - wanted) / wanted
    errors = errors[np.isfinite(errors)]
    return TruncationError(float(errors.max()), float(errors.mean()), len(truncated.spectrum.values))
