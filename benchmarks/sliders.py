"""What needs no new samples: another source and another diffusion time on a slice that is complete."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from bodies import SEED, Body
from settings import Settings
from table import Bar, Row
from timing import arrivals, percentile
from truth import frame_error

from idviewer.core import Diffusion, Plane
from idviewer.session.state import Frame, FrameRequest, Point, Query, default_plane

TITLE = "A moved source and the slider of the diffusion time, on a complete slice"
NOTE = "Medians over 20 first frames, 95th percentiles beside them; errors as for the dragged plane."
MOVES = 20
SOURCE_MOVE = Bar(5.0)


def rows(settings: Settings) -> Iterator[Row]:
    for body in settings.bodies:
        plane = default_plane(body.mesh)
        *_, full = _frames(body, Query(planes=(plane,)))
        sources = _some_points(full[1])
        size = f"{len(full[1].slices[0].points):,} points"
        moved = [Query(planes=(plane,), source=source) for source in sources]
        yield _row(f"source moved, {size}", body, moved, SOURCE_MOVE)
        yield _row(f"time changed, {size}", body, _times(body, plane, sources[0]), None)


def _some_points(frame: Frame) -> list[Point]:
    points = np.random.default_rng(SEED).permutation(frame.slices[0].points)[:MOVES]
    return [(x, y, z) for x, y, z in points.tolist()]


def _times(body: Body, plane: Plane, source: Point) -> list[Query]:
    middle = Diffusion().resolved_time(float(body.solver.spectrum.values[0]))
    times = middle * np.geomspace(1 / 4, 16, MOVES + 1)[1:]
    return [Query(planes=(plane,), source=source, distance=Diffusion(float(time))) for time in times]


def _row(what: str, body: Body, queries: list[Query], bar: Bar | None) -> Row:
    first = [next(_frames(body, query)) for query in queries]
    spent = [1e3 * seconds for seconds, _ in first]
    return Row(
        what,
        body.label,
        percentile(spent, 50),
        "ms",
        beside=("95 %", percentile(spent, 95)),
        error=max(frame_error(frame, body.solver) for _, frame in first),
        bar=bar,
        readme=body.readme,
    )


def _frames(body: Body, query: Query) -> Iterator[tuple[float, Frame]]:
    for spent, result in arrivals(body.pipeline.results(FrameRequest(body.mesh, query))):
        if isinstance(result, Frame):
            yield spent, result
