"""Outlines: the polygons that a file holds, of which one is taken."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.errors import Part
from idviewer.core.io.contents import FileSource
from idviewer.core.io.text import UnreadableError


@dataclass(frozen=True)
class Outline:
    """One polygon of a file.

    Attributes:
        loops: (k, 2) points of each, the outer one first.
        name: by which messages call it; empty where the file has no name for it.
        other_names: further ones by which it can be chosen.
        notes: on it alone, one sentence each.
    """

    loops: tuple[Floats, ...]
    name: str = ""
    other_names: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def extent(self) -> tuple[float, float]:
        """Width and height of the bounding box; zero where there are no points."""
        points = np.concatenate([np.empty((0, 2)), *self.loops])
        if not len(points):
            return 0.0, 0.0
        width, height = np.ptp(points, axis=0).tolist()
        return width, height


def chosen_outline(source: FileSource, outlines: Sequence[Outline], kind: str, unit: str = "") -> Outline:
    """The one outline of a file, or the one that is asked for.

    Args:
        source: the file, with the name of the outline to take.
        outlines: those in it, in its order.
        kind: what they are called there, in the plural.
        unit: of their coordinates, for messages.

    Raises:
        PartError: there are several and none is chosen, or there is none of that name.
        UnreadableError: there is none at all.

    >>> from pathlib import Path
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> both = [Outline((square,), "left"), Outline((square + 2,), "right")]
    >>> chosen_outline(FileSource(b"", Path("a.json"), "right"), both, "features").name
    'right'
    """
    if not outlines:
        raise UnreadableError(f"it holds no {kind}")
    names = unique_names([one.name for one in outlines])
    parts = [Part(name, _size(one, unit)) for name, one in zip(names, outlines, strict=True)]
    number = source.chosen(parts, kind, [one.other_names for one in outlines])
    assert number is not None
    if not any(map(len, outlines[number].loops)):
        raise UnreadableError("it holds no points")
    return outlines[number]


def unique_names(names: Sequence[str]) -> list[str]:
    """Names of which no two are the same: where there is none, or twice the same, the place in the file.

    Args:
        names: as the file gives them.

    >>> unique_names(["yard", "", "shed", "yard"])
    ['yard #1', '2', 'shed', 'yard #4']
    """
    counts = Counter(names)
    taken = {name for name in names if name}
    unique = []
    for place, name in enumerate(names, 1):
        if not name or counts[name] > 1:
            free = not name and str(place) not in taken
            name = str(place) if free else f"{name} #{place}".strip()
        unique.append(name)
    return unique


def _size(outline: Outline, unit: str) -> str:
    width, height = outline.extent
    return f"{width:.4g} x {height:.4g}{' ' if unit else ''}{unit}"
