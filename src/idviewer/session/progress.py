"""Telling how far long work is."""

from __future__ import annotations

from collections.abc import Generator
from typing import TypeVar

from idviewer.session.state import Progress

Made = TypeVar("Made")


def with_progress(stage: str, steps: Generator[float | None, None, Made]) -> Generator[Progress, None, Made]:
    """Runs steps to their end and tells of them."""
    while True:
        try:
            share = next(steps)
        except StopIteration as stop:
            return stop.value
        yield Progress(stage, share)
