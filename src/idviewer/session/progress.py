"""Progress of long work, as the user is told of it."""

from __future__ import annotations

from collections.abc import Generator
from typing import TypeVar

from idviewer.core.steps import map_steps
from idviewer.session.state import Progress

PREPARING_SLICES = "Preparing slices"

Made = TypeVar("Made")


def with_progress(stage: str, steps: Generator[float | None, None, Made]) -> Generator[Progress, None, Made]:
    """Run steps to their end and tell the share done of a stage."""
    return map_steps(lambda share: Progress(stage, share), steps)
