"""Bridges between the shells of a mesh: heat and ways get to voids, whatever the mesh."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes
from tests.core.test_mean_value import by_vtk
from tests.core.voxels import box, emptied, voxel_surface

from idviewer.core import Diffusion, InteriorDistance, Mesh, Plane, eigenpairs, laplacian_of, repair_mesh
from idviewer.core.coordinates import mean_value_weights
from idviewer.core.distances.geodesic_solvers import Geodesics
from idviewer.core.slices import section, slice_mesh
from idviewer.core.validation.soup_repairs import volume_and_area

PLACES = [[-0.9, 0, 0], [0, 0.9, 0], [0.2, 0, 0.5], [-0.15, 0, 0]]


def hollow_ball(level, radius=0.4, middle=(0.3, 0.0, 0.0)):
    """A unit ball with a void in it, of so fine a tessellation."""
    void = shapes.icosphere(level)
    return repair_mesh(
        *shapes.joined(shapes.icosphere(level), (void[0] * radius + np.array(middle), void[1]))
    )


def hollow_box(times):
    """A cube of side 3 with a cubic void of side 1 off its middle, every face cut into four so many times."""
    outer, void = shapes.cube(), shapes.cube()
    arrays = shapes.joined((outer[0] * 3.0, outer[1]), shapes.moved(void, 1.5, 1.0, 1.0))
    for _ in range(times):
        arrays = shapes.subdivided(*arrays)
    return repair_mesh(*arrays)


@pytest.mark.slow
def test_lambda_2_and_distances_converge_at_second_order():
    values, distances = [], []
    for level in (2, 3, 4):
        mesh = hollow_ball(level)
        spectrum = eigenpairs(mesh, k=40)
        values.append(spectrum.values[:4])
        solver = InteriorDistance(mesh, Diffusion(0.25), spectrum=spectrum)
        distances.append(solver.distance(PLACES[:1], PLACES[1:]))
    for rows in (np.array(values), np.array(distances)):
        coarse, fine = np.abs(rows[1] - rows[0]), np.abs(rows[2] - rows[1])
        assert np.all(fine < 0.6 * coarse + 1e-3 * np.abs(rows[2]))
        assert np.all(fine < 0.1 * np.abs(rows[2]))


@pytest.mark.slow
def test_a_bridge_depends_on_the_surface_alone():
    bridges = [hollow_box(times).bridges for times in (0, 1, 2)]
    assert [len(some) for some in bridges] == [1, 1, 1]
    for (bridge,) in bridges:
        assert bridge.length == pytest.approx(0.5, rel=1e-12)
        assert bridge.radius == pytest.approx(bridges[0][0].radius, rel=1e-12)
        np.testing.assert_allclose(bridge.ends, bridges[0][0].ends, atol=1e-12)
    values = [eigenpairs(hollow_box(times), k=3).values[0] for times in (2, 3, 4)]
    # The disc at the outer end is as wide as three of the last mesh's edges.
    assert abs(values[2] - values[1]) < 0.6 * abs(values[1] - values[0]) < 0.05 * values[2]


def test_the_energy_of_linear_functions_is_that_of_the_tube():
    mesh = hollow_box(2)
    (bridge,) = mesh.bridges
    added = mesh.shell_bridges.laplacian()
    u = mesh.vertices[:, 0]
    # All threads are as long as the bridge, along x: 2 pi r / l times l squared.
    assert u @ (added @ u) == pytest.approx(2 * np.pi * bridge.radius * bridge.length, rel=1e-9)
    assert abs(added @ np.ones(len(u))).max() < 1e-12
    assert abs(added @ mesh.vertices[:, 1]).max() < 1e-9
    assert abs(added - added.T).max() < 1e-12
    assert laplacian_of(mesh).shape == added.shape


@pytest.mark.slow
def test_a_small_void_far_from_the_outline_relaxes_as_a_tube_lets_it():
    mesh = hollow_ball(3, 0.05, (0.2, 0.1, 0.0))
    (bridge,) = mesh.bridges
    areas = [mesh.face_areas[shell].sum() for shell in mesh.shells]
    # Of two bodies of uniform heat, joined by a conductor; the void's own surface resists a little.
    alone = bridge.conductance * (1.0 / areas[0] + 1.0 / areas[1])
    values, vectors, masses = (lambda s: (s.values, s.vectors, s.masses))(eigenpairs(mesh, k=30))
    inside = np.zeros(len(masses), bool)
    inside[mesh.faces[mesh.shells[1]]] = True
    share = np.abs((masses * inside) @ vectors) / np.sqrt(areas[1])
    assert values[np.argmax(share)] == pytest.approx(alone, rel=0.12)
    assert values[np.argmax(share)] < alone


@pytest.mark.slow
def test_the_limit_of_shells_that_nearly_touch():
    values = []
    for gap in (1e-2, 1e-4, 1e-6, 1e-9):
        outer, void = shapes.cube(), shapes.cube()
        arrays = shapes.joined((outer[0] * 3.0, outer[1]), shapes.moved(void, 2.0 - gap, 1.0, 1.0))
        for _ in range(2):
            arrays = shapes.subdivided(*arrays)
        mesh = repair_mesh(*arrays)
        assert mesh.bridge_lengths == pytest.approx([gap], rel=1e-5)
        values.append(eigenpairs(mesh, k=2).values[0])
    assert values[0] < values[1]
    assert values[-1] == pytest.approx(values[-2], rel=1e-6)
    assert values[-1] == pytest.approx(values[1], rel=5e-3)


def test_all_shells_are_joined_by_the_shortest_bridges():
    full = emptied(box(9, 3, 3), (1, 1, 1), (3, 1, 1), (5, 1, 1), (7, 1, 1))
    mesh = repair_mesh(*voxel_surface(full))
    assert mesh.bridge_lengths.tolist() == [1.0] * 4
    assert {shell for bridge in mesh.bridges for shell in bridge.shells} == set(range(5))
    assert eigenpairs(mesh, k=1).values[0] > 0.0


@pytest.mark.parametrize(("method", "accuracy"), [("heat", 0.05), ("exact", 1e-7)])
def test_geodesics_go_over_the_bridge(method, accuracy):
    mesh = repair_mesh(*shapes.subdivided(*voxel_surface(emptied(box(4, 3, 3), (1, 1, 1)))))
    (bridge,) = mesh.bridges
    parts = [np.unique(mesh.faces[shell]) for shell in mesh.shells]
    # The middles of the nearest sides are vertices.
    ends = [int(np.linalg.norm(mesh.vertices - end, axis=1).argmin()) for end in bridge.ends]
    np.testing.assert_allclose(mesh.vertices[ends], bridge.ends, atol=1e-12)
    whole = Geodesics(mesh, method)
    alone = []
    for own, shell, sense in zip(parts, mesh.shells, (1, -1), strict=True):
        faces = np.searchsorted(own, mesh.faces[shell])[:, ::sense]
        alone.append(Geodesics(Mesh(mesh.vertices[own], faces), method))
    places = [int(np.searchsorted(own, end)) for own, end in zip(parts, ends, strict=True)]
    beyond = alone[1].from_vertex(places[1])
    for vertex in (0, 5, 20):
        found = whole.from_vertex(int(parts[0][vertex]))
        own = alone[0].from_vertex(vertex)
        np.testing.assert_allclose(found[parts[0]], own, atol=accuracy)
        np.testing.assert_allclose(found[parts[1]], own[places[0]] + bridge.length + beyond, atol=accuracy)
    back = whole.from_vertex(int(parts[1][3]))
    np.testing.assert_allclose(back[parts[0][5]], whole.from_vertex(int(parts[0][5]))[parts[1][3]], rtol=0.03)


def test_mean_value_coordinates_of_a_hollow_body_are_vtks(rng):
    mesh = hollow_ball(1)
    points = rng.uniform(-1.0, 1.0, (60, 3))
    weights = mean_value_weights(mesh, points)
    inside = np.isfinite(weights).all(axis=1)
    from_void = np.linalg.norm(points - [0.3, 0, 0], axis=1)
    assert not inside[from_void < 0.3].any()
    assert inside[(from_void > 0.41) & (np.linalg.norm(points, axis=1) < 0.78)].all()
    np.testing.assert_allclose(weights[inside] @ mesh.vertices, points[inside], atol=1e-12)
    np.testing.assert_allclose(weights[inside], by_vtk(mesh, points[inside]), atol=1e-9)


def test_sections_have_holes_where_voids_are():
    mesh = hollow_box(1)
    cut = section(mesh, Plane((0.0, 0.0, 1.4), (0.0, 0.0, 1.0)))
    made = slice_mesh(cut, 0.2)
    assert volume_and_area(made.points, np.asarray(made.triangles))[1] == pytest.approx(9.0 - 1.0)
