"""What a pixel of the body and the markers means."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from tests.view.frames import along_x, disc, frame, shown, sphere
from tests.view.stage import SIDE, apart, color_of, pixel, stage

from idviewer.core import Mesh, Plane

WHITE = (255, 255, 255)
NO_SOURCE = {"source": np.array([50.0, 0.0, 0.0])}
"""Out of the picture, so that the dot does not cover what is looked at."""


@pytest.fixture(scope="module")
def ball():
    return sphere()


# The body


def test_glass_tints_the_slice_only_slightly_also_under_the_rim(ball):
    pictures = {}
    for opacity in (0.0, 0.25, 0.6):
        with stage() as on:
            on.scene.show(shown(ball, opacity=opacity))
            on.scene.show_frame(frame(ball, disc(values=along_x), value_range=(-1.0, 1.0), **NO_SOURCE))
            pictures[opacity] = on.picture()
    for x in np.linspace(-0.95, 0.95, 21):
        clear = pictures[0.0][pixel(x, 0.1)]
        assert apart(clear, color_of((x + 1) / 2)) <= 5
        assert apart(pictures[0.25][pixel(x, 0.1)], clear) <= 30
        assert apart(pictures[0.6][pixel(x, 0.1)], clear) <= 40


def test_glass_is_more_opaque_towards_the_rim(ball):
    with stage() as on:
        on.scene.show(shown(ball, opacity=0.25))
        picture = on.picture()
    light = [int(picture[pixel(0, y)].sum()) for y in (-0.1, -0.5, -0.9, -0.97)]
    assert light == sorted(light, reverse=True)
    assert light[0] - light[-1] > 60
    assert light[0] < 3 * 255 - 10


@pytest.mark.parametrize(("opacity", "seen"), [(0.0, True), (1.0, False)])
def test_opacity_goes_from_invisible_to_solid(ball, opacity, seen):
    behind = Plane((0.0, 0.0, -0.5), (0.0, 0.0, 1.0))
    with stage() as on:
        on.scene.show(shown(ball, opacity=opacity))
        before = on.picture()
        on.scene.show_frame(frame(ball, disc(behind, radius=0.8), **NO_SOURCE))
        after = on.picture()
    assert (apart(before[pixel(0.3, 0.3)], after[pixel(0.3, 0.3)]) > 50) == seen
    assert (apart(before[pixel(0.3, 0.3)], WHITE) == 0) == seen


@pytest.mark.parametrize("opacity", [0.25, 0.5, 0.95, 1.0])
def test_the_order_of_triangles_does_not_matter(opacity):
    """A ring seen from its side, so that one half of it is behind the other."""
    ring = trimesh.creation.torus(0.8, 0.3, major_sections=48, minor_sections=24)
    orders = [ring.faces, ring.faces[::-1], np.random.default_rng(7).permutation(ring.faces)]
    pictures = []
    for faces in orders:
        with stage() as on:
            on.look((0.0, -0.98, 0.2), (0.0, 0.0, 1.0))
            on.scene.show(shown(Mesh(ring.vertices, faces), opacity=opacity))
            pictures.append(on.picture())
    for other in pictures[1:]:
        assert np.abs(other - pictures[0]).max() <= 4


def test_a_solid_body_shows_where_it_is_cut(ball):
    side = Plane((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    with stage() as on:
        on.scene.show(shown(ball, opacity=1.0))
        on.scene.show_frame(frame(ball, disc(side), **NO_SOURCE))
        picture = on.picture()
    assert picture[pixel(0.0, 0.3)].max() < 130 < picture[pixel(0.1, 0.3)].min() - 30


def test_the_slice_hides_the_body_behind_it(ball):
    """A disc larger than the ball, in front of it: nothing of the ball is seen through it."""
    front = Plane((0.0, 0.0, 1.1), (0.0, 0.0, 1.0))
    with stage() as on:
        on.scene.show(shown(ball, opacity=0.9))
        on.scene.show_frame(
            frame(ball, disc(front, radius=1.1, values=along_x), value_range=(-1, 1), **NO_SOURCE)
        )
        picture = on.picture()
    for x in (-0.9, -0.4, 0.4, 0.9):
        assert apart(picture[pixel(x, 0.1)], color_of((x + 1) / 2)) <= 5


def test_of_two_slices_the_nearer_one_is_seen(ball):
    near, far = (
        disc(Plane((0, 0, z), (0, 0, 1)), 0.7, lambda p, v=v: np.full(len(p), v))
        for z, v in ((0.3, 0.9), (-0.3, 0.1))
    )
    for order in ((near, far), (far, near)):
        with stage() as on:
            on.scene.show(shown(ball, opacity=0.25))
            on.scene.show_frame(frame(ball, *order, **NO_SOURCE))
            assert apart(on.picture()[pixel(0.2, 0.2)], color_of(0.9)) <= 30


@pytest.mark.parametrize(
    ("centre", "size"), [((1e6, -2e6, 3e6), 1.0), ((0.0, 0.0, 0.0), 1e-9), ((5.0, 0.0, 0.0), 1e6)]
)
def test_far_tiny_and_huge_bodies_look_the_same(ball, centre, size):
    def picture(middle, unit):
        mesh = sphere(unit, middle)
        section = disc(Plane(middle, (0, 0, 1)), unit, lambda p: (p[:, 0] - middle[0]) / unit)
        with stage(middle, unit) as on:
            on.scene.show(shown(mesh, opacity=0.3, isolines=8))
            on.scene.show_frame(frame(mesh, section, value_range=(-1, 1), source=np.array(middle)))
            return on.picture()

    there, here = picture(centre, size), picture((0.0, 0.0, 0.0), 1.0)
    assert np.mean(np.abs(there - here).max(axis=2) > 12) < 0.002


# Markers


def test_the_source_is_a_black_dot_with_a_white_rim(ball):
    with stage() as on:
        on.scene.show(shown(ball))
        on.scene.show_frame(frame(ball, disc(), source=np.array([0.3, 0.2, 0.0])))
        picture = on.picture()
    row, column = pixel(0.3, 0.2)
    assert picture[row + 2, column + 1].max() < 40
    assert picture[row, column - 10 : column].min(axis=1).max() > 150


@pytest.mark.parametrize("eye", [(0.0, 0.0, 1.0), (0.0, -0.8, 0.6), (0.0, 0.8, -0.6)])
@pytest.mark.parametrize("opacity", [0.0, 0.25, 0.6])
def test_the_dot_in_a_slice_is_whole_from_either_side_under_glass(ball, eye, opacity):
    with stage() as on:
        on.look(eye, (0.0, 0.6, 0.8))
        on.scene.show(shown(ball, opacity=opacity))
        on.scene.show_frame(frame(ball, disc(values=lambda p: np.ones(len(p)))))
        picture = on.picture()
    middle = picture[SIDE // 2 - 8 : SIDE // 2 + 8, SIDE // 2 - 8 : SIDE // 2 + 8]
    assert 60 <= np.sum(middle.max(axis=2) < 60) <= 130  # pi 5.5^2 = 95


@pytest.mark.parametrize("opacity", [0.0, 0.25, 0.6])
def test_a_dot_behind_a_slice_shines_through_faintly(ball, opacity):
    with stage() as on:
        on.scene.show(shown(ball, opacity=opacity))
        section = disc(values=lambda p: np.full(len(p), 0.6))
        on.scene.show_frame(frame(ball, section, source=np.array([0.0, 0.0, -0.5])))
        rgb = on.picture()[SIDE // 2 + 2, SIDE // 2]
    assert 40 < apart(rgb, color_of(0.6)) < 130


@pytest.mark.parametrize("scale", [1, 2])
def test_dots_follow_the_dots_per_inch_of_the_window(ball, scale):
    state = shown(ball)
    with stage() as on:
        on.scene.show(state)
        on.scene.show_frame(frame(ball, disc(values=lambda p: np.ones(len(p)))))
        on.plotter.render_window.SetDPI(72 * scale)
        on.scene.show(state)
        middle = on.picture()[100:200, 100:200]
    assert np.sum(middle.max(axis=2) < 60) == pytest.approx(95 * scale**2, rel=0.15)


def test_the_barycentroid_is_a_blue_ball_if_wanted(ball):
    with stage() as on:
        on.scene.show_frame(frame(ball, disc(values=lambda p: np.ones(len(p))), **NO_SOURCE))
        seen = []
        for wanted in (False, True):
            on.scene.show(shown(ball, barycentroid=wanted))
            seen.append(on.picture()[SIDE // 2 + 2, SIDE // 2])
    assert apart(seen[0], color_of(1.0)) <= 5
    assert seen[1][2] > 120 > 2 * seen[1][0]


def test_the_potential_has_no_source(ball):
    made = frame(ball, disc(values=lambda p: np.full(len(p), 0.6)))
    with stage() as on:
        on.scene.show(shown(ball))
        on.scene.show_frame(replace(made, query=replace(made.query, quantity="potential")))
        assert apart(on.picture()[SIDE // 2, SIDE // 2], color_of(0.6)) <= 5
