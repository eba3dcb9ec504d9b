"""An outline sampled again, and the bridges that join loops."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.core.outlines import SQUARE, circle, flower, regular, staircase, with_holes

from idviewer.core import Polygon, PolygonError


def test_a_square_is_sampled_evenly_and_exactly():
    sampled = Polygon(3 * SQUARE + 5, name="square").resampled(48)
    assert len(sampled.vertices) == 48
    np.testing.assert_allclose(sampled.lengths, 0.25, rtol=1e-12)
    assert sampled.area == pytest.approx(9.0, rel=1e-14)
    assert sampled.name == "square"
    assert all((sampled.vertices == corner).all(axis=1).any() for corner in 3 * SQUARE + 5)


def test_smooth_outlines_are_sampled_evenly():
    sampled = regular(1000).resampled(100)
    np.testing.assert_allclose(sampled.lengths, 2 * math.sin(math.pi / 100), rtol=1e-4)
    assert flower(400).resampled(133).area == pytest.approx(flower(400).area, rel=1e-2)


def test_loops_share_points_by_their_length():
    plate = with_holes().resampled(300)
    lengths = [plate.lengths[loop].sum() for loop in plate.loops]
    shares = [len(loop) / 300 for loop in plate.loops]
    np.testing.assert_allclose(shares, np.array(lengths) / sum(lengths), atol=0.03)


def test_sampling_keeps_corners_also_when_there_are_few_points():
    stairs = staircase(9)
    assert stairs.resampled(len(stairs.vertices)).area == pytest.approx(stairs.area, rel=1e-14)
    with pytest.raises(
        PolygonError, match=r"with 5 points: 5 points are too few for the 20 corners; ask for more"
    ):
        stairs.resampled(5)
    with pytest.raises(PolygonError, match="with 2 points: "):
        regular(100).resampled(2)


def test_too_coarse_a_sampling_says_so():
    angles = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    radii = 1 + 0.5 * np.cos(3 * angles)
    outer, inner = (np.stack([r * np.cos(angles), r * np.sin(angles)], axis=1) for r in (radii, 0.98 * radii))
    with pytest.raises(PolygonError, match=r"with 26 points: edge .* crosses"):
        Polygon.of_loops([outer, np.roll(inner, 14, axis=0)]).resampled(26)


def test_one_loop_has_no_bridges():
    assert regular(9).bridges.shape == (0, 2)


def test_bridges_are_the_minimum_spanning_tree(rng):
    from scipy.sparse.csgraph import minimum_spanning_tree

    centres = [(x, y) for x in range(4) for y in range(3)]
    holes = [circle(9, rng.uniform(0.1, 0.4), centre) for centre in centres]
    plate = Polygon.of_loops([np.array([[-1, -1], [5, -1], [5, 4], [-1, 4]]), *holes])
    apart = np.zeros((len(plate.loops),) * 2)
    for i, one in enumerate(plate.loops):
        for j, other in enumerate(plate.loops[:i]):
            gaps = plate.vertices[one][:, None] - plate.vertices[other]
            apart[i, j] = np.linalg.norm(gaps, axis=2).min()
    assert plate.bridges.shape == (12, 2)
    assert plate.bridge_lengths.sum() == pytest.approx(minimum_spanning_tree(apart).sum(), rel=1e-12)
    reached = set(plate.loops[0].tolist())
    for near, far in plate.bridges.tolist():
        assert near in reached
        assert far not in reached
        reached |= set(next(loop for loop in plate.loops if far in loop).tolist())
