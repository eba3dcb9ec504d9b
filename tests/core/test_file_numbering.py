"""File numbering: every vertex of a file is found again after each repair, and values go both ways."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.core import meshfiles, shapes

from idviewer.core import DistanceError, Polygon
from idviewer.core.distances.matrix_input import RowsOfVertices
from idviewer.core.io import read_mesh, read_polygon
from idviewer.core.io.listed_points import without_repeated_points
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.mesh_repair import repair_mesh
from idviewer.core.validation.file_numbering import FileNumbering


def assert_found_again(mesh, given_vertices, dropped=(), within=0.0):
    """Each vertex given lies where the one lies that it became; those dropped are exactly these."""
    became = mesh.file_vertices
    assert np.flatnonzero(became < 0).tolist() == sorted(dropped)
    kept = np.flatnonzero(became >= 0)
    assert np.abs(mesh.vertices[became[kept]] - np.asarray(given_vertices)[kept]).max() <= within
    assert np.array_equal(became[mesh.numbering.origins], np.arange(len(mesh.vertices)))


def test_a_mesh_made_in_memory_counts_as_its_arrays_do():
    mesh = Mesh(*shapes.torus())
    assert mesh.numbering.trivial
    assert mesh.file_vertices.tolist() == list(range(len(mesh.vertices)))


def test_the_corners_of_a_soup_are_found_again():
    vertices, faces = shapes.soup(shapes.cube())
    mesh = repair_mesh(vertices, faces)
    assert_found_again(mesh, vertices)
    assert (mesh.numbering.merged, mesh.numbering.dropped) == (36 - 8, 0)


def test_isolated_vertices_are_told_as_dropped_wherever_they_stand():
    vertices, faces = shapes.cube()
    for place in (0, 3, 8):
        with_one = np.insert(vertices, place, [5.0, 5.0, 5.0], axis=0)
        mesh = repair_mesh(with_one, faces + (faces >= place))
        assert_found_again(mesh, with_one, dropped=[place])


def test_the_vertices_of_other_components_are_told_as_dropped():
    vertices, faces = shapes.joined(shapes.cube(), shapes.moved(shapes.tetrahedron(), 3.0, 0.0, 0.0))
    assert_found_again(repair_mesh(vertices, faces, component=2), vertices, dropped=range(8))
    assert_found_again(repair_mesh(vertices, faces, component=1), vertices, dropped=range(8, 12))


def test_vertices_merged_across_a_gap_are_found_again(rng):
    vertices, faces = shapes.soup(shapes.torus())
    shaken = vertices + 1e-8 * rng.uniform(-1, 1, vertices.shape)
    mesh = repair_mesh(shaken, faces)
    assert_found_again(mesh, shaken, within=2e-8)
    assert 1e-9 < mesh.numbering.gap < 2e-8


def test_vertices_are_found_again_after_faces_without_area_went():
    vertices, faces = shapes.cube()
    a, b, c = faces[0]
    middle = len(vertices)
    vertices = np.vstack([vertices, (vertices[a] + vertices[b]) / 2, [[7.0, 7.0, 7.0]]])
    # A flat face fills the side on whose middle only one of its faces has a vertex.
    split = np.vstack([faces[1:], [[a, middle, c], [middle, b, c], [a, b, middle]]])
    mesh = repair_mesh(vertices, split)
    assert any("without area" in note for note in mesh.notes)
    assert_found_again(mesh, vertices, dropped=[middle + 1])


@pytest.mark.slow
@given(st.integers(0, 2**32 - 1))
@settings(max_examples=25, deadline=None)
def test_several_repairs_at_once_are_followed(seed):
    rng = np.random.default_rng(seed)
    vertices, faces = shapes.joined(shapes.octahedron(), shapes.moved(shapes.cube(), 4.0, 0.0, 0.0))
    vertices, faces = shapes.soup((vertices, faces))
    order = rng.permutation(len(vertices))
    alone = rng.uniform(-9, 9, (3, 3))
    shuffled = np.vstack([alone, vertices[order]])
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.arange(len(order)) + 3
    mesh = repair_mesh(shuffled, number[faces], component=2)
    gone = (
        np.flatnonzero(shuffled[:, 0] < 2.0)
        if len(mesh.vertices) == 8
        else np.flatnonzero(shuffled[:, 0] > 2.0)
    )
    assert_found_again(mesh, shuffled, dropped=sorted({0, 1, 2} | set(gone.tolist())))


@pytest.mark.parametrize("suffix", ["off", "obj", "ply", "stl", "glb"])
def test_the_order_of_a_file_is_that_of_its_points(suffix, tmp_path):
    vertices, faces = shapes.cube()
    mesh = read_mesh(meshfiles.write(tmp_path, f".{suffix}", getattr(meshfiles, suffix)(vertices, faces)))
    listed = vertices[faces].reshape(-1, 3) if suffix == "stl" else vertices
    assert_found_again(mesh, listed)


def test_values_go_back_to_the_files_order():
    numbering = FileNumbering(np.array([1, -1, 0, 1]), np.array([2, 0]))
    back = numbering.in_file_order([[3.0, 4.0], [5.0, 6.0]])
    assert np.array_equal(back, [[5, 6], [np.nan, np.nan], [3, 4], [5, 6]], equal_nan=True)
    with pytest.raises(ValueError, match="none of 2 vertices"):
        numbering.in_file_order([1.0, 2.0, 3.0])


def test_copies_and_new_points_are_followed():
    numbering = FileNumbering.unchanged(3).renumbered(np.array([-1, 0, 1]))
    copied = numbering.split(np.array([1, 0, -1, 0]))
    assert copied.became.tolist() == [-1, 1, 0]
    assert copied.origins.tolist() == [2, 1, -1, 1]
    assert not copied.trivial
    dropped = copied.renumbered(np.array([0, -1, 1, 2]))
    assert (dropped.became.tolist(), dropped.origins.tolist()) == ([-1, -1, 0], [2, -1, 1])


def test_a_refined_shape_knows_which_vertices_are_the_files():
    soup = shapes.soup(shapes.cube())
    for shape in (repair_mesh(*soup), Polygon(SQUARE)):
        fine = shape.refined(0.4)
        assert np.array_equal(fine.file_vertices, shape.file_vertices)
        count = len(shape.vertices)
        assert fine.numbering.origins[:count].tolist() == shape.numbering.origins.tolist()
        assert set(fine.numbering.origins[count:].tolist()) == {-1}
        back = fine.numbering.in_file_order(fine.vertices)
        assert np.array_equal(back, shape.vertices[shape.file_vertices])
        with pytest.raises(DistanceError, match="were made by a repair or a refinement, and have no rows"):
            RowsOfVertices("embedding").of(np.ones((len(shape.file_vertices), 1)), fine)


SQUARE = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
HOLE = [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("suffix", ["csv", "json", "geojson", "wkt"])
def test_the_points_of_a_polygons_file_are_found_again(suffix, closed, tmp_path):
    closed = closed or suffix in ("geojson", "wkt")
    loops = [loop + loop[:1] if closed else loop for loop in (SQUARE, HOLE)]
    rings = ", ".join("(" + ", ".join(f"{x} {y}" for x, y in loop) + ")" for loop in loops)
    content = {
        "csv": "\n\n".join("\n".join(f"{x},{y}" for x, y in loop) for loop in loops),
        "json": json.dumps({"outer": loops[0], "holes": loops[1:]}),
        "geojson": json.dumps({"type": "Polygon", "coordinates": loops}),
        "wkt": f"POLYGON ({rings})",
    }[suffix]
    path = tmp_path / f"plate.{suffix}"
    path.write_text(content)
    polygon = read_polygon(path)
    assert_found_again(polygon, loops[0] + loops[1])
    assert polygon.notes == () or "taken for lengths" in polygon.notes[0]
    assert polygon.numbering.without_closing().trivial
    assert polygon.numbering.closing.tolist() == ([4, 8] if closed else [])


def test_points_that_repeat_the_one_before_are_merged_with_a_note(tmp_path):
    listed = [[0, 0], [3, 0], [3, 0], [3, 0], [3, 2], [0, 2], [0, 2 - 1e-15], [0, 0], [0, 0]]
    path = tmp_path / "plate.json"
    path.write_text(json.dumps(listed))
    polygon = read_polygon(path)
    assert polygon.area == pytest.approx(6.0, rel=1e-14)
    assert polygon.notes == ("4 points that repeat the one before were merged with it.",)
    assert_found_again(polygon, listed, within=2e-15)
    assert polygon.with_vertices(polygon.vertices * 2).file_vertices.tolist() == [0, 1, 1, 1, 2, 3, 3, 0, 0]


@given(st.lists(st.integers(1, 3), min_size=3, max_size=8), st.integers(0, 4), st.booleans())
def test_every_listed_point_becomes_the_vertex_in_its_place(repeats, again, closed):
    corners = np.column_stack([np.cos(np.arange(len(repeats))), np.sin(np.arange(len(repeats)))])
    listed = np.concatenate(
        [np.repeat(corners, repeats, axis=0), np.repeat(corners[:1], again + closed, axis=0)]
    )
    found = without_repeated_points([listed])
    assert np.array_equal(found.loops[0], corners)
    assert np.array_equal(corners[found.numbering.became], listed)
    assert np.array_equal(found.numbering.became[found.numbering.origins], np.arange(len(corners)))
