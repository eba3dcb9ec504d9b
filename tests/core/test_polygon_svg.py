"""SVG drawings of polygons: their spellings of one outline, curves, and shapes told by their id."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.core.polygonfiles import CSV, drawing, path, written

from idviewer.core import PolygonError, read_polygon
from idviewer.core.io import svg
from idviewer.core.io.svg import CurveFlattening


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
        drawing('<defs><path d="M0 0 9 9 0 9z"/></defs><path d="M0 0H1V1H0Z"/>'),
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
    for part, area in (("r", 1.0), ("2", 4.0), ("p", 8.0), ("3", 8.0)):
        assert read_polygon(file, part=part).area == area
    several = r"it holds 3 shapes: 'r' \(1 x 1 px\), '2' \(2 x 2 px\), 'p' \(3 x 3 px\); choose one"
    with pytest.raises(PolygonError, match=several) as caught:
        read_polygon(file)
    assert [part.name for part in caught.value.parts] == ["r", "2", "p"]
    with pytest.raises(PolygonError, match=r"three.svg: it has no 'q' among its shapes; there are 'r' "):
        read_polygon(file, part="q")
    with pytest.raises(PolygonError, match="it holds one shape, and no part 'r'"):
        read_polygon(written(tmp_path, "square.csv", CSV), part="r")
