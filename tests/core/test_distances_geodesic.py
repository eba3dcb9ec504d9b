"""Geodesic distance: paths of known length, landmarks against all pairs, and what embedding leaves out."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from tests.core import shapes
from tests.core.outlines import flower, shortest_paths, with_holes

from idviewer.core import (
    DistanceError,
    Geodesic,
    InteriorDistance,
    Mesh,
    Polygon,
    parameters_of,
    read_mesh,
    sample_path,
)
from idviewer.core.distances.classical_mds import classical_mds_steps, double_centred, landmark_mds_steps
from idviewer.core.distances.geodesic_solvers import Geodesics, landmark_steps
from idviewer.core.distances.spectral import percentage
from idviewer.core.interior.embedded_points import squares_of
from idviewer.core.steps import finish


@pytest.fixture(scope="module")
def sphere() -> Mesh:
    return Mesh(*shapes.icosphere(3))


@pytest.mark.parametrize(("method", "error"), [("exact", 0.012), ("heat", 0.04)])
def test_on_a_sphere_they_are_great_circles(sphere, method, error):
    expected = np.arccos(np.clip(sphere.vertices @ sphere.vertices[7], -1, 1))
    found = Geodesics(sphere, method).from_vertex(7)
    assert found[7] == 0
    assert abs(found - expected).max() < error * np.pi


def test_on_a_box_they_are_unfolded():
    """Opposite corners of a unit cube are sqrt(5) apart."""
    vertices, faces = shapes.cube()
    for _ in range(2):
        vertices, faces = shapes.subdivided(vertices, faces)
    found = Geodesics(Mesh(vertices, faces), "exact").from_vertex(0)
    assert found[7] == pytest.approx(5**0.5, rel=1e-9)


@pytest.mark.parametrize("method", ["heat", "exact"])
def test_size_and_place_do_not_matter(method):
    vertices, faces = shapes.icosphere(2)
    plain = Geodesics(Mesh(vertices, faces), method).from_vertex(3)
    for size, shift in ((1e-9, 0.0), (1.0, 1e6)):
        found = Geodesics(Mesh(size * vertices + shift, faces), method).from_vertex(3)
        np.testing.assert_allclose(found, size * plain, atol=1e-6 * size)


def test_along_a_polygon_they_are_arc_lengths_and_take_bridges():
    corners = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]])
    np.testing.assert_allclose(Geodesics(Polygon(corners)).from_vertex(0), [0, 3, 4, 1], rtol=1e-12)
    hole = [[0.25, 0.0], [0.75, 0.25], [0.75, -0.25]]
    bridged = Polygon.of_loops([corners, np.add(hole, [0.5, 0.5])])
    np.testing.assert_array_equal(bridged.bridges, [[0, 4]])
    bridge, side = np.hypot(0.75, 0.5), np.hypot(0.5, 0.25)
    expected = [0, 3, 4, 1, bridge, bridge + side, bridge + side]
    np.testing.assert_allclose(Geodesics(bridged).from_vertex(0), expected, rtol=1e-12)


@pytest.mark.parametrize("polygon", [flower(90), with_holes()], ids=["one loop", "holes"])
def test_a_polygon_s_are_the_shortest_of_all_paths(polygon):
    geodesics = Geodesics(polygon)
    found = np.stack([geodesics.from_vertex(vertex) for vertex in range(len(polygon.vertices))])
    np.testing.assert_allclose(found, shortest_paths(polygon), rtol=1e-11, atol=1e-12 * polygon.diagonal)


def test_a_polygon_s_embedding_is_the_positive_part_of_its_gram_matrix():
    """Arc lengths of a loop do not embed: their squares' Gram matrix has negative eigenvalues."""
    for polygon in (flower(90), with_holes()):
        values, vectors = np.linalg.eigh(double_centred(shortest_paths(polygon) ** 2))
        positive = (vectors * np.maximum(values, 0)) @ vectors.T
        solver = InteriorDistance(polygon, Geodesic())
        gram = solver.boundary.embedding @ solver.boundary.embedding.T
        np.testing.assert_allclose(gram, positive, atol=1e-9 * values[-1])
        left_out = -values[values < 0].sum() / abs(values).sum()
        assert left_out > 0.01
        assert f"all pairs, {percentage(left_out)}" in solver.description


def test_landmarks_lie_far_apart(sphere):
    chosen, distances = finish(landmark_steps(sphere, Geodesics(sphere), 20))
    assert len(set(chosen.tolist())) == 20
    assert distances.shape == (len(sphere.vertices), 20)
    # Each is as far from those before as any vertex is.
    for count in range(1, 20):
        nearest = distances[:, :count].min(axis=1)
        assert nearest[chosen[count]] == nearest.max()


def test_landmarks_that_are_all_vertices_are_classical_scaling(rng):
    squares = squares_of(rng.standard_normal((60, 4))) ** 0.7  # concave, so not quite Euclidean squares
    order = rng.permutation(60)
    full = finish(classical_mds_steps(squares))
    landmarks = finish(landmark_mds_steps(squares[:, order], order))
    np.testing.assert_allclose(squares_of(landmarks.embedding), squares_of(full.embedding), rtol=1e-6)
    assert landmarks.discarded == pytest.approx(full.discarded)


def test_landmarks_place_the_others_exactly_where_distances_embed(rng):
    squares = squares_of(rng.standard_normal((80, 3)))
    placed = finish(landmark_mds_steps(squares[:, :10], np.arange(10)))
    np.testing.assert_allclose(squares_of(placed.embedding), squares, atol=1e-9 * squares.max())


@pytest.mark.slow
def test_scaling_is_the_positive_part_of_the_gram_matrix(sphere):
    geodesics = Geodesics(sphere, "heat")
    matrix = np.stack([geodesics.from_vertex(vertex) for vertex in range(len(sphere.vertices))])
    squares = (0.5 * (matrix + matrix.T)) ** 2
    values, vectors = np.linalg.eigh(double_centred(squares))
    positive = (vectors * np.maximum(values, 0)) @ vectors.T
    solver = InteriorDistance(sphere, Geodesic())
    np.testing.assert_allclose(solver.boundary.embedding @ solver.boundary.embedding.T, positive, atol=1e-8)
    left_out = -values[values < 0].sum() / abs(values).sum()
    assert f"all pairs, {100 * left_out:.2g}%" in solver.description
    assert left_out > 0.01, "a sphere's geodesics do not embed"


@pytest.mark.slow
def test_few_landmarks_come_as_near_to_the_geodesics_as_all_pairs_do(sphere):
    """On a sphere the positive part is a third off: the embedding's limit, not the landmarks'."""
    angles = np.arccos(np.clip(sphere.vertices @ sphere.vertices.T, -1, 1))
    errors = []
    for landmarks in (60, 2000):
        solver = InteriorDistance(sphere, Geodesic(landmarks=landmarks))
        errors.append(abs(np.sqrt(squares_of(solver.boundary.embedding)) - angles).mean() / angles.mean())
    assert "all pairs" in solver.description
    assert errors[0] < 1.05 * errors[1] < 0.4


def test_it_tells_of_its_progress_and_shares_its_basis_with_itself(sphere):
    shares = [one for one in Geodesic(landmarks=30).basis_steps(sphere, None) if one is not None]
    assert len(shares) >= 30
    assert shares == sorted(shares)
    solver = InteriorDistance(sphere, Geodesic(landmarks=30))
    assert solver.with_distance(Geodesic(landmarks=30)).boundary.basis is solver.boundary.basis
    assert not solver.boundary.shares_basis(Geodesic(landmarks=31))
    assert not solver.boundary.shares_basis(Geodesic(landmarks=30, method="exact"))


@pytest.mark.parametrize(
    ("values", "part"),
    [
        ({"landmarks": 3}, "the geodesic landmarks must be a whole number from 4 to 2000, not 3"),
        ({"landmarks": 2001}, "the geodesic landmarks must be a whole number from 4 to 2000, not 2001"),
        ({"landmarks": 7.5}, "the geodesic landmarks must be a whole number from 4 to 2000, not 7.5"),
        ({"method": "magic"}, "the geodesic method must be heat or exact, not 'magic'"),
    ],
)
def test_bad_parameters(values, part):
    with pytest.raises(ValueError) as error:  # noqa: PT011
        Geodesic(**values)
    assert str(error.value) == part


def test_the_exact_method_names_the_extra_that_it_needs(sphere, monkeypatch):
    for module in ("pygeodesic", "pygeodesic.geodesic"):
        monkeypatch.setitem(sys.modules, module, None)
    remedy = "exact needs the package pygeodesic: pip install 'idviewer[exact-geodesics]'"
    told = f"the method exact for geodesics {remedy.removeprefix('exact ')}; or take the method heat"
    for call in (
        lambda: Geodesics(sphere, "exact"),
        lambda: InteriorDistance(sphere, Geodesic(method="exact")),
    ):
        with pytest.raises(DistanceError) as error:
            call()
        assert str(error.value) == told
    method = parameters_of(Geodesic)["method"]
    assert method.domain == f"heat or exact; {remedy}"
    assert dict(method.titles) == {"heat": "Heat method", "exact": "Exact (slow), not installed"}
    polygon = flower(90)
    along = [Geodesics(polygon, one).from_vertex(0) for one in ("heat", "exact")]
    np.testing.assert_array_equal(*along, err_msg="along edges nothing is needed")


def test_where_the_extra_is_installed_nothing_is_said_of_it():
    method = parameters_of(Geodesic)["method"]
    assert (method.domain, method.remedies, method.titles) == ("heat or exact", [], method.choices)


def test_methods_that_do_not_exist_are_refused(sphere):
    with pytest.raises(
        DistanceError, match="there is no method 'magic' for geodesics; there are: heat, exact"
    ):
        Geodesics(sphere, "magic")


@pytest.mark.slow
def test_there_is_one_solve_for_each_landmark_and_distances_to_it_stay_near(monkeypatch):
    """How long 300 of them take on 27,000 vertices is a row of `make bench`."""
    asked: list[int] = []
    plain = Geodesics.from_vertex

    def counted(self: Geodesics, vertex: int) -> np.ndarray:
        asked.append(vertex)
        return plain(self, vertex)

    monkeypatch.setattr(Geodesics, "from_vertex", counted)
    mesh = read_mesh(sample_path("hand"))
    solver = InteriorDistance(mesh, Geodesic(landmarks=100))
    found = np.linalg.norm(solver.boundary.embedding - solver.boundary.embedding[0], axis=1)
    assert len(set(asked)) == len(asked) == 100
    exact = plain(Geodesics(mesh, "heat"), 0)
    assert abs(found - exact).mean() < 0.2 * exact.mean()
