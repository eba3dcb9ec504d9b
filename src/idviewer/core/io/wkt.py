"""Well-known text: the polygons of its geometries, also with the number of a system of coordinates."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import shapely

from idviewer.core.arrays import Floats
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.degrees import projected, system_is_degrees
from idviewer.core.io.outlines import Outline, chosen_outline
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.text_tables import text_of

_SYSTEM = re.compile(r"\s*SRID\s*=\s*(\d+)\s*;", re.IGNORECASE)
_START = re.compile(r"\s*(SRID\s*=|[A-Z]+\s*(ZM|Z|M)?\s*(\(|EMPTY))", re.IGNORECASE)


def read_wkt(source: FileSource) -> Contents[list[Floats]]:
    """Read the polygon, or the chosen one, of well-known text; there may be one geometry a line.

    Heights and measures are left out. Degrees, which only "SRID=4326;" and such tell, are projected.

    Args:
        source: the file, with the number of the polygon to take.

    Raises:
        UnreadableError: it is no well-known text, or there is no polygon.

    >>> from pathlib import Path
    >>> data = b"SRID=25832;POLYGON Z ((0 0 7, 1 0 7, 0 1 7, 0 0 7))"
    >>> [loop[:2].tolist() for loop in read_wkt(FileSource(data, Path("a.wkt"))).geometry]
    [[[0.0, 0.0], [1.0, 0.0]]]
    """
    text = text_of(source.data)
    systems = {found[1] for found in map(_SYSTEM.match, text.splitlines()) if found}
    if len(systems) > 1:
        raise UnreadableError(f"its geometries are in several systems, SRID {' and '.join(sorted(systems))}")
    outlines: list[Outline] = []
    others: list[str] = []
    for geometry in _geometries(text):
        for part in _parts(geometry):
            if part.geom_type == "Polygon":
                rings = shapely.get_rings(part)
                outlines.append(Outline(tuple(shapely.get_coordinates(ring) for ring in rings)))
            else:
                others.append(part.geom_type.upper())
    if not outlines:
        raise UnreadableError(
            f"a {', '.join(sorted(set(others)))[:60] or 'collection without parts'} is no POLYGON"
        )
    notes = []
    if others:
        kinds = ", ".join(sorted(set(others)))[:60]
        notes.append(f"What has no area was passed over ({len(others):,}: {kinds}).")
    points = np.concatenate([np.empty((0, 2)), *(loop for one in outlines for loop in one.loops)])
    degrees = any(system_is_degrees(f"EPSG:{system}", points) for system in systems)
    if degrees and len(points):
        outlines = [projected(one) if any(map(len, one.loops)) else one for one in outlines]
    unit = "m" if degrees else ""
    outline = chosen_outline(source, outlines, "polygons", unit)
    return Contents(list(outline.loops), (*notes, *outline.notes), unit)


def _geometries(text: str) -> Iterator[Any]:
    """The geometries of a text: one over all lines, or one a line."""
    lines = [line for line in text.splitlines() if line.strip()]
    apart = len(lines) > 1 and all(_START.match(line) for line in lines)
    for number, line in enumerate(lines if apart else [text], 1):
        try:
            with np.errstate(over="ignore"):  # infinite coordinates are refused later
                yield shapely.from_wkt(_SYSTEM.sub("", line, count=1))
        except shapely.errors.ShapelyError as error:
            cause = str(error).rpartition("Exception: ")[2]
            raise UnreadableError(f"line {number}: {cause}" if apart else cause) from None


def _parts(geometry: Any) -> Iterator[Any]:
    """The single geometries in collections of collections."""
    for part in shapely.get_parts(geometry):
        yield from _parts(part) if hasattr(part, "geoms") else (part,)
