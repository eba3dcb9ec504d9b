"""A diagnosis names everything that is wrong, with counts and places that are right."""

from __future__ import annotations

import json

import numpy as np
import pytest
from tests.core import shapes

from idviewer.core.shapes.diagnosis import diagnose
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.validation.finding_kinds import KINDS
from idviewer.core.validation.findings import point_text


def kinds(diagnosis):
    return [finding.kind for finding in diagnosis.findings]


@pytest.mark.parametrize(
    ("arrays", "genus"),
    [(shapes.icosphere(1), 0), (shapes.l_shape(), 0), (shapes.torus(), 1)],
)
def test_a_faultless_mesh_has_sizes_and_no_findings(arrays, genus):
    diagnosis = diagnose(*arrays)
    assert diagnosis.findings == ()
    assert diagnosis.usable
    assert diagnosis.genus == genus
    assert diagnosis.euler_characteristic == 2 - 2 * genus
    assert diagnosis.components == (len(arrays[1]),)
    assert (diagnosis.vertices, diagnosis.faces) == (len(arrays[0]), len(arrays[1]))
    assert diagnosis.boundary_loops == 0
    mesh = Mesh(*arrays)
    assert (diagnosis.volume, diagnosis.area) == pytest.approx((mesh.volume, mesh.area), rel=1e-14)
    assert np.array_equal(diagnosis.bounds, mesh.bounds)


def test_a_mesh_can_be_diagnosed():
    assert diagnose(Mesh(*shapes.torus())) == diagnose(*shapes.torus())


def test_genus_adds_up_over_components_and_pinched_vertices():
    assert (
        diagnose(*shapes.joined(shapes.torus(), shapes.moved(shapes.torus(), 9, 0, 0), shapes.cube())).genus
        == 2
    )
    pinched = diagnose(*shapes.pinched_cubes())
    assert pinched.genus == 0
    assert kinds(pinched) == ["cut_vertices", "several_components"]
    assert pinched.findings[0].where == (1.0, 1.0, 1.0)
    assert pinched.findings[0].as_dict()["severity"] == "repaired"


def test_boundary_edges_are_counted_with_their_loops_and_a_place_on_them():
    vertices, faces = shapes.torus()
    # Two triangles that share an edge make a hole of four edges, a third elsewhere one of three.
    opened = np.delete(faces, [0, len(faces) // 2, 5], axis=0)
    diagnosis = diagnose(vertices, opened)
    (finding,) = diagnosis.findings
    assert finding.message.startswith("7 boundary edges in 2 loops, near (")
    assert (finding.count, diagnosis.boundary_loops) == (7, 2)
    assert finding.fatal
    assert finding.remedy
    assert np.any(np.all(vertices[faces[[0, len(faces) // 2, 5]]].reshape(-1, 3) == finding.where, axis=1))
    assert (diagnosis.genus, diagnosis.volume) == (None, None)


def test_several_things_are_found_behind_each_other():
    vertices, faces = shapes.soup(shapes.joined(shapes.moebius_band(), shapes.moved(shapes.cube(), 9, 0, 0)))
    faces = np.concatenate([faces, [[0, 0, 1]]])
    diagnosis = diagnose(np.concatenate([vertices, [[5, 5, 5]]]), faces)
    expected = ["isolated_vertices", "repeated_vertices", "duplicated_vertices", "several_components"]
    assert kinds(diagnosis) == [*expected, "boundary_edges", "not_orientable"]
    assert diagnosis.components == (12, 24)
    assert (diagnosis.input_vertices, diagnosis.input_faces) == (109, 37)
    assert (diagnosis.vertices, diagnosis.faces) == (32, 36)
    assert not diagnosis.usable


def test_components_are_named_by_size_the_largest_first():
    many = shapes.joined(
        *(shapes.moved(shapes.tetrahedron(), 3 * i, 0, 0) for i in range(1, 8)), shapes.cube()
    )
    (finding,) = diagnose(*many).findings
    assert finding.message == "8 components with 12, 4, 4, 4, 4, ... faces"
    assert "component=1 (the largest) to component=8" in finding.remedy


def test_non_manifold_edges_are_counted():
    with pytest.raises(MeshError) as caught:
        Mesh(*shapes.non_manifold_cubes())
    assert caught.value.findings[0].message == "1 edge with more than two faces, near (1, 1, 0)"
    # Where it can be told which faces bound the same solid, it is cut.
    assert kinds(diagnose(*shapes.non_manifold_cubes())) == ["cut_edges", "several_components"]


def test_klein_bottle_is_closed_but_has_no_inside():
    diagnosis = diagnose(*shapes.klein_bottle())
    assert kinds(diagnosis) == ["not_orientable"]
    assert (diagnosis.euler_characteristic, diagnosis.genus, diagnosis.boundary_loops) == (0, None, 0)


@pytest.mark.parametrize(
    "arrays",
    [
        ([], []),
        ([[0, 0, 0]], []),
        ([[0, 0, 0], [1, 0, 0]], [[0, 1]]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 7]]),
        ([[0, 0, 0], [1, 0, 0], [np.inf, 1, 0]], [[0, 1, 2]]),
        ([[1e308, 0, 0], [-1e308, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
        (np.zeros((3, 3)), [[0, 1, 2]]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 1]]),
        ([], [[0, 1, 2]]),
        ([], [[]]),
        shapes.two_components(),
        shapes.flat_sheet(),
        shapes.moebius_band(),
    ],
)
def test_rubbish_is_diagnosed_not_stumbled_over(arrays):
    diagnosis = diagnose(*arrays)
    assert not diagnosis.usable
    assert all("\n" not in finding.message for finding in diagnosis.findings)
    plain = json.loads(json.dumps(diagnosis.as_dict(), allow_nan=False))
    assert plain["usable"] is False
    assert {finding["kind"] for finding in plain["findings"]} <= set(KINDS)


def test_a_pillow_of_two_faces_has_no_volume():
    assert kinds(diagnose([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 1]])) == ["no_volume"]


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_verdicts_do_not_depend_on_size_and_place(scale, shift):
    for arrays in (
        shapes.cube(),
        shapes.opened(shapes.torus()),
        shapes.flat_sheet(),
        shapes.soup(shapes.cube()),
    ):
        moved = (arrays[0] + shift) * scale, arrays[1]
        assert kinds(diagnose(*moved)) == kinds(diagnose(*arrays))


def test_a_thin_plate_has_a_volume_and_a_sheet_has_none():
    vertices, faces = shapes.cube()
    assert diagnose(vertices * [1, 1, 1e-6], faces).usable
    assert kinds(diagnose(vertices * [1, 1, 0], faces)) != []
    assert not diagnose(vertices * [1, 1, 0], faces).usable


@pytest.mark.parametrize(
    ("point", "size", "text"),
    [
        ((0.1, 0.2, 0.3), 1.0, "(0.1, 0.2, 0.3)"),
        ((0.0, 0.0, 0.0), 1.0, "(0, 0, 0)"),
        ((1 / 3, 1e-17, -2 / 3), 1.0, "(0.3333, 0, -0.6667)"),
        ((1e6 + 1 / 3, 0.0, 1e6), 1.0, "(1000000.3333, 0, 1000000)"),
        ((1e-9, 0.0, 2.5e-10), 1e-9, "(1e-09, 0, 2.5e-10)"),
        ((1.0, 2.0, 3.0), 0.0, "(1, 2, 3)"),
    ],
)
def test_places_have_the_digits_that_the_mesh_needs(point, size, text):
    assert point_text(np.array(point), size) == text
