"""`--component`: one by its number, the largest, or all, each on its own."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.cli.commands import QUICK, Answer, Run, refused
from tests.core import shapes

from idviewer.cli.components import on_one_scale
from idviewer.core import Mesh


def write_off(path: Path, arrays: shapes.Arrays) -> str:
    vertices, faces = arrays
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(map(repr, row)) for row in vertices.tolist()]
    lines += ["3 " + " ".join(map(str, row)) for row in faces.tolist()]
    path.write_text("\n".join(lines))
    return str(path)


@pytest.fixture
def three(tmp_path: Path) -> str:
    """A cube of volume 8, a ball of many faces, and a small cube inside a void of the large one."""
    large = shapes.cube()[0] * 2.0, shapes.cube()[1]
    void = shapes.moved(shapes.cube(), 0.5, 0.5, 0.5)
    small = shapes.moved((shapes.cube()[0] * 0.5, shapes.cube()[1]), 0.75, 0.75, 0.75)
    ball = shapes.moved(shapes.icosphere(1), 5.0, 0.0, 0.0)
    return write_off(tmp_path / "three.off", shapes.joined(ball, small, void, large))


def told_last(answer: Answer) -> str:
    """The error, which follows the notes of the mesh."""
    assert answer.status == 2
    assert answer.out == ""
    return answer.err.splitlines()[-1]


def rows(text: str) -> list[list[str]]:
    return list(csv.reader(text.splitlines()))


class TestComponents:
    def test_info_lists_them(self, run: Run, three: str) -> None:
        told = run("info", three)
        assert told.status == 2
        assert "1: volume 7, 24 faces, 1 void" in told.out
        assert "3: volume 0.125, 12 faces" in told.out
        listed = json.loads(run("info", three, "--json").out)["component_list"]
        assert [(one["number"], one["faces"], one["voids"]) for one in listed] == [
            (1, 24, 1),
            (2, 80, 0),
            (3, 12, 0),
        ]
        assert listed[0]["volume"] == pytest.approx(7.0)

    @pytest.mark.slow
    def test_info_of_one_and_of_each(self, run: Run, three: str) -> None:
        assert json.loads(run("info", three, "--component", "3", "--json").out)["volume"] == pytest.approx(
            0.125
        )
        assert run("info", three, "--component", "largest").status == 0
        every = json.loads(run("info", three, "--component", "all", "--json").out)
        assert every["usable"]
        assert [one["faces"] for one in every["components"]] == [24, 80, 12]
        assert run("info", three, "--component", "all").out.count("usable          yes") == 3

    def test_the_largest_is_that_of_the_largest_volume(self, run: Run, three: str) -> None:
        ends = ("--from", "0.2,0.2,0.2", "--to", "1.8,1.8,0.2", *QUICK)
        values = [run("distance", three, *ends, "--component", name).out for name in ("1", "largest")]
        assert values[0] == values[1] != ""

    @pytest.mark.slow
    def test_barycentroids_of_all(self, run: Run, three: str) -> None:
        header, *found = rows(run("barycentroid", three, "--component", "all", *QUICK).out)
        assert header == ["component", "x", "y", "z", "potential"]
        assert [row[0] for row in found] == ["1", "2", "3"]
        np.testing.assert_allclose([float(x) for x in found[2][1:4]], [1.0, 1.0, 1.0], atol=0.02)
        one = json.loads(run("barycentroid", three, "--component", "2", *QUICK, "--json").out)
        every = json.loads(run("barycentroid", three, "--component", "all", *QUICK, "--json").out)[
            "components"
        ]
        assert every[1]["point"] == one["point"]
        assert every[1]["volume"] == pytest.approx(Mesh(*shapes.icosphere(1)).volume)

    @pytest.mark.slow
    def test_distances_within_all(self, run: Run, three: str, tmp_path: Path) -> None:
        pair = ("--from", "4.8,0,0", "--to", "5.3,0,0", *QUICK)
        found = rows(run("distance", three, *pair, "--component", "all").out)
        assert [row[1] for row in found[1:] if row[0] != "2"] == ["", ""]
        assert float(found[2][1]) == pytest.approx(0.5)
        apart = ("--from", "0.2,0.2,0.2", "--to", "5,0,0", *QUICK)
        assert "no component contains both" in told_last(run("distance", three, *apart, "--component", "all"))
        (tmp_path / "p.csv").write_text("x,y,z\n0.2,0.2,0.2\n5,0,0\n1,1,1\n9,9,9\n")
        many = ("--source", "barycentroid", "--points", str(tmp_path / "p.csv"), *QUICK)
        header, *found = rows(run("distance", three, *many, "--component", "all").out)
        assert header == ["x", "y", "z", "component", "distance"]
        assert [row[3] for row in found] == ["1", "2", "3", ""]
        assert found[3][4] == ""
        assert float(found[2][4]) == pytest.approx(0.0, abs=0.02)
        listed = json.loads(run("distance", three, *many, "--component", "all", "--json").out)
        assert [entry["interior"][3] for entry in listed["components"]] == [None] * 3

    @pytest.mark.slow
    def test_a_picture_of_all(self, run: Run, three: str, tmp_path: Path) -> None:
        size = ("--size", "300x200", "--plane", "z=0.6", *QUICK)
        one, every = str(tmp_path / "one.png"), str(tmp_path / "all.png")
        assert run("render", three, one, *size, "--component", "2").status == 0
        told = run("render", three, every, *size, "--component", "all", "--source", "5,0,0")
        assert told.status == 0
        assert "their own barycentroids" in told.err
        pixels = np.asarray(Image.open(every)).astype(int)[:, :225]  # without the scale bar
        coloured = np.ptp(pixels, axis=2) > 60
        columns = np.flatnonzero(coloured.any(axis=0))
        # The cube and the ball lie apart: two blocks of coloured columns.
        assert np.count_nonzero(np.diff(columns) > 10) >= 1
        assert "contains this point" in told_last(
            run("render", three, every, *size, "--component", "all", "--source", "9,9,9")
        )
        assert "misses all" in told_last(
            run("render", three, every, *QUICK, "--component", "all", "--plane", "0,0,99/0,0,1")
        )

    def test_a_word_that_is_none(self, run: Run, three: str) -> None:
        told = refused(run("barycentroid", three, "--component", "biggest"))
        assert "its number" in told
        assert "largest" in told

    def test_polygons_have_none(self, run: Run, tmp_path: Path) -> None:
        (tmp_path / "a.csv").write_text("0,0\n1,0\n0,1\n")
        for verb in (("info",), ("barycentroid",)):
            assert "no components" in refused(run(*verb, str(tmp_path / "a.csv"), "--component", "all"))


def test_one_frame_keeps_its_scale() -> None:
    assert on_one_scale(["frame"]) == ["frame"]  # type: ignore[list-item]


class TestParts:
    @pytest.mark.slow
    def test_all_labels_of_a_volume_each_on_its_own(self, run: Run, tmp_path: Path) -> None:
        voxels = np.zeros((9, 6, 6), np.uint8)
        voxels[1:4, 1:4, 1:4], voxels[5:8, 1:5, 1:5] = 3, 7
        path = tmp_path / "labels.npy"
        np.save(path, voxels)
        answer = run("barycentroid", str(path), "--label", "all", "--distance", "euclidean", "--no-cache")
        centres = [[float(cell) for cell in row[1:4]] for row in rows(answer.out)[1:]]
        np.testing.assert_allclose(centres, [[2.0, 2.0, 2.0], [6.0, 2.5, 2.5]], atol=0.02)
        assert "part 7 is component 2 of the result" in answer.err
        told = json.loads(run("info", str(path), "--label", "all", "--refine", "no", "--json").out)
        assert [one["name"] for one in told["components"]] == [f"{path}, part 3", f"{path}, part 7"]
        np.testing.assert_allclose([one["volume"] for one in told["components"]], [27.0, 48.0], rtol=0.01)
