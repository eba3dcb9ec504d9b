"""Meshes named on the command line: files, bundled shapes, components, and what is none."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh
from tests.cli.commands import INSIDE, QUICK, Run, refused

from idviewer.core import sample_names


class TestMeshes:
    @pytest.mark.parametrize("verb", ["info", "barycentroid", "distance", "render", "window"])
    def test_no_such_mesh(self, run: Run, verb: str) -> None:
        more = {"distance": ("--from", INSIDE, "--to", INSIDE), "render": ("out.png",)}.get(verb, ())
        told = refused(run(*([] if verb == "window" else [verb]), "nowhere.ply", *more))
        assert "nowhere.ply: neither a file nor a bundled shape" in told

    @pytest.mark.parametrize(
        ("name", "content"),
        [
            ("empty.ply", b""),
            ("text.obj", b"hello\n"),
            ("cut.stl", b"solid\nfacet normal 0 0"),
            ("odd.xyz", b"1 2 3\n"),
            ("bytes.ply", bytes(range(256))),
        ],
    )
    def test_files_that_hold_no_mesh(self, run: Run, tmp_path: Path, name: str, content: bytes) -> None:
        (tmp_path / name).write_bytes(content)
        assert name in refused(run("barycentroid", name))

    def test_a_folder(self, run: Run, tmp_path: Path) -> None:
        (tmp_path / "shapes").mkdir()
        assert "folder" in refused(run("info", "shapes"))

    def test_a_near_miss(self, run: Run) -> None:
        name = sample_names()[0]
        assert f"did you mean {name}?" in refused(run("info", name + "x"))

    @pytest.mark.slow
    def test_bundled_shapes_by_name(self, run: Run) -> None:
        names = [line.split()[0] for line in run("samples").out.splitlines()]
        assert names == list(sample_names())
        assert run("info", names[0]).status == 0

    def test_a_file_wins_over_a_bundled_shape(self, run: Run, tmp_path: Path) -> None:
        (tmp_path / sample_names()[0]).write_text("not a mesh")
        assert refused(run("info", sample_names()[0]))


class TestComponents:
    @pytest.fixture
    def two(self, body: str, tmp_path: Path) -> str:
        one = trimesh.load(body)
        other = trimesh.creation.box(extents=(0.5, 0.5, 0.5))
        other.apply_translation((5, 0, 0))
        trimesh.util.concatenate([one, other]).export(tmp_path / "two.off")
        return str(tmp_path / "two.off")

    def test_several_are_refused_and_one_can_be_chosen(self, run: Run, two: str) -> None:
        ends = ("--from", INSIDE, "--to", "0.5,0,1", *QUICK)
        assert "component" in refused(run("distance", two, *ends))
        assert run("distance", two, *ends, "--component", "1").status == 0
        assert "component" in refused(run("distance", two, *ends, "--component", "3"))
