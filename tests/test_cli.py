"""The command line: every verb, every refusal, and what a shell may do to it."""

from __future__ import annotations

import csv
import io
import json
import math
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple, get_args, get_type_hints

import numpy as np
import pytest
import trimesh
from PIL import Image

import idviewer
from idviewer.cli import main, output, parsing
from idviewer.cli.options import DisplayOptions
from idviewer.core import (
    COORDINATES,
    DISTANCES,
    Euclidean,
    InteriorDistance,
    interior_distance,
    parameters_of,
    read_mesh,
    read_shape,
    sample_names,
)
from idviewer.core.coordinates.maximum_entropy import MaximumEntropyCoordinates, MaximumEntropySettings
from idviewer.session import array_cache, spectrum_cache
from idviewer.session import eigenpair_source as eigenpairs

INSIDE, OUTSIDE = "-0.3,0.1,0.2", "0.3,4,0.2"
QUICK = ("--distance", "euclidean")
"""Needs no eigenpairs; for tests to which the kind of distance does not matter."""


class Answer(NamedTuple):
    status: int
    out: str
    err: str


Run = Callable[..., Answer]


@pytest.fixture
def run(capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Runs a command line in this process, in a folder of its own."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> Answer:
        status = main(arguments)
        return Answer(status, *capfd.readouterr())

    return run


@pytest.fixture(scope="session")
def body(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A spindle, long enough to need few modes."""
    angles = np.linspace(np.pi, 0.0, 35)
    outline = np.column_stack([np.sin(angles).clip(0.0), 6.0 * np.cos(angles)])
    outline[[0, -1], 0] = 0.0
    shape = trimesh.creation.revolve(outline, sections=20)
    path = tmp_path_factory.mktemp("bodies") / "spindle.off"
    shape.export(path)
    return str(path)


@pytest.fixture
def table(tmp_path: Path) -> Callable[[str], str]:
    def write(text: str) -> str:
        path = tmp_path / "points.csv"
        path.write_text(text)
        return str(path)

    return write


def refused(answer: Answer) -> str:
    """The one line of an error."""
    assert answer.status == 2
    assert answer.out == ""
    assert answer.err.startswith("idviewer: ")
    assert answer.err.count("\n") == 1
    return answer.err


class TestDistance:
    @pytest.mark.slow
    def test_two_points(self, run: Run, body: str) -> None:
        answer = run("distance", body, "--from", INSIDE, "--to", "0.5,0,1")
        assert answer.status == 0
        interior, euclidean = (float(line.split()[1]) for line in answer.out.splitlines())
        assert 0 < interior < 1
        assert euclidean == pytest.approx(math.dist((-0.3, 0.1, 0.2), (0.5, 0, 1)))

    def test_json_holds_the_same(self, run: Run, body: str) -> None:
        ends = ("--from", INSIDE, "--to", "0.5,0,1", *QUICK)
        in_words = run("distance", body, *ends).out.split()
        told = json.loads(run("distance", body, *ends, "--json").out)
        assert told["interior"] == float(in_words[1])
        assert told["from"] == [-0.3, 0.1, 0.2]
        assert told["distance"] == "euclidean"

    def test_euclidean_reproduces_straight_lines(self, run: Run, body: str) -> None:
        ends = ("--from", INSIDE, "--to", "0.5,0,1")
        told = json.loads(run("distance", body, *ends, "--distance", "euclidean", "--json").out)
        assert told["interior"] == pytest.approx(told["euclidean"], rel=1e-12)

    @pytest.mark.one_is_quick
    @pytest.mark.parametrize("header", ["", "x,y,z\n", "\ufeffX, y, z\r\n"])
    def test_many_points(self, run: Run, body: str, table: Callable[[str], str], header: str) -> None:
        points = table(header + "0.1,0.2,0.3\n\n-0.3,0.1,2.5\n")
        answer = run("distance", body, "--source", INSIDE, "--points", points, *QUICK)
        rows = list(csv.reader(io.StringIO(answer.out)))
        assert rows[: bool(header)] == [["x", "y", "z", "distance"]][: bool(header)]
        numbers = [tuple(map(float, row)) for row in rows[bool(header) :]]
        assert [row[:3] for row in numbers] == [(0.1, 0.2, 0.3), (-0.3, 0.1, 2.5)]
        pair = json.loads(
            run("distance", body, "--from", INSIDE, "--to", "0.1,0.2,0.3", "--json", *QUICK).out
        )
        assert numbers[0][3] == pytest.approx(pair["interior"], rel=1e-9)

    @pytest.mark.slow
    def test_many_points_from_the_barycentroid_as_json(
        self, run: Run, body: str, table: Callable[[str], str]
    ) -> None:
        points = table("0,0,0\n0,0,3\n")
        told = json.loads(run("distance", body, "--source", "barycentroid", "--points", points, "--json").out)
        assert told["source"] == pytest.approx([0, 0, 0], abs=0.05)
        assert told["interior"][0] < told["interior"][1]
        assert told["points"] == [[0, 0, 0], [0, 0, 3]]

    @pytest.mark.parametrize("end", ["--from", "--to"])
    def test_a_point_outside_is_named(self, run: Run, body: str, end: str) -> None:
        other = {"--from": "--to", "--to": "--from"}[end]
        told = refused(run("distance", body, end, OUTSIDE, other, INSIDE, *QUICK))
        assert f"{end}: the point 0.3,4.0,0.2 lies outside" in told
        assert "(-1, -1, -6) to (1, 1, 6)" in told

    def test_a_point_outside_is_named_by_its_line(
        self, run: Run, body: str, table: Callable[[str], str]
    ) -> None:
        points = table("x,y,z\n0,0,0\n\n9,9,9\n8,8,8\n")
        told = refused(run("distance", body, "--source", INSIDE, "--points", points, *QUICK))
        assert "points.csv, line 4: the point 9.0,9.0,9.0 lies outside the mesh (and 1 more)" in told

    @pytest.mark.parametrize(
        ("text", "part"),
        [
            ("", "there are no points in it"),
            ("x,y,z\n", "there are no points in it"),
            ("0,0,0\n1,2\n", "line 2: '1,2' is not three numbers"),
            ("0,0,0\n1,2,nan\n", "line 2: '1,2,nan' is not three numbers"),
            ("a,b,c\n1,2,3\n", "line 1: 'a,b,c' is not three numbers"),
        ],
    )
    def test_tables_that_are_none(
        self, run: Run, body: str, table: Callable[[str], str], text: str, part: str
    ) -> None:
        assert part in refused(run("distance", body, "--source", INSIDE, "--points", table(text)))

    def test_a_table_of_bytes(self, run: Run, body: str, tmp_path: Path) -> None:
        path = tmp_path / "points.csv"
        path.write_bytes(bytes(range(256)))
        assert "not a CSV file" in refused(run("distance", body, "--source", INSIDE, "--points", str(path)))

    def test_a_table_that_is_not_there(self, run: Run, body: str) -> None:
        told = refused(run("distance", body, "--source", INSIDE, "--points", "nowhere.csv"))
        assert told == "idviewer: nowhere.csv: No such file or directory\n"

    @pytest.mark.parametrize(
        "ends",
        [
            (),
            ("--from", INSIDE),
            ("--source", INSIDE),
            ("--from", INSIDE, "--points", "p.csv"),
            ("--from", INSIDE, "--to", INSIDE, "--source", INSIDE),
        ],
    )
    def test_half_a_question(self, run: Run, body: str, ends: tuple[str, ...]) -> None:
        assert "distance needs --from X,Y,Z and --to X,Y,Z, or" in refused(run("distance", body, *ends))


class TestKindsOfDistance:
    @pytest.mark.one_is_quick
    @pytest.mark.parametrize("verb", ["render", "distance", "barycentroid"])
    def test_all_are_in_the_help(self, run: Run, verb: str) -> None:
        told = " ".join(run(verb, "--help").out.split())
        for name in DISTANCES:
            assert name in told
        assert "--time" in told

    @pytest.mark.slow
    @pytest.mark.parametrize("name", ["gps", "biharmonic"])
    def test_the_same_as_in_the_library(self, run: Run, body: str, name: str) -> None:
        ends = ("--from", INSIDE, "--to", "0.5,0,1", "--distance", name, "--json")
        told = json.loads(run("distance", body, *ends).out)
        expected = interior_distance(read_mesh(body), [told["from"]], [told["to"]], DISTANCES[name]())
        assert told["interior"] == pytest.approx(float(expected[0]), rel=1e-9)
        assert told["distance"] == name
        assert "time" not in told

    @pytest.mark.slow
    def test_a_time(self, run: Run, body: str) -> None:
        ends = ("--from", INSIDE, "--to", "0.5,0,1", "--json")
        default = json.loads(run("distance", body, *ends).out)
        same = json.loads(run("distance", body, *ends, "--time", repr(default["time"])).out)
        longer = json.loads(run("distance", body, *ends, "--time", repr(4 * default["time"])).out)
        assert same == default
        assert longer["time"] == 4 * default["time"]
        assert longer["interior"] < default["interior"], "heat that flows longer brings points nearer"

    @pytest.mark.slow
    def test_a_time_in_words_and_in_a_barycentroid(self, run: Run, body: str) -> None:
        answer = run("distance", body, "--from", INSIDE, "--to", "0.5,0,1", "--time", "0.5")
        assert "(Diffusion distance, t = 0.5)" in answer.out
        assert json.loads(run("barycentroid", body, "--json", "--time", "0.5").out)["time"] == 0.5

    @pytest.mark.one_is_quick
    @pytest.mark.parametrize(
        ("options", "part"),
        [
            (("--time", "0"), "--time 0: the diffusion time must be a positive number, not 0.0"),
            (("--time", "-0.5"), "--time -0.5: the diffusion time must be a positive number"),
            (("--time", "nan"), "--time nan: the diffusion time must be a positive number"),
            (("--time", "soon"), "--time"),
            (("--time", "1", "--distance", "gps"), "--time 1: gps has no time"),
        ],
    )
    @pytest.mark.parametrize("verb", ["render", "distance", "barycentroid"])
    def test_times_that_mean_nothing(
        self, run: Run, body: str, verb: str, options: tuple[str, ...], part: str
    ) -> None:
        more = {"distance": ("--from", INSIDE, "--to", INSIDE), "render": ("out.png",)}.get(verb, ())
        assert part in refused(run(verb, body, *more, *options))


class TestParameters:
    ENDS = ("--from", INSIDE, "--to", "0.5,0,1")

    @pytest.fixture
    def arrays(self, body: str, tmp_path: Path) -> Path:
        """A folder with the body's vertices, and their straight distances."""
        folder = tmp_path
        vertices = read_mesh(body).vertices
        np.save(folder / "e.npy", vertices)
        np.save(folder / "d.npy", np.linalg.norm(vertices[:, None] - vertices, axis=2))
        np.save(folder / "small.npy", np.zeros((3, 3)))
        return folder

    @pytest.mark.parametrize("verb", ["render", "distance", "barycentroid"])
    def test_the_help_has_every_parameter(self, run: Run, verb: str) -> None:
        told = " ".join(run(verb, "--help").out.split())
        for kind in DISTANCES.values():
            assert kind.title in told
            for name in parameters_of(kind):
                assert f" {name}: " in told

    @pytest.mark.slow
    def test_given_distances_and_embeddings(self, run: Run, body: str, arrays: Path) -> None:
        for name, file in (("matrix", "d.npy"), ("embedding", "e.npy")):
            given = ("--distance", name, "--set", f"{name}={arrays / file}")
            told = json.loads(run("distance", body, *self.ENDS, *given, "--json").out)
            assert told["interior"] == pytest.approx(told["euclidean"], rel=1e-6)
            assert told[name] == str(arrays / file)

    @pytest.mark.slow
    def test_parameters_of_every_kind(self, run: Run, body: str) -> None:
        for options, part in (
            (
                ("--distance", "geodesic", "--set", "landmarks=20", "--set", "method=exact"),
                "(Geodesic distance; 20 l",
            ),
            (("--distance", "filter", "--set", "filter=1 / lambda"), "(Spectral filter 1 / lambda, "),
            (("--distance", "commute"), "(Commute-time distance)"),
            (("--set", "time=0.5"), "(Diffusion distance, t = 0.5)"),
        ):
            answer = run("distance", body, *self.ENDS, *options)
            assert answer.status == 0
            assert part in answer.out

    def test_many_points_by_sparse_solves(self, run: Run, body: str, table: Callable[[str], str]) -> None:
        points = table("0,0,0\n0.5,0,1\n")
        told = json.loads(
            run(
                "distance", body, "--source", INSIDE, "--points", points, "--distance", "commute", "--json"
            ).out
        )
        pair = json.loads(run("distance", body, *self.ENDS, "--distance", "commute", "--json").out)
        assert told["interior"][1] == pytest.approx(pair["interior"], rel=1e-9)

    @pytest.mark.one_is_quick
    @pytest.mark.parametrize(
        ("options", "part"),
        [
            (("--distance", "matrix"), "--distance matrix: it needs a .npy file with n x n distances"),
            (("--distance", "embedding", "--set", "embedding=no.npy"), "there is no file no.npy"),
            (
                ("--distance", "geodesic", "--set", "landmarks=3"),
                "--set landmarks=3: the geodesic landmarks must be a whole number from 4 to 2000, not 3",
            ),
            (("--distance", "geodesic", "--set", "landmarks=x"), "'x' is not a whole number"),
            (
                ("--distance", "geodesic", "--set", "method=magic"),
                "--set method=magic: the geodesic method must be heat or exact, not 'magic'",
            ),
            (("--distance", "filter", "--set", "filter=1/(os)"), '"os" at character 4 is no part of an'),
            (("--distance", "filter", "--set", "filter=-lambda"), "the filter -lambda: is -"),
            (("--distance", "gps", "--set", "colour=1"), "gps has no colour; its parameters: none"),
            (("--distance", "gps", "--set", "landmarks=9"), "or take --distance geodesic"),
            (("--set", "time"), "--set time: write NAME=VALUE"),
            (("--set", "time=soon"), "--set time=soon: 'soon' is not a number"),
            (("--set", "time=-1"), "--set time=-1: the diffusion time must be a positive number"),
        ],
    )
    def test_what_means_nothing_is_refused(
        self, run: Run, body: str, options: tuple[str, ...], part: str
    ) -> None:
        assert part in refused(run("distance", body, *self.ENDS, *options))

    def test_a_method_whose_package_is_missing_names_the_extra(
        self, run: Run, body: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        for module in ("pygeodesic", "pygeodesic.geodesic"):
            monkeypatch.setitem(sys.modules, module, None)
        remedy = "pip install 'idviewer[exact-geodesics]'"
        options = ("--distance", "geodesic", "--set", "method=exact")
        assert remedy in refused(run("distance", body, *self.ENDS, *options))
        assert remedy in " ".join(run("distance", "--help").out.split())

    def test_bad_matrices_are_refused(self, run: Run, body: str, arrays: Path) -> None:
        for verb, more in (("distance", self.ENDS), ("barycentroid", ())):
            given = ("--distance", "matrix", "--set", f"matrix={arrays / 'small.npy'}")
            assert "small.npy: its shape is (3, 3)" in refused(run(verb, body, *more, *given))


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
                "line 1: '0,0,0' is not two numbers x,y",
            ),
            (("render", "--plane", "x=0.5"), "--plane x=0.5: a polygon is shown whole; leave the plane out"),
            (("render", "--source", "2,2"), "the source (2, 2) lies outside the polygon"),
            (("render", "--source", "2,2,2"), "--source 2,2,2: not a point of a 2D shape; write two numbers"),
            (("render", "--component", "2"), "a polygon has no components"),
            (("barycentroid", "--distance", "matrix"), "it needs a .npy file"),
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
        assert "line 1: 'x,y' is not three numbers x,y,z" in told

    def test_info(self, run: Run, corner: str) -> None:
        answer = run("info", corner)
        assert (answer.status, answer.err) == (0, "")
        told = {line[2:18].strip(): line[18:] for line in answer.out.splitlines()[1:]}
        assert told == {
            "vertices": "6",
            "loops": "1 (no holes)",
            "bounding box": "(0, 0) to (4, 3)",
            "area": "6",
            "perimeter": "14",
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


class TestCoordinates:
    ENDS = ("--from", INSIDE, "--to", "0.5,0,1", "--distance", "gps")

    @pytest.mark.parametrize("verb", ["render", "distance", "barycentroid"])
    def test_all_are_in_the_help(self, run: Run, verb: str) -> None:
        told = " ".join(run(verb, "--help").out.split())
        for name, kind in COORDINATES.items():
            assert f" {name} {kind.title}" in told

    @pytest.mark.slow
    def test_the_same_as_in_the_library(self, run: Run, body: str) -> None:
        values = set()
        for name in COORDINATES:
            told = json.loads(run("distance", body, *self.ENDS, "--coordinates", name, "--json").out)
            solver = InteriorDistance(read_mesh(body), DISTANCES["gps"](), name)
            expected = float(solver.distance([told["from"]], [told["to"]])[0])
            assert told["interior"] == pytest.approx(expected, rel=1e-9)
            assert told["coordinates"] == name
            values.add(told["interior"])
        assert len(values) == len(COORDINATES)

    @pytest.mark.parametrize("verb", ["render", "distance", "barycentroid"])
    def test_unknown_ones_are_refused(self, run: Run, verb: str) -> None:
        more = {"distance": ("--from", INSIDE, "--to", INSIDE), "render": ("out.png",)}.get(verb, ())
        # Before the shape is even looked for.
        told = refused(run(verb, "no-such-shape", *more, "--coordinates", "wachspress"))
        assert "--coordinates wachspress: there are no such coordinates; there are: mean_value, " in told

    @pytest.mark.slow
    def test_points_without_weights_are_told_in_one_line(
        self, run: Run, body: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(
            MaximumEntropyCoordinates, "settings", MaximumEntropySettings(largest_residual=-1.0)
        )
        answer = run("distance", body, *self.ENDS, "--coordinates", "maximum_entropy", "--json")
        assert answer.status == 0
        assert json.loads(answer.out)["interior"] is None
        assert answer.err == (
            "idviewer: Maximum entropy coordinates were not found at 2 of the points tried; "
            "they have no value\n"
        )


class TestBarycentroid:
    @pytest.mark.slow
    def test_in_words(self, run: Run, body: str) -> None:
        answer = run("barycentroid", body)
        place, potential = (line.split()[1] for line in answer.out.splitlines())
        assert parsing.point_of(place, "--source") == pytest.approx((0, 0, 0), abs=0.05)
        assert 0 < float(potential) < 1

    @pytest.mark.slow
    def test_as_json(self, run: Run, body: str) -> None:
        told = json.loads(run("barycentroid", body, "--json", "--distance", "euclidean").out)
        assert told["distance"] == "euclidean"
        assert told["point"] == pytest.approx([0, 0, 0], abs=1e-6)


class TestInfo:
    def test_a_good_mesh(self, run: Run, body: str) -> None:
        answer = run("info", body)
        assert (answer.status, answer.err) == (0, "")
        assert "662" in answer.out
        assert "usable          yes" in answer.out

    def test_a_good_mesh_as_json(self, run: Run, body: str) -> None:
        told = json.loads(run("info", body, "--json").out)
        assert (told["usable"], told["vertices"], told["genus"], told["findings"]) == (True, 662, 0, [])

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


class TestRender:
    @pytest.mark.slow
    def test_the_default_picture(self, run: Run, body: str) -> None:
        answer = run("render", body, "out.png", "--size", "320x200")
        assert answer == (0, "", "")
        with Image.open("out.png") as picture:
            assert (picture.size, picture.mode) == ((320, 200), "RGB")
            assert len(picture.getcolors(1 << 16)) > 100
        assert [path.name for path in Path.cwd().iterdir()] == ["out.png"]

    @pytest.mark.slow
    def test_every_option(self, run: Run, body: str) -> None:
        asked = "--source -0.3,0.1,0.2 --plane x=0.4 --plane -0.1,0,0/0,-1,1 --quantity potential"
        asked += " --distance euclidean"
        looks = "--isolines 5 --colormap even --opacity 0.1 --size 200x150 --transparent"
        assert run("render", body, "out.PNG", *asked.split(), *looks.split()).status == 0
        with Image.open("out.PNG") as picture:
            assert (picture.size, picture.mode) == ((200, 150), "RGBA")
            assert picture.getpixel((0, 0))[3] == 0

    @pytest.mark.one_is_quick
    @pytest.mark.parametrize(
        ("options", "part"),
        [
            (("--source", OUTSIDE), "lies outside"),
            (("--source", "1,2"), "--source 1,2: not a point of a 3D shape; write three numbers"),
            (("--source", "nan,0,0"), "--source nan,0,0: not a point"),
            (("--plane", "w=0.5"), "'w=0.5'"),
            (("--plane", "0,0,0/0,0,0"), "normal must not be zero"),
            (("--plane", "x=1.5"), "--plane x=1.5: the plane misses the body"),
            (("--quantity", "colour"), '"distance", "potential"'),
            (("--colormap", "jet"), '"paper", "even"'),
            (("--isolines", "-1"), "--isolines -1"),
            (("--isolines", "many"), "--isolines"),
            (("--opacity", "1.5"), "--opacity 1.5"),
            (("--opacity", "nan"), "--opacity nan"),
            (("--size", "4"), "--size 4: not a size"),
            (("--size", "0x100"), "1 to 8192"),
            (("--size", "100000x100000"), "1 to 8192"),
            (("--component", "7"), "component"),
            (("--time", "1"), "--time 1: euclidean has no time; leave it out, or take --distance diffusion"),
            (("--sorce", "1,2,3"), "--sorce"),
            (("--source",), "--source requires an argument"),
            (("surplus",), "surplus"),
        ],
    )
    def test_refusals_leave_what_was_there(
        self, run: Run, body: str, options: tuple[str, ...], part: str
    ) -> None:
        Path("out.png").write_text("an older picture")
        assert part in refused(run("render", body, "out.png", "--distance", "euclidean", *options))
        assert Path("out.png").read_text() == "an older picture"
        assert [path.name for path in Path.cwd().iterdir()] == ["out.png"]

    def test_an_unknown_distance(self, run: Run, body: str) -> None:
        told = refused(run("render", body, "out.png", "--distance", "manhattan"))
        assert f"--distance manhattan: there is no such distance; there are: {', '.join(DISTANCES)}" in told

    @pytest.mark.parametrize(
        ("out", "part"),
        [
            ("out.jpg", "ends in .png"),
            ("out", "ends in .png"),
            ("nowhere/out.png", "there is no folder nowhere"),
            ("folder.png", "this is a folder"),
        ],
    )
    def test_places_that_cannot_be_written(self, run: Run, out: str, part: str) -> None:
        Path("folder.png").mkdir()
        # Before the mesh is even looked for.
        assert part in refused(run("render", "no-such-mesh", out))


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

    def test_bundled_shapes_by_name(self, run: Run) -> None:
        names = [line.split()[0] for line in run("samples").out.splitlines()]
        assert names == list(sample_names())
        assert run("info", names[0]).status == 0

    def test_a_file_wins_over_a_bundled_shape(self, run: Run, tmp_path: Path) -> None:
        (tmp_path / sample_names()[0]).write_text("not a mesh")
        assert refused(run("info", sample_names()[0]))


class TestCache:
    """Eigenpairs are kept from one call to the next."""

    VERBS = (
        ("barycentroid",),
        ("distance", "--from=0,0,0", "--to=0.1,0.2,1"),
        ("render", "out.png", "--size=64x64"),
    )

    @pytest.fixture
    def body(self, tmp_path: Path) -> str:
        """Small enough to take no time."""
        path = tmp_path / "ball.off"
        trimesh.creation.icosphere(subdivisions=1, radius=2).export(path)
        return str(path)

    @pytest.fixture
    def folder(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
        """Where they are; also those that took no time."""
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
        monkeypatch.setattr(spectrum_cache.SpectrumCache.__init__, "__defaults__", (10**9, 0.0))
        return tmp_path / "idviewer" / "eigenpairs"

    @pytest.mark.parametrize("verb", VERBS)
    def test_what_was_computed_once_is_read(
        self, run: Run, body: str, folder: Path, verb: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        first = run(verb[0], body, *verb[1:])
        assert [path.suffix for path in folder.iterdir()] == [array_cache.SUFFIX]
        monkeypatch.delattr(eigenpairs, "eigenpair_steps")
        assert run(verb[0], body, *verb[1:]) == first
        assert first.status == 0

    @pytest.mark.parametrize("verb", VERBS)
    def test_no_cache_neither_reads_nor_writes(
        self, run: Run, body: str, folder: Path, verb: tuple[str, ...]
    ) -> None:
        first = run(verb[0], body, *verb[1:], "--no-cache")
        assert not folder.exists()
        run("barycentroid", body)
        (path,) = folder.iterdir()
        path.write_text("damaged")
        assert run(verb[0], body, *verb[1:], "--no-cache") == first
        assert path.read_text() == "damaged"

    @pytest.mark.parametrize("verb", VERBS)
    def test_damage_is_told(self, run: Run, body: str, folder: Path, verb: tuple[str, ...]) -> None:
        run("barycentroid", body)
        (path,) = folder.iterdir()
        path.write_bytes(path.read_bytes()[:5000])
        told = run(verb[0], body, *verb[1:])
        assert told.status == 0
        assert told.err.splitlines() == [
            "idviewer: The eigenpairs kept of this shape were computed again: their file was damaged."
        ]
        assert run("barycentroid", body).err == ""

    @pytest.mark.parametrize("verb", ["render", "distance", "barycentroid", ""])
    def test_it_is_in_the_help(self, run: Run, verb: str) -> None:
        assert "--no-cache" in run(*verb.split(), "--help").out


class TestWindow:
    @pytest.fixture
    def opened(self, monkeypatch: pytest.MonkeyPatch) -> list[Path | None]:
        """What the window was opened on."""
        opened: list[Path | None] = []
        self.caches = caches = []
        app = SimpleNamespace(run_window=lambda path, cache: opened.append(path) or caches.append(cache) or 7)
        monkeypatch.setitem(sys.modules, "idviewer.app", app)
        monkeypatch.setattr(parsing, "why_no_display", lambda: "")
        monkeypatch.setattr(parsing, "need_window_libraries", lambda: None)
        return opened

    def test_opens_on_a_file(self, run: Run, body: str, opened: list[Path | None]) -> None:
        assert run(body).status == 7
        assert opened == [Path(body)]

    def test_no_cache(self, run: Run, body: str, opened: list[Path | None]) -> None:
        assert (run(body).status, run(body, "--no-cache").status) == (7, 7)
        assert [cache is None for cache in self.caches] == [False, True]

    def test_opens_on_what_it_likes(self, run: Run, opened: list[Path | None]) -> None:
        assert run().status == 7
        assert opened == [None]

    def test_a_missing_library_is_named(self, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(parsing, "why_no_display", lambda: "")
        monkeypatch.setattr(parsing, "_loads", lambda library: library != "libEGL.so.1")
        told = refused(run())
        assert "libEGL.so.1" in told
        assert "apt-get install libegl1`" in told

    def test_a_machine_without_opengl(self, run: Run, body: str, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(parsing, "_loads", lambda library: False)
        told = refused(run("render", body, "out.png", *QUICK))
        assert "there is no OpenGL to draw with" in told
        assert "apt-get install libegl1" in told

    def test_a_machine_with_opengl_but_without_x11(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(parsing, "_loads", lambda library: library == "libEGL.so.1")
        monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", "")
        monkeypatch.delenv("VTK_DEFAULT_OPENGL_WINDOW")
        parsing.need_picture_libraries()
        assert os.environ["VTK_DEFAULT_OPENGL_WINDOW"] == "vtkEGLRenderWindow"

    def test_why_there_is_no_display(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
        monkeypatch.delenv("DISPLAY", raising=False)
        assert "neither DISPLAY nor WAYLAND_DISPLAY" in parsing.why_no_display()
        monkeypatch.setenv("DISPLAY", ":4711")
        assert parsing.why_no_display() == "no X server answers at DISPLAY=:4711"
        monkeypatch.setenv("WAYLAND_DISPLAY", "wayland-0")
        assert parsing.why_no_display() == ""


class TestProgram:
    def test_version(self, run: Run) -> None:
        assert run("--version") == (0, idviewer.__version__ + "\n", "")

    @pytest.mark.parametrize(
        "verb", [(), ("render",), ("distance",), ("barycentroid",), ("info",), ("samples",)]
    )
    def test_help(self, run: Run, verb: tuple[str, ...]) -> None:
        answer = run(*verb, "--help")
        assert answer.status == 0
        assert " ".join(("Usage: idviewer", *verb)) in answer.out

    def test_unknown_option(self, run: Run) -> None:
        assert "--wiggle" in refused(run("--wiggle"))

    def test_an_interrupt_leaves_no_trace(self, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
        def interrupt(name: str) -> Path:
            raise KeyboardInterrupt

        monkeypatch.setattr(parsing, "path_of", interrupt)
        assert run("info", "hand") == (130, "", "")

    def test_running_out_of_memory(self, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
        def exhaust(name: str) -> Path:
            raise MemoryError

        monkeypatch.setattr(parsing, "path_of", exhaust)
        assert "not enough memory" in refused(run("info", "hand"))

    @pytest.mark.slow
    def test_a_reader_that_leaves(self, body: str) -> None:
        reader, writer = os.pipe()
        os.close(reader)
        command = [sys.executable, "-m", "idviewer", "info", body]
        done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, check=False)
        os.close(writer)
        assert (done.returncode, done.stderr) == (141, b"")

    def test_colormaps_are_those_of_the_view(self) -> None:
        from idviewer.view.colormaps import COLORMAPS

        assert get_args(get_type_hints(DisplayOptions)["colormap"]) == tuple(COLORMAPS)

    def test_json_has_no_nan(self) -> None:
        assert output.as_json({"a": [1.0, math.inf]}) == '{"a": [1.0, null]}'


def no_display() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}


@pytest.mark.slow
def test_without_a_display_a_picture_is_drawn(body: str, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "idviewer", body]
    done = subprocess.run(
        command, cwd=tmp_path, env=no_display(), capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (0, "idviewer.png\n"), done.stderr
    assert done.stderr.startswith("idviewer: there is no display")
    assert done.stderr.count("\n") == 1
    with Image.open(tmp_path / "idviewer.png") as picture:
        assert len(picture.convert("RGB").getcolors(1 << 20)) > 1000


@pytest.mark.slow
def test_the_bundled_shape_is_drawn_without_a_display(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "idviewer", "render", sample_names()[0], "out.png", "--size", "300x200"]
    done = subprocess.run(
        command, cwd=tmp_path, env=no_display(), capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert (tmp_path / "out.png").stat().st_size > 1000
