"""The search for the barycentroid with a scout, which tells the potential within a tolerance."""

from __future__ import annotations

from collections.abc import Generator
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from idviewer.core import Diffusion, InteriorDistance, read_mesh, sample_path
from idviewer.core.interior.barycentroid import Evaluate, barycentroid_steps
from idviewer.core.steps import finish

Floats = NDArray[np.float64]

TOLERANCE = 4e-4


@pytest.fixture(scope="module")
def solver() -> InteriorDistance:
    return InteriorDistance(read_mesh(sample_path("hand_2k")))


class Counted:
    """A potential that counts its points, with errors of up to a share of its largest value."""

    def __init__(self, potential: Evaluate, share: float = 0.0) -> None:
        self.count, self.noise = 0, 0.0
        self._potential, self._share, self._rng = potential, share, np.random.default_rng(3)

    def __call__(self, points: Floats) -> Generator[float | None, None, Floats]:
        values = yield from self._potential(points)
        self.count += len(points)
        self.noise = max(self.noise, self._share * float(np.nanmax(values)))
        return values + self._rng.uniform(-self.noise, self.noise, len(points))


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.0, TOLERANCE])
def test_a_scout_leads_to_the_same_point_sooner(solver, share):
    alone, led, surrogate = (
        Counted(solver.interpolation.potential_steps, noise) for noise in (0.0, 0.0, share)
    )
    expected = finish(barycentroid_steps(solver.shape, alone))
    found = finish(barycentroid_steps(solver.shape, led, surrogate=surrogate))
    assert np.linalg.norm(found.point - expected.point) < 1e-7 * solver.shape.diagonal
    assert found.potential == pytest.approx(expected.potential, rel=1e-12)
    assert led.count < 0.6 * alone.count


@pytest.mark.slow
def test_where_a_scout_sees_too_little_it_is_not_followed(solver):
    """After a long time the potential is nearly 0 along a valley, and the tolerance hides its floor."""
    late = solver.with_distance(Diffusion(time=30 / (8 * solver.spectrum.values[0])))
    expected = finish(barycentroid_steps(late.shape, late.interpolation.potential_steps))
    found = finish(
        barycentroid_steps(
            late.shape,
            late.interpolation.potential_steps,
            surrogate=Counted(late.interpolation.potential_steps, 0.01 * TOLERANCE),
        )
    )
    np.testing.assert_array_equal(found.point, expected.point)


@pytest.mark.slow
def test_the_tree_is_such_a_scout(solver):
    surrogate = partial(solver.interpolation.potential_steps, rtol=TOLERANCE)
    expected, found = solver.barycentroid(), finish(solver.barycentroid_steps(surrogate))
    assert np.linalg.norm(found.point - expected.point) < 1e-7 * solver.shape.diagonal
