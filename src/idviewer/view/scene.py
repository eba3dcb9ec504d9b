"""Everything that is drawn of a shape, put into a plotter. It never renders by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pyvista as pv
from vtkmodules.vtkRenderingCore import vtkProp, vtkRenderer

from idviewer.core import Mesh, Polygon
from idviewer.session import Display
from idviewer.view.body_actor import BodyActor
from idviewer.view.broken_shape import BrokenShape
from idviewer.view.colormaps import colors, lookup_table
from idviewer.view.fault_marks import FaultMarks
from idviewer.view.markers import Markers
from idviewer.view.outline_actor import OutlineActor
from idviewer.view.polydata import Place
from idviewer.view.polygon_view import is_2d
from idviewer.view.scale_bar import ScaleBar
from idviewer.view.slice_actor import SliceActor

if TYPE_CHECKING:
    from idviewer.core import Shape
    from idviewer.core.shapes import FaultPlace, Health
    from idviewer.session import Frame, State

BACKGROUND_BOTTOM, BACKGROUND_TOP = (0.975, 0.977, 0.980), (0.865, 0.885, 0.915)
"""The background, shaded from below to above."""
POINTS_PER_INCH = 72.0
"""Dots per inch at which a pixel of line widths and letters is one of the screen's."""


class Scene:
    """The body, its slices, the markers and the scale bar of a plotter, in its window or off-screen.

    The plotter is used, not owned: `close` takes out of it what was put in. Line widths, letters and balls
    follow the dots per inch of its window.
    """

    def __init__(self, plotter: pv.BasePlotter) -> None:
        renderer: vtkRenderer = plotter.renderer
        self._renderer: vtkRenderer | None = renderer
        self._shape: Shape | None = None
        self._display = Display()
        self._frame: Frame | None = None
        self._dpi = 0.0
        self._place = Place()
        self._table = lookup_table(self._display.colormap)
        self._body, self._outline = BodyActor(renderer), OutlineActor()
        self._slices: list[SliceActor] = []
        self._markers = Markers()
        self._faults = FaultMarks()
        self._bar = ScaleBar()
        self._props: tuple[vtkProp, ...] = ()
        renderer.SetUseOIT(False)  # balls are drawn as they come, not averaged
        if not renderer.GetLights().GetNumberOfItems():
            renderer.CreateLight()  # without any, VTK hands no normals to the body's shader
        renderer.SetBackground(*BACKGROUND_BOTTOM)
        renderer.SetBackground2(*BACKGROUND_TOP)
        renderer.GradientBackgroundOn()
        self._stack()
        self._apply_display()

    def show(self, state: State) -> None:
        """Show the state's body, in the way its display says; what is shown already costs nothing."""
        if self._renderer is None:
            return
        if state.shape is not self._shape:
            self._show_shape(state.shape)
        if state.display != self._display or self._window_dpi() != self._dpi:
            if state.display.colormap != self._display.colormap:
                self._table.DeepCopy(lookup_table(state.display.colormap))
            self._display = state.display
            self._apply_display()

    @property
    def shape(self) -> Shape | None:
        """The shape that is shown."""
        return self._shape

    def show_frame(self, frame: Frame | None) -> None:
        """Show what a frame says; with none, there are no slices, markers or scale bar."""
        if self._renderer is None:
            return
        self._frame = frame
        sections = frame.slices if frame is not None else ()
        if len(sections) > len(self._slices):
            self._slices += [SliceActor(self._table) for _ in sections[len(self._slices) :]]
            self._stack()
            self._apply_display()
        for actor, section in zip(self._slices, sections, strict=False):
            assert frame is not None
            actor.show(section, frame.value_range, self._place, alone=len(sections) == 1)
        for actor in self._slices[len(sections) :]:
            actor.hide()
        self._markers.show_frame(frame)
        self._show_bar()

    def show_faults(self, health: Health | None) -> None:
        """Mark the faults of the body that is shown, or none."""
        self._faults.show(health, self._place, alone=isinstance(self._shape, BrokenShape))

    def choose_fault(self, chosen: FaultPlace | None) -> None:
        """Bring out one place of a fault, or none."""
        self._faults.choose(chosen, self._place)

    def close(self) -> None:
        """Take everything out of the plotter and let go of it; may be called again."""
        if self._renderer is None:
            return
        for prop in self._props:
            self._renderer.RemoveViewProp(prop)
        self._renderer = self._shape = self._frame = None
        self._props = ()
        self._slices.clear()

    def _show_shape(self, shape: Shape | None) -> None:
        dimension_changed = is_2d(shape) != is_2d(self._shape)
        self._shape = shape
        if shape is not None:
            self._place = Place(shape.bounds)
        self._body.show_mesh(shape if isinstance(shape, Mesh) else None, self._place)
        self._outline.show(shape if isinstance(shape, Polygon) else None, self._place)
        self.show_faults(shape.health if isinstance(shape, BrokenShape) else None)
        if dimension_changed:
            self._apply_display()
        if self._frame is not None and not _belongs_to(self._frame, shape):
            self.show_frame(None)

    def _apply_display(self) -> None:
        display = self._display
        self._dpi = self._window_dpi()
        scale = self._dpi / POINTS_PER_INCH
        in_2d = is_2d(self._shape)
        opacity = 0.0 if in_2d else display.opacity  # nothing is around a polygon
        self._body.set_opacity(opacity)
        self._outline.set_look(scale)
        self._faults.set_look(scale)
        for actor in self._slices:
            actor.set_look(display.isolines, opacity, scale, edged=not in_2d)
        self._markers.set_look(display.barycentroid, opacity, scale, in_2d)
        self._show_bar()

    def _show_bar(self) -> None:
        frame, display = self._frame, self._display
        if frame is None or not display.scale_bar:
            self._bar.hide()
        else:
            scale = self._dpi / POINTS_PER_INCH
            self._bar.show(frame.title, frame.value_range, colors(display.colormap), display.isolines, scale)

    def _stack(self) -> None:
        """Put the props into the renderer in the order in which they must be drawn."""
        assert self._renderer is not None
        for prop in self._props:
            self._renderer.RemoveViewProp(prop)
        stages = list(zip(*(actor.actors for actor in self._slices), strict=True)) or [()]
        bases, *overlays = stages
        self._props = (
            *bases,
            self._faults.body,
            *self._body.actors,
            *self._outline.actors,
            *(prop for stage in overlays for prop in stage),
            *self._faults.marks.actors,
            *self._faults.chosen.actors,
            *self._markers.actors,
            *self._bar.actors,
        )
        for prop in self._props:
            self._renderer.AddViewProp(prop)

    def _window_dpi(self) -> float:
        window = self._renderer.GetRenderWindow() if self._renderer is not None else None
        return float(window.GetDPI()) if window is not None else POINTS_PER_INCH


def _belongs_to(frame: Frame, shape: Shape | None) -> bool:
    """Whether the frame is the shape's, or, while a polygon's vertices are dragged, one of a moment ago."""
    return frame.shape is shape or (is_2d(shape) and is_2d(frame.shape))
