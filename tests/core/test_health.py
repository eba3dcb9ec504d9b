"""Health: every fault with all its places, which lie on the body; the repairs that help."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes
from tests.core.test_named_repairs import body, torn

from idviewer.core.shapes import RawBody, examine
from idviewer.core.validation import PolygonSoup
from idviewer.core.validation.finding_kinds import COMPONENT_KINDS


def faults(arrays: shapes.Arrays) -> dict:
    return {fault.kind: fault for fault in examine(body(arrays)).faults}


def test_each_hole_is_a_place_with_all_its_edges() -> None:
    arrays = torn(shapes.icosphere(2), (1, 0, 0), (0, 1, 0), (0, -0.6, 0.8))
    health = examine(body(arrays))
    fault = health.faults[0]
    assert (fault.kind, fault.fatal, len(fault.places)) == ("boundary_edges", True, 3)
    assert "boundary edges in 3 loops" in fault.text
    sizes = sorted(len(place.segments) for place in fault.places)
    assert sizes[-1] == health.suggested.fill_holes
    directions = np.array([[1, 0, 0], [0, 1, 0], [0, -0.6, 0.8]])
    for place in fault.places:
        assert (directions @ place.centre).max() == pytest.approx(np.linalg.norm(place.centre), rel=0.02)
        distances = np.linalg.norm(place.segments.reshape(-1, 3) - place.centre, axis=1)
        assert distances.max() == place.radius
        # Each corner of a loop is the end of two edges.
        _, counts = np.unique(place.segments.reshape(-1, 3), axis=0, return_counts=True)
        assert (counts == 2).all()


def test_pieces_are_places_the_largest_first() -> None:
    found = faults(shapes.two_components())["several_components"]
    assert [len(place.triangles) for place in found.places] == [12, 8]
    assert found.kind in COMPONENT_KINDS


def test_an_edge_of_three_faces_is_a_place() -> None:
    vertices, faces = shapes.cube()
    fin = np.concatenate([vertices, [[0.5, -1.0, -1.0]]]), np.concatenate([faces, [[0, 1, 8]]])
    (place,) = faults(fin)["fins"].places
    np.testing.assert_array_equal(np.sort(place.segments[0], axis=0), [[0, 0, 0], [1, 0, 0]])


def test_a_mesh_without_faults_has_notes_alone() -> None:
    soup = PolygonSoup.of(*shapes.octahedron())
    health = examine(RawBody(soup, "egg", notes=("Two bytes were passed over.",)))
    assert [(fault.kind, fault.text) for fault in health.faults] == [("note", "Two bytes were passed over.")]
    assert not health.suggested
    assert health.outcome.usable
    assert len(health.faces) == 8


def test_what_makes_no_surface_has_faults_and_no_places() -> None:
    vertices, faces = shapes.octahedron()
    health = examine(body((vertices, faces + 3)))
    assert health.faults[0].kind == "index_out_of_range"
    assert health.faults[0].places == ()
    assert len(health.faces) == 0


def test_a_great_many_places_are_all_there_the_last_ones_in_one() -> None:
    arrays = shapes.soup(shapes.icosphere(2))
    apart = arrays[0] * (1.0 + np.arange(len(arrays[0]))[:, None] // 3)
    places = faults((apart, arrays[1]))["boundary_edges"].places
    assert [len(place.segments) for place in places] == [3] * 200 + [3 * 120]
