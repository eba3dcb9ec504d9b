"""Polygon files: each format's spellings of one outline, and one clear line for what is none."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from tests.core.outlines import SQUARE, flower, with_holes

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
from idviewer.core.io import svg
from idviewer.core.io.svg import CurveFlattening

CSV = "0,0\n1,0\n1,1\n0,1\n"
RING = "0 0, 1 0, 1 1, 0 1, 0 0"
HOLED = "0,0\n4,0\n4,4\n0,4\n{}1,1\n2,1\n2,2\n1,2\n"


def drawing(body: str, attributes: str = "") -> str:
    return f'<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg" {attributes}>\n{body}\n</svg>\n'


def path(data: str, more: str = "") -> str:
    return drawing(f'<path {more} d="{data}"/>')


def written(folder: Path, name: str, content: str | bytes) -> Path:
    file = folder / name
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    return file


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
    "text",
    [
        path("M 0 0 L 1 0 L 1 1 L 0 1 Z"),
        path("m0,0 1,0 0,1 -1,0z"),
        path("M0 0H1V1H0Z"),
        path("M0 0h1v1h-1v-1z"),
        path("M0-1 m0 1 h1v1h-1z", 'transform="translate(0 0)"'),
        drawing('<polygon points="0,0 1,0 1,1 0,1"/>'),
        drawing('<polyline points="0 0 1 0 1 1 0 1"/>'),
        drawing('<rect width="1" height="1"/>'),
        drawing('<g transform="scale(0.5)"><rect width="2" height="2"/></g>'),
        drawing('<defs><path d="M0 0 9 9 0 9z"/></defs><circle r="3"/><path d="M0 0H1V1H0Z"/>'),
        drawing('<path d="M0 0H1V1H0Z"/>').replace(' xmlns="http://www.w3.org/2000/svg"', ""),
    ],
)
def test_svg_squares(tmp_path, text):
    """They all hang down from the origin, where a drawing's y points."""
    square = read_polygon(written(tmp_path, "square.svg", text))
    assert len(square.vertices) == 4
    np.testing.assert_allclose(square.bounds, [[0, -1], [1, 0]], atol=1e-15)
    assert square.area == pytest.approx(1.0)


def test_svg_circles_and_ellipses(tmp_path):
    arcs = path("M 5 2 a 3 2 0 0 1 -6 0 A 3 2 0 1 1 5 2 z")
    for body in (arcs, drawing('<ellipse cx="2" cy="2" rx="3" ry="2"/>')):
        polygon = read_polygon(written(tmp_path, "ellipse.svg", body))
        np.testing.assert_allclose(polygon.bounds, [[-1, -4], [5, 0]], atol=4e-3)
        assert polygon.area == pytest.approx(6 * math.pi, rel=2e-3)
        gap = np.abs((polygon.vertices[:, 0] - 2) ** 2 / 9 + (polygon.vertices[:, 1] + 2) ** 2 / 4 - 1)
        assert gap.max() < 1e-12


@pytest.mark.one_is_quick
@pytest.mark.parametrize(
    "data",
    [
        "M0 0 C 0 4 6 4 6 0 S 3 -2 0 0 z",
        "M0 0 c 0 4 6 4 6 0 s -3 -2 -6 0 z",
        "M0 0 Q 3 6 6 0 T 12 0 V 20 H 0 z",
        "m0 0 q 3 6 6 0 t 6 0 v 20 h -12 z",
    ],
)
def test_svg_curves_are_as_flat_as_promised(tmp_path, data, monkeypatch):
    """Chords of a hundred times finer flattening lie within the tolerance of the coarse ones."""
    coarse = read_polygon(written(tmp_path, "curve.svg", path(data)))
    monkeypatch.setattr(svg, "FLATTENING", CurveFlattening(tolerance=svg.FLATTENING.tolerance / 100))
    fine = read_polygon(written(tmp_path, "curve.svg", path(data)))
    assert len(fine.vertices) > 5 * len(coarse.vertices)
    start, end = coarse.vertices, coarse.vertices[coarse.edges[:, 1]]
    to, side = fine.vertices[:, None] - start, end - start
    share = np.clip((to * side).sum(axis=2) / (side**2).sum(axis=1), 0, 1)[..., None]
    away = np.linalg.norm(to - share * side, axis=2).min(axis=1)
    assert away.max() < 1.01e-4 * fine.diagonal


def test_svg_elements_are_told_by_their_id(tmp_path):
    body = (
        '<rect id="r" width="1" height="1"/><path d="M0 0H2V2H0z"/><path id="p" d="M0 0H3V3H0zM1 1V2H2V1"/>'
    )
    file = written(tmp_path, "three.svg", drawing(body))
    assert read_polygon(file).area == 4.0
    assert read_polygon(file, element="r").area == 1.0
    assert read_polygon(file, element="p").area == 8.0
    with pytest.raises(PolygonError, match=r"three.svg: .*no shape in it has the id 'q'; there are: r, p"):
        read_polygon(file, element="q")
    with pytest.raises(PolygonError, match="only SVG drawings have elements"):
        read_polygon(written(tmp_path, "square.csv", CSV), element="r")


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("a.csv", "0,0\n1,zero\n1,1\n", r"as CSV: line 2: '1,zero' stands where two numbers belong"),
        ("a.csv", "x,y\n0,0\n1,0,0\n", r"line 3: '1,0,0' is not x,y"),
        ("a.csv", "0,0\n1,inf\n1,1\n", "line 2: '1,inf' is not finite"),
        ("a.csv", "0,0\n1,nan\n1,1\n", "line 2: '1,nan' is not finite"),
        ("a.csv", "x,y\n", "it holds no points"),
        ("a.csv", b"0,0\n1,0\n\xff,1\n", "line 3: not UTF-8 text"),
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
        ("a.json", "7", "it holds neither"),
        ("a.json", "[" * 100_000, "nested too deeply"),
        ("a.geojson", '{"type": "MultiPolygon", "coordinates": []}', "as GeoJSON: .*'MultiPolygon'"),
        ("a.geojson", '{"type": "FeatureCollection", "features": [1]}', "holds no single Polygon"),
        (
            "a.geojson",
            '{"type": "MultiPolygon", "coordinates": [[[[0,0],[1,0],[1,1]]], [[[5,0],[6,0],[6,1]]]]}',
            "of the type 'MultiPolygon' holds no single Polygon",
        ),
        ("a.wkt", "POLYGON ((0 0, 1 0, 1", "as WKT: Expected number but encountered end of stream"),
        ("a.wkt", "hello", "as WKT: Unknown type: 'HELLO'"),
        ("a.wkt", "POLYGON ((0 0, 1 0, 1 1))", "as WKT: .*closed"),
        ("a.wkt", "POLYGON EMPTY", "it holds no points|no single POLYGON"),
        ("a.wkt", "LINESTRING (0 0, 1 0, 1 1)", "a LINESTRING of 1 parts is no single POLYGON"),
        ("a.wkt", f"MULTIPOLYGON ((({RING})), ((5 0, 6 0, 6 1, 5 0)))", "of 2 parts is no single POLYGON"),
        ("a.wkt", "POLYGON ((0 0, 1e999 0, 1 1, 0 0))", r"vertex 1 \(inf, 0\) is not finite"),
        ("a.svg", "<svg>\n<path</svg>", "as SVG: line 2: not well-formed"),
        ("a.svg", "hello", "line 1: syntax error"),
        ("a.svg", drawing(""), "it holds no path"),
        ("a.svg", path("M 0 0 L 1 0 L 1 x"), "the path has data that cannot be read: 'M 0 0 L 1 0 L 1 x'"),
        ("a.svg", path("M 0 0 L 1", 'id="p"'), "the path 'p' has data that cannot be read"),
        ("a.svg", path(""), "the path is empty"),
        ("a.svg", path("M 0 0"), "no points|three vertices"),
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
