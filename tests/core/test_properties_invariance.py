"""Properties that the paper shows in pictures or takes for granted: smoothness, and what must not matter."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes
from tests.core.property_shapes import (
    BY_ALL_COORDINATES,
    EVERYWHERE,
    EXACT,
    RANDOM,
    Body,
    exact_distance,
    inside,
    pairs,
    shape,
    solver_of,
    with_vertices,
)

from idviewer.core import (
    GPS,
    Biharmonic,
    CommuteTime,
    Diffusion,
    Distance,
    Euclidean,
    Geodesic,
    GivenEmbedding,
    InteriorDistance,
    Mesh,
    Polygon,
    SpectralFilter,
)

HEAT = "exp(-lambda / (8 * lambda_2))"


def crossings(body: Body, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Where the segment meets the lines or planes of edges or faces, as shares of it in ascending order."""
    corners = body.vertices[body.facets]
    if body.dimension == 3:
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    else:
        side = corners[:, 1] - corners[:, 0]
        normals = np.column_stack([-side[:, 1], side[:, 0]])
    heights = np.einsum("fi,fi->f", corners[:, 0] - start, normals)
    shares = heights / (normals @ (end - start))
    return np.sort(shares[(shares > 0.02) & (shares < 0.98)])


def bends(solver: InteriorDistance, source: np.ndarray, at: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Second differences of the distance from a source at points, along a step."""
    rows = np.concatenate([at - step, at, at + step])
    before, here, after = solver.field(source, rows).reshape(3, -1)
    return before - 2 * here + after


def clear_segment(body: Body, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A segment inside that keeps away from the boundary, and a source away from it."""
    fan = 0.02 * body.diagonal * np.concatenate([np.eye(body.dimension), -np.eye(body.dimension)])
    solver = InteriorDistance(body, Euclidean())
    for start, end, source in inside(body, rng, 600).reshape(-1, 3, body.dimension):
        along = start + np.linspace(0, 1, 40)[:, None] * (end - start)
        long = np.linalg.norm(end - start) > 0.15 * body.diagonal
        apart = np.linalg.norm(along - source, axis=1).min() > 0.05 * body.diagonal
        met = len(crossings(body, start, end)) > 4
        if (
            long
            and apart
            and met
            and solver.contains((along[:, None] + fan).reshape(-1, body.dimension)).all()
        ):
            return start, end, source
    raise AssertionError("no such segment")


@pytest.mark.one_is_quick
@pytest.mark.parametrize("name", [*RANDOM, "gingerbread"])
@BY_ALL_COORDINATES
def test_smoothness_along_lines_through_planes_of_faces(name, coordinates, rng):
    """ "The distance does not experience any discontinuities", it is "smooth within the shape interior".

    Second differences shrink like h^2 wherever the line meets the plane of a face, and between. A kink
    would make them shrink like h, a jump not at all.
    """
    body = shape(name)
    start, end, source = clear_segment(body, rng)
    solver = solver_of("diffusion", body, coordinates)
    shares = np.concatenate([crossings(body, start, end), np.linspace(0.05, 0.95, 30)])
    at = start + shares[:, None] * (end - start)
    step = 2e-4 * body.diagonal * (end - start) / np.linalg.norm(end - start)
    coarse, middle, fine = (bends(solver, source, at, step * factor) for factor in (1.0, 0.5, 0.25))
    # At every single place what is left after h^2 is of order h^4; h is a hundredth of the clearance.
    largest = np.abs(middle).max()
    assert np.abs(coarse - 4 * middle).max() < 2e-3 * largest
    assert np.abs(middle - 4 * fine).max() < 5e-4 * largest


@pytest.mark.parametrize("coordinates", ["mean_value", "shepard"])
def test_smoothness_in_the_plane_of_a_face_and_across_it(coordinates):
    """In the L, where faces at the inner corner extend into the interior: across their planes and in them."""
    ell = Mesh(*shapes.subdivided(*shapes.subdivided(*shapes.l_shape())))
    solver = InteriorDistance(ell, Diffusion(), coordinates)
    source = np.array([0.2, 0.3, 0.4])
    inner = np.array([[0.55, 1.0, 0.5], [0.8, 1.0, 0.3], [1.0, 0.6, 0.55], [1.0, 1.0 - 0.1, 0.5]])
    for heading in ([1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0], [1.0, 1.0, 0.2]):
        step = 2e-4 * np.array(heading)
        coarse, fine = bends(solver, source, inner, step), bends(solver, source, inner, 0.5 * step)
        assert np.abs(coarse - 4 * fine).max() < 1e-4 * np.abs(coarse).max()


def test_the_measure_of_smoothness_sees_a_kink():
    """A control: the height above a line, as a distance would have it, bends like h there."""
    at = np.array([0.0])
    kinked = [np.abs(at - h) - 2 * np.abs(at) + np.abs(at + h) for h in (1.0, 0.5)]
    assert np.abs(kinked[0] - 4 * kinked[1]).max() > 0.9 * np.abs(kinked[1]).max()


def made(kind: str, body: Body) -> Distance:
    return Geodesic() if kind == "geodesic" else exact_distance(kind, body)


def solver_with(kind: str, body: Body, coordinates: str = "mean_value") -> InteriorDistance:
    return InteriorDistance(body, made(kind, body), coordinates)


@pytest.mark.one_is_quick
@EVERYWHERE
@pytest.mark.parametrize("kind", [*EXACT, "geodesic"])
def test_rigid_motions_change_nothing(name, kind, rng):
    """Boundary distances and weights depend on lengths and angles alone; turned, moved, and mirrored."""
    body, (p, q) = shape(name), pairs(name)
    expected = solver_with(kind, body).distance(p, q)
    turn = np.linalg.qr(rng.standard_normal((body.dimension,) * 2))[0]
    turn[:, 0] *= np.sign(np.linalg.det(turn))
    mirror = np.diag([-1.0] + [1.0] * (body.dimension - 1))
    shift = 7.0 * rng.standard_normal(body.dimension)
    for matrix in (turn, turn @ mirror):
        vertices = body.vertices @ matrix + shift
        mirrored = isinstance(body, Mesh) and np.linalg.det(matrix) < 0
        moved = Mesh(vertices, body.faces[:, ::-1]) if mirrored else with_vertices(body, vertices)
        if kind in ("matrix", "embedding", "euclidean"):
            found = InteriorDistance(moved, made(kind, body)).distance(p @ matrix + shift, q @ matrix + shift)
        else:
            found = solver_with(kind, moved).distance(p @ matrix + shift, q @ matrix + shift)
        np.testing.assert_allclose(found, expected, rtol=1e-6)


POWERS = {
    "diffusion": (Diffusion(), -0.5, -1.0),
    "filter": (SpectralFilter(HEAT), -0.5, -1.0),
    "gps": (GPS(), 0.5, 0.0),
    "commute": (CommuteTime(), 0.5, 0.0),
    "biharmonic": (Biharmonic(), 1.5, 1.0),
    "geodesic": (Geodesic(), 1.0, 1.0),
    "exact geodesic": (Geodesic(method="exact"), 1.0, 1.0),
    "landmarks": (Geodesic(landmarks=20), 1.0, 1.0),
    "euclidean": (Euclidean(), 1.0, 1.0),
}
"""d(s p, s q) = s^power d(p, q), the powers in the plane and in space.

lambda_k scales with s^-2 in both. phi^T M phi = 1 with M a length in the plane and an area in space, so phi
scales with s^-1/2 and s^-1. Diffusion with t = 1 / (8 lambda_2) scales like phi, GPS and commute time like
phi / lambda^1/2, biharmonic like phi / lambda.
"""


@pytest.mark.one_is_quick
@EVERYWHERE
@pytest.mark.parametrize("kind", POWERS)
@pytest.mark.parametrize("size", [3.0, 1e-9, pytest.param(1e6, marks=pytest.mark.slow)])
def test_scale_law(name, kind, size):
    body, (p, q) = shape(name), pairs(name)
    distance, *powers = POWERS[kind]
    scaled = with_vertices(body, size * body.vertices)
    expected = InteriorDistance(body, distance).distance(p, q)
    found = InteriorDistance(scaled, distance).distance(size * p, size * q)
    np.testing.assert_allclose(found, size ** powers[body.dimension - 2] * expected, rtol=1e-6)


@pytest.mark.one_is_quick
@EVERYWHERE
@pytest.mark.parametrize("size", [3.0, 1e-3])
def test_scale_law_of_a_given_diffusion_time(name, size):
    """A time is a length squared: s^2 t on the scaled shape stands for t."""
    body, (p, q) = shape(name), pairs(name)
    time = 0.01 * body.diagonal**2
    scaled = with_vertices(body, size * body.vertices)
    expected = InteriorDistance(body, Diffusion(time)).distance(p, q)
    found = InteriorDistance(scaled, Diffusion(size**2 * time)).distance(size * p, size * q)
    power = -0.5 if body.dimension == 2 else -1.0
    np.testing.assert_allclose(found, size**power * expected, rtol=1e-8)


def renumbered(body: Body, order: np.ndarray, rng: np.random.Generator) -> Body:
    """Vertex i of the result is order[i] of the shape; faces begin elsewhere, loops too and run backwards."""
    rank = np.argsort(order)
    if isinstance(body, Polygon):
        loops = [np.roll(rank[loop], 3)[::-1] for loop in body.loops[::-1]]
        return Polygon(body.vertices[order], loops)
    faces = rank[body.faces][rng.permutation(len(body.faces))]
    turned = [np.roll(face, shift) for face, shift in zip(faces, rng.integers(0, 3, len(faces)), strict=True)]
    return Mesh(body.vertices[order], np.array(turned))


@pytest.mark.one_is_quick
@EVERYWHERE
@pytest.mark.parametrize("kind", [*EXACT, "geodesic"])
@BY_ALL_COORDINATES
def test_renumbering_changes_nothing(name, kind, coordinates, rng):
    body, (p, q) = shape(name), pairs(name)
    order = rng.permutation(len(body.vertices))
    other = renumbered(body, order, rng)
    distance = made(kind, body)
    if kind in ("matrix", "embedding"):
        distance = GivenEmbedding(solver_of(kind, body, "mean_value").boundary.embedding[order])
    expected = InteriorDistance(body, made(kind, body), coordinates).distance(p, q)
    found = InteriorDistance(other, distance, coordinates).distance(p, q)
    np.testing.assert_allclose(found, expected, rtol=1e-6)
