"""The eigenpairs by the paper's rule, beside the recipe that a user would write in ten lines."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import peers
from bodies import Body
from settings import Settings
from table import Row
from timing import take_turns

from idviewer.core import eigenpairs

TITLE = "Preprocess: all eigenpairs below the cut-off"
NOTE = (
    "Beside it SciPy's eigsh on SuperLU, which is told how many to ask for; "
    "the error is the largest relative difference of an eigenvalue."
)
TURNS = 3
"""At most."""


def rows(settings: Settings) -> Iterator[Row]:
    for body in settings.bodies:
        yield _row(body, min(settings.turns, TURNS))


def _row(body: Body, turns: int) -> Row:
    values = eigenpairs(body.mesh).values
    reference = peers.recipe(body.mesh, len(values))
    own, peer = take_turns(turns, lambda: eigenpairs(body.mesh), lambda: peers.recipe(body.mesh, len(values)))
    return Row(
        f"{len(values)} eigenpairs",
        body.label,
        own,
        "s",
        beside=("eigsh", peer),
        error=float(np.abs(values / reference - 1).max()),
        readme=body.readme,
    )
