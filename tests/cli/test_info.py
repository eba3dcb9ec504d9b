"""What is told of a mesh, usable or not."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from tests.cli.commands import Run, refused


class TestInfo:
    @pytest.mark.slow
    def test_a_good_mesh(self, run: Run, body: str) -> None:
        answer = run("info", body)
        assert (answer.status, answer.err) == (0, "")
        assert "662" in answer.out
        assert "usable          yes" in answer.out

    @pytest.mark.slow
    def test_a_good_mesh_as_json(self, run: Run, body: str) -> None:
        told = json.loads(run("info", body, "--json").out)
        assert (told["usable"], told["vertices"], told["genus"], told["findings"]) == (True, 662, 0, [])

    @pytest.mark.slow
    def test_wide_angles_and_what_is_done_about_them_are_told(self, run: Run, tmp_path: Path) -> None:
        shape = trimesh.creation.icosphere(subdivisions=3)
        shape.apply_scale([1, 1, 6])
        shape.export(tmp_path / "stretched.off")
        (finding,) = json.loads(run("info", "stretched.off", "--json").out)["findings"]
        assert (finding["kind"], finding["severity"]) == ("uneven_triangles", "kept")
        answer = run("barycentroid", "stretched.off")
        assert answer.status == 0
        assert "were bridged by an intrinsic Delaunay triangulation" in answer.err

    @pytest.fixture
    def open_box(self, tmp_path: Path) -> str:
        box = trimesh.creation.box()
        box.update_faces([True] * 10 + [False] * 2)
        box.export(tmp_path / "open.off")
        return str(tmp_path / "open.off")

    def test_an_unusable_mesh_is_reported_all_the_same(self, run: Run, open_box: str) -> None:
        answer = run("info", open_box)
        assert (answer.status, answer.err) == (2, "")
        assert "4 boundary edges in 1 loop, near" in answer.out
        assert "usable          no" in answer.out

    def test_an_unusable_mesh_as_json(self, run: Run, open_box: str) -> None:
        answer = run("info", open_box, "--json")
        assert answer.status == 2
        assert json.loads(answer.out)["findings"][0]["severity"] == "fatal"

    def test_the_other_verbs_refuse_it(self, run: Run, open_box: str) -> None:
        told = refused(run("barycentroid", open_box))
        assert "open.off: 4 boundary edges in 1 loop, near" in told

    @pytest.mark.slow
    def test_repairs_are_told(self, run: Run, body: str, tmp_path: Path) -> None:
        lines = Path(body).read_text().splitlines()
        vertices, faces, edges = map(int, lines[1].split())
        lines[1] = f"{vertices + 1} {faces} {edges}"
        lines.insert(2 + vertices, "7 7 7")
        (tmp_path / "loose.off").write_text("\n".join(lines))
        assert "1 isolated vertex" in run("info", "loose.off").out
        answer = run("barycentroid", "loose.off", "--distance", "euclidean")
        assert answer.status == 0
        assert answer.err == "idviewer: loose.off: 1 isolated vertex was dropped.\n"

    def test_a_file_without_numbers(self, run: Run, tmp_path: Path) -> None:
        (tmp_path / "nan.off").write_text(
            "OFF\n4 4 0\nnan 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
        )
        answer = run("info", "nan.off", "--json")
        assert answer.status == 2
        assert "NaN" not in answer.out
        assert not json.loads(answer.out)["usable"]


def test_all_shapes_of_a_file_are_listed(run: Run, tmp_path: Path) -> None:
    voxels = np.zeros((24, 3, 3), np.uint8)
    for label in range(1, 11):
        voxels[2 * label : 2 * label + 2] = label
    np.save(tmp_path / "ten.npy", voxels)
    (tmp_path / "two.wkt").write_text("POLYGON ((0 0, 1 0, 0 1, 0 0))\nPOLYGON ((0 0, 3 0, 0 2, 0 0))\n")
    answer = run("info", "ten.npy")
    assert answer.status == 2
    assert [line.split()[1:] for line in answer.out.splitlines() if line.startswith("  shape")] == [
        [str(label), "18", "voxels"] for label in range(1, 11)
    ]
    told = json.loads(run("info", "two.wkt", "--json").out)
    assert told["shapes"] == [{"name": "1", "description": "1 x 1"}, {"name": "2", "description": "3 x 2"}]
    assert not told["usable"]
    assert run("info", "ten.npy", "--label", "3").status == 0
