"""Whole polygons as sections, and the points inside from which the barycentroid is looked for."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from tests.core.outlines import SQUARE, circle, flower, regular, staircase, with_holes

from idviewer.core import (
    Diffusion,
    Polygon,
    PolygonError,
    eigenpairs,
    masses_of,
    polygon_section,
    read_polygon,
    sample_names,
    sample_path,
)
from idviewer.core.arrays import in_space
from idviewer.core.interior.barycentroid import barycentroid_steps, interior_samples
from idviewer.core.slices.triangulation import SliceMesh, slice_mesh, spacing_for
from idviewer.core.steps import finish

POLYGONS = {"flower": flower(90), "holes": with_holes(), "stairs": staircase(6), "square": Polygon(SQUARE)}


@pytest.fixture(params=POLYGONS)
def polygon(request: pytest.FixtureRequest) -> Polygon:
    return POLYGONS[request.param]


def areas(mesh: SliceMesh) -> np.ndarray:
    a, b, c = mesh.points[mesh.triangles][:, :, :2].swapaxes(0, 1)
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


@pytest.mark.parametrize("offset", [0.0, 1e6, -1e6, 1e-3])
def test_outline_points_are_the_vertices_exactly(polygon, offset):
    moved = Polygon(polygon.vertices + offset, polygon.loops)
    outline = polygon_section(moved)
    np.testing.assert_array_equal(outline.points, in_space(moved.vertices))
    np.testing.assert_array_equal(outline.interpolate(moved.vertices), moved.vertices)
    assert outline.area == pytest.approx(moved.area, rel=1e-13)
    assert outline.plane.normal == (0.0, 0.0, 1.0)


def test_divided_edges_know_where_they_are(polygon):
    longest = 0.3 * float(polygon.lengths.max())
    outline = polygon_section(polygon, longest)
    starts, ends = outline.segments
    assert np.linalg.norm(outline.points[ends] - outline.points[starts], axis=1).max() < longest * (1 + 1e-12)
    np.testing.assert_allclose(outline.interpolate(polygon.vertices), outline.points[:, :2], atol=1e-14)
    assert outline.area == pytest.approx(polygon.area, rel=1e-13)
    kept = outline.points[outline.fractions == 0.0, :2]
    np.testing.assert_array_equal(kept, polygon.vertices)
    for bad in (0.0, -1.0, np.nan):
        with pytest.raises(ValueError, match="positive length"):
            polygon_section(polygon, bad)


@pytest.mark.parametrize("samples", [20, 400, 5000])
def test_triangles_fill_the_polygon_and_nothing_else(polygon, samples):
    outline = polygon_section(polygon)
    mesh = slice_mesh(outline, spacing_for(outline, samples))
    sizes = areas(mesh)
    assert sizes.min() >= -1e-12
    assert sizes.sum() == pytest.approx(polygon.area, rel=1e-11)
    assert polygon.contains(mesh.node_points[:, :2]).all()
    large = mesh.points[mesh.triangles][sizes > 1e-9 * polygon.area]
    assert polygon.contains(large.mean(axis=1)[:, :2]).all()
    assert (mesh.points[:, 2] == 0.0).all()
    if samples > 20:
        assert 0.5 * samples < len(mesh.nodes) < 1.2 * samples


@pytest.mark.parametrize(("scale", "offset"), [(1e-9, 0.0), (1e6, 0.0), (1.0, 1e6)])
def test_size_and_place_do_not_matter(polygon, scale, offset):
    moved = Polygon(polygon.vertices * scale + offset, polygon.loops)
    outline = polygon_section(moved)
    mesh = slice_mesh(outline, spacing_for(outline, 300))
    assert areas(mesh).sum() == pytest.approx(polygon.area * scale**2, rel=1e-8)


@pytest.mark.parametrize("name", sample_names(2))
def test_bundled_polygons_are_filled(name):
    polygon = read_polygon(sample_path(name))
    outline = polygon_section(polygon)
    mesh = slice_mesh(outline, spacing_for(outline, 1000))
    assert areas(mesh).sum() == pytest.approx(polygon.area, rel=1e-11)
    assert 500 < len(mesh.nodes) < 1100


def test_inner_samples_are_inside_and_spread(polygon):
    points = interior_samples(polygon)
    assert points.shape[1] == 2
    assert polygon.contains(points).all()
    assert 80 < len(points) < 250
    thin = Polygon([[0, 0], [1, 0], [1, 1e-9], [0, 1e-9]])
    assert thin.contains(interior_samples(thin)).all()
    assert len(interior_samples(thin)) > 0


# --- the barycentroid, with mean value coordinates written naively ---


def mean_value_weights(polygon: Polygon, point: np.ndarray) -> np.ndarray:
    """Hormann and Floater 2006, w_i = (tan(a_{i-1} / 2) + tan(a_i / 2)) / r_i, for points inside alone."""
    to = polygon.vertices - point
    radius = np.linalg.norm(to, axis=1)
    weights = np.zeros(len(to))
    for loop in polygon.loops:
        for i, j in pairwise([*loop, loop[0]]):
            across = to[i, 0] * to[j, 1] - to[i, 1] * to[j, 0]
            half = np.tan(0.5 * np.arctan2(across, to[i] @ to[j]))
            weights[i] += half / radius[i]
            weights[j] += half / radius[j]
    return weights / weights.sum()


def potential_of(polygon: Polygon):
    spectrum = eigenpairs(polygon)
    embedded = spectrum.vectors * Diffusion().scale(spectrum)

    def potential(points):
        yield None
        inside = polygon.contains(points)
        images = np.full((len(points), embedded.shape[1]), np.nan)
        for i in np.flatnonzero(inside):
            images[i] = mean_value_weights(polygon, points[i]) @ embedded
        return np.linalg.norm(images, axis=1)

    return potential


@pytest.mark.slow
def test_the_barycentroid_of_a_symmetric_polygon_is_its_centre():
    for polygon in (Polygon(regular(24).vertices * [2.0, 1.0] + 7.0), Polygon(3 * SQUARE).resampled(24)):
        found = finish(barycentroid_steps(polygon, potential_of(polygon)))
        assert found.point.shape == (2,)
        assert found.path.shape[1] == 2
        np.testing.assert_allclose(found.point, polygon.bounds.mean(axis=0), atol=1e-4)


@pytest.mark.slow
def test_the_barycentroid_lies_inside_and_lower_than_all_that_was_sampled():
    polygon = Polygon.of_loops([circle(24), circle(12, 0.3, (0.2, 0.1))])
    potential = potential_of(polygon)
    found = finish(barycentroid_steps(polygon, potential))
    assert polygon.contains(found.point[None]).all()
    assert found.potential <= finish(potential(interior_samples(polygon))).min()


def test_where_nothing_is_inside_that_is_told():
    def nowhere(points):
        yield None
        return np.full(len(points), np.nan)

    with pytest.raises(PolygonError, match="no point inside the polygon was found"):
        finish(barycentroid_steps(regular(5), nowhere))


def test_euclidean_potential_is_lowest_in_the_boundary_s_centroid():
    polygon = flower(60)
    masses = masses_of(polygon)
    centroid = masses @ polygon.vertices / masses.sum()

    def potential(points):
        yield None
        inside = polygon.contains(points)
        return np.where(inside, np.linalg.norm(points - centroid, axis=1), np.nan)

    found = finish(barycentroid_steps(polygon, potential))
    np.testing.assert_allclose(found.point, centroid, atol=1e-6)
