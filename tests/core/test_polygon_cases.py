"""Polygon files as tools write them, that were once read as other shapes than their owners'."""

from __future__ import annotations

import json

import numpy as np
import pytest
from tests.core.outlines import SQUARE
from tests.core.polygonfiles import written

from idviewer.core import PolygonError, read_polygon, read_shape


def ring(x, y, width, height):
    return [[x, y], [x + width, y], [x + width, y + height], [x, y + height], [x, y]]


FIELDS = {
    "type": "FeatureCollection",
    "features": [
        {
            "type": "Feature",
            "properties": {"name": name},
            "geometry": {"type": "Polygon", "coordinates": [ring(*box)]},
        }
        for name, box in (("shed", (0, 0, 1, 1)), ("yard", (5, 0, 3, 2)), ("field", (0, 5, 20, 9)))
    ],
}
HOLED = {
    "type": "Feature",
    "properties": {},
    "geometry": {"type": "MultiPolygon", "coordinates": [[ring(0, 0, 6, 4), ring(1, 1, 1, 1)]]},
}
DEGREES = {"type": "Polygon", "coordinates": [ring(7, 45, 0.012704038469036, 0.00898311174991)]}
ARROW = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 40"><marker id="arrow">'
    '<path d="M0 0 H3 L1 2 Z"/></marker><path id="plate" d="M5 5 H55 V35 H5 Z"/></svg>'
)
INCHES = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="4in" height="3in" viewBox="0 0 4 3">'
    '<path d="M0.5 0.5 H3.5 V2.5 H0.5 Z"/></svg>'
)


def test_three_fields_are_named_and_each_can_be_chosen(tmp_path):
    file = written(tmp_path, "fields.geojson", json.dumps(FIELDS))
    with pytest.raises(
        PolygonError, match=r"'shed' \(1 x 1\), 'yard' \(3 x 2\), 'field' \(20 x 9\)"
    ) as caught:
        read_shape(file)
    assert [part.name for part in caught.value.parts] == ["shed", "yard", "field"]
    assert [read_shape(file, part=part).area for part in ("shed", "yard", "field", "3")] == [1, 6, 180, 180]


def test_a_multipolygon_of_one_part(tmp_path):
    assert read_polygon(written(tmp_path, "a.geojson", json.dumps(HOLED))).area == 23.0


def test_as_far_east_as_north_is_equally_far(tmp_path):
    square = read_polygon(written(tmp_path, "a.geojson", json.dumps(DEGREES)))
    assert (square.unit, len(square.notes)) == ("m", 1)
    east, north = square.bounds[1]
    assert east == pytest.approx(500.0, rel=2e-3)  # the file's author took the Earth for a sphere
    assert north == pytest.approx(500.0, rel=2e-3)


def test_a_marker_is_no_plate(tmp_path):
    assert read_polygon(written(tmp_path, "a.svg", ARROW)).area == 1500.0


def test_inches_stay_inches(tmp_path):
    plate = read_polygon(written(tmp_path, "a.svg", INCHES))
    assert plate.unit == "in"
    np.testing.assert_array_equal(np.abs(plate.bounds[:, 0]), [0.5, 3.5])


def test_a_point_given_twice(tmp_path):
    polygon = read_polygon(written(tmp_path, "a.csv", "x,y\n0,0\n3,0\n3,0\n3,2\n0,2\n"))
    assert polygon.area == 6.0
    assert len(polygon.notes) == 1


@pytest.mark.parametrize("cuts", [0, 2, 8, 32])
def test_one_rectangle_however_its_sides_are_cut(tmp_path, cuts):
    steps = np.linspace(0, 1, cuts + 1, endpoint=False)[:, None]
    sides = [a + steps * (b - a) for a, b in zip(SQUARE, np.roll(SQUARE, -1, axis=0), strict=True)]
    text = "\n".join(f"{x!r},{y!r}" for x, y in (np.concatenate(sides) * [11, 3]).tolist())
    polygon = read_polygon(written(tmp_path, "a.csv", text))
    assert (len(polygon.vertices), polygon.notes) == (4 * (cuts + 1), ())
    assert polygon.area == pytest.approx(33.0, rel=1e-14)
