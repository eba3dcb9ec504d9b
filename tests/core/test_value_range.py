"""Distances beyond floats are refused with a line, and within them follow their scale laws."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes

from idviewer.core import (
    Biharmonic,
    Diffusion,
    DistanceError,
    Euclidean,
    GivenEmbedding,
    InteriorDistance,
    Mesh,
    Polygon,
    SpectralFilter,
)

BODY = shapes.icosphere(1)[0] * [1.0, 1.3, 0.8] + [0.3, 0.0, 0.0]
MESH = Mesh(BODY + np.outer(BODY[:, 1] ** 2, [0.3, 0.0, 0.0]), shapes.icosphere(1)[1])
OUTLINE = Polygon([[0, 0], [3, 0], [3, 1], [1, 1], [1, 2], [0, 2]]).resampled(40)


@pytest.fixture(scope="module")
def solver() -> InteriorDistance:
    return InteriorDistance(MESH, refine="no")


@pytest.mark.slow
def test_a_time_after_which_nothing_is_left_is_refused(solver):
    lambda_2 = float(solver.spectrum.values[0])
    for time in (310 / lambda_2, 1e3, 1e300):
        with pytest.raises(DistanceError, match=r"the diffusion time .* is too long for this shape") as error:
            solver.with_distance(Diffusion(time=time))
        allowed = float(str(error.value).rpartition(" ")[2])
        assert allowed == pytest.approx(276.3 / lambda_2, rel=0.01)
    kept = solver.with_distance(Diffusion(time=allowed))
    # The first mode alone is left: distances are its differences.
    ends = MESH.vertices[:1], MESH.vertices[5:6]
    first = solver.spectrum.vectors[[0, 5], 0]
    expected = abs(first[0] - first[1]) * np.exp(-lambda_2 * allowed)
    assert kept.distance(*ends)[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("1e-200 / x", "too small"),
        ("1e-320", "too small"),
        ("1e300 * x", "too large"),
        ("exp(18 * x)", "too large"),
        ("1e155 / x", "too large"),
    ],
)
def test_filters_beyond_floats_are_refused(solver, text, size):
    with pytest.raises(DistanceError, match=f"is {size}; a factor before it changes the unit") as error:
        solver.with_distance(SpectralFilter(text))
    assert "\n" not in str(error.value)


@pytest.mark.slow
def test_a_filter_of_any_size_within_is_the_same_but_for_its_unit(solver):
    usual = solver.with_distance(SpectralFilter("1 / x"))
    ends = [[0.2, 0.3, 0.1]], [[0.3, -0.2, 0.1]]
    middle = usual.barycentroid().point
    for factor in (1e-120, 1e120):
        found = solver.with_distance(SpectralFilter(f"{factor!r} / x"))
        assert found.distance(*ends)[0] == pytest.approx(factor * usual.distance(*ends)[0], rel=1e-12)
        np.testing.assert_allclose(found.barycentroid().point, middle, atol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("size", [1e-59, 1e59])
@pytest.mark.parametrize(("kind", "powers"), [(Biharmonic, (1.5, 1.0)), (Diffusion, (-0.5, -1.0))])
def test_the_smallest_and_largest_shapes_follow_the_scale_law(size, kind, powers):
    for shape, ends, power in (
        (OUTLINE, ([[0.5, 0.5]], [[2.0, 0.4]]), powers[0]),
        (MESH, ([[0.4, 0.3, 0.1]], [[0.5, -0.2, 0.1]]), powers[1]),
    ):
        scaled = shape.vertices * size
        other = Mesh(scaled, shape.faces) if isinstance(shape, Mesh) else Polygon(scaled)
        usual, found = InteriorDistance(shape, kind()), InteriorDistance(other, kind())
        expected = usual.distance(*ends)[0] * size**power
        assert found.distance(*(np.array(end) * size for end in ends))[0] == pytest.approx(expected, rel=1e-8)
        if shape.dimension == 2:
            gap = found.barycentroid().point / size - usual.barycentroid().point
            assert np.abs(gap).max() < 1e-6 * shape.diagonal


def test_given_values_beyond_floats_are_refused():
    with pytest.raises(DistanceError, match="given embedding: distances reach about 1e\\+200"):
        _ = InteriorDistance(
            MESH, GivenEmbedding(1e200 * MESH.vertices / np.abs(MESH.vertices).max())
        ).boundary.scale
    assert InteriorDistance(MESH, GivenEmbedding(np.zeros((42, 2)))).field(
        [0, 0, 0], [[0.1, 0, 0]]
    ).tolist() == [0.0]
    assert InteriorDistance(MESH, Euclidean()).boundary.barycentroid_remark == ""


def test_a_barycentroid_that_too_few_modes_determine_has_a_remark(solver):
    values = solver.spectrum.values
    assert solver.boundary.barycentroid_remark == ""
    third = float(np.log(1e4) / (values[2] - values[0]))
    assert solver.with_distance(Diffusion(time=0.9 * third)).boundary.barycentroid_remark == ""
    remark = solver.with_distance(Diffusion(time=1.2 * third)).boundary.barycentroid_remark
    assert remark == (
        "Only 2 modes count with these parameters, so the barycentroid is not determined accurately"
    )
