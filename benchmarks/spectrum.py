"""The eigenpairs by the paper's rule, beside the recipe that a user would write in ten lines."""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np
import peers
from bodies import Body, pebble
from settings import Settings
from table import Bar, Row
from timing import take_turns

from idviewer.core import eigenpairs

TITLE = "Preprocess: all eigenpairs below the cut-off"
NOTE = (
    "A pebble, which is a bumpy ellipsoid, and the bodies. Beside it SciPy's eigsh on "
    "SuperLU, which is told how many to ask for; the error is the largest relative difference of an "
    "eigenvalue. 540K vertices are measured without the recipe unless --patient asks for it."
)
TURNS, ONCE = 3, 100_000
"""Turns at most; bodies of more vertices than this take one."""

LONELY = 400_000
"""Vertices from which on the recipe takes a quarter of an hour and more."""

TIMES = {27_000: 4.0, 134_000: 8.0, 537_000: 15.0}
"""How many times as fast as the recipe it should be, by vertices."""

EQUAL = 1e-6
"""Largest relative difference between eigenvalues that count as equal."""


def rows(settings: Settings) -> Iterator[Row]:
    for body in settings.bodies:
        yield _row(body, settings, None)
    for vertices in settings.sizes:
        yield _row(Body(pebble(vertices)), settings, TIMES.get(vertices))


def _row(body: Body, settings: Settings, times: float | None) -> Row:
    start = time.perf_counter()
    spectrum = eigenpairs(body.mesh)  # which also wakes up what is asleep
    first = time.perf_counter() - start
    count, size = len(spectrum.values), len(body.mesh.vertices)
    what, on = f"{count} eigenpairs", f"{body.mesh.name}, {size / 1000:,.1f}K vertices"
    if size > LONELY and not settings.patient:
        return Row(what, on, first, "s", readme=True)
    found: list[np.ndarray] = []
    own, peer = take_turns(
        1 if size > ONCE else min(settings.turns, TURNS),
        lambda: eigenpairs(body.mesh),
        lambda: found.append(peers.recipe(body.mesh, count)),
    )
    return Row(
        what,
        on,
        own,
        "s",
        beside=("eigsh", peer),
        error=float(np.abs(spectrum.values / found[-1] - 1).max()),
        bar=None if times is None else Bar(times, EQUAL, ratio=True),
        readme=body.readme or times is not None,
    )
