"""Outlines that labelme, COCO and VIA write: chosen by label or number, y upwards."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from tests.core.outlines import SQUARE
from tests.core.polygonfiles import written

from idviewer.core import PolygonError, read_polygon

FLAT = (4 * SQUARE).ravel().tolist()
LABELME = {
    "version": "5.4.1",
    "flags": {},
    "shapes": [
        {"label": "cat", "points": (4 * SQUARE).tolist(), "shape_type": "polygon", "group_id": None},
        {"label": "box", "points": [[1, 1], [3, 4]], "shape_type": "rectangle"},
        {"label": "sun", "points": [[5, 5], [8, 9]], "shape_type": "circle"},
        {"label": "ear", "points": [[1, 1]], "shape_type": "point"},
    ],
    "imagePath": "cat.png",
    "imageHeight": 100,
}
COCO = {
    "images": [{"id": 1, "width": 10}],
    "categories": [{"id": 3, "name": "cat"}, {"id": 4, "name": "dog"}],
    "annotations": [
        {"id": 11, "category_id": 3, "segmentation": [FLAT]},
        {"id": 12, "category_id": 4, "segmentation": [[0, 0, 2, 0, 0, 2], [5, 5, 6, 5, 5, 6]]},
        {"id": 13, "category_id": 4, "iscrowd": 1, "segmentation": {"counts": [1], "size": [1, 1]}},
    ],
}
REGIONS = [
    {
        "shape_attributes": {"name": "polygon", "all_points_x": [0, 4, 4, 0], "all_points_y": [0, 0, 4, 4]},
        "region_attributes": {"kind": "cat"},
    },
    {"shape_attributes": {"name": "rect", "x": 1, "y": 2, "width": 3, "height": 5}, "region_attributes": {}},
    {"shape_attributes": {"name": "ellipse", "cx": 1, "cy": 2, "rx": 3, "ry": 5}},
    {"shape_attributes": {"name": "circle", "cx": 1, "cy": 2, "r": 3}},
    {"shape_attributes": {"name": "point", "cx": 1, "cy": 2}},
]
VIA = {"_via_settings": {}, "_via_img_metadata": {"a.png99": {"filename": "a.png", "regions": REGIONS}}}


def read(folder, content, part=None):
    return read_polygon(written(folder, "a.json", json.dumps(content)), part=part)


@pytest.mark.parametrize(
    ("content", "areas"),
    [
        (LABELME, {"cat": 16, "box": 6, "sun": 25 * math.pi, "1": 16}),
        (COCO, {"cat": 16, "dog #2": 2, "3": 0.5, "11": 16}),
        (VIA, {"cat": 16, "2": 15, "3": 15 * math.pi, "4": 9 * math.pi}),
        ({"a.png99": {"regions": {str(i): region for i, region in enumerate(REGIONS)}}}, {"cat": 16}),
    ],
)
def test_annotated_outlines_are_chosen(tmp_path, content, areas):
    for part, area in areas.items():
        chosen = read(tmp_path, content, part)
        assert chosen.area == pytest.approx(area, rel=2e-4)
        assert chosen.unit == "px"
        assert "y was turned upwards" in chosen.notes[0]
        assert "no outlines and were passed over" in chosen.notes[1]
    np.testing.assert_array_equal(read(tmp_path, content, "cat").bounds, [[0, -4], [4, 0]])
    with pytest.raises(
        PolygonError, match=r"a.json: it holds \d .*: 'cat' \(4 x 4 px\), .*; choose one"
    ) as caught:
        read(tmp_path, content)
    assert len(caught.value.parts) in (3, 4)


def test_one_outline_needs_no_choice(tmp_path):
    assert read(tmp_path, {"shapes": LABELME["shapes"][:1]}).area == 16.0
    assert read(tmp_path, {"annotations": COCO["annotations"][:1]}).area == 16.0


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ({"shapes": []}, "it holds no shapes"),
        ({"shapes": [3]}, r"shapes\[0\] is 3, not a shape"),
        ({"shapes": [{"label": "a", "points": [[0], [1, 1]]}]}, r"shapes\[0\].points\[0\] is \[0\], not"),
        (
            {"annotations": [{"segmentation": [[1, 2, 3]]}]},
            r"annotations\[0\].segmentation\[0\] is no list of x, y",
        ),
        ({"annotations": [{"segmentation": {"counts": []}}]}, "it holds no annotations"),
        ({"annotations": [None]}, r"annotations\[0\] is null"),
        ({"a": {"regions": [7]}}, "a region is 7, without shape_attributes"),
        ({"a": {"regions": [{"shape_attributes": {"name": "rect", "x": 1}}]}}, "not all numbers"),
        (
            {"a": {"regions": [{"shape_attributes": {"name": "polygon", "all_points_x": [1]}}]}},
            "all_points_x and all_points_y are not as many",
        ),
    ],
)
def test_what_is_wrong_is_told(tmp_path, content, told):
    with pytest.raises(PolygonError, match=told):
        read(tmp_path, content)
