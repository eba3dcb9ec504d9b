"""Meshes repaired by name on the command line: written, told of, and refused where they stay open."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
import trimesh
from tests.cli.commands import INSIDE, QUICK, Run, refused
from tests.core import meshfiles, shapes


@pytest.fixture
def gap(tmp_path: Path, rng: np.random.Generator) -> str:
    """A ball of facets whose corners differ."""
    vertices, faces = shapes.soup(shapes.icosphere(2))
    path = tmp_path / "gap.off"
    path.write_bytes(meshfiles.off(vertices + rng.uniform(-1e-5, 1e-5, vertices.shape), faces))
    return str(path)


@pytest.fixture
def torn(tmp_path: Path) -> str:
    """A ball with a hole of three edges and one of five or six."""
    vertices, faces = shapes.icosphere(2)
    hub = (faces == faces[0, 0]).any(axis=1)
    hub[-1] = True
    path = tmp_path / "torn.off"
    path.write_bytes(meshfiles.off(vertices, faces[~hub]))
    return str(path)


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["ply", "off", "obj", "stl"])
def test_what_is_written_is_watertight_for_another_library(run: Run, gap: str, suffix: str) -> None:
    answer = run("repair", gap, f"whole.{suffix}", "--weld", "1e-4")
    assert answer.status == 0
    assert "798 vertices merged" in answer.out
    theirs = trimesh.load_mesh(f"whole.{suffix}")
    assert theirs.is_watertight
    assert len(theirs.faces) == 320
    told = json.loads(run("info", f"whole.{suffix}", "--json").out)
    assert told["usable"]
    assert theirs.volume == pytest.approx(told["volume"], rel=1e-6)
    assert ("single precision" in answer.err) == (suffix == "stl")


def test_the_report_as_json(run: Run, gap: str) -> None:
    told = json.loads(run("repair", gap, "whole.ply", "--weld", "1e-4", "--json").out)
    (done,) = told["repairs"]
    assert (done["name"], done["value"], done["count"]) == ("weld", 1e-4, 798)
    assert 0.0 < told["moved"] < 1e-4
    assert (told["before"]["volume"], told["before"]["usable"]) == (None, False)
    assert told["before"]["boundary_loops"] == 320
    assert told["after"]["volume"] == pytest.approx(trimesh.load_mesh("whole.ply").volume)
    assert told["after"]["usable"]


def test_what_stays_open_is_one_line_and_nothing_is_written(run: Run, torn: str) -> None:
    line = refused(run("repair", torn, "whole.ply", "--fill-holes", "3"))
    assert "nothing is written" in line
    assert "boundary edges in 1 loop" in line
    assert not Path("whole.ply").exists()
    assert run("repair", torn, "whole.ply", "--fill-holes", "6").status == 0
    assert trimesh.load_mesh("whole.ply").is_watertight


def test_the_refusal_says_which_option_mends_it(run: Run, torn: str) -> None:
    line = refused(run("distance", torn, "--from", "0,0,0", "--to", "0.1,0,0", *QUICK))
    option = line[line.index("--fill-holes") :].split(",")[0].split()
    answer = run("distance", torn, "--from", "0,0,0", "--to", "0.1,0,0", *QUICK, *option)
    assert answer.status == 0
    assert "Fill holes" in answer.err
    assert "euclidean" in answer.out.lower()


def test_info_offers_the_repair_and_shows_what_it_makes(run: Run, gap: str) -> None:
    answer = run("info", gap)
    assert answer.status == 2
    assert f"idviewer repair {gap} OUT --weld 1e-4" in answer.out
    assert json.loads(run("info", gap, "--json").out)["advice"] == "--weld 1e-4"
    told = json.loads(run("info", gap, "--weld", "1e-4", "--json").out)
    assert (told["usable"], told["vertices"], told["advice"]) == (True, 162, "")


def test_the_input_is_not_overwritten_unasked(run: Run, torn: str) -> None:
    before = Path(torn).read_bytes()
    os.link(torn, "same.off")
    for name in (torn, "same.off"):
        assert "--overwrite" in refused(run("repair", torn, name, "--fill-holes", "6"))
    assert Path(torn).read_bytes() == before
    assert run("repair", torn, torn, "--fill-holes", "6", "--overwrite").status == 0
    assert trimesh.load_mesh(torn).is_watertight


def test_a_component_is_chosen_after_welding(run: Run, tmp_path: Path) -> None:
    both = shapes.joined(shapes.two_components(), shapes.moved(shapes.opened(shapes.octahedron()), 9, 0, 0))
    (tmp_path / "two.off").write_bytes(meshfiles.off(*both))
    assert "components" in refused(run("repair", "two.off", "one.off", "--fill-holes", "3"))
    assert run("repair", "two.off", "one.off", "--fill-holes", "3", "--component", "1").status == 0
    assert trimesh.load_mesh("one.off").volume == pytest.approx(4.0 / 3.0)


def test_walls_inside_are_left_out(run: Run, tmp_path: Path) -> None:
    two = shapes.joined(shapes.cube(), shapes.moved(shapes.cube(), 1, 0, 0))
    merged = trimesh.Trimesh(*two)  # merges vertices, and keeps both faces of the wall
    (tmp_path / "wall.off").write_bytes(meshfiles.off(merged.vertices, merged.faces))
    assert "--drop-walls" in refused(run("repair", "wall.off", "one.off"))
    answer = run("repair", "wall.off", "one.off", "--drop-walls")
    assert "Leave walls out: 2 faces inside the body" in answer.out
    assert trimesh.load_mesh("one.off").is_watertight
    assert trimesh.load_mesh("one.off").volume == pytest.approx(2.0)


def test_parts_that_overlap_are_united(run: Run, tmp_path: Path) -> None:
    two = shapes.joined(shapes.cube(), shapes.moved(shapes.cube(), 0.5, 0.25, 0.125))
    (tmp_path / "two.off").write_bytes(meshfiles.off(*two))
    assert "--unite" in refused(run("repair", "two.off", "one.off"))
    answer = run("repair", "two.off", "one.off", "--unite")
    assert "2 parts become 1" in answer.out
    assert trimesh.load_mesh("one.off").volume == pytest.approx(2.0 - 0.5 * 0.75 * 0.875)


@pytest.mark.parametrize(
    ("out", "words"),
    [("whole.glb", ".ply, .off, .obj, .stl"), ("nowhere/whole.ply", "no folder"), ("folder.ply", "a folder")],
)
def test_outputs_that_cannot_be_written(run: Run, torn: str, out: str, words: str) -> None:
    Path("folder.ply").mkdir()
    assert words in refused(run("repair", torn, out))


@pytest.mark.parametrize("option", ["--weld -1", "--weld nan", "--weld x", "--fill-holes 2"])
def test_values_without_a_meaning(run: Run, torn: str, option: str) -> None:
    refused(run("repair", torn, "whole.ply", *option.split()))
    refused(run("info", torn, *option.split()))


def test_polygons_are_not_repaired_so(run: Run) -> None:
    refused(run("repair", "star", "whole.ply", "--fill-holes", "3"))
    assert "only meshes" in refused(
        run("distance", "star", "--from", "0,0", "--to", "0.1,0", *QUICK, "--weld", "1e-3")
    )


def test_a_faultless_mesh_is_written_as_it_is(run: Run, body: str) -> None:
    answer = run("repair", body, "same.ply")
    assert "Nothing was wrong with it." in answer.out
    theirs, ours = trimesh.load_mesh(body, process=False), trimesh.load_mesh("same.ply", process=False)
    np.testing.assert_array_equal(theirs.vertices, ours.vertices)
    pair = ("--from", INSIDE, "--to", "0,0,1", *QUICK)
    assert run("distance", body, *pair).out == run("distance", "same.ply", *pair).out
