"""What a frame costs the thread of the window: its arrays handed to VTK, and by it to the card."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pyvista as pv
from bodies import Body
from settings import Settings
from table import Bar, Row
from timing import take_turns

from idviewer.core import section
from idviewer.core.sampling import SliceValues
from idviewer.core.slices import slice_mesh, spacing_for
from idviewer.session.picking import FramePicker
from idviewer.session.state import Display, Frame, Query, State, default_plane
from idviewer.view.scene import Scene

TITLE = "A frame in the window's thread"
NOTE = (
    "A slice of 20,000 points put into the scene, with what the mouse picks by; then also drawn into 16 x 16 "
    "pixels, less the drawing of an unchanged scene. As in a plane's drag, the colours' range stays."
)
NODES, SIDE, TIMES = 20_000, 16, 10
IN_WINDOW = Bar(4.0)


def rows(settings: Settings) -> Iterator[Row]:
    body = next((one for one in settings.bodies if one.readme), settings.bodies[-1])
    frames = [frame_of(body, shift) for shift in (0.0, 1e-4, 2e-4)]
    plotter = pv.Plotter(off_screen=True, window_size=[SIDE, SIDE])
    try:
        scene = Scene(plotter)
        scene.show(State(body.mesh, frames[0].query, Display()))
        plotter.reset_camera()
        accepted, drawn, again = _spent(scene, plotter.render_window.Render, frames, settings.turns * TIMES)
        scene.close()
    finally:
        plotter.close()
    label = f"{len(frames[0].slices[0].points):,} points"
    yield Row("frame accepted", label, 1e3 * accepted, "ms")
    yield Row(
        "frame accepted and handed to the card",
        label,
        1e3 * (drawn - again),
        "ms",
        bar=IN_WINDOW,
        readme=True,
    )


def _spent(scene: Scene, draw: Callable[[], None], frames: list[Frame], turns: int) -> list[float]:
    """Median seconds of a frame accepted, of one accepted and drawn, and of a scene drawn again."""
    number = 0

    def accept() -> None:
        nonlocal number
        number += 1
        FramePicker(frames[number % len(frames)])
        scene.show_frame(frames[number % len(frames)])

    def accept_and_draw() -> None:
        accept()
        draw()

    accept_and_draw()
    return take_turns(turns, accept, accept_and_draw, draw)


def frame_of(body: Body, shift: float) -> Frame:
    """A frame of many points, with distances in space for values; colours span those of the whole body."""
    mesh, plane = body.mesh, default_plane(body.mesh).moved(shift * body.mesh.diagonal)
    cut = section(mesh, plane)
    filled = slice_mesh(cut, spacing_for(cut, NODES))
    values, all_values = (
        np.linalg.norm(p - mesh.vertices[0], axis=1) for p in (filled.points, mesh.vertices)
    )
    outline = tuple(loop.astype(np.int32) for loop in cut.loops)
    one = SliceValues(plane, filled.points, filled.triangles, values, outline)
    return Frame(
        shape=mesh,
        query=Query(planes=(plane,)),
        slices=(one,),
        level=0,
        exact=True,
        error=0.0,
        source=mesh.vertices[0],
        barycentroid=mesh.vertices[0],
        value_range=(0.0, float(all_values.max())),
        title="Distance",
    )
