"""Slices in one call of the library: what the session's last frame shows, and what `field` says there."""

from __future__ import annotations

import numpy as np
import pytest
from tests.session.bodies import egg

from idviewer.core import GPS, InteriorDistance, Plane, Polygon, slice_values
from idviewer.core.sampling import POLYGON_PLANE, SampledSlice, SliceValues, SourceError, sample_slice
from idviewer.session import Query, run_to_end

MESH = egg(3)
PLANE = Plane((0.1, 0.0, 0.0), (1.0, 0.2, 0.1))
SOURCE = (0.0, 0.3, 0.5)
ANGLES = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
STAR = Polygon(np.column_stack([np.cos(ANGLES), np.sin(ANGLES)]) * (2.0 + np.cos(5 * ANGLES))[:, None])


@pytest.fixture(scope="module")
def solver() -> InteriorDistance:
    return InteriorDistance(MESH)


def inner(one: SliceValues | SampledSlice) -> np.ndarray:
    """Points off the outline."""
    return np.setdiff1d(np.arange(len(one.points)), np.concatenate(one.outline))


def assert_same(one: SliceValues, other: SliceValues) -> None:
    assert one.plane == other.plane
    for name in ("points", "triangles"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    np.testing.assert_allclose(one.values, other.values, rtol=1e-12)
    for loop, same in zip(one.outline, other.outline, strict=True):
        np.testing.assert_array_equal(loop, same)


@pytest.mark.slow
def test_it_is_the_last_frame_of_the_session(solver):
    frame = run_to_end(MESH, Query((PLANE,), SOURCE))
    assert_same(slice_values(solver, PLANE, SOURCE), frame.slices[0])


@pytest.mark.slow
def test_a_polygon_needs_no_plane_and_the_barycentroid_is_the_source():
    found = slice_values(InteriorDistance(STAR, GPS()))
    (one,) = run_to_end(STAR, Query(distance=GPS())).slices
    assert_same(found, one)
    assert found.plane == POLYGON_PLANE
    assert (found.points[:, 2] == 0.0).all()


@pytest.mark.parametrize("nodes", [50, 400])
def test_values_are_those_of_field(solver, nodes):
    found = slice_values(solver, PLANE, SOURCE, nodes=nodes)
    within = inner(found)
    assert 0.8 * nodes < len(within) < 1.5 * nodes
    expected = solver.field(SOURCE, found.points[within])
    np.testing.assert_allclose(found.values[within], expected, rtol=1e-9)
    assert found.triangles.max() == len(found.points) - 1


@pytest.mark.slow
def test_within_a_tolerance():
    solver = InteriorDistance(egg(4))
    exact, near = (slice_values(solver, PLANE, SOURCE, rtol, nodes=300) for rtol in (0.0, 1e-3))
    np.testing.assert_array_equal(near.points, exact.points)
    embedded = solver.boundary.embedding
    largest = max(np.linalg.norm(embedded - one, axis=1).max() for one in embedded[::100])
    apart = np.abs(near.values - exact.values).max()
    assert 0.0 < apart <= 1e-3 * largest


def test_rows_are_the_embedding(solver):
    found = sample_slice(solver, PLANE, nodes=50)
    within = inner(found)
    expected = solver.embed(found.points[within])
    np.testing.assert_allclose(
        found.rows[within] * solver.boundary.scale, expected, rtol=0, atol=1e-12 * np.abs(expected).max()
    )


def test_a_plane_that_misses_gives_nothing(solver):
    found = slice_values(solver, Plane((50.0, 0.0, 0.0), (1.0, 0.0, 0.0)), SOURCE)
    assert len(found.points) == len(found.triangles) == len(found.values) == len(found.outline) == 0


def test_what_cannot_be_sliced_is_refused(solver):
    with pytest.raises(SourceError, match="lies outside the mesh; choose a point inside"):
        slice_values(solver, PLANE, (9.0, 0.0, 0.0), nodes=50)
    with pytest.raises(ValueError, match=r"a mesh is sliced by a plane; give one"):
        slice_values(solver)
    with pytest.raises(ValueError, match=r"rtol must lie in \[0, 1\), not 1.5"):
        slice_values(solver, PLANE, rtol=1.5)
    with pytest.raises(ValueError, match="at least one node, not 0"):
        slice_values(solver, PLANE, nodes=0)
    with pytest.raises(ValueError, match=r"points must have shape \(p, 3\)"):
        slice_values(solver, PLANE, (0.0, 0.1), nodes=50)
