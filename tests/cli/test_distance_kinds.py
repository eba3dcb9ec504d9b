"""The kinds of distance on the command line, and their parameters."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.cli.commands import INSIDE, Run, refused

from idviewer.core import DISTANCES, interior_distance, parameters_of, read_mesh


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
        assert "(Diffusion distance, t = 0.5; " in answer.out
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
            (("--distance", "commute"), "(Commute-time distance; "),
            (("--set", "time=0.5"), "(Diffusion distance, t = 0.5; "),
        ):
            answer = run("distance", body, *self.ENDS, *options)
            assert answer.status == 0
            assert part in answer.out

    @pytest.mark.slow
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
            (
                ("--distance", "matrix"),
                "--distance matrix: it needs a .npy, .npz, .csv, .txt or .mtx file with n x n distances",
            ),
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
