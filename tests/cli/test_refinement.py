"""--refine, and the error of the discretisation, on the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.cli.commands import Run, refused

pytestmark = pytest.mark.refined

ENDS = ("--from", "1,0.5", "--to", "8,0.5")


@pytest.fixture
def rectangle(tmp_path: Path) -> str:
    (tmp_path / "rectangle.csv").write_text("0,0\n10,0\n10,1\n0,1\n")
    return str(tmp_path / "rectangle.csv")


class TestRefinement:
    def test_what_is_added_is_told(self, run: Run, rectangle: str) -> None:
        answer = run("distance", rectangle, *ENDS)
        assert "4 -> 86 vertices, since its edges are too long for 20 modes" in answer.err
        assert "discretisation within about" in answer.out

    def test_json_tells_the_refinement_and_the_error(self, run: Run, rectangle: str) -> None:
        told = json.loads(run("distance", rectangle, *ENDS, "--json").out)
        assert told["refinement"]["computed_on"] == 86
        assert 0.0 < told["error"] < 0.01 * told["interior"]
        assert 0.0 < told["discretisation"]["lambda_2"] < 0.01
        assert not told["discretisation"]["may_exceed_5_percent"]

    def test_as_it_is_says_how_wrong_it_may_be(self, run: Run, rectangle: str) -> None:
        answer = run("distance", rectangle, *ENDS, "--refine", "no", "--json")
        told = json.loads(answer.out)
        assert "may be off by more than 5%" in answer.err
        assert told["refinement"]["computed_on"] == 4
        fine = json.loads(run("distance", rectangle, *ENDS, "--time", str(told["time"]), "--json").out)
        assert abs(told["interior"] - fine["interior"]) <= told["error"]

    def test_a_length(self, run: Run, rectangle: str) -> None:
        told = json.loads(run("barycentroid", rectangle, "--refine", "0.1", "--json").out)
        assert told["refinement"]["computed_on"] == 220
        assert told["discretisation"]["distances"] < 0.01

    @pytest.mark.parametrize("text", ["fine", "-1", "0", "nan"])
    def test_what_is_none_is_refused(self, run: Run, rectangle: str, text: str) -> None:
        assert "--refine" in refused(run("distance", rectangle, *ENDS, "--refine", text))
        assert "--refine" in refused(run("info", rectangle, "--refine", text))

    def test_info_tells_both(self, run: Run, rectangle: str) -> None:
        answer = run("info", rectangle)
        assert "refinement      4 -> 86 vertices" in answer.out
        assert "discretisation  distances within about" in answer.out
        told = json.loads(run("info", rectangle, "--json").out)
        assert told["refinement"]["computed_on"] == 86
        assert told["discretisation"]["distances"] < 0.01

    def test_many_points_get_their_errors(self, run: Run, rectangle: str, tmp_path: Path) -> None:
        (tmp_path / "points.csv").write_text("x,y\n2,0.5\n9,0.2\n")
        options = ("--source", "1,0.5", "--points", str(tmp_path / "points.csv"), "--json")
        told = json.loads(run("distance", rectangle, *options).out)
        assert len(told["errors"]) == 2
        assert all(0.0 < error < 0.02 for error in told["errors"])

    def test_exact_distances_have_no_error(self, run: Run, rectangle: str) -> None:
        answer = run("distance", rectangle, *ENDS, "--distance", "euclidean", "--json")
        told = json.loads(answer.out)
        assert (answer.err, told["error"], told["refinement"]["computed_on"]) == ("", 0.0, 4)
