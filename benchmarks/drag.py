"""A dragged plane: from its new pose to the first frame, and to frames that are good enough."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from bodies import SEED, Body, inner_points
from settings import Settings
from table import Bar, Row
from timing import arrivals, percentile
from truth import frame_error, largest_on_slices

from idviewer.core import Plane
from idviewer.session.state import Frame, FrameRequest, Query, default_plane

TITLE = "A dragged plane: from its pose to frames"
NOTE = (
    "95th percentiles over the poses, medians beside them. A frame's error is checked against exact values "
    "at 250 of its points and around the worst 20 of these, as a share of the largest value on the slice, "
    "when the drag is over. After 0.6 s a pose is given up."
)
FIRST, TARGETS = Bar(12.0, error=5e-3), {1e-3: Bar(33.0, error=1e-3), 1e-4: Bar(200.0, error=1e-4)}
PATIENCE = 0.6
"""Seconds."""

FEWER = 4
"""On bodies that the README does not tell of, one in so many of the poses must do."""

WARM = 3
"""Poses that come before the first that counts."""

ROUNDING = 1e-9
"""What exact frames may be off by."""

Seen = list[tuple[float, Frame, float]]
"""Seconds from the pose, the frame, and its true error."""


def rows(settings: Settings) -> Iterator[Row]:
    for body in settings.bodies:
        stated: list[bool] = []
        count = settings.poses if body.readme else -(-settings.poses // FEWER)
        for kind, planes in poses(body, count).items():
            # Looked at after the last pose, as nobody does so in a drag either.
            timed = [_frames(body, plane) for plane in planes][WARM:]
            seen = [[(spent, one, frame_error(one, body.solver)) for spent, one in pose] for pose in timed]
            stated += [_tells_enough(frame, error) for one in seen for _, frame, error in one]
            yield from _rows(f"{len(seen)} {kind} poses", body, seen)
        kept = 100.0 * sum(stated) / max(1, len(stated))
        yield Row("frames with no larger error than they state", body.label, kept, "%", readme=body.readme)


def _tells_enough(frame: Frame, error: float) -> bool:
    return error <= frame.error / largest_on_slices(frame) + ROUNDING


def poses(body: Body, count: int) -> dict[str, list[Plane]]:
    """Planes through random points at random angles, and those of a slow drag that pushes and turns."""
    mesh, generator = body.mesh, np.random.default_rng(SEED)
    normals = generator.standard_normal((count + WARM, 3))
    origins = inner_points(mesh, 1000)[: count + WARM]
    random = [Plane(tuple(o), tuple(n)) for o, n in zip(origins.tolist(), normals.tolist(), strict=True)]
    first = default_plane(mesh)
    depth = float(np.ptp(mesh.vertices @ np.array(first.normal)))
    tilts = np.linspace(0.0, math.pi / 4, count + WARM)
    shifts = np.linspace(-0.15, 0.15, count + WARM) * depth
    drag = [_turned(first.moved(shift), tilt) for shift, tilt in zip(shifts, tilts, strict=True)]
    return {"random": random, "consecutive": drag}


def _turned(plane: Plane, angle: float) -> Plane:
    normal = math.cos(angle) * np.array(plane.normal) + math.sin(angle) * plane.basis[0]
    return Plane(plane.origin, tuple(normal.tolist()))


def _frames(body: Body, plane: Plane) -> list[tuple[float, Frame]]:
    """The frames of a pose up to the first that claims to be good enough for the strictest target."""
    seen = []
    results = body.pipeline.results(FrameRequest(body.mesh, Query(planes=(plane,))))
    for spent, frame in arrivals(results, PATIENCE):
        if isinstance(frame, Frame):
            seen.append((spent, frame))
            if frame.error <= min(TARGETS) * largest_on_slices(frame):
                break
    results.close()  # type: ignore[attr-defined]
    return seen


def _rows(poses: str, body: Body, seen: list[Seen]) -> Iterator[Row]:
    yield _row(f"first frame, {poses}", body, [one[0] if one else None for one in seen], FIRST)
    for target, bar in TARGETS.items():
        good = [next((two for two in one if two[2] <= target), None) for one in seen]
        yield _row(f"within {target:.0e}, {poses}", body, good, bar)


def _row(what: str, body: Body, frames: list[tuple[float, Frame, float] | None], bar: Bar) -> Row:
    spent = [math.inf if one is None else 1e3 * one[0] for one in frames]
    return Row(
        what,
        body.label,
        percentile(spent, 95),
        "ms",
        beside=("median", percentile(spent, 50)),
        error=max((one[2] for one in frames if one is not None), default=None),
        bar=bar,
        readme=body.readme,
    )
