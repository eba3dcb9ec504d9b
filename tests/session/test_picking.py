"""The value under the mouse, beside a slow twin that asks every triangle."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import Delaunay

from idviewer.core import Mesh, Plane
from idviewer.core.sampling import SliceValues
from idviewer.core.shapes.rays import Ray
from idviewer.session.picking import FramePicker
from idviewer.session.state import Frame, Query

TETRAHEDRON = Mesh(np.vstack([np.zeros(3), np.eye(3)]), [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
PLANE = Plane((0.3, -0.2, 0.5), (0.3, -0.5, 0.8))


@pytest.fixture
def section(rng: np.random.Generator) -> SliceValues:
    flat = rng.uniform(-1.0, 1.0, (400, 2))
    triangles = Delaunay(flat).simplices.astype(np.int32)
    corners = flat[triangles]
    edges = corners[:, 1:] - corners[:, :1]
    backwards = edges[:, 0, 0] * edges[:, 1, 1] < edges[:, 0, 1] * edges[:, 1, 0]
    triangles[backwards] = triangles[backwards, ::-1]
    triangles = triangles[rng.random(len(triangles)) > 0.2]  # with holes
    points = np.array(PLANE.origin) + flat @ PLANE.basis
    return SliceValues(PLANE, points, triangles, rng.random(len(points)), ())


def picker(*sections: SliceValues) -> FramePicker:
    query = Query(planes=tuple(one.plane for one in sections))
    nowhere = np.zeros(3)
    return FramePicker(
        Frame(TETRAHEDRON, query, sections, 0, True, 0.0, nowhere, nowhere, (0.0, 1.0), "a distance")
    )


def across(point: np.ndarray) -> Ray:
    normal = np.array(PLANE.normal)
    return Ray(tuple(point + 3 * normal), tuple(-normal))


def asked_of_every_triangle(section: SliceValues, point: np.ndarray) -> float | None:
    for triangle in section.triangles:
        system = np.vstack([section.plane.basis @ section.points[triangle].T, np.ones(3)])
        shares = np.linalg.solve(system, [*(section.plane.basis @ point), 1.0])
        if (shares >= 0.0).all():
            return float(shares @ section.values[triangle])
    return None


@pytest.mark.slow
def test_it_finds_the_value_that_the_triangles_have_there(
    section: SliceValues, rng: np.random.Generator
) -> None:
    found = picker(section)
    hits = 0
    for point in np.array(PLANE.origin) + rng.uniform(-1.1, 1.1, (100, 2)) @ PLANE.basis:
        probe, expected = found.probe(across(point)), asked_of_every_triangle(section, point)
        assert (probe is None) == (expected is None)
        if probe is not None:
            hits += 1
            assert probe.value == pytest.approx(expected, abs=1e-9)
            np.testing.assert_allclose(probe.point, point, atol=1e-12)
    assert 20 < hits < 90


def test_a_vertex_has_its_own_value() -> None:
    flat = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    plane = Plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    triangles = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]], np.int32)
    section = SliceValues(plane, np.column_stack([flat, np.zeros(5)]), triangles, np.arange(5.0), ())
    for point, value in zip(section.points, section.values, strict=True):
        ray = Ray((point[0], point[1], 1.0), (0.0, 0.0, -1.0))
        assert picker(section).probe(ray).value == value


def test_nothing_lies_on_an_empty_slice() -> None:
    empty = SliceValues(PLANE, np.empty((0, 3)), np.empty((0, 3), np.int32), np.empty(0), ())
    assert picker(empty).probe(across(np.array(PLANE.origin))) is None
