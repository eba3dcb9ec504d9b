"""Distances and embeddings that are given: what embeds is reproduced, what does not is said."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes
from tests.core.test_mean_value import inner_points

from idviewer.core import (
    Diffusion,
    DistanceError,
    Euclidean,
    GivenDistances,
    GivenEmbedding,
    InteriorDistance,
    Mesh,
    gram_distance,
    pairwise_distance,
)
from idviewer.core.distances.classical_mds import double_centred
from idviewer.core.interior.embedded_points import squares_of


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    vertices, faces = shapes.icosphere(2)
    return Mesh(vertices * [1.0, 1.4, 2.1], faces)


@pytest.fixture(scope="module")
def straight(mesh: Mesh) -> np.ndarray:
    return np.linalg.norm(mesh.vertices[:, None] - mesh.vertices, axis=2)


def on_a_sphere() -> tuple[Mesh, np.ndarray]:
    """The great-circle distances of a sphere's vertices: they do not embed."""
    sphere = Mesh(*shapes.icosphere(2))
    angles = np.arccos(np.clip(sphere.vertices @ sphere.vertices.T, -1, 1))
    np.fill_diagonal(angles, 0.0)
    return sphere, angles


@pytest.mark.slow
def test_given_euclidean_distances_are_reproduced_inside(mesh, straight, rng, tmp_path):
    points = inner_points(mesh, rng, 40)
    expected = np.linalg.norm(points[:20] - points[20:], axis=1)
    np.save(tmp_path / "d.npy", straight)
    for given in (straight, tmp_path / "d.npy", str(tmp_path / "d.npy")):
        solver = InteriorDistance(mesh, GivenDistances(given))
        assert solver.boundary.basis.shape[1] == 3
        np.testing.assert_allclose(solver.distance(points[:20], points[20:]), expected, rtol=1e-6)
        assert "left out" not in solver.description


def test_the_gram_matrix_is_centred_and_has_the_distances(rng):
    """Eq. 3: rows of A sum to 0, and A_ii + A_jj - 2 A_ij = D_ij."""
    squares = squares_of(rng.standard_normal((30, 5)))
    gram = double_centred(squares)
    np.testing.assert_allclose(gram.sum(axis=0), 0, atol=1e-12 * abs(gram).max() * 30)
    norms = np.diag(gram)
    np.testing.assert_allclose(norms[:, None] + norms - 2 * gram, squares, atol=1e-12 * squares.max())


@pytest.mark.slow
def test_the_distance_does_not_depend_on_the_embedding(mesh, rng):
    """Eq. 1 = eq. 2 = eq. 4 = eq. 5, for an embedding, the same one moved, and the distances alone."""
    points = inner_points(mesh, rng, 40)
    p, q = points[:20], points[20:]
    first = InteriorDistance(mesh, Diffusion())
    embedding = first.boundary.embedding
    rotation = np.linalg.qr(rng.standard_normal((embedding.shape[1],) * 2))[0]
    moved = GivenEmbedding(embedding @ rotation + rng.standard_normal(embedding.shape[1]))
    alone = GivenDistances(np.sqrt(squares_of(embedding)))
    expected = first.distance(p, q)
    for kind in (Diffusion(), moved, alone):
        solver = InteriorDistance(mesh, kind)
        for found in (
            solver.distance(p, q),
            gram_distance(solver, p, q),
            pairwise_distance(solver, p, q),
            pairwise_distance(solver, p, q, expanded=True),
            pairwise_distance(solver, p, q, squares_of(embedding)),
        ):
            np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_the_given_distances_are_interpolated(mesh, straight):
    alone = InteriorDistance(mesh, GivenDistances(straight))
    one, other = np.arange(10), np.arange(10, 20)
    found = alone.distance(mesh.vertices[one], mesh.vertices[other])
    np.testing.assert_allclose(found, straight[one, other], rtol=1e-9)


def test_an_embedding_is_used_as_it_is(mesh, rng, tmp_path):
    points = inner_points(mesh, rng, 20)
    np.save(tmp_path / "e.npy", mesh.vertices.astype(np.float32) + 7)
    for given in (mesh.vertices, tmp_path / "e.npy"):
        found = InteriorDistance(mesh, GivenEmbedding(given)).field(points[0], points)
        np.testing.assert_allclose(
            found, InteriorDistance(mesh, Euclidean()).field(points[0], points), atol=1e-5
        )


def tree_metric(count: int) -> np.ndarray:
    """Distances in a star: all ends 2 apart, the middle 1 from each. They do not embed."""
    matrix = np.full((count, count), 2.0)
    matrix[0] = matrix[:, 0] = 1.0
    np.fill_diagonal(matrix, 0.0)
    return matrix


def test_distances_that_do_not_embed_are_refused_or_approximated():
    sphere, angles = on_a_sphere()
    for matrix in (angles, tree_metric(len(angles))):
        values = np.linalg.eigvalsh(double_centred(matrix**2))
        share = -values[0] / values[-1]
        assert share > 1e-3
        with pytest.raises(DistanceError, match=r"do not embed exactly.*fit=approximate") as error:
            InteriorDistance(sphere, GivenDistances(matrix))
        told = float(str(error.value).split("Gram matrix is ")[1].split("%")[0])
        assert told == pytest.approx(100 * share, rel=0.06)
        near = InteriorDistance(sphere, GivenDistances(matrix, fit="approximate"))
        left_out = -values[values < 0].sum() / abs(values).sum()
        told = float(near.description.split("; ")[1].split("%")[0])
        assert told == pytest.approx(100 * left_out, rel=0.06)
        # Without the negative part all distances are longer.
        assert (np.sqrt(squares_of(near.boundary.embedding)) >= matrix - 1e-6).all()


def changed(matrix: np.ndarray, row: int, column: int, value: float) -> np.ndarray:
    result = matrix.copy()
    result[row, column] = value
    return result


@pytest.mark.parametrize(
    ("spoil", "part"),
    [
        (lambda d: d[:-1, :-1], "its shape is (161, 161); the shape has 162 vertices"),
        (lambda d: d[:, :-1], "its shape is (162, 161); distances between all pairs of vertices are n x n"),
        (lambda d: d[0], "its shape is (162,)"),
        (lambda d: changed(d, 3, 5, np.nan), "1 entries are NaN or infinite, the first in row 3, column 5"),
        (lambda d: changed(d, 3, 5, np.inf), "row 3, column 5"),
        (lambda d: changed(d, 3, 5, -1.0), "the distance in row 3, column 5 is negative (-1)"),
        (lambda d: changed(d, 3, 5, 9.0), "not symmetric: row 3, column 5 has 9"),
        (lambda d: changed(d, 4, 4, 0.5), "row 4 has 0.5 on the diagonal"),
        (lambda d: 0 * d, "all distances are 0"),
        (lambda d: d.astype(complex), "complex128, not real numbers"),
        (lambda d: d.astype(str), "not real numbers"),
    ],
)
def test_bad_matrices_have_a_line_each(mesh, straight, spoil, part, tmp_path):
    np.save(tmp_path / "bad.npy", spoil(straight))
    for given in (spoil(straight), tmp_path / "bad.npy"):
        with pytest.raises(DistanceError) as error:
            InteriorDistance(mesh, GivenDistances(given))
        assert part in str(error.value)
        assert "\n" not in str(error.value)


@pytest.mark.parametrize("kind", [GivenDistances, GivenEmbedding])
def test_bad_files_have_a_line_each(mesh, kind, tmp_path):
    (tmp_path / "text.npy").write_text("hello")
    (tmp_path / "empty.npy").write_bytes(b"")
    np.save(tmp_path / "objects.npy", np.array([{}], dtype=object))
    for name, part in (
        ("text.npy", "not a whole .npy file"),
        ("empty.npy", "not a whole .npy file"),
        ("objects.npy", "pickled Python objects, which can run any program and are not opened"),
    ):
        with pytest.raises(DistanceError, match=f"{name}: .*{part}"):
            InteriorDistance(mesh, kind(tmp_path / name))
    with pytest.raises(OSError, match="nowhere"):
        InteriorDistance(mesh, kind(tmp_path / "nowhere.npy"))
    with pytest.raises(DistanceError, match="no file with the"):
        InteriorDistance(mesh, kind())


def test_given_arrays_compare_and_hash(mesh, straight):
    one = GivenDistances(straight)
    assert one == one
    assert hash(one) == hash(one)
    assert one != GivenDistances(straight)
    assert GivenDistances("a.npy") == GivenDistances("a.npy")
    with pytest.raises(ValueError, match="the matrix fit must be exact or approximate, not 'near'"):
        GivenDistances(fit="near")
