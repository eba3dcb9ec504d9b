"""Tables of points as spreadsheets, R, numpy and pandas write them, and which columns of them are taken."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.outlines import SQUARE
from tests.core.polygonfiles import written

from idviewer.core import PolygonError, read_polygon

SEMICOLONS = "X;Y\n0,0;0,0\n0,5;0\n0,5;0,5\n0;0,5\n"
INDEXED = ",x,y\n0,0,0\n1,1,0\n2,1,1\n3,0,1\n"


@pytest.mark.parametrize(
    ("text", "size", "told"),
    [
        (SEMICOLONS, 0.5, "Commas in numbers were read as decimal points"),
        ("sep=;\n" + SEMICOLONS, 0.5, "decimal points"),
        (SEMICOLONS.replace(";", "\t"), 0.5, "decimal points"),
        ("0,0 0,0\n0,5 0\n0,5 0,5\n0 0,5\n", 0.5, "decimal points"),
        ("0,0e0 0\n5e-1 0\n0,5 0,5\n0 0,5\n", 0.5, "decimal points"),
        (INDEXED, 1, "column of running numbers was passed over"),
        (INDEXED.replace(",x", "x"), 1, "running numbers"),  # R names no column of rows' names
        (INDEXED.replace(",x,y\n", ""), 1, "running numbers"),
        ("id,x,y,note\n7,0,0,\n8,1,0,a\n9,1,1,b c\n10,0,1,\n", 1, "'note' was passed over"),
        ("x,y,z\n0,0,0\n1,0,0\n1,1,0\n0,1,0\n", 1, "'z' was passed over"),
        ("0 0 7.5\n1 0 7.5\n1 1 7.5\n0 1 7.5\n", 1, "heights, which are all the same"),
        ("1 0 0 2\n2 1 0 2\n3 1 1 2\n4 0 1 2\n", 1, "heights"),
        ('"0","0"\n"1","0"\n"1","1"\n"0","1"\n', 1, ""),
        ("y,x\n0,0\n0,1\n1,1\n1,0\n", 1, ""),
        ("Easting;Northing\n0;0\n1;0\n1;1\n0;1\n", 1, ""),
        ("x,y\nmetres,metres\n0,0\n1,0\n1,1\n0,1\n", 1, ""),
        ("x,y,\n0,0,\n1,0,\n1,1,\n0,1,\n", 1, ""),
        ("  0   0 \n  1   0\n  1   1\n  0   1\n", 1, ""),
        ("0, 0\r1, 0\r1, 1\r0, 1\r", 1, ""),
    ],
)
def test_tables_of_a_square(tmp_path, text, size, told):
    for encoding in ("utf-8", "utf-16", "utf-16-le", "utf-8-sig"):
        file = written(tmp_path, "square.csv", text.encode(encoding))
        square = read_polygon(file)
        np.testing.assert_array_equal(square.vertices, size * SQUARE)
        assert told in " ".join(square.notes)
        assert bool(square.notes) == bool(told)


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        ("x_mm,y_mm", "mm"),
        ("X [cm],Y [cm]", "cm"),
        ("x (m),y (m)", "m"),
        ("x_mm,y", ""),
        ("x [furlong],y [furlong]", ""),
        ("pos_x,pos_y", ""),
    ],
)
def test_units_in_a_header_are_named(tmp_path, header, unit):
    square = read_polygon(written(tmp_path, "a.csv", f"{header}\n0,0\n1,0\n1,1\n0,1\n"))
    assert (square.unit, square.area) == (unit, 1.0)


def test_longitude_and_latitude_are_degrees_in_either_order(tmp_path):
    one = read_polygon(written(tmp_path, "a.csv", "lat,lon\n60,7\n60,7.02\n60.01,7.02\n60.01,7\n"))
    other = read_polygon(
        written(tmp_path, "b.csv", "Longitude;Latitude\n7;60\n7.02;60\n7.02;60.01\n7;60.01\n")
    )
    np.testing.assert_array_equal(one.vertices, other.vertices)
    assert one.unit == "m"
    np.testing.assert_allclose(np.ptp(one.vertices, axis=0), [1115.6, 1114.1], rtol=1e-3)
    with pytest.raises(PolygonError, match="beyond 180 or 90 degrees"):
        read_polygon(written(tmp_path, "c.csv", "lon,lat\n7,60\n8,60\n8,95\n"))


def test_a_column_that_tells_shapes_apart_does(tmp_path):
    rows = [f"{name},{x + shift},{y}" for name, shift in (("a", 0), ("b", 5)) for x, y in SQUARE.tolist()]
    file = written(tmp_path, "two.csv", "cell,x,y\n" + "\n".join(rows) + "\n")
    with pytest.raises(PolygonError, match=r"it holds 2 shapes: 'a' \(1 x 1\), 'b' \(1 x 1\); choose one"):
        read_polygon(file)
    assert read_polygon(file, part="b").bounds.tolist() == [[5, 0], [6, 1]]
    assert "'cell' was passed over" in read_polygon(file, part="a").notes[0]


def test_holes_are_apart_by_blank_lines_in_wide_tables_too(tmp_path):
    text = "n;x;y\n0;0;0\n1;4;0\n2;4;4\n3;0;4\n;;\n4;1;1\n5;2;1\n6;2;2\n7;1;2\n"
    for between in (";;", "", "8;;", "8;nan;NaN"):
        assert read_polygon(written(tmp_path, "a.csv", text.replace(";;", between))).area == 15.0


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("0,5,1,0\n1,5,2,0\n1,5,3,1\n", "lines have 4 cells, and it is not clear which two are x and y"),
        ("0,1,5\n3,2,7\n1,9,9\n", "lines have 3 cells, and it is not clear"),
        ("0;0,5\n1;0.5\n1;1\n", "line 2: '0.5' has a point where other numbers have a decimal comma"),
        ("x;y\n1.234,5;0\n2;0\n2;2\n", "line 2: '1.234,5' has a point|stands where two numbers belong"),
        ("0\n1\n2\n", "line 1: '0' is not x,y"),
        ("x,y\n0,0\n1_0,0\n1,1\n", "line 3: '1_0,0' stands where"),
        ("1,0,0\n2,1,0\n3,1\n", "line 3: '3.1' has 2 columns, and line 1 has 3"),
        ("0,0\n1,0\n1,1\n", None),
    ],
)
def test_what_is_ambiguous_is_refused(tmp_path, text, told):
    file = written(tmp_path, "a.csv", text)
    if told is None:
        assert read_polygon(file).area == 0.5
        return
    with pytest.raises(PolygonError, match=told) as caught:
        read_polygon(file)
    assert "\n" not in str(caught.value)


def test_repeated_points_are_left_out_with_a_note(tmp_path):
    file = written(tmp_path, "a.csv", "0,0\n3,0\n3,0\n3,2\n0,2\n0,2\n0,2\n0,0\n")
    polygon = read_polygon(file)
    assert (polygon.area, len(polygon.vertices)) == (6.0, 4)
    assert polygon.notes == ("3 points that repeat the one before were merged with it.",)
    tiny = "1e6,0\n1000000.000000003,0\n1000000.000000003,0\n1000000.000000003,2e-9\n1e6,2e-9\n"
    assert len(read_polygon(written(tmp_path, "b.csv", tiny)).vertices) == 4
