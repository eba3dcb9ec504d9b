"""Polygon files: each format's spellings of one outline, and one clear line for what is none."""

from __future__ import annotations

import json

import numpy as np
import pytest
import shapely
from tests.core.outlines import SQUARE, flower, with_holes
from tests.core.polygonfiles import CSV, HOLED, RING, drawing, path, written

from idviewer.core import (
    Mesh,
    Polygon,
    PolygonError,
    ShapeError,
    read_polygon,
    read_shape,
    sample_path,
    write_polygon,
)


@pytest.mark.parametrize(
    "text",
    [
        CSV,
        "x,y\n" + CSV,
        '"x","y"\r\n0,0\r\n1,0\r\n1,1\r\n0,1\r\n0,0\r\n',
        "\ufeffX;Y\n0;0\n1;0\n1;1\n0;1",
        "0\t0\n1\t0\n1\t1\n0\t1\n",
        "# a square\n0 0\n1 0 # corner\n# between\n1 1\n0 1\n\n\n",
        "\n\n 0.0 , 0 \n1e0,-0\n1,1\n+0,1\nnan,nan\n",
    ],
)
def test_csv(tmp_path, text):
    square = read_polygon(written(tmp_path, "square.csv", text))
    np.testing.assert_array_equal(square.vertices, SQUARE)
    assert (square.name, len(square.loops)) == ("square", 1)


@pytest.mark.parametrize("between", ["\n", "\n\n", "NaN,nan\n", ",\n", "4,0\n4,4\n\n"])
def test_csv_with_a_hole(tmp_path, between):
    if between.startswith("4"):
        with pytest.raises(PolygonError, match=r"vertex 1 \(4, 0\) is repeated as vertex 4"):
            read_polygon(written(tmp_path, "holed.csv", HOLED.format(between)))
        return
    polygon = read_polygon(written(tmp_path, "holed.csv", HOLED.format(between)))
    assert (polygon.area, len(polygon.loops)) == (15.0, 2)


@pytest.mark.parametrize(
    "content",
    [
        SQUARE.tolist(),
        [*SQUARE.tolist(), SQUARE[0].tolist()],
        {"outer": SQUARE.tolist()},
        {"outer": SQUARE.tolist(), "holes": []},
        {"type": "Polygon", "coordinates": [[*SQUARE.tolist(), [0, 0]]]},
        {
            "type": "Feature",
            "geometry": {"type": "Polygon", "coordinates": [SQUARE.tolist()]},
            "properties": {},
        },
        {
            "type": "FeatureCollection",
            "features": [
                {"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [SQUARE.tolist()]}}
            ],
        },
        {"type": "Polygon", "coordinates": [[[0, 0, 7], [1, 0, 7], [1, 1, 7], [0, 1, 7]]]},
    ],
)
def test_json(tmp_path, content):
    for name in ("square.json", "square.geojson"):
        square = read_polygon(written(tmp_path, name, json.dumps(content)))
        np.testing.assert_array_equal(square.vertices, SQUARE)


@pytest.mark.parametrize(
    "text",
    [
        f"POLYGON (({RING}))",
        f"polygon(({RING}))\n",
        "POLYGON Z ((0 0 7, 1 0 7, 1 1 7, 0 1 7, 0 0 7))",
        f"MULTIPOLYGON ((({RING})))",
        f"GEOMETRYCOLLECTION (POLYGON (({RING})))",
    ],
)
def test_well_known_text(tmp_path, text):
    square = read_polygon(written(tmp_path, "square.wkt", text))
    np.testing.assert_array_equal(square.vertices, SQUARE)
    assert (square.name, len(square.loops)) == ("square", 1)


def test_multipolygons_of_one_part_may_have_holes(tmp_path):
    outer, hole = (4 * SQUARE).tolist(), (SQUARE + 1).tolist()
    content = json.dumps({"type": "MultiPolygon", "coordinates": [[outer, hole]]})
    assert read_polygon(written(tmp_path, "a.geojson", content)).area == 15.0
    holed = "MULTIPOLYGON (((0 0, 4 0, 4 4, 0 4, 0 0), (1 1, 2 1, 2 2, 1 2, 1 1)))"
    assert read_polygon(written(tmp_path, "a.wkt", holed)).area == 15.0


def test_json_with_holes(tmp_path):
    outer, hole = (4 * SQUARE).tolist(), (SQUARE + 1).tolist()
    for content in ({"outer": outer, "holes": [hole]}, {"type": "Polygon", "coordinates": [outer, hole]}):
        assert read_polygon(written(tmp_path, "holed.json", json.dumps(content))).area == 15.0


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("a.csv", "0,0\n1,zero\n1,1\n", r"as CSV: line 2: '1,zero' stands where two numbers belong"),
        ("a.csv", "x,y\n0,0\n1,0,0\n", "line 3: '1.0.0' has 3 columns, and line 2 has 2"),
        ("a.csv", "0,0\n1,inf\n1,1\n", "line 2: '1,inf' is not finite"),
        ("a.csv", "0,0\n1,nan\n1,1\n", "line 2: '1,nan' is not finite"),
        ("a.csv", "x,y\n", "it holds no points"),
        ("a.csv", b"0,0\n1,0\n\xff,1\n", "line 3: .* stands where two numbers belong"),
        ("a.csv", bytes(range(256)), "it holds binary data"),
        ("a.csv", "0,0\n1,0\n", "a polygon needs three vertices or more"),
        ("a.csv", "0,0\n1,1\n1,0\n0,2\n", "edge 0-1 .* crosses or touches edge 2-3"),
        ("a.csv", HOLED.format("\n") + "\n5,5\n6,6\n", "loop 2 needs three vertices"),
        ("a.csv", "", "the file is empty"),
        ("a.json", "[[0, 0],\n[1, 0]\n[1, 1]]", "as JSON: line 3: expecting ',' delimiter"),
        ("a.json", "[[0, 0], [1], [1, 1]]", r"the list\[1\] is \[1\], not \[x, y\]"),
        ("a.json", '[[0, 0], [1, "a"], [1, 1]]', r"the list\[1\] is \[1, \"a\"\], not"),
        ("a.json", "[[0, 0], [1, NaN], [1, 1]]", r"the list\[1\] is \[1, NaN\], not"),
        ("a.json", "[[0, 0], [1, true], [1, 1]]", r"the list\[1\]"),
        ("a.json", '{"outer": [[0, 0], [1, 0], [1, 1]], "holes": [3]}', r"holes\[0\] is not a list"),
        ("a.json", '{"outer": [[0, 0], [1, 0], [1, 1]], "holes": 3}', '"holes" is not a list'),
        ("a.json", "[]", r"needs three vertices"),
        ("a.json", "7", "it holds none of these"),
        ("a.json", "[" * 100_000, "nested too deeply"),
        ("a.geojson", '{"type": "MultiPolygon", "coordinates": []}', "as GeoJSON: .*'MultiPolygon'"),
        ("a.geojson", '{"type": "FeatureCollection", "features": [1]}', r"features\[0\] is 1, not a feature"),
        (
            "a.geojson",
            '{"type": "MultiPolygon", "coordinates": [[[[0,0],[1,0],[1,1]]], [[[5,0],[6,0],[6,1]]]]}',
            r"it holds 2 polygons: '1' \(1 x 1\), '2' \(1 x 1\); choose one by its name, part='1'",
        ),
        ("a.wkt", "POLYGON ((0 0, 1 0, 1", "as WKT: Expected number but encountered end of stream"),
        ("a.wkt", "hello", "as WKT: Unknown type: 'HELLO'"),
        ("a.wkt", "POLYGON ((0 0, 1 0, 1 1))", "as WKT: .*closed"),
        ("a.wkt", "POLYGON EMPTY", "it holds no points"),
        ("a.wkt", "LINESTRING (0 0, 1 0, 1 1)", "a LINESTRING is no POLYGON"),
        (
            "a.wkt",
            f"MULTIPOLYGON ((({RING})), ((5 0, 6 0, 6 1, 5 0)))",
            r"it holds 2 polygons: '1' \(1 x 1\), '2' \(1 x 1\); choose",
        ),
        ("a.wkt", "POLYGON ((0 0, 1e999 0, 1 1, 0 0))", r"vertex 1 \(inf, 0\) is not finite"),
        ("a.svg", "<svg>\n<path</svg>", "as SVG: line 2: not well-formed"),
        ("a.svg", "hello", "line 1: syntax error"),
        ("a.svg", drawing(""), "it holds no path"),
        ("a.svg", path("M 0 0 L 1 0 L 1 x"), "the path has data that cannot be read: 'M 0 0 L 1 0 L 1 x'"),
        ("a.svg", path("M 0 0 L 1", 'id="p"'), "the path 'p' has data that cannot be read"),
        ("a.svg", path(""), "it holds no points"),
        ("a.svg", path("M 0 0"), "it holds no points"),
        ("a.svg", path("M 0 0 H 1 V 1 H 0 z M 3 3 H 4 V 4 z"), "lies outside the outer loop"),
        ("a.txt", CSV, "'.txt' files hold no polygon; save it as one of .csv, .svg"),
        ("a", CSV, "a suffix must tell"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(tmp_path, name, content, told):
    file = written(tmp_path, name, content)
    with pytest.raises(PolygonError, match=told) as caught:
        read_polygon(file)
    assert str(caught.value).startswith(f"{file}: ")
    assert "\n" not in str(caught.value)


def test_files_that_are_none(tmp_path):
    for file, told in ((tmp_path / "none.csv", "there is no such file"), (tmp_path, "this is a folder")):
        with pytest.raises(PolygonError, match=told):
            read_polygon(file)


def test_rubbish_never_escapes_as_something_else(tmp_path, rng):
    whole = {
        "a.csv": HOLED.format("\n"),
        "a.json": json.dumps({"outer": SQUARE.tolist(), "holes": []}),
        "a.svg": path("M0 0 C 0 4 6 4 6 0 A 3 2 0 1 1 5 2 z"),
    }
    for name, text in whole.items():
        data = np.frombuffer(text.encode(), dtype=np.uint8)
        for _ in range(60):
            broken = data.copy()
            places = rng.integers(len(data), size=3)
            broken[places] = rng.integers(32, 127, size=3)
            try:
                read_polygon(written(tmp_path, name, broken.tobytes()[: rng.integers(1, len(data) + 1)]))
            except PolygonError as error:
                assert "\n" not in str(error)  # noqa: PT017


@pytest.mark.parametrize("suffix", [".csv", ".json"])
def test_what_is_written_is_read_again(tmp_path, suffix):
    for polygon in (flower(50), with_holes()):
        file = tmp_path / f"{polygon.name}{suffix}"
        write_polygon(polygon, file)
        again = read_polygon(file)
        assert again.name == polygon.name
        for loop, same in zip(polygon.loops, again.loops, strict=True):
            np.testing.assert_array_equal(polygon.vertices[loop], again.vertices[same])
    assert len(list(tmp_path.iterdir())) == 2  # nothing else is left lying about


def test_shapely_writes_what_we_read(tmp_path):
    polygon = with_holes()
    loops = [polygon.vertices[loop] for loop in polygon.loops]
    region = shapely.Polygon(loops[0], loops[1:])
    texts = {"a.wkt": shapely.to_wkt(region, rounding_precision=17), "a.geojson": shapely.to_geojson(region)}
    for name, text in texts.items():
        again = read_polygon(written(tmp_path, name, text))
        assert again.area == pytest.approx(polygon.area, rel=1e-14)
        assert len(again.loops) == len(polygon.loops)


def test_only_known_formats_are_written(tmp_path):
    with pytest.raises(PolygonError, match=r"written as .csv or .json"):
        write_polygon(flower(20), tmp_path / "flower.svg")
    with pytest.raises(FileNotFoundError):
        write_polygon(flower(20), tmp_path / "nowhere" / "flower.csv")


def test_a_file_can_be_sampled(tmp_path):
    file = written(tmp_path, "square.csv", CSV)
    assert len(read_polygon(file, samples=40).vertices) == 40
    with pytest.raises(
        PolygonError, match=r"square.csv: with 3 points: 3 points are too few for the 4 corners"
    ):
        read_polygon(file, samples=3)


def test_shapes_are_told_by_their_suffix(tmp_path):
    assert isinstance(read_shape(sample_path("cat_2k")), Mesh)
    assert isinstance(read_shape(sample_path("star")), Polygon)
    assert len(read_shape(written(tmp_path, "a.csv", CSV), samples=8).vertices) == 8
    for wrong, told in (
        (lambda: read_shape(written(tmp_path, "a.xyz", CSV)), "'.xyz' files cannot be read; .*off, .*csv"),
        (lambda: read_shape(tmp_path / "a.csv", component=1), "a polygon has no components"),
        (lambda: read_shape(sample_path("cat_2k"), samples=9), "only polygons are sampled"),
        (lambda: read_shape(tmp_path / "none.ply"), "there is no such file"),
    ):
        with pytest.raises(ShapeError, match=told):
            wrong()
