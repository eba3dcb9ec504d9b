"""Repairs by name: gaps welded, T-junctions joined, holes filled; what is foretold is what is done."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from tests.core import meshfiles, shapes

from idviewer.core import Mesh, MeshError, Repairs, ShapeError, read_mesh, repair_mesh
from idviewer.core.io import read_body
from idviewer.core.shapes import BrokenBodyError, RawBody
from idviewer.core.validation import PolygonSoup

SCALES = [(1.0, 0.0), (1e-9, 0.0), (1.0, 1e6), (1e9, 0.0)]


def torn(arrays: shapes.Arrays, *directions: tuple[float, float, float]) -> shapes.Arrays:
    """Without the faces in some directions."""
    vertices, faces = arrays
    middles = vertices[faces].mean(axis=1)
    heights = middles @ np.array(directions).T
    return vertices, faces[(heights < 0.93).all(axis=1)]


def gaping(arrays: shapes.Arrays, rng: np.random.Generator, width: float) -> shapes.Arrays:
    """Facets whose corners differ by up to a width."""
    vertices, faces = shapes.soup(arrays)
    step = rng.normal(size=vertices.shape)
    return vertices + 0.5 * width * step / np.linalg.norm(step, axis=1, keepdims=True), faces


def t_junctions() -> shapes.Arrays:
    """A cube of which two faces have edges twice as fine as their neighbours."""
    vertices, faces = shapes.cube()
    fine, finer = shapes.subdivided(vertices, faces)
    return shapes.joined((vertices, faces[2:]), (fine, finer[:8]))


def body(arrays: shapes.Arrays) -> RawBody:
    return RawBody(PolygonSoup.of(*arrays), "body")


@pytest.mark.parametrize(("scale", "shift"), SCALES)
def test_gaps_are_welded_at_any_size_and_place(scale, shift, rng) -> None:
    whole = Mesh(*shapes.icosphere(1))
    vertices, faces = gaping(shapes.icosphere(1), rng, 1e-5)
    arrays = vertices * scale + shift, faces
    advice = body(arrays).suggested()
    assert advice.weld == pytest.approx(1e-5 * scale, rel=10.0)
    assert advice.fill_holes is None
    outcome = body(arrays).repaired(advice)
    assert len(outcome.mesh.vertices) == len(whole.vertices)
    assert len(outcome.mesh.faces) == len(whole.faces)
    assert outcome.mesh.volume == pytest.approx(whole.volume * scale**3, rel=1e-4)
    distance = np.linalg.norm(outcome.mesh.vertices[outcome.mesh.file_vertices] - arrays[0], axis=1)
    assert distance.max() == pytest.approx(outcome.moved, rel=1e-6)
    assert 0.0 < outcome.moved <= 1e-5 * scale * 1.001


def test_a_gap_wider_than_the_weld_stays(rng) -> None:
    arrays = gaping(shapes.octahedron(), rng, 1e-3)
    assert not body(arrays).repaired(Repairs(weld=1e-6)).usable
    assert body(arrays).repaired(Repairs(weld=1e-2)).usable


def test_vertices_on_edges_are_joined_and_the_body_is_the_same() -> None:
    vertices, faces = t_junctions()
    with pytest.raises(MeshError, match=r"--weld"):
        repair_mesh(vertices, faces)
    mesh = repair_mesh(vertices, faces, repairs=Repairs(weld=1e-6))
    assert (mesh.volume, mesh.area) == pytest.approx((1.0, 6.0), rel=1e-12)
    (note,) = (note for note in mesh.notes if note.startswith("Weld"))
    assert "4 vertices joined to edges" in note


def test_several_vertices_on_one_edge_are_joined() -> None:
    coarse = shapes.cube()
    fine = shapes.subdivided(*shapes.subdivided(*shapes.cube()))
    vertices, faces = shapes.joined((coarse[0], coarse[1][2:]), (fine[0], fine[1][:32]))
    mesh = repair_mesh(vertices, faces, repairs=Repairs(weld=1e-6))
    assert (mesh.volume, mesh.area) == pytest.approx((1.0, 6.0), rel=1e-12)


def test_holes_are_filled_up_to_the_size_that_is_asked_for() -> None:
    arrays = torn(shapes.icosphere(2), (1, 0, 0), (0, 1, 0), (0, -0.6, 0.8))
    sizes = sorted(len(one.points) for one in trimesh.Trimesh(*arrays, process=False).outline().entities)
    sizes = [size - 1 for size in sizes]  # the first point is the last one again
    assert len(sizes) == 3
    assert body(arrays).suggested() == Repairs(fill_holes=sizes[-1])
    assert not body(arrays).repaired(Repairs(fill_holes=sizes[-1] - 1)).usable
    outcome = body(arrays).repaired(Repairs(fill_holes=sizes[-1]))
    assert trimesh.Trimesh(outcome.mesh.vertices, outcome.mesh.faces, process=False).is_watertight
    # Lids are flat, and so cut off caps: the body is a convex polyhedron with its own vertices.
    assert outcome.mesh.volume == pytest.approx(trimesh.Trimesh(*arrays).convex_hull.volume, rel=0.01)
    assert outcome.moved == 0.0
    np.testing.assert_array_equal(
        outcome.mesh.vertices[outcome.mesh.file_vertices[np.unique(arrays[1])]],
        arrays[0][np.unique(arrays[1])],
    )


def test_a_missing_triangle_is_put_back() -> None:
    whole = Mesh(*shapes.torus())
    mesh = repair_mesh(*shapes.opened(shapes.torus()), repairs=Repairs(fill_holes=3))
    assert mesh.volume == pytest.approx(whole.volume, rel=1e-14)
    assert {tuple(sorted(face)) for face in mesh.faces.tolist()} == {
        tuple(sorted(face)) for face in whole.faces.tolist()
    }


def test_two_holes_that_meet_in_a_vertex_are_filled() -> None:
    vertices, faces = shapes.icosphere(1)
    hub = np.bincount(faces.ravel()).argmax()
    around = np.flatnonzero((faces == hub).any(axis=1))
    first = around[0]
    apart = next(face for face in around if len(set(faces[face]) & set(faces[first])) == 1)
    mesh = repair_mesh(vertices, np.delete(faces, [first, apart], axis=0), repairs=Repairs(fill_holes=8))
    assert len(mesh.faces) == len(faces)
    assert mesh.volume == pytest.approx(Mesh(vertices, faces).volume, rel=1e-14)


def test_a_lid_whose_sides_are_there_already_gets_a_middle() -> None:
    # Of a tetrahedron, two faces: the lid's diagonal is the one edge inside, where four faces would meet.
    vertices, faces = shapes.tetrahedron()
    mesh = repair_mesh(vertices, faces[:2], repairs=Repairs(fill_holes=4))
    assert len(mesh.vertices) == 5
    assert len(mesh.faces) == 6
    assert mesh.numbering.origins.tolist() == [0, 1, 2, 3, -1]


def test_what_is_foretold_is_what_is_done_and_noted(rng) -> None:
    arrays = torn(gaping(shapes.icosphere(2), rng, 1e-5), (1, 0, 0))
    raw = body(arrays)
    advice = raw.suggested()
    assert set(advice.asked) == {"weld", "fill_holes"}
    outcome = raw.repaired(advice)
    assert [record.name for record in outcome.records] == ["weld", "fill_holes"]
    assert all(record.count for record in outcome.records)
    notes = repair_mesh(*arrays, repairs=advice).notes
    for record in outcome.records:
        assert f"{record.sentence}." in notes


def test_a_refusal_names_the_repair_that_closes_it_on_one_line(rng, tmp_path: Path) -> None:
    path = tmp_path / "gap.off"
    path.write_bytes(meshfiles.off(*gaping(shapes.icosphere(1), rng, 1e-5)))
    with pytest.raises(BrokenBodyError) as caught:
        read_mesh(path)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)
    assert caught.value.advice.options in str(caught.value)
    assert caught.value.components == ()
    assert read_mesh(path, repairs=caught.value.advice).volume > 0.0
    assert len(caught.value.body.polygons.sizes) == len(read_body(path).polygons.sizes) == 80


@pytest.mark.parametrize("arrays", [shapes.klein_bottle(), shapes.non_manifold_cubes(), shapes.flat_sheet()])
def test_no_repair_is_offered_that_does_not_help(arrays) -> None:
    with pytest.raises(BrokenBodyError) as caught:
        repair_mesh(*arrays)
    assert not caught.value.advice
    assert "a repair mends it" not in str(caught.value)


def test_nothing_is_changed_without_being_asked() -> None:
    arrays = torn(shapes.icosphere(2), (1, 0, 0))
    with pytest.raises(MeshError, match="boundary edges"):
        repair_mesh(*arrays)
    whole = shapes.icosphere(1)
    asked = repair_mesh(*whole, repairs=Repairs(weld=1e-3, fill_holes=9))
    np.testing.assert_array_equal(asked.vertices, whole[0])
    np.testing.assert_array_equal(asked.faces, whole[1])


@pytest.mark.parametrize(
    "wrong",
    [{"weld": 0.0}, {"weld": -1.0}, {"weld": float("nan")}, {"weld": float("inf")}, {"fill_holes": 2}],
)
def test_values_without_a_meaning_are_refused(wrong) -> None:
    with pytest.raises(ShapeError):
        Repairs(**wrong)


def test_damaged_input_is_told_as_without_repairs() -> None:
    vertices, faces = shapes.octahedron()
    for bad in ((vertices, faces + 5), (vertices * np.nan, faces)):
        with pytest.raises(MeshError) as plain:
            repair_mesh(*bad)
        with pytest.raises(MeshError) as repaired:
            repair_mesh(*bad, repairs=Repairs(weld=1e-3, fill_holes=9))
        assert str(plain.value) == str(repaired.value)


def test_parts_that_overlap_are_united_on_request_alone() -> None:
    arrays = shapes.joined(shapes.cube(), shapes.moved(shapes.cube(), 0.5, 0.25, 0.125))
    with pytest.raises(BrokenBodyError, match=r"--unite") as caught:
        repair_mesh(*arrays)
    assert caught.value.advice == Repairs(unite=True)
    outcome = body(arrays).repaired(caught.value.advice)
    assert outcome.mesh.volume == pytest.approx(2.0 - 0.5 * 0.75 * 0.875, rel=1e-12)
    assert "2 parts become 1" in outcome.mesh.notes[0]
    kept = outcome.mesh.file_vertices >= 0
    np.testing.assert_allclose(
        outcome.mesh.vertices[outcome.mesh.file_vertices[kept]], arrays[0][kept], atol=1e-12
    )
    assert kept.sum() == 14, "one corner of each lies inside the other"


def test_parts_apart_and_voids_are_not_united() -> None:
    vertices, faces = shapes.cube()
    hollow = shapes.joined((vertices, faces), (0.25 + 0.5 * vertices, faces[:, ::-1]))
    for arrays in (hollow, shapes.two_components(), shapes.cube()):
        (record,) = body(arrays).repaired(Repairs(unite=True)).records
        assert record.count == 0
    assert body(hollow).repaired(Repairs(unite=True)).mesh.volume == pytest.approx(0.875)
