"""What a pixel of a slice means: its colour, its isolines, its outline."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.view.frames import along_x, disc, frame, shown, sphere
from tests.view.stage import HALF, SIDE, apart, color_of, middles_of_runs, pixel, stage

from idviewer.view.colormaps import UNKNOWN_COLOR, colors

WHITE = (255, 255, 255)
NO_SOURCE = {"source": np.array([50.0, 0.0, 0.0])}
"""Out of the picture, so that the dot does not cover what is looked at."""


@pytest.fixture(scope="module")
def ball():
    return sphere()


# Slices


@pytest.mark.parametrize("name", ["paper", "even"])
def test_a_pixel_has_the_color_of_its_value(ball, name):
    with stage() as on:
        on.scene.show(shown(ball, colormap=name))
        on.scene.show_frame(frame(ball, disc(values=along_x), value_range=(-1.0, 1.0), **NO_SOURCE))
        picture = on.picture()
    for x in np.linspace(-0.9, 0.9, 19):
        for y in (-0.3, 0.0, 0.3):
            assert apart(picture[pixel(x, y)], color_of((x + 1) / 2, name)) <= 5, (x, y)


def test_values_are_interpolated_before_they_are_colored(ball):
    """Between two samples that are far apart lie the colours of the table, not a mixture of the two ends."""
    coarse = disc(values=along_x, rings=1)
    with stage() as on:
        on.scene.show(shown(ball))
        on.scene.show_frame(frame(ball, coarse, value_range=(-1.0, 1.0), **NO_SOURCE))
        picture = on.picture()
    for x in np.linspace(-0.7, 0.7, 15):
        assert apart(picture[pixel(x, 0.05)], color_of((x + 1) / 2)) <= 5


def test_values_beyond_the_range_take_the_colors_of_its_ends(ball):
    with stage() as on:
        on.scene.show(shown(ball))
        on.scene.show_frame(frame(ball, disc(values=along_x), value_range=(-0.3, 0.3), **NO_SOURCE))
        picture = on.picture()
    assert apart(picture[pixel(-0.7, 0)], colors("paper")[0]) <= 3
    assert apart(picture[pixel(0.7, 0)], colors("paper")[-1]) <= 3


def test_unknown_values_are_grey(ball):
    section = disc(values=lambda points: np.where(points[:, 1] > 0, np.nan, 0.5))
    with stage() as on:
        on.scene.show(shown(ball, isolines=7))
        on.scene.show_frame(frame(ball, section, **NO_SOURCE))
        picture = on.picture()
    assert apart(picture[pixel(0.2, 0.4)], np.array(UNKNOWN_COLOR) * 255) <= 2
    assert apart(picture[pixel(0.2, -0.4)], color_of(0.5)) <= 3


def test_a_range_without_extent_is_drawn_in_one_color(ball):
    with stage() as on:
        on.scene.show(shown(ball, isolines=5, scale_bar=True))
        on.scene.show_frame(frame(ball, disc(values=lambda p: np.full(len(p), 3.0)), value_range=(3.0, 3.0)))
        picture = on.picture()
    assert apart(picture[pixel(0.4, 0.4)], colors("paper")[0]) <= 3


def test_the_slice_ends_at_its_outline_with_a_dark_line(ball):
    with stage() as on:
        on.scene.show(shown(ball))
        on.scene.show_frame(frame(ball, disc(radius=0.8), value_range=(0.0, 1.6), **NO_SOURCE))
        row = on.picture()[SIDE // 2]
    assert middles_of_runs(row.max(axis=1) < 90) == pytest.approx(
        [pixel(-0.8, 0)[1], pixel(0.8, 0)[1]], abs=1.0
    )
    assert apart(row[pixel(0.86, 0)[1]], WHITE) == 0


def test_a_plane_that_misses_the_body_shows_nothing(ball):
    empty = replace(
        disc(), points=np.empty((0, 3)), triangles=np.empty((0, 3), np.int32), values=np.empty(0), outline=()
    )
    with stage() as on:
        on.scene.show(shown(ball))
        on.scene.show_frame(frame(ball, empty, **NO_SOURCE))
        assert apart(on.picture().reshape(-1, 3), WHITE) == 0
        on.scene.show_frame(frame(ball, disc(), **NO_SOURCE))
        assert apart(on.picture()[pixel(0.5, 0)], color_of(0.5)) <= 5


# Isolines


def _ink(on, mesh, steps):
    """Which share of a pixel's light isolines take away, along the middle row."""
    rows = []
    for isolines in (0, steps):
        on.scene.show(shown(mesh, isolines=isolines))
        rows.append(on.picture()[SIDE // 2].sum(axis=1))
    return 1 - rows[1] / rows[0]


@pytest.mark.parametrize("steps", [0, 1, 2, 9, 16])
def test_isolines_divide_the_range_in_equal_steps(ball, steps):
    with stage() as on:
        on.scene.show_frame(frame(ball, disc(values=along_x), value_range=(-1.0, 1.0), **NO_SOURCE))
        ink = _ink(on, ball, steps)
    places = [SIDE / 2 * (1 + (2 * k / steps - 1) / HALF) - 0.5 for k in range(1, steps)]
    assert middles_of_runs(ink > 0.2) == pytest.approx(places, abs=1.0)


def test_isolines_are_as_wide_at_any_zoom(ball):
    per_line = []
    for zoom in (0.6, 1.0, 3.0):
        with stage() as on:
            on.look((0, 0, 1), (0, 1, 0), zoom)
            on.scene.show_frame(frame(ball, disc(values=along_x), value_range=(-1.0, 1.0), **NO_SOURCE))
            per_line.append(_ink(on, ball, 6).sum() / sum(abs(k / 3) < HALF / zoom for k in range(-2, 3)))
    assert per_line == pytest.approx([np.mean(per_line)] * 3, rel=0.1)


def test_isolines_that_would_be_too_dense_fade_away(ball):
    with stage() as on:
        on.scene.show(shown(ball, isolines=2000))
        on.scene.show_frame(frame(ball, disc(values=along_x), value_range=(-1.0, 1.0), **NO_SOURCE))
        picture = on.picture()
    for x in np.linspace(-0.8, 0.8, 31):
        assert apart(picture[pixel(x, 0.1)], color_of((x + 1) / 2)) <= 5
