"""The kinds of coordinates on the command line."""

from __future__ import annotations

import json

import pytest
from tests.cli.commands import INSIDE, Run, refused

from idviewer.core import COORDINATES, DISTANCES, InteriorDistance, read_mesh
from idviewer.core.coordinates.maximum_entropy import MaximumEntropyCoordinates, MaximumEntropySettings


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
