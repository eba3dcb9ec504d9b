"""Pictures without a window: sizes, transparency, files, and what happens where nothing can be drawn."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.view.frames import along_x, disc, frame, sphere
from tests.view.stage import color_of

from idviewer.core import Plane
from idviewer.session.state import State
from idviewer.view import images
from idviewer.view.images import VIEW_ANGLE_DEGREES, default_camera, image, write_image
from idviewer.view.scene import Scene

SIZE = (320, 240)
IN_FRONT = ((0.0, 0.0, 6.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0))


@pytest.fixture(scope="module")
def ball():
    return sphere()


@pytest.fixture
def shown(ball):
    section = disc(values=along_x)
    return State(shape=ball), frame(ball, section, value_range=(-1.0, 1.0))


def _channels(pixels):
    return pixels[..., :3].astype(float), pixels[..., 3:].astype(float) / 255


def test_a_picture_has_the_size_asked_for_and_a_white_background(shown):
    pixels = image(*shown, SIZE, IN_FRONT)
    assert pixels.shape == (240, 320, 3)
    assert pixels.dtype == np.uint8
    assert np.all(pixels[[0, 0, -1, -1], [0, -1, 0, -1]] == 255)
    assert np.abs(pixels[120, 185].astype(int) - color_of(0.67)).max() < 40


def test_the_background_is_transparent_and_the_slice_is_not(shown):
    _, alpha = _channels(image(*shown, SIZE, IN_FRONT, transparent=True))
    assert alpha.shape == (240, 320, 1)
    assert np.all(alpha[0] == 0.0)
    assert np.all(alpha[-1] == 0.0)
    assert alpha[120, 185] > 0.95


def test_glass_is_translucent_more_so_in_its_middle(ball):
    _, alpha = _channels(image(State(shape=ball), None, SIZE, IN_FRONT, transparent=True))
    middle, rim = alpha[120, 160, 0], alpha[120].max()
    assert 0.1 < middle < 0.35
    assert rim > middle + 0.3


def test_a_transparent_picture_on_white_is_the_opaque_picture(shown):
    rgb, alpha = _channels(image(*shown, SIZE, IN_FRONT, transparent=True))
    white = image(*shown, SIZE, IN_FRONT).astype(float)
    assert np.abs(rgb * alpha + 255 * (1 - alpha) - white).max() <= 3.0


def test_a_larger_picture_looks_the_same(shown):
    """Lines, letters and dots grow with it."""
    width, height = images.WINDOW_SIZE_PX
    small = image(*shown, (width, height), IN_FRONT).astype(float)
    large = Image.fromarray(image(*shown, (2 * width, 2 * height), IN_FRONT))
    shrunk = np.asarray(large.resize((width, height), Image.Resampling.BOX)).astype(float)
    assert np.mean(np.abs(shrunk - small).max(axis=2) > 60) < 0.005


def test_a_file_holds_the_picture(shown, tmp_path):
    path = tmp_path / "ball.png"
    write_image(path, *shown, SIZE, IN_FRONT, transparent=True)
    with Image.open(path) as read:
        assert read.format == "PNG"
        assert read.size == SIZE
        assert np.array_equal(np.asarray(read), image(*shown, SIZE, IN_FRONT, transparent=True))
    assert list(tmp_path.iterdir()) == [path]
    ordinary = tmp_path / "ordinary"
    ordinary.touch()
    assert path.stat().st_mode == ordinary.stat().st_mode


def test_writing_that_fails_leaves_the_old_file_and_nothing_else(shown, tmp_path, monkeypatch):
    path = tmp_path / "ball.png"
    path.write_bytes(b"old")

    def full(*_args, **_kwargs):
        raise OSError("no space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OSError, match="no space"):
        write_image(path, *shown, (64, 64))
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_is_not_there_is_named_before_anything_is_drawn(shown, tmp_path):
    with pytest.raises(FileNotFoundError, match="missing"):
        write_image(tmp_path / "missing" / "ball.png", *shown, (64, 64))


@pytest.mark.parametrize("size", [(0, 100), (100, -1), (10**6, 10)])
def test_impossible_sizes_are_errors(shown, size):
    with pytest.raises(ValueError, match="pixels"):
        image(*shown, size)


def test_the_plotter_is_closed_when_drawing_fails(shown, monkeypatch):
    """The leak check of this folder would find its window."""

    def broken(*_args):
        raise RuntimeError("broken")

    monkeypatch.setattr(Scene, "show_frame", broken)
    with pytest.raises(RuntimeError, match="broken"):
        image(*shown, (64, 64))


def test_nothing_to_show_is_a_blank_picture():
    assert np.all(image(State(), None, (64, 64)) == 255)


# The first view


NORMALS = [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0, -1, 0), (0.3, 0.5, 0.8), (0.1, 0, -1)]


@pytest.mark.parametrize("normal", NORMALS)
@pytest.mark.parametrize("aspect", [0.5, 1.0, 2.0])
def test_the_first_view_shows_the_whole_body_obliquely_from_the_normals_side(normal, aspect):
    mesh = sphere(2.0, (30.0, -10.0, 5.0), level=2)
    plane = Plane((30.0, -10.0, 5.0), normal)
    position, focal, up = map(np.array, default_camera(mesh.vertices, plane, aspect))
    back = (position - focal) / np.linalg.norm(position - focal)
    assert np.degrees(np.arccos(back @ plane.normal)) == pytest.approx(25, abs=0.5)
    wanted_up = np.array([0, 1, 0]) if abs(plane.normal[2]) > 0.9 else np.array([0, 0, 1])
    right = np.cross(up, back) / np.linalg.norm(np.cross(up, back))
    above = np.cross(back, right)
    assert above @ wanted_up > 0.3
    seen = mesh.vertices - position
    depth = -(seen @ back)
    tangent = np.tan(np.radians(VIEW_ANGLE_DEGREES / 2))
    assert np.all(depth > 0)
    assert np.abs(seen @ above / depth).max() <= tangent
    assert np.abs(seen @ right / depth).max() <= tangent * aspect
    fill = max(np.abs(seen @ above / depth).max(), np.abs(seen @ right / depth).max() / aspect) / tangent
    assert fill > 0.75


def test_the_body_keeps_clear_of_the_scale_bar():
    """A long body, seen from its side."""
    long = sphere(level=3)
    long = type(long)(long.vertices * [4.0, 1.0, 1.0], long.faces)
    plane = Plane((0, 0, 0), (0, 0, 1))
    made = frame(long, disc(plane, 0.5))
    pixels = [image(State(shape=long).with_(scale_bar=bar), made, (800, 600)) for bar in (True, False)]
    bar = np.argwhere(np.any(pixels[0] != 255, axis=(0, 2))).ravel()
    gaps = np.diff(bar)
    assert gaps.max() > 15  # between the body and the bar
    assert np.all(pixels[1][:, -5:] == 255)


# Where there is no display, or no OpenGL


DRAW = """
import sys
sys.path[:0] = {paths!r}
from tests.view.frames import sphere
from idviewer.session.state import State
from idviewer.view.images import image
print(image(State(shape=sphere(level=1)), None, (40, 30)).shape)
"""


def _draw(**environment):
    """Draws in a process without a display; the environment's variables are added to our own."""
    root = Path(__file__).parents[2]
    known = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    code = DRAW.format(paths=[str(root), str(root / "src")])
    return subprocess.run(
        [sys.executable, "-c", code], env=known | environment, capture_output=True, text=True
    )


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has displays that may be missing")
def test_a_picture_needs_no_display():
    done = _draw()
    assert (done.returncode, done.stdout.strip()) == (0, "(30, 40, 3)"), done.stderr
    assert done.stderr == ""


@pytest.mark.skipif(sys.platform != "linux", reason="there are other libraries elsewhere")
def test_without_opengl_the_error_says_what_to_install(tmp_path):
    for name in ("libEGL.so.1", "libEGL.so", "libOSMesa.so", "libOSMesa.so.8"):
        (tmp_path / name).write_text("not a library")
    done = _draw(LD_LIBRARY_PATH=str(tmp_path))
    assert done.returncode == 1
    assert "apt install libegl1" in done.stderr.splitlines()[-1]
