"""GeoJSON and well-known text: features, collections and parts by name, and degrees told from lengths."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from tests.core.outlines import SQUARE
from tests.core.polygonfiles import RING, written

from idviewer.core import PolygonError, read_polygon

AROUND = SQUARE - 0.5


def polygon(shift=0.0, size=1.0):
    return {"type": "Polygon", "coordinates": [(size * AROUND + shift).tolist()]}


def multi(*shifts):
    return {"type": "MultiPolygon", "coordinates": [polygon(shift)["coordinates"] for shift in shifts]}


def feature(geometry, **more):
    return {"type": "Feature", "geometry": geometry, "properties": {}, **more}


def collection(*features, **more):
    return {"type": "FeatureCollection", "features": list(features), **more}


def read(folder, content, part=None):
    return read_polygon(written(folder, "a.geojson", json.dumps(content)), part=part)


THREE = collection(
    feature(polygon(), properties={"Name": "yard", "area": 1}, id=17),
    feature(multi(5, 7), properties={"name": "fields"}),
    feature(polygon(9, 2), properties=None, id="s"),
    feature({"type": "Point", "coordinates": [0, 0]}),
    feature(None),
)


@pytest.mark.parametrize(
    ("part", "centre"),
    [("yard", 0), ("17", 0), ("1", 0), ("fields/1", 5), ("fields/2", 7), ("s", 9), ("4", 9)],
)
def test_a_feature_goes_by_name_id_or_number(tmp_path, part, centre):
    chosen = read(tmp_path, THREE, part)
    np.testing.assert_allclose(chosen.bounds.mean(axis=0), centre, atol=1e-12)
    assert "What has no area was passed over (1: Point)." in chosen.notes


@pytest.mark.parametrize(
    ("part", "told"),
    [
        (
            None,
            r"4 polygons: 'yard' \(1 x 1\), 'fields/1' .*, 'fields/2' .*, 's' \(2 x 2\); choose",
        ),
        (
            "fields",
            r"'fields' is the name of several: 'fields/1' \(1 x 1\), 'fields/2' \(1 x 1\); choose one",
        ),
        ("0", "it has no '0' among its polygons"),
        ("barn", "it has no 'barn' among its polygons; there are 'yard'"),
    ],
)
def test_never_the_first_one_silently(tmp_path, part, told):
    with pytest.raises(PolygonError, match=told) as caught:
        read(tmp_path, THREE, part)
    assert len(caught.value.parts) == (2 if part == "fields" else 4)


def test_names_that_are_not_unique_get_their_place(tmp_path):
    twins = collection(*(feature(polygon(shift), properties={"name": "yard"}) for shift in (0, 4)))
    with pytest.raises(PolygonError, match=r"'yard #1' .*'yard #2'"):
        read(tmp_path, twins)
    with pytest.raises(PolygonError, match="'yard' is the name of several"):
        read(tmp_path, twins, "yard")
    assert read(tmp_path, twins, "yard #2").bounds[0, 0] == 3.5


@pytest.mark.parametrize(
    "content",
    [
        {"type": "GeometryCollection", "geometries": [polygon()]},
        {"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates": [1, 2]}, multi(0)]},
        feature(
            {
                "type": "GeometryCollection",
                "geometries": [{"type": "GeometryCollection", "geometries": [polygon()]}],
            }
        ),
        collection(feature(None), feature(polygon())),
        {"type": "Polygon", "coordinates": [[[*point, 30.5] for point in AROUND.tolist()], []]},
        {**polygon(), "bbox": [0, 0, 1, 1]},
    ],
)
def test_one_polygon_needs_no_choice(tmp_path, content):
    assert read(tmp_path, content).area == 1.0


def slow_distance(one, other):
    """Metres between two places by the haversine formula, on a sphere."""
    (x, y), (u, v) = np.radians(one), np.radians(other)
    h = math.sin((v - y) / 2) ** 2 + math.cos(y) * math.cos(v) * math.sin((u - x) / 2) ** 2
    return 2 * 6_371_008.8 * math.asin(math.sqrt(h))


@pytest.mark.parametrize("middle", [(7.0, 45.0), (-70.3, -33.4), (25.1, 70.2), (179.0, 0.4), (12.0, 0.0)])
def test_degrees_become_metres_about_their_middle(tmp_path, middle):
    """From the middle, a point as far east as north is equally far; lengths agree with the sphere's."""
    places = np.array(middle) + 0.01 * AROUND * [1 / math.cos(math.radians(middle[1])), 1.0]
    square = read(tmp_path, {"type": "Polygon", "coordinates": [places.tolist()]})
    east, north = square.bounds[1]
    assert square.unit == "m"
    assert east == pytest.approx(north, rel=7e-3)  # what the ellipsoid differs by from the sphere
    for i in range(4):
        straight = np.linalg.norm(square.vertices[i] - square.vertices[i - 1])
        assert straight == pytest.approx(slow_distance(places[i], places[i - 1]), rel=7e-3)
    assert "projected to metres about their middle" in square.notes[0]


def test_radii_of_the_ellipsoid(tmp_path):
    """A degree of latitude and of longitude at 0, 45 and 60 degrees, from tables of WGS 84."""
    for latitude, along, across in (
        (0.0, 110_574, 111_320),
        (45.0, 111_132, 78_847),
        (60.0, 111_412, 55_800),
    ):
        places = np.array([30.0, latitude]) + 0.01 * AROUND
        box = read(tmp_path, {"type": "Polygon", "coordinates": [places.tolist()]}).bounds
        np.testing.assert_allclose((box[1] - box[0]) / 0.01, [across, along], rtol=2e-5)


def test_a_country_is_told_how_far_off_its_lengths_are(tmp_path):
    land = {"type": "Polygon", "coordinates": [[[6.1, 47.2], [15.3, 47.2], [15.3, 55.1], [6.1, 55.1]]]}
    ratio = math.cos(math.radians(51.15)) / math.cos(math.radians(55.1)) - 1
    assert f"off by up to {100 * ratio:.2g} % at its ends" in read(tmp_path, land).notes[0]


@pytest.mark.parametrize(
    ("shift", "more", "told"),
    [
        (400.0, {}, "some lie beyond 180 or 90"),
        ([30.0, 120.0], {}, "some lie beyond 180 or 90"),
        (0.0, {}, "they lie about the origin"),
        (1.0, {}, "they lie about the origin"),
        (
            50.0,
            {"crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}},
            "EPSG::25832",
        ),
    ],
)
def test_lengths_stay_lengths_with_a_note(tmp_path, shift, more, told):
    square = read(tmp_path, {**polygon(shift), **more})
    assert (square.area, square.unit) == (1.0, "")
    assert "taken for lengths" in square.notes[0]
    assert told in square.notes[0]


@pytest.mark.parametrize("name", ["urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326", "urn:ogc:def:crs:EPSG::4258"])
def test_a_system_of_degrees_is_believed(tmp_path, name):
    square = read(tmp_path, {**polygon(), "crs": {"type": "name", "properties": {"name": name}}})
    assert square.unit == "m"
    assert square.area == pytest.approx(111_320 * 110_574, rel=1e-4)


@pytest.mark.parametrize(
    ("text", "area"),
    [
        (f"SRID=25832;POLYGON (({RING}))", 1.0),
        ("POLYGON ZM ((0 0 1 2, 1 0 1 2, 1 1 1 2, 0 1 1 2, 0 0 1 2))", 1.0),
        ("POLYGON M ((0 0 1, 1 0 1, 1 1 1, 0 1 1, 0 0 1))", 1.0),
        (f"GEOMETRYCOLLECTION (POINT (3 3), MULTIPOLYGON ((({RING}))))", 1.0),
        (f"POINT (1 1)\nPOLYGON (({RING}))\n", 1.0),
        (f"POLYGON (({RING.replace(', ', ',' + chr(10))}))", 1.0),
        (f"srid=4326; POLYGON (({RING}))", 111_320 * 110_574),
    ],
)
def test_well_known_text(tmp_path, text, area):
    square = read_polygon(written(tmp_path, "a.wkt", text))
    assert square.area == pytest.approx(area, rel=1e-3)
    assert square.unit == ("m" if area > 1 else "")


def test_well_known_text_of_several(tmp_path):
    other = "5 0, 7 0, 7 2, 5 0"
    for text in (
        f"MULTIPOLYGON ((({RING})), (({other})))",
        f"GEOMETRYCOLLECTION (POLYGON (({RING})), POLYGON (({other})))",
        f"POLYGON (({RING}))\n\nPOLYGON (({other}))",
    ):
        file = written(tmp_path, "a.wkt", text)
        with pytest.raises(PolygonError, match=r"2 polygons: '1' \(1 x 1\), '2' \(2 x 2\); choose"):
            read_polygon(file)
        assert read_polygon(file, part="2").area == 2.0
    with pytest.raises(PolygonError, match="several systems, SRID 1 and 2"):
        read_polygon(written(tmp_path, "a.wkt", f"SRID=1;POLYGON (({RING}))\nSRID=2;POLYGON (({RING}))"))
    with pytest.raises(PolygonError, match="line 2: "):
        read_polygon(written(tmp_path, "a.wkt", f"POLYGON (({RING}))\nPOLYGON ((0 0, 1 0"))
