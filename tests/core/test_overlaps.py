"""Bodies that overlap themselves: where values are given, and where none is."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely
from tests.core import mean_value_twin, shapes
from tests.core.overlapping_bodies import OVERLAPPING, bent_tube
from tests.core.test_mean_value import winding_numbers

from idviewer.core import (
    Euclidean,
    InteriorDistance,
    MeanValueCoordinates,
    Mesh,
    read_mesh,
    sample_path,
    section,
)
from idviewer.core.coordinates import coordinates_of
from idviewer.core.coordinates.mean_value_mesh import MeshMeanValue
from idviewer.core.coordinates.weight_sums import WEIGHT_SUMS
from idviewer.core.sampling import SourceError, remarks_on, slice_values
from idviewer.core.shapes import Plane, Ray, middle_of_first_chord
from idviewer.core.shapes.nearest_points import nearest_points
from idviewer.core.shapes.winding_numbers import WindingNumbers
from idviewer.core.slices.covered_outlines import covered_outline
from idviewer.core.slices.triangulation import slice_mesh, spacing_for
from idviewer.core.steps import finish

BOUND = WEIGHT_SUMS.largest_absolute_sum
NAMES = pytest.mark.parametrize("name", OVERLAPPING)


@cache
def body(name: str) -> Mesh:
    return Mesh(*OVERLAPPING[name])


@cache
def points_around(name: str, count: int = 400) -> np.ndarray:
    """Points in the bounding box, half of them about a place where the body overlaps itself."""
    mesh, rng = body(name), np.random.default_rng(len(name))
    near = np.array(mesh.self_intersections.places[0]) + 0.1 * mesh.diagonal * rng.uniform(-1, 1, (count, 3))
    points = np.concatenate([rng.uniform(*mesh.bounds, size=(count, 3)), near])
    # Points hardly outside count as inside.
    beside = np.isfinite(nearest_points(mesh, points, np.full(len(points), 1e-4 * mesh.diagonal)).distances)
    return points[~beside]


def twin_sums(mesh: Mesh, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """W, and the same of absolute values face by face, in extended precision; its shares are twice ours."""
    shares = [mean_value_twin.shares(mesh.vertices, mesh.faces, point) for point in points]
    totals = 0.5 * np.array(shares, dtype=float).sum(axis=2)
    return totals.sum(axis=1), np.abs(totals).sum(axis=1)


def areas_of(corners: np.ndarray) -> np.ndarray:
    """Areas (t,) of triangles (t, 3, 3)."""
    return 0.5 * np.linalg.norm(np.cross(*(corners[:, 1:] - corners[:, :1]).transpose(1, 0, 2)), axis=1)


@NAMES
def test_winding_numbers_are_solid_angles(name: str) -> None:
    points = points_around(name)
    found = WindingNumbers(body(name)).at(points)
    np.testing.assert_allclose(found, winding_numbers(body(name), points), atol=1e-9)
    assert found.min() == (-1 if name == "dented through" else 0)
    assert found.max() == (1 if name in ("dented through", "spindle torus") else 2)


def test_winding_numbers_do_not_depend_on_how_rays_meet_edges(rng: np.random.Generator) -> None:
    vertices, faces = shapes.subdivided(*shapes.subdivided(*shapes.cube()))
    for size, away in ((1.0, 0.0), (1e-9, 0.0), (1.0, 1e6)):
        cube = Mesh(size * vertices + away, faces)
        lattice = np.stack(np.meshgrid(*[np.arange(-1, 6)] * 3), axis=-1).reshape(-1, 3) / 4
        lattice = lattice[((lattice != 0) & (lattice != 1)).all(axis=1)]
        inside = ((lattice > 0) & (lattice < 1)).all(axis=1)
        assert WindingNumbers(cube).at(size * lattice + away).tolist() == inside.astype(int).tolist()
    assert (
        WindingNumbers(cube).at([[np.nan, 0, 0], [np.inf, 0.5, 0.5], [0.5, 0.5, -np.inf]]).tolist() == [0] * 3
    )


@pytest.mark.slow
@NAMES
def test_sums_of_weights_decide_where_values_are_given(name: str) -> None:
    mesh, points = body(name), points_around(name)[::16]
    sums, absolute = twin_sums(mesh, points)
    mean_value = MeshMeanValue(mesh)
    found = mean_value.weight_sums.at(mean_value.normalise(points)) / mesh.diagonal
    assert (np.abs(found[:, 0] - sums) < 0.02 * absolute).all()
    share = found[:, 1] / absolute
    assert share.min() > 0.98
    assert share.max() < 1.05
    windings = winding_numbers(mesh, points).round()
    coordinates = MeanValueCoordinates(mesh)
    given = np.isfinite(coordinates.weights(points)).all(axis=1)
    expected = (windings > 0) & (sums > 0.0) & (absolute <= BOUND * sums)
    sure = np.abs(absolute - BOUND * np.abs(sums)) > 0.1 * absolute
    assert (given == expected)[sure].all()
    assert coordinates.undefined == np.count_nonzero(~given & (windings > 0))
    assert np.count_nonzero(given) > 3


@NAMES
def test_no_number_is_given_out_that_its_weights_do_not_allow(name: str) -> None:
    mesh, points = body(name), points_around(name)
    solver = InteriorDistance(mesh, Euclidean())
    rows = solver.coordinates.weights(points)
    given = np.isfinite(rows).all(axis=1)
    assert np.abs(rows[given]).sum(axis=1).max() <= BOUND
    assert not given[winding_numbers(mesh, points) < 0.5].any()
    np.testing.assert_allclose(rows[given] @ mesh.vertices, points[given], atol=1e-11)
    assert np.array_equal(np.isfinite(solver.embed(points)).all(axis=1), given)
    assert np.array_equal(np.isfinite(solver.potential(points)), given)
    assert np.array_equal(np.isfinite(solver.coordinates.negativity(points)), given)


@NAMES
def test_the_tree_gives_values_at_the_same_points(name: str) -> None:
    mesh, points = body(name), points_around(name)
    exact = MeanValueCoordinates(mesh)
    heights = mesh.vertices[:, 2:].copy()
    wanted = finish(exact.interpolate_steps(points, heights))
    tree = exact.approximation(heights, np.ones(1) / mesh.diagonal)
    before = exact.undefined
    found = finish(tree.interpolate_steps(points, 1e-3))
    assert np.array_equal(np.isfinite(found), np.isfinite(wanted))
    np.testing.assert_allclose(found, wanted, atol=1e-3 * mesh.diagonal)
    assert exact.undefined == 2 * before


@NAMES
@pytest.mark.parametrize("kind", ["mean_value", "shepard", "maximum_entropy"])
def test_inside_is_where_the_winding_number_is_positive(name: str, kind: str) -> None:
    mesh, points = body(name), points_around(name)
    inside = winding_numbers(mesh, points) > 0.5
    solver = InteriorDistance(mesh, Euclidean(), kind)
    assert np.array_equal(solver.contains(points), inside)
    rows = coordinates_of(mesh, kind).weights(points)
    assert not np.isfinite(rows[~inside]).any()
    if kind != "mean_value":
        np.testing.assert_allclose(rows[inside].sum(axis=1), 1.0)


def test_vertices_have_their_own_values() -> None:
    mesh = body("bent tube")
    np.testing.assert_allclose(MeanValueCoordinates(mesh).weights(mesh.vertices), np.eye(len(mesh.vertices)))


def test_a_body_that_touches_itself_has_no_values_at_the_wall_alone() -> None:
    mesh = Mesh(*bent_tube(1.0))
    wall = np.array([[2.0, 1e-3, 0.1], [2.0, -1e-3, 0.1], [0.0, 2.0, 0.0]])
    assert np.isfinite(MeanValueCoordinates(mesh).weights(wall)).all(axis=1).tolist() == [False, False, True]


def test_a_slit_costs_no_values() -> None:
    mesh = Mesh(*bent_tube(0.9999))
    assert not mesh.self_intersections
    points = np.array([[2.0, 1e-2, 0.1], [2.0, -1e-2, 0.1]])
    rows = MeanValueCoordinates(mesh).weights(points)
    assert np.abs(rows).sum(axis=1).min() > BOUND


def test_a_source_without_a_value_is_told_from_one_outside() -> None:
    mesh = body("bent tube")
    points = points_around("bent tube")
    rows = MeanValueCoordinates(mesh).weights(points)
    lost = points[np.isnan(rows).any(axis=1) & (winding_numbers(mesh, points) > 0.5)]
    solver, plane = InteriorDistance(mesh, Euclidean()), Plane.along("z", 0.5, mesh.bounds)
    with pytest.raises(SourceError, match="beside a place where the mesh overlaps itself"):
        slice_values(solver, plane, lost[0], nodes=20)
    with pytest.raises(SourceError, match="outside the mesh"):
        slice_values(solver, plane, [0.0, 0.0, 0.0], nodes=20)
    (remark,) = remarks_on(solver.coordinates)
    assert "overlaps itself" in remark


@NAMES
def test_sections_are_what_the_surface_goes_round(name: str) -> None:
    mesh, crossings = body(name), 0
    for axis in "xyz":
        for share in (0.3, 0.5, 0.52):
            cut = section(mesh, Plane.along(axis, share, mesh.bounds))
            np.testing.assert_allclose(cut.interpolate(mesh.vertices), cut.points, atol=1e-7 * mesh.diagonal)
            ends, shares = cut.stencil
            np.testing.assert_allclose(
                (shares[:, :, None] * mesh.vertices[ends]).sum(axis=1), cut.points, atol=1e-7
            )
            filled = slice_mesh(cut, spacing_for(cut, 200))
            corners = filled.points[filled.triangles]
            areas = 0.5 * np.linalg.norm(
                np.cross(*(corners[:, 1:] - corners[:, :1]).transpose(1, 0, 2)), axis=1
            )
            assert areas.sum() == pytest.approx(cut.area, rel=1e-9)
            windings = winding_numbers(mesh, corners.mean(axis=1))
            assert windings[areas > 1e-9 * mesh.diagonal**2].min() > 0.5
            crossings += len(cut.chords)
    assert crossings > 0 or name == "spindle torus"


def test_the_outline_of_what_is_covered() -> None:
    square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    points = np.concatenate([square, square + 1.0, square + 5.0])
    loops = (np.arange(4), np.arange(4, 8), np.arange(11, 7, -1))
    union = covered_outline(points, loops)
    assert len(union.loops) == 1, "what is wound clockwise is not covered"
    corners = np.concatenate([points[union.points], union.crossings])[union.loops[0]]
    assert shapely.Polygon(corners).area == pytest.approx(7.0)
    assert shapely.LinearRing(corners).is_ccw
    points = np.concatenate([square, 0.5 + 0.5 * square[::-1]])
    hole = covered_outline(points, (np.arange(4), np.arange(4, 8)))
    assert [shapely.LinearRing(points[loop]).is_ccw for loop in hole.loops] == [True, False]
    nothing = covered_outline(square, (np.arange(3, -1, -1),))
    assert nothing.loops == ()


@pytest.mark.slow
@NAMES
@pytest.mark.parametrize("rtol", [0.0, 1e-3])
def test_slices_have_values_where_there_are_some_and_carry_negativity(name: str, rtol: float) -> None:
    mesh = body(name)
    solver = InteriorDistance(mesh, Euclidean())
    plane = Plane.along("z", 0.5, mesh.bounds)
    found = slice_values(solver, plane, nodes=150, rtol=rtol)
    assert np.isfinite(found.values).all()
    assert found.negativity.shape == found.values.shape
    exact = solver.negativity(found.points)
    known = np.isfinite(exact)
    assert (found.negativity[known] > exact[known] - 0.02).all()
    assert found.negativity[known].max() <= 0.5 * (BOUND - 1.0)
    inner = ~np.isin(np.arange(len(found.points)), np.concatenate(found.outline))
    assert known[inner].all()
    middles = found.points[found.triangles].mean(axis=1)
    beside = np.isin(found.triangles, np.concatenate(found.outline)).any(axis=1)
    assert solver.coordinates.have_values(middles[beside]).all()
    if name != "dented through":
        whole = section(mesh, plane).area
        corners = found.points[found.triangles]
        areas = areas_of(corners)
        assert 0.5 * whole < areas.sum() <= whole * (1.0 + 1e-9)


@NAMES
def test_distances_exceed_the_boundarys_by_no_more_than_negativity_explains(name: str) -> None:
    solver, points = InteriorDistance(body(name), Euclidean()), points_around(name)
    negativity = solver.negativity(points)
    given = np.flatnonzero(np.isfinite(negativity))
    largest = float(np.sqrt(solver.boundary.squares().max()))
    source = given[np.argmax(negativity[given])]
    distances = solver.field(points[source], points[given])
    allowed = largest * (1.0 + negativity[source] + negativity[given])
    assert (distances <= allowed).all()
    bound = finish(solver.coordinates.negativity_bound_steps(points[given]))
    assert (bound > negativity[given] - 0.05).all()


@pytest.mark.slow
def test_bodies_that_do_not_overlap_lose_no_values_and_tell_their_negativity() -> None:
    hand = read_mesh(sample_path("hand_2k"))
    solver = InteriorDistance(hand, Euclidean())
    rng = np.random.default_rng(2)
    points = rng.uniform(*hand.bounds, size=(800, 3))
    inside = winding_numbers(hand, points) > 0.5
    exact = solver.negativity(points)
    assert np.array_equal(np.isfinite(exact), inside)
    bound = finish(solver.coordinates.negativity_bound_steps(points[inside]))
    assert (bound > exact[inside] - 0.01).all()
    assert np.median(bound - exact[inside]) < 0.01
    assert solver.coordinates.undefined == 0


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["shepard", "maximum_entropy"])
def test_coordinates_that_are_never_negative_say_so(kind: str) -> None:
    solver = InteriorDistance(body("bent tube"), Euclidean(), kind)
    found = slice_values(solver, Plane.along("z", 0.5, solver.shape.bounds), nodes=40)
    assert not found.negativity.any()
    assert remarks_on(solver.coordinates) == ()


def test_a_ray_finds_the_whole_stretch_through_two_arms() -> None:
    mesh = body("pushed boxes")
    middle = middle_of_first_chord(mesh, Ray((0.05, -2.0, 0.1), (0.0, 1.0, 0.0)))
    samples = np.linspace(-1.0, 4.0, 20001)
    line = np.column_stack([np.full_like(samples, 0.05), samples, np.full_like(samples, 0.1)])
    inside = WindingNumbers(mesh).at(line) > 0
    first = int(np.argmax(inside))
    last = first + int(np.argmin(inside[first:]))
    assert middle is not None
    assert middle[1] == pytest.approx(0.5 * (samples[first] + samples[last]), abs=1e-3)
