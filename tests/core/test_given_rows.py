"""Given arrays count as the shape's file does, through merging, dropping, reordering and choosing."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import meshfiles, shapes

from idviewer.core import (
    DistanceError,
    Euclidean,
    GivenDistances,
    GivenEmbedding,
    InteriorDistance,
    Mesh,
    read_mesh,
    read_polygon,
)
from idviewer.core.distances.matrix_input import RowsOfVertices
from idviewer.core.shapes.mesh_repair import repair_mesh

TWO = shapes.joined(shapes.cube(), shapes.moved(shapes.cube(), 3.0, 0.0, 0.0))


def with_isolated(place: int):
    vertices, faces = shapes.cube()
    return np.insert(vertices, place, [9.0, 9.0, 9.0], axis=0), faces + (faces >= place)


def reversed_order():
    vertices, faces = shapes.cube()
    return vertices[::-1], len(vertices) - 1 - faces


CASES = {
    "a soup of 12 triangles": (shapes.soup(shapes.cube()), None, 36),
    "an isolated vertex first": (with_isolated(0), None, 9),
    "an isolated vertex in the middle": (with_isolated(4), None, 9),
    "an isolated vertex last": (with_isolated(8), None, 9),
    "component 1 of 2": (TWO, 1, 16),
    "component 2 of 2": (TWO, 2, 16),
    "in reverse": (reversed_order(), None, 8),
}


def stretched(points: np.ndarray) -> np.ndarray:
    """An embedding that tells all corners of a box apart."""
    return np.asarray(points) @ [[1.0, 0.3], [0.2, 2.0], [0.1, 0.4]]


def between(points: np.ndarray) -> np.ndarray:
    return np.linalg.norm(points[:, None] - points, axis=2)


@pytest.mark.parametrize("case", CASES)
def test_distances_and_embeddings_are_those_of_the_files_vertices(case):
    (vertices, faces), component, count = CASES[case]
    assert len(vertices) == count
    mesh = repair_mesh(vertices, faces, component=component)
    expected = stretched(mesh.vertices)
    embedding = InteriorDistance(mesh, GivenEmbedding(stretched(vertices))).boundary.embedding
    np.testing.assert_allclose(embedding, expected - expected.mean(axis=0), atol=1e-14)
    found = GivenDistances(between(stretched(vertices))).squares(mesh)
    np.testing.assert_allclose(np.sqrt(found), between(expected), atol=1e-14)


def test_a_distance_between_inner_points_is_the_one_asked_for(tmp_path):
    """The straight distances of an STL file's 36 corners give the straight distance inside."""
    path = meshfiles.write(tmp_path, ".stl", meshfiles.stl(*shapes.cube()))
    corners = shapes.soup(shapes.cube())[0]
    np.savetxt(tmp_path / "d.csv", between(corners), delimiter=";")
    mesh = read_mesh(path)
    middle, away = mesh.centre, mesh.centre + 0.2
    found = InteriorDistance(mesh, GivenDistances(tmp_path / "d.csv")).distance([middle], [away])
    assert found[0] == pytest.approx(np.linalg.norm(away - middle), rel=1e-9)


def test_a_count_that_fits_only_by_accident_is_refused_with_the_reason():
    vertices, faces = with_isolated(4)
    mesh = repair_mesh(vertices, faces)
    eight = stretched(shapes.cube()[0])
    with pytest.raises(DistanceError) as error:
        InteriorDistance(mesh, GivenEmbedding(eight))
    assert str(error.value) == (
        "the embedding: its 8 rows are as many as the shape's vertices by now, but its file has 9, "
        "of which 1 was dropped; give one row for each of the 9, or say counting=shape"
    )
    counted = InteriorDistance(mesh, GivenEmbedding(stretched(mesh.vertices), counting="shape"))
    np.testing.assert_allclose(counted.boundary.embedding, eight - eight.mean(axis=0), atol=1e-14)
    soup = repair_mesh(*shapes.soup(shapes.cube()))
    with pytest.raises(DistanceError, match="has 36, of which 28 were merged with others; give one row"):
        GivenDistances(between(soup.vertices)).squares(soup)
    with pytest.raises(DistanceError, match=r"its shape is \(5, 5\); the shape's file has 36 vertices"):
        GivenDistances(np.zeros((5, 5))).squares(soup)
    with pytest.raises(DistanceError, match=r"its shape is \(36, 36\); the shape has 8 vertices"):
        GivenDistances(np.zeros((36, 36)), counting="shape").squares(soup)


def test_a_mesh_made_in_memory_counts_as_its_vertices_do():
    mesh = Mesh(*shapes.cube())
    for counting in ("file", "shape"):
        assert RowsOfVertices("rows", counting).of(np.eye(8), mesh).tolist() == np.eye(8).tolist()


def test_rows_of_merged_vertices_are_to_agree(rng):
    vertices, faces = shapes.soup(shapes.cube())
    mesh = repair_mesh(vertices, faces)
    rows = stretched(vertices)
    twin = int(np.flatnonzero(mesh.file_vertices == mesh.file_vertices[0])[1])
    rounded = rows.astype(np.float32)
    assert len(RowsOfVertices("rows").of(rounded + 0.5e-6 * rng.uniform(-1, 1, rows.shape), mesh)) == 8
    rows[twin, 1] += 1e-4
    with pytest.raises(
        DistanceError, match=f"rows 0 and {twin} belong to vertices that were merged into one"
    ):
        RowsOfVertices("rows").of(rows, mesh)


def test_rows_across_a_gap_may_differ_as_the_gap_does(rng):
    vertices, faces = shapes.soup(shapes.icosphere(1))
    shaken = vertices + 4e-7 * rng.uniform(-1, 1, vertices.shape)
    mesh = repair_mesh(shaken, faces)
    matrix = between(shaken)
    np.testing.assert_allclose(
        np.sqrt(GivenDistances(matrix).squares(mesh)), between(mesh.vertices), atol=2e-6
    )


def test_what_is_told_of_dropped_vertices_does_not_matter():
    """Distances to vertices of other components are infinite, as libraries have them."""
    vertices, faces = TWO
    mesh = repair_mesh(vertices, faces, component=2)
    matrix = between(vertices)
    matrix[:8, 8:] = matrix[8:, :8] = np.inf
    found = np.sqrt(GivenDistances(matrix).squares(mesh))
    np.testing.assert_allclose(found, between(mesh.vertices), atol=1e-14)
    matrix[9, 12] = matrix[12, 9] = np.nan
    with pytest.raises(DistanceError, match="2 entries are NaN or infinite, the first in row 9, column 12"):
        GivenDistances(matrix).squares(mesh)


@pytest.mark.parametrize("closed", [4, 5])
def test_a_polygons_closing_point_may_be_counted_or_not(closed, tmp_path):
    listed = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0], [0.0, 0.0]])
    path = tmp_path / "plate.csv"
    np.savetxt(path, listed, delimiter=",")
    polygon = read_polygon(path)
    solver = InteriorDistance(polygon, GivenDistances(between(listed[:closed])))
    straight = InteriorDistance(polygon, Euclidean())
    for one in (solver, straight):
        assert one.distance([[1.0, 1.0]], [[3.0, 2.0]])[0] == pytest.approx(5**0.5, rel=1e-9)
