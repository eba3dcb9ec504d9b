"""True errors: what was computed within a tolerance beside what the exact loop over all faces gives."""

from __future__ import annotations

import numpy as np
from bodies import SEED
from numpy.typing import NDArray
from scipy.spatial.distance import pdist

from idviewer.core import InteriorDistance
from idviewer.core.sampling import SliceValues
from idviewer.session.state import Frame

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ANYWHERE, IN_BAND, HIGHEST = 150, 100, 5
"""Points of a slice that are checked: at random, at random beside the outline, with the largest values."""

WORST = 20
"""The neighbours of so many of those with the largest errors are checked besides."""


def embedding_error(computed: Floats, exact: Floats, largest: float, most: int = 1000) -> float:
    """Largest error of a distance between two embedded points, as a share of the largest boundary distance.

    Of the pairs among the points that are farthest off, and among others at random.
    """
    off = np.linalg.norm(computed - exact, axis=1)
    assert np.isfinite(off).all()
    order = np.argsort(-off)
    others = np.random.default_rng(SEED).permutation(order[most // 2 :])
    chosen = np.concatenate([order[: most // 2], others[: most // 2]])
    return float(np.abs(pdist(computed[chosen]) - pdist(exact[chosen])).max() / largest)


def frame_error(frame: Frame, solver: InteriorDistance) -> float:
    """Largest error found of a value on a frame's slices, as a share of the largest value there.

    Looks at some hundred points, first spread, then around the worst of these.
    """
    exact = solver.with_distance(frame.query.distance)
    origin = exact.embed(frame.source[None])
    return max(_slice_error(one, exact, origin) for one in frame.slices)


def largest_on_slices(frame: Frame) -> float:
    """Largest value shown on a frame's slices."""
    return max(float(np.nanmax(one.values, initial=0.0)) for one in frame.slices)


def _slice_error(one: SliceValues, exact: InteriorDistance, origin: Floats) -> float:
    if not len(one.points):
        return 0.0
    first = _spread(one)
    values = _values(one, first, exact, origin)
    errors = _errors(one, first, values)
    second = np.setdiff1d(_around(one, first[np.argsort(-errors)[:WORST]]), first)
    more = _errors(one, second, _values(one, second, exact, origin))
    return float(max(errors.max(), more.max(initial=0.0)) / np.nanmax(values))


def _values(one: SliceValues, chosen: Ints, exact: InteriorDistance, origin: Floats) -> Floats:
    return np.linalg.norm(exact.embed(one.points[chosen]) - origin, axis=1)


def _errors(one: SliceValues, chosen: Ints, values: Floats) -> Floats:
    """Infinite where a value is missing; 0 where a point of the outline is outside but for rounding."""
    errors = np.abs(one.values[chosen] - values)
    errors[np.isnan(one.values[chosen])] = np.inf
    return np.where(np.isnan(values), 0.0, errors)


def _spread(one: SliceValues) -> Ints:
    generator = np.random.default_rng(SEED)
    on_outline = np.zeros(len(one.points), dtype=bool)
    on_outline[np.concatenate(one.outline)] = True
    band = np.unique(one.triangles[on_outline[one.triangles].any(axis=1)])
    band = band[~on_outline[band]]
    highest = np.argsort(-one.values)[:HIGHEST]
    anywhere = generator.permutation(len(one.points))[:ANYWHERE]
    return np.unique(np.concatenate([highest, anywhere, generator.permutation(band)[:IN_BAND]]))


def _around(one: SliceValues, points: Ints) -> Ints:
    return np.unique(one.triangles[np.isin(one.triangles, points).any(axis=1)]).astype(np.int64)
