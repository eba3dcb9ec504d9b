"""JSON of polygons: lists of points, an outline with holes, GeoJSON, and what image annotators write."""

from __future__ import annotations

import json
from typing import Any

from idviewer.core.arrays import Floats
from idviewer.core.io.annotations import annotated_outlines
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.geojson import is_geojson, loop_of, read_geojson
from idviewer.core.io.outlines import chosen_outline
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.text_tables import text_of

WHAT_IS_READ = (
    'a list of [x, y], "outer" and "holes", GeoJSON with a Polygon, or what labelme, COCO and VIA write'
)


def read_json(source: FileSource) -> Contents[list[Floats]]:
    """Read the polygon, or the chosen one, of a JSON file.

    Args:
        source: the file, with the name of the polygon to take.

    Raises:
        UnreadableError: it is no JSON, or holds none of what is read.

    >>> from pathlib import Path
    >>> data = b'{"outer": [[0, 0], [1, 0], [0, 1]], "holes": []}'
    >>> [len(loop) for loop in read_json(FileSource(data, Path("a.json"))).geometry]
    [3]
    """
    try:
        content = json.loads(text_of(source.data))
    except json.JSONDecodeError as error:
        raise UnreadableError(f"line {error.lineno}: {error.msg[:1].lower()}{error.msg[1:]}") from error
    except RecursionError:
        raise UnreadableError("its lists are nested too deeply") from None
    if is_geojson(content):
        return read_geojson(content, source)
    if (annotated := annotated_outlines(content)) is not None:
        outline = chosen_outline(source, annotated.outlines, annotated.kind, "px")
        return Contents(list(outline.loops), (*annotated.notes, *outline.notes), "px")
    source.refuse_part()
    return Contents(_plain(content))


def _plain(content: Any) -> list[Floats]:
    if isinstance(content, list):
        return [loop_of(content, "the list")]
    if isinstance(content, dict) and "outer" in content:
        holes = content.get("holes", [])
        if not isinstance(holes, list):
            raise UnreadableError('"holes" is not a list of loops')
        loops = [(content["outer"], "outer"), *((hole, f"holes[{i}]") for i, hole in enumerate(holes))]
        return [loop_of(points, where) for points, where in loops]
    raise UnreadableError(f"it holds none of these: {WHAT_IS_READ}")
