"""Loops as files list them: the closing point, points that repeat the one before, and the numbers of all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.validation.file_numbering import FileNumbering
from idviewer.core.validation.tolerances import TOLERANCES


class ListedLoops(NamedTuple):
    """Loops without repeated points.

    Attributes:
        loops: (k, 2) points each, none of which repeats the one before.
        numbering: which listed point became which of these, all loops one after the other.
        notes: what was merged, in a sentence; empty where nothing was.
    """

    loops: list[Floats]
    numbering: FileNumbering
    notes: tuple[str, ...]


def without_repeated_points(loops: Sequence[Floats]) -> ListedLoops:
    """Leave out the last point of loops that repeats the first, and points that repeat the one before.

    A loop that is closed so is usual and not worth a note. Points repeat each other where they are nearer
    than rounding, 1e-12 of the diagonal of all.

    Args:
        loops: (k, 2) points each, as they are listed.

    >>> listed = without_repeated_points([np.array([[0.0, 0], [1, 0], [1, 0], [0, 1], [0, 0]])])
    >>> listed.numbering.became.tolist(), listed.numbering.closing.tolist(), listed.notes
    ([0, 1, 1, 2, 0], [4], ('1 point that repeats the one before was merged with it.',))
    """
    together = np.concatenate([np.empty((0, 2)), *loops])
    finite = together[np.isfinite(together).all(axis=1)]
    near = TOLERANCES.side_of_outline * float(np.linalg.norm(np.ptp(finite, axis=0))) if len(finite) else 0.0
    kept_loops: list[Floats] = []
    became: list[int] = []
    closing: list[int] = []
    for loop in loops:
        first, listed = sum(map(len, kept_loops)), len(became)
        closed = len(loop) > 1 and bool((loop[0] == loop[-1]).all())
        points = loop[:-1] if closed else loop
        numbers = _numbers_without_repeats(points, near)
        became += (first + numbers).tolist()
        if closed:
            closing.append(len(became))
            became.append(became[listed])
        kept_loops.append(points[np.unique(numbers, return_index=True)[1]])
    count = sum(map(len, kept_loops))
    numbering = FileNumbering.unchanged(len(became)).renumbered(np.array(became, dtype=np.int64))
    merged = len(became) - len(closing) - count
    return ListedLoops(kept_loops, numbering.with_closing(np.array(closing, dtype=np.int64)), _note(merged))


def _numbers_without_repeats(points: Floats, near: float) -> Ints:
    """The number of each point of a loop (k, 2), once those are merged that repeat the one before, (k,)."""
    steps = np.abs(points - np.roll(points, 1, axis=0)).max(axis=1, initial=0.0)
    numbers = np.arange(len(points))
    if len(points) < 2 or not (steps <= near).any():
        return numbers
    last = 0
    for place in range(1, len(points)):
        differs = bool(np.abs(points[place] - points[last]).max() > near)
        numbers[place] = numbers[place - 1] + differs
        last = place if differs else last
    # What the loop ends with may repeat its beginning.
    if last and np.abs(points[last] - points[0]).max() <= near:
        numbers[last:] = 0
    return numbers


def _note(merged: int) -> tuple[str, ...]:
    if merged == 0:
        return ()
    if merged == 1:
        return ("1 point that repeats the one before was merged with it.",)
    return (f"{merged:,} points that repeat the one before were merged with it.",)
