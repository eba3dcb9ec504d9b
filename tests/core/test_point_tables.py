"""Tables of points: whoever wrote them, they are the same points; what is ambiguous is refused."""

from __future__ import annotations

import io

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from idviewer.core.io import UnreadableError, read_points, rounding_of

POINTS = np.array([[0.5, -1.25, 3.0], [1e-3, 2.0, -0.0625], [7.5, 8.25, 1e3]])


def rows(mark: str, decimal: str = ".", first: tuple[str, ...] = ()) -> str:
    lines = [mark.join(f"{value:.10g}".replace(".", decimal) for value in row) for row in POINTS]
    names = [f"{name}{mark}" for name in first] or [""] * len(lines)
    return "".join(f"{name}{line}\n" for name, line in zip(names, lines, strict=True))


def savetxt(**how: str) -> str:
    out = io.StringIO()
    np.savetxt(out, POINTS, **how)
    return out.getvalue()


WRITTEN = {
    "commas": rows(","),
    "commas and blanks": rows(", "),
    "blanks": rows("  "),
    "tabs": rows("\t"),
    "semicolons": rows(";"),
    "a spreadsheet": "x;y;z\r\n" + rows(";", ",").replace("\n", "\r\n"),
    "a spreadsheet's separator": "sep=;\n" + rows(";", ","),
    "decimal commas between blanks": rows(" ", ","),
    "numpy": savetxt(),
    "numpy with a heading": savetxt(header="x y z"),
    "numpy as csv": savetxt(delimiter=",", header="x,y,z", comments=""),
    "remarks": "% made by hand\n" + rows(" ").replace("\n", "  # here\n") + "\n# the end\n",
    "slashes": "// made by hand\n" + rows(" "),
    "names": rows(",", first=("A", "B", "C")),
    "a count from 0": rows(" ", first=("0", "1", "2")),
    "a count from 1": rows(";", ",", first=("1", "2", "3")),
    "ids": "id,x,y,z\n" + rows(",", first=("17", "3", "5")),
    "pandas": ",0,1,2\n" + rows(",", first=("0", "1", "2")),
    "units": "label;X [mm];Y [mm];Z [mm]\n" + rows(";", ",", first=("A", "B", "C")),
    "paraview": '"Points:0","Points:1","Points:2"\n' + rows(","),
    "quotes": "x,y,z\n" + "".join(f'"{x!r}","{y!r}","{z!r}"\n' for x, y, z in POINTS.tolist()),
    "ends of lines": rows(";").replace("\n", ";\n") + ";;;\n",
    "fortran": rows(" ").replace("0.001", "1.0D-03"),
    "another order": "z,y,x\n" + "".join(f"{z!r},{y!r},{x!r}\n" for x, y, z in POINTS.tolist()),
}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "cp1252"])
@pytest.mark.parametrize("kind", WRITTEN)
def test_the_same_points_come_out_of_every_table(kind, encoding):
    table = read_points(WRITTEN[kind].encode(encoding), 3)
    np.testing.assert_array_equal(table.points, POINTS)
    for row, point in zip(table.rows, POINTS, strict=True):
        for column, value in zip(table.columns, point, strict=True):
            assert float(row[column].replace(",", ".").replace("D", "e")) == value


@pytest.mark.slow
@given(
    st.lists(st.tuples(*[st.floats(-1e6, 1e6)] * 2), min_size=1, max_size=6),
    st.sampled_from([(",", "."), (";", ","), ("\t", ","), (" ", "."), (" ", ","), (";", ".")]),
)
@settings(max_examples=60)
def test_every_number_comes_back_from_every_style(points, style):
    mark, decimal = style
    lines = [mark.join(repr(float(value)).replace(".", decimal) for value in row) for row in points]
    text = "\n".join(lines)
    np.testing.assert_array_equal(read_points(text.encode(), 2).points, np.array(points))


REFUSED = {
    "": "there are no points in it",
    "x,y,z\n": "there are no points in it",
    "# 0,0,0\n": "there are no points in it",
    "1 2\n": "line 1: '1 2' has 2 columns, not three numbers x,y,z",
    "1,5,2,5,3,5\n": "has 6 columns, not three numbers x,y,z; name them in a first line, such as id,x,y,z; "
    "decimal commas need another mark between columns",
    "1 2 3 4\n5 6 7 8\n": "has 4 columns",
    "0 1 2 3\n": "has 4 columns",
    "id,x,y\n1,2,3\n": "has 3 columns, not three numbers",
    "x,x,y,z\n1,2,3,4\n": "has 4 columns",
    "1 2 3\n4 5\n": "line 2: '4 5' has 2 columns, and line 1 has 3",
    "1 2 3\n\n4 five 6\n": "line 3: '4 five 6' is not three numbers x,y,z",
    "1 2 nan\n": "line 1: '1 2 nan' is not three numbers",
    "1,2,\n3,4,5\n": "line 1: '1,2,' is not three numbers",
    "1;2.5;3,5\n": "line 1: '2.5' has a point where other numbers have a decimal comma",
    "1.234,5;2;3,5\n": "line 1: '1.234,5' has a point",
    "1_000 2 3\n": "line 1: '1_000 2 3' is not three numbers",
}


@pytest.mark.parametrize("text", REFUSED)
def test_what_cannot_be_told_is_refused_in_one_line(text):
    with pytest.raises(UnreadableError) as error:
        read_points(text.encode(), 3)
    assert REFUSED[text] in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("style", ["%.6g", "%.4f", "%.3e", "%.8f"])
def test_no_point_is_farther_off_than_its_rounding(style, rng):
    exact = rng.uniform(-1, 1, (200, 3)) * 10.0 ** rng.integers(-3, 3, (200, 1))
    cells = [[style % value for value in row] for row in exact]
    written = np.array([[float(cell) for cell in row] for row in cells])
    rounding = rounding_of(cells, written)
    off = np.linalg.norm(written - exact, axis=1)
    assert (off <= rounding * (1 + 1e-9)).all()
    assert (off > 0.2 * rounding).mean() > 0.3  # and it is no more than that


def test_zeros_that_a_program_leaves_out_do_not_count_as_coarse():
    cells = [["0.5", "1", "0"], ["0.123457", "-0.25", "2"]]
    rounding = rounding_of(cells, np.array([[0.5, 1.0, 0.0], [0.123457, -0.25, 2.0]]))
    assert rounding.max() < 1e-5
