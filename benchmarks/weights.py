"""Exact mean value weights of a point, beside vtkMeanValueCoordinatesInterpolator."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import peers
from bodies import Body, inner_points
from settings import Settings
from table import Bar, Row
from timing import take_turns

from idviewer.core import MeanValueCoordinates

TITLE = "Exact weights of a point"
NOTE = "The error is the largest difference to VTK's weights."
OURS, THEIRS = 64, 16
"""Points a call. Of more, results take over 32 MB, which the system gives anew each time, and slowly."""


def rows(settings: Settings) -> Iterator[Row]:
    for body in settings.bodies:
        yield _row(body, settings.turns)


def _row(body: Body, turns: int) -> Row:
    points = inner_points(body.mesh, OURS)
    few = points[:THEIRS]
    ours, theirs = MeanValueCoordinates(body.mesh), peers.VtkWeights(body.mesh)
    difference = float(np.abs(ours.weights(few) - theirs(few)).max())
    own, peer = take_turns(turns, lambda: ours.weights(points), lambda: theirs(few))
    return Row(
        "weights, every face",
        body.label,
        own / len(points) * 1e6,
        "µs",
        beside=("VTK", peer / len(few) * 1e6),
        error=difference,
        bar=Bar(60.0, error=1e-10, ratio=True) if body.large else None,
        readme=body.readme,
    )
