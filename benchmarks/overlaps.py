"""Seconds that the search for faces that cross each other adds to opening a mesh."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from bodies import pebble
from settings import Settings
from table import Bar, Row
from timing import take_turns

from idviewer.core.validation.self_intersections import self_intersections_of

TITLE = "Opening: the search for faces that cross each other"
NOTE = "A pebble, none of whose faces cross: every pair of boxes that meet is looked at."

SEARCH = {43_000: Bar(0.5)}


def rows(settings: Settings) -> Iterator[Row]:
    for vertices in settings.sizes:
        mesh = pebble(vertices)
        search = partial(self_intersections_of, mesh.vertices, mesh.faces)
        (seconds,) = take_turns(settings.turns, search)
        on = f"{len(mesh.faces):,} faces"
        yield Row("search for crossing faces", on, seconds, "s", bar=SEARCH.get(vertices))
