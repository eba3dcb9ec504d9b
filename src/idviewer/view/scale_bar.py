"""The scale bar: which colour is which value, where the isolines lie, and what the values are.

It has a size in pixels and hangs on the middle of the picture's right edge, so nothing needs to be laid out
again when the picture changes its size.
"""

from __future__ import annotations

import math
import re

import numpy as np
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor2D, vtkCoordinate, vtkPolyDataMapper2D, vtkProp, vtkTextActor

from idviewer.view.polydata import as_array, as_cells, as_points

TEXT_COLOR = (0.13, 0.15, 0.20)
RIGHT_MARGIN_PX, BAR_WIDTH_PX, BAR_HEIGHT_PX, LABEL_GAP_PX = 20.0, 16.0, 250.0, 8.0
"""Space beside the labels, the bar's width and height, and its distance from the labels, in pixels."""
CHARACTER_WIDTH_PX = 7.6
"""About the width of a label's character in pixels."""
TITLE_SIZE_PX, LABEL_SIZE_PX, NOTE_SIZE_PX = 15.0, 13.0, 12.0
"""Of letters, in pixels."""
MAX_LABELS = 8
ROUND_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
"""Differences that two labels may have, but for a power of ten."""


class ScaleBar:
    """Colours, values and a title at the right edge of the picture."""

    def __init__(self) -> None:
        self._colors = vtkPolyData()
        self._lines = vtkPolyData()
        self._title = _text("right", "bottom", bold=True)
        self._note = _text("right", "top")
        self._labels = [_text("left", "centered") for _ in range(MAX_LABELS)]
        self._bar = _untextured_actor(self._colors, layer=0)
        self._ruling = _untextured_actor(self._lines, layer=1)
        self._ruling.GetProperty().SetColor(TEXT_COLOR)
        self._shown: tuple[object, ...] | None = None
        self._filling: tuple[object, ...] | None = None

    @property
    def actors(self) -> tuple[vtkProp, ...]:
        """Everything that is drawn."""
        return self._bar, self._ruling, self._title, self._note, *self._labels

    def hide(self) -> None:
        """Show nothing."""
        self._shown = None
        for actor in self.actors:
            actor.VisibilityOff()

    def show(
        self,
        title: str,
        value_range: tuple[float, float],
        rgb: NDArray[np.uint8],
        isolines: int,
        scale: float,
    ) -> None:
        """Show a range of values in (n, 3) colours from low to high; scale is device pixels in a pixel.

        What is shown already costs nothing.
        """
        wanted = (title, value_range, rgb.tobytes(), isolines, scale)
        if wanted == self._shown:
            return
        self._shown = wanted
        low, high = value_range
        ticks, texts, factor = nice_labels(low, high)
        heights = BAR_HEIGHT_PX * ((ticks - low) / (high - low) - 0.5) if high > low else np.zeros(len(ticks))
        labels_left = -RIGHT_MARGIN_PX - CHARACTER_WIDTH_PX * max(map(len, texts), default=0)
        right = labels_left - LABEL_GAP_PX
        box = np.array([right - BAR_WIDTH_PX, -BAR_HEIGHT_PX / 2, right, BAR_HEIGHT_PX / 2])
        filling = tuple((scale * box).tolist()), rgb.tobytes()
        if filling != self._filling:  # most often only the labels change from frame to frame
            self._filling = filling
            _fill(self._colors, scale * box, rgb)
        _rule(self._lines, scale * box, scale * heights, isolines, scale)
        self._ruling.GetProperty().SetLineWidth(scale)
        for actor in (self._bar, self._ruling):
            actor.VisibilityOn()
        for label, text, height in zip(self._labels, texts, heights, strict=False):
            _write(label, text, (labels_left, height), LABEL_SIZE_PX, scale)
        for label in self._labels[len(texts) :]:
            label.VisibilityOff()
        lines = f"{_broken(title)}\n{factor}" if factor else _broken(title)
        _write(self._title, lines, (-RIGHT_MARGIN_PX, BAR_HEIGHT_PX / 2 + 16.0), TITLE_SIZE_PX, scale)
        step = f"isolines every {(high - low) / isolines:.3g}" if isolines and high > low else ""
        _write(self._note, step, (-RIGHT_MARGIN_PX, -BAR_HEIGHT_PX / 2 - 14.0), NOTE_SIZE_PX, scale)


def nice_labels(low: float, high: float) -> tuple[NDArray[np.float64], list[str], str]:
    """Round values in a range, their texts, and the power of ten that the texts leave out ("" if none).

    >>> nice_labels(0.0, 2.7)[1]
    ['0', '0.5', '1.0', '1.5', '2.0', '2.5']
    >>> nice_labels(0.0, 4.1e-7)[1:]
    (['0', '1', '2', '3', '4'], '×1e−7')
    """
    if not high - low > 1e-9 * max(abs(low), abs(high)):
        return np.array([low]), [f"{low:.3g}"], ""
    around = np.asarray(MaxNLocator(nbins=MAX_LABELS - 1, steps=ROUND_STEPS).tick_values(low, high))
    # Free of what rounding leaves of zero, and of the labels around the range.
    step = float(f"{around[1] - around[0]:.2g}")
    ticks = step * np.rint(around / step)
    ticks = ticks[(ticks >= low - 1e-6 * step) & (ticks <= high + 1e-6 * step)]
    power = math.floor(math.log10(max(abs(low), abs(high))))
    power = 0 if -3 < power < 4 else power
    unit = step / 10.0**power
    decimals = next((d for d in range(16) if math.isclose(round(unit, d), unit, rel_tol=1e-6)), 15)
    texts = [f"{tick / 10.0**power:.{decimals}f}" if tick else "0" for tick in ticks]
    return ticks, texts, f"×1e{power}".replace("-", "−") if power else ""


def _broken(title: str) -> str:
    """A title with its parameters on lines of their own."""
    return re.sub(r"(?<=[,;]) | (?=\()", "\n", title)


def _untextured_actor(data: vtkPolyData, layer: int) -> vtkActor2D:
    mapper = vtkPolyDataMapper2D()
    mapper.SetInputData(data)
    actor = vtkActor2D()
    actor.SetMapper(mapper)
    actor.SetLayerNumber(layer)
    anchor = actor.GetPositionCoordinate()
    anchor.SetCoordinateSystemToNormalizedViewport()
    anchor.SetValue(1.0, 0.5)
    actor.VisibilityOff()
    return actor


def _text(horizontal: str, vertical: str, bold: bool = False) -> vtkTextActor:
    actor = vtkTextActor()
    look = actor.GetTextProperty()
    look.SetFontFamilyToArial()
    look.SetColor(TEXT_COLOR)
    look.SetBold(bold)
    look.SetLineSpacing(1.15)
    look.SetJustification({"left": 0, "right": 2}[horizontal])
    look.SetVerticalJustification({"bottom": 0, "centered": 1, "top": 2}[vertical])
    edge = vtkCoordinate()
    edge.SetCoordinateSystemToNormalizedViewport()
    edge.SetValue(1.0, 0.5)
    position = actor.GetPositionCoordinate()
    position.SetCoordinateSystemToViewport()
    position.SetReferenceCoordinate(edge)
    actor.VisibilityOff()
    return actor


def _write(
    actor: vtkTextActor,
    text: str,
    position: tuple[float, float],
    size: float,
    scale: float,
) -> None:
    actor.SetInput(text)
    actor.GetPositionCoordinate().SetValue(scale * position[0], scale * position[1])
    actor.GetTextProperty().SetFontSize(round(size))  # VTK scales letters by the window's dots per inch
    actor.SetVisibility(bool(text))


def _fill(data: vtkPolyData, box: NDArray[np.float64], rgb: NDArray[np.uint8]) -> None:
    """A ladder of coloured rectangles from the bottom of box (left, bottom, right, top) to its top."""
    left, bottom, right, top = box
    steps = len(rgb)
    heights = np.linspace(bottom, top, steps + 1)
    points = np.zeros((steps + 1, 2, 3), np.float32)
    points[:, 0, 0], points[:, 1, 0] = left, right
    points[:, :, 1] = heights[:, None]
    first = 2 * np.arange(steps, dtype=np.int32)[:, None]
    data.SetPoints(as_points(points.reshape(-1, 3)))
    data.SetPolys(as_cells(first + np.array([0, 1, 3, 2])))
    data.GetCellData().SetScalars(as_array(rgb.copy()))


def _rule(
    data: vtkPolyData, box: NDArray[np.float64], ticks: NDArray[np.float64], isolines: int, scale: float
) -> None:
    """The frame, a tick beside it for each label, and across it the isolines if there is room for them."""
    left, bottom, right, top = box
    ends = [
        (left, bottom, right, bottom),
        (right, bottom, right, top),
        (right, top, left, top),
        (left, top, left, bottom),
    ]
    ends += [(right, height, right + 4 * scale, height) for height in ticks]
    if isolines and (top - bottom) / isolines > 3 * scale:
        ends += [(left, height, right, height) for height in np.linspace(bottom, top, isolines + 1)[1:-1]]
    points = np.zeros((2 * len(ends), 3), np.float32)
    points[:, :2] = np.reshape(ends, (-1, 2))
    data.SetPoints(as_points(points))
    data.SetLines(as_cells(np.arange(len(points)).reshape(-1, 2)))
