"""The barycentroid on the command line."""

from __future__ import annotations

import json

import pytest
from tests.cli.commands import Run

from idviewer.cli import parsing


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
