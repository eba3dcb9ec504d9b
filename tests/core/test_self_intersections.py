"""Faces that cross each other: found as exact arithmetic finds them, counted, located and told."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from tests.core import overlapping_bodies as bodies
from tests.core import shapes

from idviewer.core import Mesh, diagnose, read_mesh, repair_mesh, sample_path
from idviewer.core.validation.self_intersections import SelfIntersectionSettings, self_intersections_of

Exact = list[Fraction]


def exact(point: np.ndarray) -> Exact:
    return [Fraction(float(value)) for value in point]


def side(a: Exact, b: Exact, c: Exact, d: Exact) -> int:
    """On which side of the plane a, b, c the point d lies, without rounding."""
    u, v, w = ([x - y for x, y in zip(p, a, strict=True)] for p in (b, c, d))
    volume = (
        u[0] * (v[1] * w[2] - v[2] * w[1])
        - u[1] * (v[0] * w[2] - v[2] * w[0])
        + u[2] * (v[0] * w[1] - v[1] * w[0])
    )
    return (volume > 0) - (volume < 0)


def pierces(tail: Exact, head: Exact, face: list[Exact]) -> bool:
    """Whether an edge passes through the inside of a face."""
    if side(*face, tail) * side(*face, head) >= 0:
        return False
    turns = {side(tail, head, face[i], face[(i + 1) % 3]) for i in range(3)}
    return turns in ({1}, {-1})


def crossing_pairs(vertices: np.ndarray, faces: np.ndarray) -> list[list[int]]:
    """Pairs of faces of which an edge of one passes through the inside of the other: every pair is tried."""
    points = [exact(vertex) for vertex in vertices]
    low, high = vertices[faces].min(axis=1), vertices[faces].max(axis=1)
    meet = ((low[:, None] <= high) & (low <= high[:, None])).all(axis=2)
    found = []
    for first, second in np.argwhere(np.triu(meet, 1)).tolist():
        one, other = faces[first], faces[second]
        through = (
            pierces(points[a], points[b], [points[i] for i in face])
            for edges, face in ((one, other), (other, one))
            for a, b in zip(edges, np.roll(edges, -1), strict=True)
            if not {a, b} & set(face.tolist())
        )
        if any(through):
            found.append([first, second])
    return found


@pytest.mark.slow
@pytest.mark.parametrize("name", bodies.OVERLAPPING)
def test_the_pairs_are_those_of_exact_arithmetic(name: str, rng: np.random.Generator) -> None:
    vertices, faces = bodies.OVERLAPPING[name]
    # In general position: edges that meet within rounding only touch, or cross.
    vertices = vertices + 1e-3 * rng.standard_normal(vertices.shape)
    found = self_intersections_of(vertices, faces)
    assert found.pairs.tolist() == crossing_pairs(vertices, faces)
    assert len(found) > 3


def test_random_triangles(rng: np.random.Generator) -> None:
    vertices = rng.uniform(size=(90, 3))
    faces = np.arange(90).reshape(-1, 3)
    found = self_intersections_of(vertices, faces)
    assert found.pairs.tolist() == crossing_pairs(vertices, faces)
    assert len(found) > 20


@pytest.mark.parametrize("name", ["hand_2k"])
def test_a_clean_scan_has_none(name: str) -> None:
    assert not read_mesh(sample_path(name)).self_intersections


@pytest.mark.parametrize("make", [shapes.cube, shapes.l_shape, shapes.icosphere, shapes.torus])
def test_clean_solids_have_none(make) -> None:  # type: ignore[no-untyped-def]
    assert len(self_intersections_of(*make())) == 0


PLANE = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
FACE_PAIRS = {
    "across": ([[1, 1, -1], [1, 1, 1], [1.2, 1.5, 1]], True),
    "beside": ([[3, 3, -1], [3, 3, 1], [3, 4, 1]], False),
    "on top of each other": ([[1, 1, 0], [2, 1, 0], [1, 2, 0]], True),
    "side by side in a plane": ([[4, 4, 0], [4, 0.5, 0], [0.5, 4, 0]], False),
    "one corner on the other": ([[1, 1, 0], [1, 1, 1], [2, 1, 1]], False),
    "sharing a corner, apart": ([[0, 0, 0], [-1, 0, 1], [0, -1, 1]], False),
    "sharing a corner, across": ([[0, 0, 0], [2, 1, 1], [1, 2, -1]], True),
    "sharing a side, apart": ([[4, 0, 0], [0, 0, 0], [1, 1, 0.5]], False),
    "sharing a side, folded flat": ([[4, 0, 0], [0, 0, 0], [1, 2, 0]], True),
    "sharing a side, side by side": ([[4, 0, 0], [0, 0, 0], [1, -2, 0]], False),
    "the same face": (PLANE[::-1], True),
}


@pytest.mark.parametrize("name", FACE_PAIRS)
@pytest.mark.parametrize(("size", "away"), [(1.0, 0.0), (1e-9, 0.0), (1e40, 0.0), (1.0, 1e6)])
def test_two_faces_wherever_they_lie(name: str, size: float, away: float) -> None:
    other, overlap = FACE_PAIRS[name]
    turn = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
    vertices = size * np.array(PLANE + other, dtype=float) @ turn + away
    for faces in ([[0, 1, 2], [3, 4, 5]], [[4, 5, 3], [1, 2, 0]], [[0, 2, 1], [5, 3, 4]]):
        assert len(self_intersections_of(vertices, np.array(faces))) == overlap


def test_no_faces_at_all() -> None:
    assert not self_intersections_of(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64))


def test_places_lie_where_the_body_overlaps() -> None:
    found = Mesh(*bodies.crossing_arms()).self_intersections
    assert all(np.abs(np.array(place) - [0.0, 3.0, 0.0]).max() < 0.5 for place in found.places)
    assert found.place_count == len(found.places)
    twice = shapes.joined(bodies.crossing_arms(), shapes.moved(bodies.crossing_arms(), 50, 0, 0))
    assert self_intersections_of(*twice).place_count == 2 * found.place_count


def test_ends_that_touch_along_a_wall_lie_on_each_other() -> None:
    assert len(Mesh(*bodies.bent_tube(1.0)).self_intersections) > 0
    assert not Mesh(*bodies.bent_tube(0.99)).self_intersections


def test_a_search_that_would_take_too_long_says_so() -> None:
    found = self_intersections_of(*bodies.spindle_torus(), SelfIntersectionSettings(most_tests=200))
    whole = self_intersections_of(*bodies.spindle_torus())
    assert found
    assert not found.complete
    assert len(found) < len(whole)
    assert found.finding.message.startswith(f"at least {len(found)} pairs of faces")
    none = self_intersections_of(*bodies.bent_tube(0.9), SelfIntersectionSettings(most_tests=200))
    assert none
    assert len(none) == 0


def test_they_are_a_finding_and_a_note_and_the_mesh_can_be_used() -> None:
    vertices, faces = bodies.bent_tube(1.02)
    diagnosis = diagnose(vertices, faces)
    (finding,) = diagnosis.findings
    assert finding.kind == "self_intersections"
    assert finding.harmless
    assert diagnosis.usable
    assert repair_mesh(vertices, faces).notes == (finding.note,)
    told = diagnosis.as_dict()["self_intersections"]
    assert told["count"] == len(Mesh(vertices, faces).self_intersections)
    assert told["faces"] == np.unique(Mesh(vertices, faces).self_intersections.pairs).tolist()
    assert told["places"] == [list(finding.where or ())]
    assert diagnose(*shapes.cube()).as_dict()["self_intersections"]["count"] == 0
    assert diagnose(*shapes.two_components()).as_dict()["self_intersections"] is None
