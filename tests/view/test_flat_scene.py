"""Polygons off-screen: what the pixels of the window's scene and of pictures mean."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.view.polygons import flat_frame, ring, star
from tests.view.stage import HALF, SIDE, Stage, apart, color_of, middles_of_runs, pixel, stage

from idviewer.core import Mesh, Polygon
from idviewer.session.state import State
from idviewer.view.images import default_camera, image, write_image

ALLOCATION_FREE = {"isolines": 0, "scale_bar": False}
RING = ring()


def shown(polygon: Polygon, **fields: object) -> State:
    return State(shape=polygon).with_(**(ALLOCATION_FREE | fields))


@pytest.fixture
def scene() -> Iterator[Stage]:
    with stage() as made:
        made.plotter.renderer.GetActiveCamera().SetClippingRange(1, 10)
        yield made


def test_all_of_it_is_coloured_and_nothing_else(scene: Stage) -> None:
    scene.scene.show(shown(RING, opacity=0.9))  # nothing is around it that could be opaque
    scene.scene.show_frame(flat_frame(RING, source=np.array([0.0, 0.75, 0.0])))
    picture = scene.picture()
    for x in (-0.9, -0.7, 0.6, 0.8):
        assert apart(picture[pixel(x, 0.0)], color_of((x + 1) / 2)) < 8
    for x in (-1.1, 0.0, 0.4, 1.1):
        assert apart(picture[pixel(x, 0.0)], (255, 255, 255)) == 0


def test_the_outline_is_a_dark_line_around_the_holes_too(scene: Stage) -> None:
    scene.scene.show(shown(RING))
    row = scene.picture()[pixel(0.0, 0.0)[0]]
    lines = middles_of_runs(row.max(axis=1) < 120)
    wanted = [SIDE * (0.5 + x / HALF / 2) - 0.5 for x in (-1.0, -0.5, 0.5, 1.0)]
    np.testing.assert_allclose(lines, wanted, atol=1.0)


def test_a_corner_has_no_notch(scene: Stage) -> None:
    square = Polygon([[-0.8, -0.8], [0.8, -0.8], [0.8, 0.8], [-0.8, 0.8]])
    scene.scene.show(shown(square))
    picture = scene.picture()
    row, column = pixel(0.8, 0.8)
    assert picture[row - 1 : row + 1, column : column + 2].max(axis=2).min() < 120


def test_isolines_are_as_wide_far_as_near(scene: Stage) -> None:
    scene.scene.show(shown(RING, isolines=10))
    scene.scene.show_frame(flat_frame(RING, source=np.array([0.0, 0.75, 0.0])))
    share = []
    for zoom in (1.0, 2.0):
        scene.look((0, 0, 1), (0, 1, 0), zoom)
        row = scene.picture()[pixel(0.0, 0.0)[0]]
        isoline = pixel(0.6, 0.0, zoom)[1]
        share.append(765 - row[isoline - 4 : isoline + 5].sum(axis=1).min())
        assert row[isoline - 4 : isoline + 5].sum(axis=1).min() < 250
    assert abs(share[0] - share[1]) < 150


def test_the_source_is_black_and_the_barycentroid_a_blue_disc(scene: Stage) -> None:
    scene.scene.show(shown(RING, barycentroid=True))
    source, middle = np.array([0.75, 0.0, 0.0]), np.array([-0.75, 0.0, 0.0])
    scene.scene.show_frame(flat_frame(RING, source=source, barycentroid=middle))
    picture = scene.picture()
    assert picture[pixel(0.75, 0.0)].max() < 20
    row, column = pixel(-0.75, 0.0)
    disc = picture[row - 4 : row + 5, column - 4 : column + 5].reshape(-1, 3)
    assert np.ptp(disc, axis=0).max() < 12  # of one colour: a disc and no ball
    assert disc[0, 2] > 200 > 100 > disc[0, 0]


def test_a_frame_of_a_moment_ago_stays_while_vertices_move(scene: Stage) -> None:
    scene.scene.show(shown(RING))
    scene.scene.show_frame(flat_frame(RING, source=np.array([0.0, 0.75, 0.0])))
    scene.scene.show(shown(RING.with_vertices(1.1 * RING.vertices)))
    picture = scene.picture()
    assert apart(picture[pixel(0.7, 0.0)], color_of(0.85)) < 8
    assert picture[pixel(1.1, 0.0)].max() < 120  # the outline is the new one


def test_nothing_of_a_polygon_stays_with_a_body(scene: Stage, tetrahedron: Mesh) -> None:
    scene.scene.show(shown(RING))
    scene.scene.show_frame(flat_frame(RING))
    scene.scene.show(State(shape=tetrahedron).with_(**ALLOCATION_FREE, opacity=0.0))
    assert scene.picture().min() == 255


@pytest.fixture
def tetrahedron() -> Mesh:
    return Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


# Pictures


def test_the_first_picture_is_the_whole_polygon_seen_from_above() -> None:
    picture = image(shown(RING), flat_frame(RING), (400, 300)).astype(int)
    used = np.argwhere((picture != 255).any(axis=2))
    (top, left), (bottom, right) = used.min(axis=0), used.max(axis=0)
    # Round, in the middle, and as high as there is room for.
    assert abs((right - left) - (bottom - top)) <= 2
    assert abs((left + right) / 2 - 199.5) < 1.5
    assert abs((top + bottom) / 2 - 149.5) < 1.5
    assert bottom - top > 0.9 * 300


def test_beside_a_scale_bar_it_moves_to_the_left() -> None:
    state = State(shape=RING).with_(isolines=0)
    picture = image(state, flat_frame(RING), (800, 600)).astype(int)
    vivid = np.ptp(picture, axis=2) > 60
    bar = vivid[:, 700:].any(axis=0)
    columns = np.flatnonzero(vivid[:, :700].any(axis=0))
    assert bar.any()
    assert columns.min() > 5
    assert columns.max() < 700 - 20


def test_the_default_view_looks_straight_down() -> None:
    position, focal, up = map(np.array, default_camera(star().vertices, None))
    np.testing.assert_allclose((focal - position)[:2], 0.0, atol=1e-12)
    assert focal[2] - position[2] < 0
    np.testing.assert_allclose(up, [0, 1, 0], atol=1e-12)


def test_a_transparent_picture_is_clear_around_and_in_the_hole(tmp_path: Path) -> None:
    frame = flat_frame(RING, source=np.array([0.0, 0.75, 0.0]))
    write_image(tmp_path / "ring.png", shown(RING), frame, (200, 200), transparent=True)
    with Image.open(tmp_path / "ring.png") as file:
        picture = np.asarray(file)
    assert picture.shape == (200, 200, 4)
    assert picture[2, 2, 3] == 0
    assert picture[100, 100, 3] == 0
    row = picture[100]
    inside = row[np.argmin(np.abs(np.arange(200) - (100 + 0.75 * 92)))]
    assert inside[3] == 255
    assert apart(inside[:3], color_of(0.875)) < 20


@pytest.mark.parametrize(("scale", "offset"), [(1e-9, 0.0), (1e9, 0.0), (1.0, 1e6)])
def test_size_and_place_do_not_matter(scale: float, offset: float) -> None:
    def picture(scale: float, offset: float) -> np.ndarray:
        polygon = Polygon(RING.vertices * scale + offset, RING.loops)
        frame = flat_frame(RING, source=np.array([0.0, 0.75, 0.0]))
        section = frame.slices[0]
        moved = section.points * scale + offset * np.array([1, 1, 0])
        changed = replace(
            frame,
            shape=polygon,
            slices=(replace(section, points=moved),),
            source=frame.source * scale + offset * np.array([1, 1, 0]),
        )
        return image(shown(polygon, isolines=10), changed, (200, 200)).astype(int)

    different = np.abs(picture(1.0, 0.0) - picture(scale, offset)).max(axis=2) > 40
    assert different.mean() < 0.02
