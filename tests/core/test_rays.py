"""Rays through bodies: in and out in turns, whatever they pass through."""

from __future__ import annotations

import itertools
import subprocess
import sys

import numpy as np
import pytest
from tests.core import shapes

from idviewer.core import Mesh, read_mesh, sample_path
from idviewer.core.shapes.rays import Ray, crossings

BODIES = {
    "cube": shapes.cube(),
    "L": shapes.l_shape(),
    "torus": shapes.torus(),
    "pinched": shapes.pinched_cubes(),
    "flat": (shapes.cube()[0] * [1, 1, 1e-8], shapes.cube()[1]),
    "far away": (shapes.cube()[0] + 1e9, shapes.cube()[1]),
    "tiny": (shapes.cube()[0] * 1e-55, shapes.cube()[1]),
    "huge": (shapes.cube()[0] * 1e55, shapes.cube()[1]),
}


def targets(mesh: Mesh, rng: np.random.Generator, count: int) -> np.ndarray:
    """Points of the box, vertices, and middles of edges."""
    low, high = mesh.bounds
    corners = rng.integers(len(mesh.vertices), size=count)
    edges = mesh.edges[rng.integers(len(mesh.edges), size=count)]
    inside = rng.uniform(low, high, size=(count, 3))
    return np.concatenate([inside, mesh.vertices[corners], mesh.vertices[edges].mean(axis=1)])


@pytest.mark.parametrize("mesh", [Mesh(*arrays) for arrays in BODIES.values()], ids=list(BODIES))
def test_rays_from_outside_leave_as_often_as_they_enter(mesh, rng):
    for target in targets(mesh, rng, 40):
        direction = rng.normal(size=3)
        direction *= 2 * mesh.diagonal / np.linalg.norm(direction)
        met = crossings(mesh, Ray(tuple(target - direction), tuple(direction)))
        assert len(met.distances) % 2 == 0
        assert (np.diff(met.distances) >= 0).all()


@pytest.mark.parametrize("mesh", [Mesh(*arrays) for arrays in BODIES.values()], ids=list(BODIES))
def test_rays_from_vertex_to_vertex_too(mesh):
    for start, end in itertools.permutations(mesh.vertices[:8], 2):
        ray = Ray(tuple(start - 9 * (end - start)), tuple(end - start))
        assert len(crossings(mesh, ray).distances) % 2 == 0


def test_a_thousand_rays_through_vertices_and_edges_of_a_body(rng):
    mesh = read_mesh(sample_path("hand"))
    for target in targets(mesh, rng, 500)[500:]:
        direction = rng.normal(size=3)
        origin = target - 3 * mesh.diagonal * direction / np.linalg.norm(direction)
        assert len(crossings(mesh, Ray(tuple(origin), tuple(direction))).distances) % 2 == 0


def crossings_of_all_faces(mesh: Mesh, ray: Ray) -> list[float]:
    """Distances along a ray of unit direction, face by face (Moeller and Trumbore 1997): the slow twin."""
    origin, direction = np.array(ray.origin), np.array(ray.direction)
    found = []
    for a, b, c in mesh.vertices[mesh.faces]:
        across = np.cross(direction, c - a)
        share = np.dot(origin - a, across) / np.dot(b - a, across)
        other = np.cross(origin - a, b - a)
        second = np.dot(direction, other) / np.dot(b - a, across)
        distance = np.dot(c - a, other) / np.dot(b - a, across)
        if min(share, second, 1.0 - share - second, distance) >= 0.0:
            found.append(float(distance))
    return sorted(found)


@pytest.mark.slow
def test_distances_are_those_of_a_slow_twin(rng):
    mesh = Mesh(*shapes.torus())
    for target in targets(mesh, rng, 60)[:60]:
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        for origin in (target, target - 3 * direction):
            ray = Ray(tuple(origin), tuple(direction))
            met = crossings(mesh, ray)
            np.testing.assert_allclose(met.distances, crossings_of_all_faces(mesh, ray), rtol=1e-12)
            np.testing.assert_allclose(met.points, ray.at(met.distances), rtol=0, atol=1e-13)


def test_a_ray_that_starts_behind_the_body_or_passes_it_meets_nothing():
    mesh = Mesh(*shapes.cube())
    for ray in (Ray((0.5, 0.5, 3.0), (0, 0, 1)), Ray((3.0, 3.0, 0.5), (1, -1, 0))):
        assert crossings(mesh, ray).points.shape == (0, 3)


@pytest.mark.slow
def test_a_program_that_ends_with_its_mesh_says_nothing():
    """Nanobind complains of objects that outlive the interpreter, such as those of module-level names."""
    program = (
        "from idviewer.core import Mesh, read_mesh, sample_path\n"
        "from idviewer.core.shapes.rays import Ray, crossings\n"
        "mesh = read_mesh(sample_path('cat_2k'))\n"
        "Mesh.one_for_ever = mesh\n"
        "assert len(crossings(mesh, Ray(tuple(mesh.centre), (0, 0, 1))).distances) < 9\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("", "")
