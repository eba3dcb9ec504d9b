"""Shepard's weights: the formula, its limits, and independence of the tessellation."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes
from tests.core.coordinate_bodies import SHAPES, inner_points

from idviewer.core import Mesh, Polygon
from idviewer.core.coordinates.shepard import ShepardCoordinates


@pytest.mark.one_is_quick
@pytest.mark.parametrize("shape", SHAPES)
def test_weights_are_those_of_the_formula(shape, rng):
    body = SHAPES[shape]
    parts = np.zeros(len(body.vertices))
    for corners in body.facets:
        a, *rest = body.vertices[corners]
        sides = [b - a for b in rest]
        parts[corners] += np.linalg.norm(sides[0] if len(sides) == 1 else np.cross(*sides))
    for point in inner_points(body, rng, 10):
        expected = parts / np.linalg.norm(body.vertices - point, axis=1) ** body.dimension
        found = ShepardCoordinates(body).weights(point[None])[0]
        np.testing.assert_allclose(found, expected / expected.sum(), rtol=1e-11)


def test_in_the_centre_of_an_even_circle_they_are_shepard_s_own_with_power_two(rng):
    circle = Polygon(shapes.star(50, 0.0))
    point = np.array([0.3, -0.2])
    plain = np.linalg.norm(circle.vertices - point, axis=1) ** -2.0
    found = ShepardCoordinates(circle).weights(point[None])[0]
    np.testing.assert_allclose(found, plain / plain.sum(), rtol=1e-12)


def test_a_finer_stretch_of_the_boundary_counts_no_more():
    """A circle whose right half has ten times the vertices: linear functions at the centre hardly notice."""
    angle = np.concatenate(
        [np.linspace(-0.5, 0.5, 500, endpoint=False), np.linspace(0.5, 1.5, 50, endpoint=False)]
    )
    circle = Polygon(np.column_stack([np.cos(np.pi * angle), np.sin(np.pi * angle)]))
    weights = ShepardCoordinates(circle).weights(np.zeros((1, 2)))
    np.testing.assert_allclose(weights @ circle.vertices, 0, atol=1e-3)


def test_refinement_of_a_sphere_converges_to_the_integral():
    """On the unit sphere sum a |p - v|^-3 tends to the integral, 4 pi / (1 - |p|^2)."""
    point = np.array([[0.3, 0.1, -0.2]])
    exact = point / np.linalg.norm(point) * _mean_height(np.linalg.norm(point))
    errors = []
    for level in (2, 3, 4):
        sphere = Mesh(*shapes.icosphere(level))
        errors.append(np.abs(ShepardCoordinates(sphere).weights(point) @ sphere.vertices - exact).max())
    assert errors[1] < 0.4 * errors[0]
    assert errors[2] < 0.4 * errors[1]


def _mean_height(r: float) -> float:
    """Mean of z with weights |p - v|^-3 over the unit sphere, p = (0, 0, r), by quadrature."""
    z, share = np.polynomial.legendre.leggauss(200)
    weight = share * (1 - 2 * r * z + r * r) ** -1.5
    return float((weight * z).sum() / weight.sum())


@pytest.mark.parametrize("distance", [1e-3, 1e-6, 1e-9, 1e-300])
def test_next_to_a_vertex_its_own_weight_tends_to_one(distance):
    for name in ("comb", "bumpy sphere"):
        body = SHAPES[name]
        centre = body.vertices.mean(axis=0) if name == "bumpy sphere" else np.array([0.5, 0.5])
        point = body.vertices[:1] + distance * (centre - body.vertices[:1])
        assert ShepardCoordinates(body).weights(point)[0, 0] > 1 - 500 * distance - 1e-15
