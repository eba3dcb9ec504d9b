"""The embedding of many inner points within a tolerance, beside VTK's weights of them alone."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import peers
from bodies import Body, Floats, inner_points
from settings import Settings
from table import Bar, Row
from timing import seconds_of, take_turns
from truth import embedding_error

from idviewer.core import InteriorDistance
from idviewer.core.interior import extent

TITLE = "Embedding of 8,000 inner points, a point of them"
NOTE = (
    "VTK computes the weights alone, here of 16 of the points. The error is the largest of a distance "
    "between two of the points, as a share of the largest boundary distance. Building includes one point."
)
POINTS, THEIRS = 8000, 16
TIMES = {1e-3: 5000.0, 1e-4: None, 1e-5: 1000.0}
"""By tolerance, how many times as quick as VTK it should be on a large body."""

BUILT_IN = 0.5
"""Seconds."""


def rows(settings: Settings) -> Iterator[Row]:
    for body in settings.bodies:
        points = inner_points(body.mesh, POINTS)
        exact = body.solver.embed(points)
        yield from _build_rows(body, settings.turns)
        for rtol in TIMES:
            yield _row(body, rtol, points, exact, settings.turns)


def _build_rows(body: Body, turns: int) -> Iterator[Row]:
    point = inner_points(body.mesh, 1)
    for rtol in TIMES:
        solvers = [_solver(body, rtol) for _ in range(turns)]
        spent = sorted(seconds_of(partial(solver.embed, point)) for solver in solvers)[turns // 2]
        bar = Bar(BUILT_IN) if body.large else None
        told = body.readme and rtol == max(TIMES)
        yield Row(f"tree built for {rtol:.0e}", body.label, spent, "s", bar=bar, readme=told)


def _row(body: Body, rtol: float, points: Floats, exact: Floats, turns: int) -> Row:
    solver, theirs = _solver(body, rtol), peers.VtkWeights(body.mesh)
    computed = solver.embed(points)
    own, peer = take_turns(turns, lambda: solver.embed(points), lambda: theirs(points[:THEIRS]))
    times = TIMES[rtol]
    return Row(
        f"embedding within {rtol:.0e}",
        body.label,
        own / len(points) * 1e6,
        "µs",
        beside=("VTK's weights", peer / THEIRS * 1e6),
        error=embedding_error(computed, exact, extent(solver.boundary.embedding)),
        bar=Bar(times, error=rtol, ratio=True) if body.large and times is not None else None,
        readme=body.readme and times is not None,
    )


def _solver(body: Body, rtol: float) -> InteriorDistance:
    return InteriorDistance(body.mesh, rtol=rtol, spectrum=body.solver.spectrum)
