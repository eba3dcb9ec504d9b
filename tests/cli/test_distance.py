"""Distances on the command line: of two points and of tables of points, and questions that are none."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.cli.commands import INSIDE, OUTSIDE, QUICK, Run, refused


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
