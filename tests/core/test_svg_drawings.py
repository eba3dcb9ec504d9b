"""What of an SVG drawing is drawn, where it lies, and in which unit; against a slow twin's matrices."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core.polygonfiles import drawing, written

from idviewer.core import PolygonError, read_polygon

PLATE = '<path id="plate" d="M5 5 H55 V35 H5 Z"/>'
ARROW = '<path d="M0 0 H3 L1 2 Z"/>'
TWO = '<rect width="2" height="2"/></svg>'
XLINK = 'xmlns:xlink="http://www.w3.org/1999/xlink"'


def read(folder, body, attributes="", part=None):
    return read_polygon(written(folder, "a.svg", drawing(body, attributes)), part=part)


@pytest.mark.parametrize(
    "body",
    [
        *(
            f"<{tag} id='q'>{ARROW}</{tag}>{PLATE}"
            for tag in ("marker", "symbol", "mask", "clipPath", "pattern", "defs")
        ),
        f"<defs><marker>{ARROW}</marker></defs><g>{PLATE}</g>",
        f"<path d='M0 0H9V9z' display='none'/>{PLATE}",
        f"<g style='display:none'>{ARROW}</g>{PLATE}",
        f"<rect width='9' height='9' style='fill:none;stroke:none'/>{PLATE}",
        f"<style>.q {{ fill: none }}</style><path class='q' d='M0 0H9V9z'/>{PLATE}",
        f"<g visibility='hidden'>{ARROW}</g>{PLATE}",
        f"<rect width='9' height='0'/><rect/><path d=''/>{PLATE}",
        f"<line x2='9' y2='9' stroke='red'/><path d='M0 0L9 9' stroke='red'/>{PLATE}",
        f"<text x='3'>plate</text><title>a</title><desc>b</desc>{PLATE}",
        f"<use href='#nowhere'/><use href='http://a/#plate'/>{PLATE}",
        f"<metadata><path d='M0 0H9V9z'/></metadata>{PLATE}",
    ],
)
def test_only_what_is_drawn_counts(tmp_path, body):
    plate = read(tmp_path, body, 'viewBox="0 0 60 40"')
    assert (plate.area, plate.unit) == (1500.0, "px")
    assert bool(plate.notes) == any(word in body for word in ("text", "fill", "hidden"))


@pytest.mark.parametrize(
    ("body", "bounds"),
    [
        ('<defs><rect id="r" width="2" height="1"/></defs><use href="#r"/>', [0, -1, 2, 0]),
        ('<defs><rect id="r" width="2" height="1"/></defs><use href="#r" x="3" y="4"/>', [3, -5, 5, -4]),
        (
            '<symbol id="s" viewBox="0 0 2 2"><rect width="2" height="1"/></symbol>'
            '<use href="#s" x="3" width="4" height="4"/>',
            [3, -2, 7, 0],
        ),
        (
            '<defs><g id="g"><rect id="r" width="1" height="1"/></g><use id="u" href="#g" x="2"/></defs>'
            '<use href="#u" transform="scale(2)" y="1"/>',
            [4, -4, 6, -2],
        ),
        (
            '<svg x="5" y="6" width="10" height="10" viewBox="1 1 2 2"><rect width="2" height="2"/></svg>',
            [0, -11, 10, -1],
        ),
        (
            '<svg width="10" height="20" viewBox="0 0 2 2"><rect width="2" height="2"/></svg>',
            [0, -15, 10, -5],
        ),
        (
            '<svg width="10" height="20" viewBox="0 0 2 2" preserveAspectRatio="none">' + TWO,
            [0, -20, 10, 0],
        ),
        (
            '<svg width="10" height="20" viewBox="0 0 2 2" preserveAspectRatio="xMinYMax">' + TWO,
            [0, -20, 10, -10],
        ),
        ('<rect x="10%" y="50%" width="20%" height="25%"/>', [10, -75, 30, -50]),
        ('<g transform="rotate(90)"><rect width="2" height="1"/></g>', [-1, -2, 0, 0]),
    ],
)
def test_uses_and_drawings_in_drawings_lie_where_they_are_drawn(tmp_path, body, bounds):
    shape = read(tmp_path, body, 'viewBox="0 0 100 100"')
    np.testing.assert_allclose(shape.bounds.ravel(), bounds, atol=1e-12)


@pytest.mark.slow
def test_old_links_and_uses_of_uses_end(tmp_path):
    body = '<defs><rect id="r" width="2" height="1"/></defs><use xlink:href="#r"/>'
    assert read(tmp_path, body, XLINK).area == 2.0
    circle = '<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/><rect width="1" height="1"/></g>'
    with pytest.raises(PolygonError, match="it holds 2 shapes"):  # b, and b as a draws it
        read(tmp_path, circle)
    tens = (f'<use href="#l{i}"/>' * 10 for i in range(11))
    laughs = "".join(f'<g id="l{i}">{ten}</g>' for i, ten in enumerate(tens, 1))
    with pytest.raises(PolygonError, match="it draws over 200,000 elements"):
        read(tmp_path, f'<defs><g id="l0">{ARROW}</g>{laughs}</defs><use href="#l11"/>')
    with pytest.raises(PolygonError, match="over 200 in one another"):
        read(tmp_path, "<g>" * 900 + ARROW + "</g>" * 900)


@pytest.mark.parametrize(
    ("attributes", "scale", "unit"),
    [
        ("", 1, "px"),
        ('viewBox="0 0 60 40"', 1, "px"),
        ('width="100%" viewBox="0 0 60 40"', 1, "px"),
        ('width="4in" height="3in" viewBox="0 0 4 3"', 1, "in"),
        ('width="4in" viewBox="0 0 4 3"', 1, "in"),
        ('height="3cm" viewBox="0 0 4 3"', 1, "cm"),
        ('width="210mm" height="297mm" viewBox="0 0 210 297"', 1, "mm"),
        ('width="105mm" height="148.5mm" viewBox="0 0 210 297"', 0.5, "mm"),
        ('width="10mm" height="1in" viewBox="0 0 10 10"', 1, "mm"),
        ('width="800" height="600" viewBox="0 0 4 3"', 200, "px"),
        ('width="96px" height="96px"', 1, "px"),
        ('width="1in" height="1in"', 1 / 96, "in"),
        ('width="40pt" viewBox="-7 3 4 3"', 10, "pt"),
    ],
)
def test_units_are_the_drawings_own(tmp_path, attributes, scale, unit):
    shape = read(tmp_path, '<rect x="0.5" y="0.5" width="3" height="2"/>', attributes)
    assert shape.unit == unit
    np.testing.assert_allclose(shape.bounds, scale * np.array([[0.5, -2.5], [3.5, -0.5]]), rtol=1e-14)


def test_a_drawing_may_be_stretched(tmp_path):
    attributes = 'width="20mm" height="10mm" viewBox="0 0 10 10" preserveAspectRatio="none"'
    assert read(tmp_path, '<rect width="1" height="1"/>', attributes).area == pytest.approx(2.0)


def test_labels_clips_and_shapes_that_cannot_be_read(tmp_path):
    space = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
    body = f'<path inkscape:label="arrow" id="p1" d="M0 0H3L1 2Z"/>{PLATE}<path id="bad" d="M 0 q"/>'
    arrow = read(tmp_path, body, space, part="arrow")
    assert arrow.area == 3.0
    assert arrow.notes == ("A shape was passed over: the path 'bad' has data that cannot be read: 'M 0 q'.",)
    clipped = read(tmp_path, PLATE.replace("/>", ' clip-path="url(#c)"/>'))
    assert clipped.notes == ("Its clip-path, which cuts it, was not looked at.",)
    with pytest.raises(PolygonError, match="the path 'bad' has data that cannot be read"):
        read(tmp_path, '<path id="bad" d="M 0 q"/>')


def slow_twin(transforms, points):
    """Points through a chain of matrices, the outermost first, one at a time; y upwards."""
    result = []
    for point in points:
        vector = np.array([*point, 1.0])
        for matrix in reversed(transforms):
            vector = matrix @ vector
        result.append([vector[0], -vector[1]])
    return np.array(result)


def test_chains_of_transforms_against_a_slow_twin(tmp_path, rng):
    triangle = [(0.0, 0.0), (2.0, 0.0), (0.0, 1.0)]
    for _ in range(20):
        x, y, angle, s, kx = (
            *rng.uniform(-5, 5, 2),
            rng.uniform(-180, 180),
            rng.uniform(0.2, 3),
            rng.uniform(-40, 40),
        )
        c, n, t = np.cos(np.radians(angle)), np.sin(np.radians(angle)), np.tan(np.radians(kx))
        u, v, w = *rng.uniform(-5, 5, 2).tolist(), rng.uniform(1, 9)
        box = rng.uniform(0.5, 4)
        used = f'<use href="#t" x="1" y="2" transform="scale({s})"/></svg></g>'
        body = (
            f'<defs><polygon id="t" points="0,0 2,0 0,1" transform="skewX({kx})"/></defs>'
            f'<g transform="translate({x} {y}) rotate({angle})"><svg x="{u}" y="{v}" width="{w}" '
            f'height="{w}" viewBox="0 0 {box} {box}">' + used
        )
        chain = [
            np.array([[1, 0, x], [0, 1, y], [0, 0, 1.0]]),
            np.array([[c, -n, 0], [n, c, 0], [0, 0, 1.0]]),
            np.array([[w / box, 0, u], [0, w / box, v], [0, 0, 1.0]]),
            np.diag([s, s, 1.0]),
            np.array([[1, 0, 1.0], [0, 1, 2.0], [0, 0, 1.0]]),
            np.array([[1, t, 0], [0, 1, 0], [0, 0, 1.0]]),
        ]
        given = read(tmp_path, body).vertices
        twin = slow_twin(chain, triangle)
        away = np.linalg.norm(given[:, None] - twin, axis=2)
        assert away.min(axis=1).max() < 1e-9 * np.abs(twin).max()
        assert away.min(axis=0).max() < 1e-9 * np.abs(twin).max()
