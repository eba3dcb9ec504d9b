"""Laplacian and eigenpairs of polygons: the appendix, closed forms, a dense solver as a second opinion."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg
from tests.core.outlines import flower, regular, with_holes

import idviewer.core.spectrum.eigen_solver as spectrum_module
from idviewer.core import Polygon, PolygonError, eigenpairs, laplacian_of, masses_of
from idviewer.core.spectrum.eigen_solver import EigenSolverSettings, paper_cutoff

WITH_HOLES = with_holes()


def everything(lambda_2: float) -> float:
    return math.inf


def dense(polygon: Polygon) -> np.ndarray:
    """L written from the appendix's stencil, vertex by vertex."""
    n = len(polygon.vertices)
    matrix = np.zeros((n, n))
    for loop in polygon.loops:
        for before, at, after in zip(np.roll(loop, 1), loop, np.roll(loop, -1), strict=True):
            minus = math.dist(polygon.vertices[before], polygon.vertices[at])
            plus = math.dist(polygon.vertices[at], polygon.vertices[after])
            matrix[at, before] -= 1 / minus
            matrix[at, at] += 1 / minus + 1 / plus
            matrix[at, after] -= 1 / plus
    for i, j in polygon.bridges:
        conductance = 1 / math.dist(polygon.vertices[i], polygon.vertices[j])
        matrix[[i, j], [i, j]] += conductance
        matrix[[i, j], [j, i]] -= conductance
    return matrix


@pytest.mark.parametrize("polygon", [flower(40), WITH_HOLES], ids=["one loop", "holes"])
def test_the_laplacian_is_the_appendix_stencil(polygon):
    matrix = laplacian_of(polygon).toarray()
    np.testing.assert_allclose(matrix, dense(polygon), rtol=1e-13, atol=1e-13 * abs(matrix).max())
    np.testing.assert_allclose(matrix @ np.ones(len(matrix)), 0.0, atol=1e-12 * abs(matrix).max())


def test_masses_are_half_the_edges_at_each_vertex():
    polygon = flower(30)
    v = polygon.vertices
    expected = [(math.dist(v[i - 1], v[i]) + math.dist(v[i], v[(i + 1) % len(v)])) / 2 for i in range(len(v))]
    np.testing.assert_allclose(masses_of(polygon), expected, rtol=1e-14)
    assert masses_of(WITH_HOLES).sum() == pytest.approx(WITH_HOLES.perimeter, rel=1e-14)


@pytest.mark.parametrize("sides", [3, 4, 7, 50, 301])
def test_a_regular_polygon_has_the_eigenvalues_of_its_circulant(sides):
    """L/M is circulant: lambda_k = (2 - 2 cos(2 pi k / n)) / d^2, each pair equal."""
    polygon = regular(sides)
    d = polygon.lengths[0]
    k = np.arange(1, sides)
    expected = np.sort((2.0 - 2.0 * np.cos(2.0 * np.pi * k / sides)) / d**2)
    spectrum = eigenpairs(polygon, cutoff=everything)
    assert spectrum.bound == math.inf
    np.testing.assert_allclose(spectrum.values, expected, rtol=1e-10)
    gram = spectrum.vectors.T @ (spectrum.masses[:, None] * spectrum.vectors)
    np.testing.assert_allclose(gram, np.eye(sides - 1), atol=1e-11)


@pytest.mark.parametrize("polygon", [flower(150), WITH_HOLES], ids=["one loop", "holes"])
@pytest.mark.parametrize("few", [True, False])
def test_the_spectrum_is_that_of_a_dense_solver(polygon, few):
    matrix, masses = dense(polygon), masses_of(polygon)
    values = scipy.linalg.eigh(matrix, np.diag(masses), eigvals_only=True)[1:]
    expected = values[values < paper_cutoff(values[0])] if few else values
    spectrum = eigenpairs(polygon) if few else eigenpairs(polygon, cutoff=everything)
    np.testing.assert_allclose(spectrum.values, expected, rtol=1e-8)
    residual = matrix @ spectrum.vectors - masses[:, None] * spectrum.vectors * spectrum.values
    assert np.abs(residual).max() < 1e-9 * abs(matrix).max() * np.abs(spectrum.vectors).max()
    np.testing.assert_allclose(masses @ spectrum.vectors, 0.0, atol=1e-11 * masses.sum() ** 0.5)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("polygon", [flower(150), WITH_HOLES.resampled(400)], ids=["one loop", "holes"])
def test_the_iterative_solver_agrees_with_the_dense_one(polygon, monkeypatch):
    plain = eigenpairs(polygon)
    monkeypatch.setattr(spectrum_module, "EIGEN_SOLVER", EigenSolverSettings(dense_polygon_vertices=0))
    iterated = eigenpairs(polygon)
    np.testing.assert_allclose(iterated.values, plain.values, rtol=1e-9)
    assert 0.0 < iterated.residual < 1e-6
    np.testing.assert_array_equal(
        eigenpairs(polygon, cutoff=everything).masses, plain.masses
    )  # falls back on dense


@pytest.mark.slow
def test_eigenvalues_of_a_circle_converge_at_second_order():
    """k^2 comes twice on a circle of radius 1."""
    expected = np.repeat(np.arange(1.0, 6.0) ** 2, 2)
    errors = [np.abs(eigenpairs(regular(n)).values[:10] / expected - 1).max() for n in (100, 200, 400)]
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (rates > 1.9).all()


def test_pairs_of_equal_eigenvalues_come_whole():
    values = eigenpairs(regular(240)).values
    assert len(values) % 2 == 0
    np.testing.assert_allclose(values[::2], values[1::2], rtol=1e-11)


def test_vertices_that_almost_meet_do_not_disturb_the_low_modes():
    """A vertex 1e-10 beside another one has a mass next to nothing: the others' modes stay."""
    plain = flower(120)
    extra = plain.vertices[7] + 1e-10 * (plain.vertices[8] - plain.vertices[7])
    crowded = Polygon(np.insert(plain.vertices, 8, extra, axis=0))
    np.testing.assert_allclose(eigenpairs(crowded).values, eigenpairs(plain).values, rtol=1e-8)


@pytest.mark.parametrize("scale", [1e-9, 1e6])
def test_size_scales_the_spectrum(scale):
    plain = flower(100)
    scaled = eigenpairs(plain.with_vertices(plain.vertices * scale))
    np.testing.assert_allclose(scaled.values * scale**2, eigenpairs(plain).values, rtol=1e-11)


def test_resistances_are_those_of_the_laplacian():
    for polygon in (flower(60), WITH_HOLES):
        inverse = np.linalg.pinv(dense(polygon))
        diagonal = np.diag(inverse)
        expected = diagonal[:, None] + diagonal - 2.0 * inverse
        np.testing.assert_allclose(polygon.resistances(), expected, atol=1e-11 * expected.max())


def test_heat_flows_between_loops():
    spectrum = eigenpairs(WITH_HOLES)
    assert spectrum.values[0] > 0.05 * (2 * np.pi / WITH_HOLES.perimeter) ** 2


def test_too_many_modes_are_refused_in_one_line(monkeypatch):
    settings = EigenSolverSettings(dense_vertices=0, dense_polygon_vertices=0)
    monkeypatch.setattr(spectrum_module, "EIGEN_SOLVER", settings)
    with pytest.raises(PolygonError, match=r"^the distance asks for about \d+ modes, .* polygon of 100 "):
        eigenpairs(regular(100), cutoff=lambda lambda_2: 1e6 * lambda_2)
