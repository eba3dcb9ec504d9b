"""Polygons on the command line, in every verb."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.cli.commands import INSIDE, QUICK, Run, refused

from idviewer.core import Euclidean, InteriorDistance, read_shape


class TestPolygons:
    ENDS = ("--from", "0.5,0.5", "--to", "3.5,0.25")

    @pytest.fixture
    def corner(self, tmp_path: Path) -> str:
        path = tmp_path / "corner.csv"
        path.write_text("x,y\n0,0\n4,0\n4,1\n1,1\n1,3\n0,3\n")
        return str(path)

    def test_two_points(self, run: Run, corner: str) -> None:
        told = json.loads(run("distance", corner, *self.ENDS, *QUICK, "--json").out)
        assert told["interior"] == pytest.approx(math.dist((0.5, 0.5), (3.5, 0.25)), rel=1e-12)
        assert (told["from"], told["to"], told["coordinates"]) == ([0.5, 0.5], [3.5, 0.25], "mean_value")

    def test_many_points(self, run: Run, corner: str, table: Callable[[str], str]) -> None:
        points = table("x,y\n0.5,0.5\n0.5,2.5\n")
        out = run("distance", corner, "--source", "0.5,0.5", "--points", points, *QUICK).out
        rows = list(csv.reader(io.StringIO(out)))
        assert rows[0] == ["x", "y", "distance"]
        assert [float(row[2]) for row in rows[1:]] == pytest.approx([0.0, 2.0], abs=1e-12)

    @pytest.mark.slow
    def test_barycentroid(self, run: Run, corner: str) -> None:
        told = json.loads(run("barycentroid", corner, *QUICK, "--json").out)
        # Of the Euclidean distance it is the mean of the boundary: each side's middle by its length.
        sides = [(2, 0, 4), (4, 0.5, 1), (2.5, 1, 3), (1, 2, 2), (0.5, 3, 1), (0, 1.5, 3)]
        mean = np.average([side[:2] for side in sides], axis=0, weights=[side[2] for side in sides])
        distances = InteriorDistance(read_shape(corner), Euclidean()).potential([told["point"], mean])
        assert distances[0] <= distances[1] * (1 + 1e-9) or not np.isfinite(distances[1])

    @pytest.mark.parametrize(
        ("arguments", "part"),
        [
            (
                ("distance", "--from", "0.5,0.5,0", "--to", "1,1"),
                "--from 0.5,0.5,0: not a point of a 2D shape",
            ),
            (
                ("distance", "--from", "2,2", "--to", "0.5,0.5"),
                "--from: the point 2.0,2.0 lies outside the polygon",
            ),
            (("distance", "--from", "1", "--to", "1,1"), "--from 1: not a point; write two or three numbers"),
            (
                ("distance", "--source", "0.5,0.5", "--points", "p.csv"),
                "line 1: '0,0,0' has 3 columns, not two numbers x,y",
            ),
            (("render", "--plane", "x=0.5"), "--plane x=0.5: a polygon is shown whole; leave the plane out"),
            (("render", "--source", "2,2"), "the source (2, 2) lies outside the polygon"),
            (("render", "--source", "2,2,2"), "--source 2,2,2: not a point of a 2D shape; write two numbers"),
            (("render", "--component", "2"), "a polygon has no components"),
            (("barycentroid", "--distance", "matrix"), "it needs a .npy"),
        ],
    )
    def test_what_means_nothing_is_refused(
        self, run: Run, corner: str, arguments: tuple[str, ...], part: str
    ) -> None:
        Path("p.csv").write_text("0,0,0\n")
        verb, *more = arguments
        out = ["out.png"] if verb == "render" else []
        told = refused(run(verb, corner, *out, *more, *(() if "--distance" in more else QUICK)))
        assert part in told
        assert not Path("out.png").exists()

    def test_points_of_a_mesh_have_three_numbers(
        self, run: Run, body: str, table: Callable[[str], str]
    ) -> None:
        told = refused(run("distance", body, "--from", "0,0", "--to", INSIDE, *QUICK))
        assert "--from 0,0: not a point of a 3D shape; write three numbers" in told
        told = refused(run("distance", body, "--source", INSIDE, "--points", table("x,y\n0,0\n"), *QUICK))
        assert "line 2: '0,0' has 2 columns, not three numbers x,y,z" in told

    def test_info(self, run: Run, corner: str) -> None:
        answer = run("info", corner)
        assert (answer.status, answer.err) == (0, "")
        told = {line[2:18].strip(): line[18:] for line in answer.out.splitlines()[1:]}
        assert told == {
            "vertices": "6",
            "loops": "1 (no holes)",
            "bounding box": "(0, 0) to (4, 3)",
            "unit": "not told by the file",
            "area": "6",
            "perimeter": "14",
            "refinement": told["refinement"],
            "discretisation": told["discretisation"],
            "faults": "none",
            "usable": "yes",
        }
        told = json.loads(run("info", "plate", "--json").out)
        assert (told["usable"], len(told["loops"]), sum(told["loops"])) == (True, 4, told["vertices"])
        assert told["area"] > 0 < told["perimeter"]

    @pytest.mark.parametrize(
        ("name", "content", "part"),
        [
            ("bow.csv", "0,0\n1,1\n1,0\n0,1\n", "cross"),
            ("two.csv", "0,0\n1,1\n", ""),
            ("twice.json", "[[0, 0], [1, 0], [1, 0], [0, 1], [0, 0.5], [1, 0]]", ""),
            ("empty.csv", "", "empty"),
            ("text.csv", "hello\n", ""),
            ("nan.csv", "0,0\n1,nan\n1,1\n", ""),
            ("bytes.svg", "\x00\x01", "svg"),
            ("flat.csv", "0,0\n1,0\n2,0\n", ""),
            ("apart.csv", "0,0\n1,0\n0,1\n\n5,5\n6,5\n5,6\n", ""),
        ],
    )
    def test_what_is_no_polygon(self, run: Run, name: str, content: str, part: str) -> None:
        Path(name).write_text(content)
        told = refused(run("barycentroid", name))
        assert name in told
        assert part in told.lower()
        for json_too in ((), ("--json",)):
            answer = run("info", name, *json_too)
            assert (answer.status, answer.err) == (2, "")
            if json_too:
                about = json.loads(answer.out)
                assert not about["usable"]
                assert told == f"idviewer: {about['problem']}\n"
            else:
                assert "problem" in answer.out
                assert "usable          no" in answer.out

    @pytest.mark.slow
    @pytest.mark.parametrize("coordinates", ["mean_value", "shepard"])
    def test_a_picture(self, run: Run, corner: str, coordinates: str) -> None:
        options = ("--coordinates", coordinates, "--source", "0.5,0.5", "--size", "320x240")
        assert run("render", corner, "out.png", *options) == (0, "", "")
        with Image.open("out.png") as picture:
            assert len(picture.getcolors(1 << 16)) > 100
