"""Bodies united with themselves: what they covered, by winding numbers, without crossings."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.overlapping_bodies import OVERLAPPING
from tests.core.test_mean_value import winding_numbers

from idviewer.core import Mesh, MeshError, Repairs, repair_mesh, unite_mesh
from idviewer.core.shapes import RawBody

UNITED = [name for name in OVERLAPPING if name != "spindle torus"]


@pytest.mark.slow
@pytest.mark.parametrize("name", UNITED)
def test_the_union_is_what_the_surface_goes_round(name: str) -> None:
    mesh = Mesh(*OVERLAPPING[name])
    united = unite_mesh(mesh)
    assert not united.mesh.self_intersections
    points = np.random.default_rng(1).uniform(*mesh.bounds, size=(4000, 3))
    covered = winding_numbers(mesh, points) > 0.5
    assert np.mean(covered != (winding_numbers(united.mesh, points) > 0.5)) < 2e-3
    box = float(np.prod(np.ptp(mesh.bounds, axis=0)))
    spread = box * np.sqrt(covered.mean() * (1.0 - covered.mean()) / len(points))
    assert abs(united.mesh.volume - covered.mean() * box) < 4.0 * spread
    assert united.before.genus == 0
    assert united.before.self_intersections == len(mesh.self_intersections)
    assert united.after.volume == united.mesh.volume
    for name_of_size in ("vertices", "faces", "volume", "genus"):
        assert name_of_size in united.report
    assert united.as_dict()["after"]["faces"] == len(united.mesh.faces)


def test_a_bent_tube_becomes_a_ring() -> None:
    assert unite_mesh(OVERLAPPING["bent tube"]).after.genus == 1


def test_size_and_place_do_not_matter() -> None:
    vertices, faces = OVERLAPPING["bent tube"]
    for size, away in ((1e-9, 0.0), (1.0, 1e6)):
        united = unite_mesh((size * vertices + away, faces))
        assert united.mesh.volume / size**3 == pytest.approx(8.0592, rel=1e-4)


@pytest.mark.slow
def test_what_cannot_be_taken_apart_is_refused_in_one_line() -> None:
    with pytest.raises(MeshError, match=r"cannot be united .* near .*; mend it in a mesh editor") as caught:
        unite_mesh(OVERLAPPING["spindle torus"])
    assert "\n" not in str(caught.value)


@pytest.mark.slow
def test_a_repair_that_cannot_take_all_apart_says_so() -> None:
    outcome = RawBody.of(Mesh(*OVERLAPPING["spindle torus"])).repaired(Repairs(unite=True))
    left = len(outcome.mesh.self_intersections)
    (told,) = [record.sentence for record in outcome.records if record.name == "unite"]
    assert left > 0
    assert f"{left:,} pairs of faces cross each other still" in told


def test_notes_tell_of_crossing_faces_only_as_long_as_there_are_some() -> None:
    mesh = repair_mesh(*OVERLAPPING["bent tube"])
    assert any("cross each other" in note for note in mesh.notes)
    made = RawBody.of(mesh).repaired(Repairs(unite=True)).mesh
    for united in (unite_mesh(mesh).mesh, made):
        assert not any("cross each other" in note for note in united.notes)


def test_a_body_that_does_not_overlap_stays_as_it_is() -> None:
    mesh = unite_mesh(OVERLAPPING["bent tube"]).mesh
    assert unite_mesh(mesh).mesh is mesh
