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

    def test_a_point_outside_has_an_empty_field_and_a_line(
        self, run: Run, body: str, table: Callable[[str], str]
    ) -> None:
        points = table("x,y,z\n0,0,0\n\n9,9,9\n0.1,0,0\n8,8,8\n")
        answer = run("distance", body, "--source", INSIDE, "--points", points, *QUICK)
        rows = answer.out.splitlines()
        assert answer.status == 0
        assert [bool(row.rpartition(",")[2]) for row in rows[1:]] == [True, False, True, False]
        assert "points.csv, lines 4, 6: 2 of 4 points lie outside the mesh, whose bounding box" in answer.err
        told = json.loads(run("distance", body, "--source", INSIDE, "--points", points, "--json", *QUICK).out)
        assert [value is None for value in told["interior"]] == [False, True, False, True]

    def test_where_all_points_are_outside_nothing_is_printed(
        self, run: Run, body: str, table: Callable[[str], str]
    ) -> None:
        told = refused(run("distance", body, "--source", INSIDE, "--points", table("9 9 9\n8 8 8\n"), *QUICK))
        assert "points.csv, lines 1, 2: all 2 points, such as 9.0,9.0,9.0, lie outside the mesh" in told

    def test_a_source_outside_is_an_error(self, run: Run, body: str, table: Callable[[str], str]) -> None:
        told = refused(run("distance", body, "--source", OUTSIDE, "--points", table("0 0 0\n"), *QUICK))
        assert "--source: the point 0.3,4.0,0.2 lies outside" in told

    def test_points_just_outside_are_on_the_surface_and_counted(
        self, run: Run, body: str, table: Callable[[str], str]
    ) -> None:
        outer = f"{INSIDE}\n0,0,6.00002\n"
        answer = run("distance", body, "--source", "0,0,6", "--points", table(outer), *QUICK)
        assert answer.out.splitlines()[1] == "0.0,0.0,6.00002,0.0"
        assert "points.csv: 1 point lies 2e-05 outside the mesh, as far as digits round off" in answer.err
        pair = run("distance", body, "--from", "0,0,6.00002", "--to", INSIDE, *QUICK)
        assert pair.status == 0
        assert "--from: 1 point lies 2e-05 outside the mesh" in pair.err

    @pytest.mark.parametrize(
        "text",
        [
            "0.1 0.2 0.3\n-0.3 0.1 2.5\n",
            "0.1\t0.2\t0.3\n-0.3\t0.1\t2.5\n",
            "x;y;z\n0,1;0,2;0,3\n-0,3;0,1;2,5\n",
            "# x,y,z\n0.1,0.2,0.3\n# half way\n-0.3,0.1,2.5  # the end\n",
            "1.0e-01 2.0e-01 3.0e-01\n-3.0e-01 1.0e-01 2.5e+00\n",
        ],
    )
    def test_tables_as_people_write_them(
        self, run: Run, body: str, table: Callable[[str], str], text: str
    ) -> None:
        usual = run(
            "distance", body, "--source", INSIDE, "--points", table("0.1,0.2,0.3\n-0.3,0.1,2.5\n"), *QUICK
        )
        found = run("distance", body, "--source", INSIDE, "--points", table(text), *QUICK)
        assert found.out.splitlines()[-2:] == usual.out.splitlines()

    def test_other_columns_are_kept(self, run: Run, body: str, table: Callable[[str], str]) -> None:
        text = "id,z,x,y,note\nA,0.3,0.1,0.2,left\nB,9,0,0,\n"
        out = run("distance", body, "--source", INSIDE, "--points", table(text), *QUICK).out
        assert out.splitlines()[0] == "id,z,x,y,note,distance"
        first, second = out.splitlines()[1:]
        assert first.startswith("A,0.3,0.1,0.2,left,0.")
        assert second == "B,9.0,0.0,0.0,,"

    def test_standard_streams(
        self, run: Run, body: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
    ) -> None:
        given = ("--source", INSIDE, "--points", "-", *QUICK)

        def stdin() -> io.TextIOWrapper:
            return io.TextIOWrapper(io.BytesIO("x y z\n0.1 0.2 0.3\n".encode("utf-16")))

        monkeypatch.setattr("sys.stdin", stdin())
        printed = run("distance", body, *given, "--out", "-").out
        assert printed.startswith("x,y,z,distance\n0.1,0.2,0.3,0.")
        monkeypatch.setattr("sys.stdin", stdin())
        assert run("distance", body, *given, "--out", str(tmp_path / "out.csv")).out == ""
        assert (tmp_path / "out.csv").read_text() == printed
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"0 0\n")))
        assert "standard input, line 1: '0 0' has 2 columns" in refused(run("distance", body, *given))
        for place in (str(tmp_path), str(tmp_path / "nowhere" / "out.csv")):
            told = refused(run("distance", body, "--source", INSIDE, "--points", "-", "--out", place))
            assert told.startswith(f"idviewer: --out {place}: th")

    @pytest.mark.parametrize(
        ("text", "part"),
        [
            ("", "there are no points in it"),
            ("x,y,z\n", "there are no points in it"),
            ("0,0,0\n1,2\n", "line 2: '1,2' has 2 columns, and line 1 has 3"),
            ("0,0,0\n1,2,nan\n", "line 2: '1,2,nan' is not three numbers"),
            ("id,x,y\n1,2,3\n", "name them in a first line, such as id,x,y,z"),
        ],
    )
    def test_tables_that_are_none(
        self, run: Run, body: str, table: Callable[[str], str], text: str, part: str
    ) -> None:
        assert part in refused(run("distance", body, "--source", INSIDE, "--points", table(text)))

    def test_a_table_of_bytes(self, run: Run, body: str, tmp_path: Path) -> None:
        path = tmp_path / "points.csv"
        path.write_bytes(bytes(range(256)))
        assert "binary data" in refused(run("distance", body, "--source", INSIDE, "--points", str(path)))

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
