"""Choice of the distance, and its parameters: built from the registry of distances."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any, Protocol, cast

from PySide6.QtWidgets import QGroupBox, QVBoxLayout

from idviewer.core import DISTANCES, Distance, Shape, parameters_of
from idviewer.core.distances import File, Formula, missing_parameters
from idviewer.session import Frame, State
from idviewer.view.panel_coordinates import CoordinatesRow, fit
from idviewer.view.panel_refinement import RefinementRow
from idviewer.view.parameter_rows import Row, choice, row_for
from idviewer.view.polygon_view import is_2d


class _Calls(Protocol):
    def set(self, **fields: object) -> None: ...

    def complain(self, text: str) -> None: ...


class DistanceGroup(QGroupBox):
    """The kind of distance, under it what may be set of the kind chosen, and what carries it inside.

    A kind that lacks something (a file) is only shown as chosen: it is asked for once it has that.
    """

    def __init__(self, calls: _Calls) -> None:
        super().__init__("Distance")
        self._calls = calls
        self._distance: Distance = State().query.distance
        self._waiting: Distance | None = None
        self._shape: Shape | None = None
        self._lambda_2: float | None = None
        self._last: dict[str, Distance] = {}
        self.kind = choice((name, kind.title) for name, kind in DISTANCES.items())
        self.kind.activated.connect(self._choose)
        self.rows = {
            (name, parameter): row_for(one, partial(self._change, parameter), calls)
            for name, kind in DISTANCES.items()
            for parameter, one in parameters_of(kind).items()
        }
        self.coordinates = CoordinatesRow(calls)
        layout = QVBoxLayout(self)
        self.refinement = RefinementRow(calls)
        for row in (self.kind, *self.rows.values(), self.coordinates, self.refinement):
            layout.addWidget(row)

    def show_state(self, state: State, frame: Frame | None) -> None:
        """Show the state; frame tells the first eigenvalue, by which parameters are measured."""
        if state.shape is not self._shape:
            self._show_shape(state.shape, frame)
        if state.query.distance != self._distance:
            self._waiting = None
        self._distance = distance = state.query.distance
        # What may fail is worth coming back to only once it was seen to work.
        if not _may_fail(distance) or (frame is not None and frame.query.distance == distance):
            self._last[distance.name] = distance
        # The frame may be one of a polygon whose vertices were where they are no longer.
        self._lambda_2 = frame.lambda_2 if frame is not None else None
        self.coordinates.show_state(state)
        self.refinement.show_state(state, frame)
        self._show(self._waiting or distance)

    def _show_shape(self, shape: Shape | None, frame: Frame | None) -> None:
        if frame is None or not is_2d(frame.shape):  # else the same polygon with its vertices moved
            self._last.clear()
            self._waiting = None
        if shape is not None and (self._shape is None or self._shape.dimension != shape.dimension):
            fit(self.kind, DISTANCES, shape.dimension)
        self._shape = shape

    def _show(self, distance: Distance) -> None:
        self.kind.setCurrentIndex(self.kind.findData(distance.name))
        for (name, parameter), widget in self.rows.items():
            row = cast(Row, widget)
            row.setVisible(name == distance.name)
            if name == distance.name:
                row.show_value(getattr(distance, parameter), self._lambda_2)

    def _choose(self) -> None:
        """A kind with the parameters that it had last on this shape."""
        name = self.kind.currentData()
        self._take(self._last.get(name) or DISTANCES[name]())

    def _take(self, distance: Distance) -> None:
        self._waiting = distance if missing_parameters(distance) else None
        if self._waiting is None:
            self._calls.set(distance=distance)
        # Also where nothing is set because it is set already.
        self._show(self._waiting or self._distance)

    def _change(self, parameter: str, value: Any) -> None:
        """Raise a ValueError where the value means nothing."""
        self._take(replace(self._waiting or self._distance, **{parameter: value}))


def _may_fail(distance: Distance) -> bool:
    """Whether its parameters may turn out wrong only when they are computed with."""
    return any(isinstance(one, File | Formula) for one in parameters_of(distance).values())
