"""Pictures from the command line, with and without a display, and refusals that leave files alone."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image
from tests.cli.commands import OUTSIDE, Run, refused

from idviewer.core import DISTANCES, sample_names


class TestRender:
    @pytest.mark.slow
    def test_the_default_picture(self, run: Run, body: str) -> None:
        answer = run("render", body, "out.png", "--size", "320x200")
        assert answer == (0, "", "")
        with Image.open("out.png") as picture:
            assert (picture.size, picture.mode) == ((320, 200), "RGB")
            assert len(picture.getcolors(1 << 16)) > 100
        assert [path.name for path in Path.cwd().iterdir()] == ["out.png"]

    @pytest.mark.slow
    def test_every_option(self, run: Run, body: str) -> None:
        asked = "--source -0.3,0.1,0.2 --plane x=0.4 --plane -0.1,0,0/0,-1,1 --quantity potential"
        asked += " --distance euclidean"
        looks = "--isolines 5 --colormap even --opacity 0.1 --size 200x150 --transparent"
        assert run("render", body, "out.PNG", *asked.split(), *looks.split()).status == 0
        with Image.open("out.PNG") as picture:
            assert (picture.size, picture.mode) == ((200, 150), "RGBA")
            assert picture.getpixel((0, 0))[3] == 0

    @pytest.mark.one_is_quick
    @pytest.mark.parametrize(
        ("options", "part"),
        [
            (("--source", OUTSIDE), "lies outside"),
            (("--source", "1,2"), "--source 1,2: not a point of a 3D shape; write three numbers"),
            (("--source", "nan,0,0"), "--source nan,0,0: not a point"),
            (("--plane", "w=0.5"), "'w=0.5'"),
            (("--plane", "0,0,0/0,0,0"), "normal must not be zero"),
            (("--plane", "x=1.5"), "--plane x=1.5: the plane misses the body"),
            (("--quantity", "colour"), '"distance", "potential"'),
            (("--colormap", "jet"), '"paper", "even"'),
            (("--isolines", "-1"), "--isolines -1"),
            (("--isolines", "many"), "--isolines"),
            (("--opacity", "1.5"), "--opacity 1.5"),
            (("--opacity", "nan"), "--opacity nan"),
            (("--size", "4"), "--size 4: not a size"),
            (("--size", "0x100"), "1 to 8192"),
            (("--size", "100000x100000"), "1 to 8192"),
            (("--component", "7"), "component"),
            (("--time", "1"), "--time 1: euclidean has no time; leave it out, or take --distance diffusion"),
            (("--sorce", "1,2,3"), "--sorce"),
            (("--source",), "--source requires an argument"),
            (("surplus",), "surplus"),
        ],
    )
    def test_refusals_leave_what_was_there(
        self, run: Run, body: str, options: tuple[str, ...], part: str
    ) -> None:
        Path("out.png").write_text("an older picture")
        assert part in refused(run("render", body, "out.png", "--distance", "euclidean", *options))
        assert Path("out.png").read_text() == "an older picture"
        assert [path.name for path in Path.cwd().iterdir()] == ["out.png"]

    def test_an_unknown_distance(self, run: Run, body: str) -> None:
        told = refused(run("render", body, "out.png", "--distance", "manhattan"))
        assert f"--distance manhattan: there is no such distance; there are: {', '.join(DISTANCES)}" in told

    @pytest.mark.parametrize(
        ("out", "part"),
        [
            ("out.jpg", "ends in .png"),
            ("out", "ends in .png"),
            ("nowhere/out.png", "there is no folder nowhere"),
            ("folder.png", "this is a folder"),
        ],
    )
    def test_places_that_cannot_be_written(self, run: Run, out: str, part: str) -> None:
        Path("folder.png").mkdir()
        # Before the mesh is even looked for.
        assert part in refused(run("render", "no-such-mesh", out))


def no_display() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}


@pytest.mark.slow
def test_without_a_display_a_picture_is_drawn(body: str, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "idviewer", body]
    done = subprocess.run(
        command, cwd=tmp_path, env=no_display(), capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (0, "idviewer.png\n"), done.stderr
    assert done.stderr.startswith("idviewer: there is no display")
    _, refined = done.stderr.splitlines()
    assert refined.startswith("idviewer: 662 -> ")
    with Image.open(tmp_path / "idviewer.png") as picture:
        assert len(picture.convert("RGB").getcolors(1 << 20)) > 1000


@pytest.mark.slow
def test_the_bundled_shape_is_drawn_without_a_display(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "idviewer", "render", sample_names()[0], "out.png", "--size", "300x200"]
    done = subprocess.run(
        command, cwd=tmp_path, env=no_display(), capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert (tmp_path / "out.png").stat().st_size > 1000
