"""Mean value coordinates: their properties, a slow twin, and VTK as a second opinion."""

from __future__ import annotations

import numpy as np
import pytest
import vtk
from tests.core import mean_value_twin, shapes
from vtk.util.numpy_support import numpy_to_vtk

from idviewer.core.arrays import as_points
from idviewer.core.coordinates.mean_value import MeanValueCoordinates, mean_value_weights
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.steps import finish


def bumpy_sphere(level: int = 3) -> Mesh:
    """A concave body without symmetry."""
    vertices, faces = shapes.icosphere(level)
    bump = 1 + 0.3 * np.sin(4 * vertices[:, 0]) * np.cos(3 * vertices[:, 1] + 1) + 0.2 * vertices[:, 2]
    return Mesh(vertices * bump[:, None], faces)


BODIES = {
    "tetrahedron": Mesh(*shapes.tetrahedron()),
    "cube": Mesh(*shapes.cube()),
    "L": Mesh(*shapes.l_shape()),
    "torus": Mesh(*shapes.torus(24, 12)),
    "bumpy sphere": bumpy_sphere(),
}


def inner_points(mesh: Mesh, rng: np.random.Generator, count: int = 40) -> np.ndarray:
    """Random points inside, told apart by solid angles rather than by the coordinates under test."""
    low, high = mesh.bounds
    points = rng.uniform(low, high, size=(20 * count, 3))
    return points[winding_numbers(mesh, points) > 0.5][:count]


def winding_numbers(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """Solid angle of the surface over 4 pi; van Oosterom and Strackee 1983."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]][None] - points[:, None] for i in range(3))
    la, lb, lc = (np.linalg.norm(side, axis=2) for side in (a, b, c))
    top = np.einsum("pfi,pfi->pf", a, np.cross(b, c))
    dots = [np.einsum("pfi,pfi->pf", *pair) for pair in ((a, b), (b, c), (c, a))]
    bottom = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
    return np.arctan2(top, bottom).sum(axis=1) / (2 * np.pi)


def by_vtk(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """Weights from vtkMeanValueCoordinatesInterpolator."""
    corners = vtk.vtkPoints()
    corners.SetDataTypeToDouble()
    corners.SetData(numpy_to_vtk(mesh.vertices, deep=True))
    cells = vtk.vtkCellArray()
    for face in mesh.faces:
        cells.InsertNextCell(3, face.tolist())
    rows = []
    for point in points:
        weights = np.zeros(len(mesh.vertices))
        vtk.vtkMeanValueCoordinatesInterpolator.ComputeInterpolationWeights(point, corners, cells, weights)
        rows.append(weights)
    return np.array(rows)


@pytest.fixture(params=BODIES, ids=lambda name: name.replace(" ", "-"))
def body(request: pytest.FixtureRequest) -> Mesh:
    return BODIES[request.param]


@pytest.mark.one_is_quick
def test_weights_add_up_to_one_and_reproduce_linear_functions(body, rng):
    points = inner_points(body, rng)
    weights = mean_value_weights(body, points)
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-12)
    np.testing.assert_allclose(weights @ body.vertices, points, atol=1e-12 * body.diagonal)


@pytest.mark.one_is_quick
def test_weights_are_those_of_the_slow_twin(body, rng):
    points = inner_points(body, rng, 12)
    twin = [mean_value_twin.weights(body.vertices, body.faces, point) for point in points]
    np.testing.assert_allclose(mean_value_weights(body, points), twin, atol=1e-12)


@pytest.mark.one_is_quick
def test_weights_are_those_of_vtk(body, rng):
    points = inner_points(body, rng)
    np.testing.assert_allclose(mean_value_weights(body, points), by_vtk(body, points), atol=1e-9)


@pytest.mark.one_is_quick
def test_interpolation_is_the_product_with_the_weights(body, rng):
    points = inner_points(body, rng, 33)
    values = rng.standard_normal((len(body.vertices), 7))
    coordinates = MeanValueCoordinates(body)
    *_, last = coordinates.interpolate_steps(points, values)
    assert last == 1
    expected = coordinates.weights(points) @ values
    np.testing.assert_allclose(finish(coordinates.interpolate_steps(points, values)), expected, atol=1e-12)


def test_vertices_interpolate(body):
    weights = mean_value_weights(body, body.vertices)
    np.testing.assert_allclose(weights, np.eye(len(body.vertices)), atol=1e-12)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("shares", [(0.2, 0.3, 0.5), (0.5, 0.5, 0.0), (1e-9, 1 - 1e-9, 0.0)])
def test_on_faces_and_edges_they_are_linear(body, shares):
    points = np.einsum("c,fci->fi", shares, body.vertices[body.faces])
    weights = mean_value_weights(body, points)
    expected = np.zeros_like(weights)
    np.add.at(expected, (np.arange(len(points))[:, None], body.faces), shares)
    np.testing.assert_allclose(weights, expected, atol=1e-12)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("shares", [(1 / 3, 1 / 3, 1 / 3), (0.5, 0.4999, 1e-4), (0.999, 5e-4, 5e-4)])
def test_just_below_the_surface_they_are_still_right(body, depth, shares):
    """Against the slow twin where that has digits left, against the limit closer by."""
    corners = body.vertices[body.faces][:24]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    on_face = np.einsum("c,fci->fi", shares, corners)
    points = on_face - depth * body.diagonal * normals
    points = points[np.abs(winding_numbers(body, on_face - 1e-3 * body.diagonal * normals) - 1) < 1e-6]
    weights = mean_value_weights(body, points)
    assert len(points) > 0
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-12)
    np.testing.assert_allclose(weights @ body.vertices, points, atol=1e-12 * body.diagonal)
    if depth <= 1e-9:
        limit = mean_value_weights(body, on_face)[: len(points)]
        if len(points) == len(on_face):
            np.testing.assert_allclose(weights, limit, atol=300 * depth / min(s for s in shares if s > 0))


@pytest.mark.one_is_quick
@pytest.mark.parametrize("tilt", [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2])
def test_in_the_plane_of_a_distant_face_they_are_smooth(tilt):
    """Inside the L, on the planes of its inner faces and a hair beside them, where solving would cancel."""
    mesh = BODIES["L"]
    points = np.array([[0.3, 1.0, 0.41], [0.71, 1.0, 0.52], [1.0, 0.37, 0.43], [1.0, 0.71, 0.77]])
    direction = np.array([[0, 1, 0], [0, 1, 0], [1, 0, 0], [1, 0, 0]])
    weights = mean_value_weights(mesh, points + tilt * direction)
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-12)
    np.testing.assert_allclose(weights @ mesh.vertices, points + tilt * direction, atol=1e-12)
    # A smooth function agrees with the mean of its values at both sides up to second order.
    beside = [mean_value_weights(mesh, points + (tilt + step) * direction) for step in (-0.02, 0.02)]
    np.testing.assert_allclose(weights, np.mean(beside, axis=0), atol=2e-3)
    if tilt >= 1e-4:
        twin = [mean_value_twin.weights(mesh.vertices, mesh.faces, p) for p in points + tilt * direction]
        np.testing.assert_allclose(weights, twin, atol=1e-11)
    exact = mean_value_weights(mesh, points)
    np.testing.assert_allclose(weights, exact, atol=5 * tilt + 1e-13)


@pytest.mark.slow
@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e6])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_size_and_place_do_not_matter(scale, shift, rng):
    body = BODIES["bumpy sphere"]
    points = inner_points(body, rng)
    expected = mean_value_weights(body, points)
    # Coordinates that survive the move exactly, so that only the computation is tested.
    offset = np.round(shift) * scale
    moved = Mesh(body.vertices * scale + offset, body.faces)
    rounding = np.finfo(float).eps * (1 + shift)
    weights = mean_value_weights(moved, points * scale + offset)
    np.testing.assert_allclose(weights, expected, atol=1e-11 + 200 * rounding)
    np.testing.assert_allclose(
        mean_value_weights(moved, moved.vertices[:50]), np.eye(len(moved.vertices))[:50], atol=1e-12
    )


@pytest.mark.one_is_quick
def test_rigid_motions_leave_them_alone(body, rng):
    points = inner_points(body, rng)
    rotation = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    rotation *= np.linalg.det(rotation)
    moved = Mesh(body.vertices @ rotation.T + 0.3, body.faces)
    np.testing.assert_allclose(
        mean_value_weights(moved, points @ rotation.T + 0.3), mean_value_weights(body, points), atol=1e-11
    )


@pytest.mark.one_is_quick
def test_points_outside_give_nan_and_points_inside_do_not(body, rng):
    low, high = body.bounds
    points = rng.uniform(low - 0.2, high + 0.2, size=(500, 3))
    winding = winding_numbers(body, points)
    known = np.isnan(mean_value_weights(body, points)).all(axis=1)
    np.testing.assert_array_equal(known, winding < 0.5)
    assert known.any()
    assert not known.all()


def test_odd_points():
    mesh = BODIES["cube"]
    assert mean_value_weights(mesh, np.empty((0, 3))).shape == (0, 8)
    assert np.isnan(mean_value_weights(mesh, [[np.nan, 0, 0], [np.inf, 0, 0], [1e300, 0, 0]])).all()
    with pytest.raises(ValueError, match=r"shape \(p, 3\), not \(3,\)"):
        as_points([1.0, 2.0, 3.0], 3)
