"""GeoJSON (RFC 7946): the polygons of geometries, collections and features."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.degrees import projected, system_is_degrees, why_lengths
from idviewer.core.io.outlines import Outline, chosen_outline
from idviewer.core.io.text import UnreadableError

NAME_PROPERTIES = ("name", "title", "label", "id")
"""Properties that name a feature, in any case of letters, the first that there is."""


def is_geojson(content: Any) -> bool:
    """Whether a JSON value says that it is an object of GeoJSON.

    >>> is_geojson({"type": "Polygon", "coordinates": []}), is_geojson([[0, 0]])
    (True, False)
    """
    return isinstance(content, dict) and isinstance(content.get("type"), str)


def read_geojson(content: dict[str, Any], source: FileSource) -> Contents[list[Floats]]:
    """The one polygon in GeoJSON, or the chosen one. Degrees are projected to metres.

    A polygon goes by its feature's name or id; one of several in a feature by that and its number, "field/2".

    Args:
        content: of the file.
        source: the file, with the name of the polygon to take.

    Raises:
        PartError: there are several polygons and none is chosen, or there is none of that name.
        UnreadableError: there is no polygon, or a list is no polygon's.

    >>> from pathlib import Path
    >>> read_geojson({"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [0, 1]]]},
    ...              FileSource(b"", Path("a.geojson"))).notes[0][:46]
    'Coordinates were taken for lengths although Ge'
    """
    outlines: list[Outline] = []
    others: list[str] = []
    for feature, where in _features(content, ""):
        _gather(feature, where, outlines, others)
    if not outlines:
        held = f"; it holds {', '.join(sorted(set(others)))[:60]}" if others else ""
        raise UnreadableError(f"GeoJSON of the type {content['type'][:30]!a} holds no Polygon{held}")
    notes = []
    if others:
        kinds = ", ".join(sorted(set(others)))[:60]
        notes.append(f"What has no area was passed over ({len(others):,}: {kinds}).")
    degrees, told = _are_degrees(content, outlines)
    if degrees:
        outlines, unit = [projected(one) if _has_points(one) else one for one in outlines], "m"
    else:
        unit = ""
    outline = chosen_outline(source, outlines, "polygons", unit)
    return Contents(list(outline.loops), (*notes, *told, *outline.notes), unit)


def _has_points(outline: Outline) -> bool:
    return any(map(len, outline.loops))


def _features(content: Any, where: str) -> Iterator[tuple[Any, str]]:
    """Features of a collection, or what there is instead, and where it is."""
    if isinstance(content, dict) and content.get("type") == "FeatureCollection":
        features = content.get("features")
        if not isinstance(features, list):
            raise UnreadableError('its "features" are no list')
        for number, feature in enumerate(features):
            yield feature, f"features[{number}]."
    else:
        yield content, where


def _gather(feature: Any, where: str, outlines: list[Outline], others: list[str]) -> None:
    """Add the outlines of a feature or geometry, and the types of what is none."""
    if not isinstance(feature, dict):
        raise UnreadableError(f"{where.rstrip('.') or 'it'} is {json.dumps(feature)[:30]}, not a feature")
    names: list[str] = []
    geometry: Any = feature
    if feature.get("type") == "Feature":
        names, geometry = _names(feature), feature.get("geometry")
        where += "geometry."
    polygons = [] if geometry is None else list(_polygons(geometry, where, others))
    for number, loops in enumerate(polygons, 1):
        if len(polygons) == 1:
            outlines.append(Outline(loops, names[0] if names else "", tuple(names)))
        else:
            first = f"{names[0]}/{number}" if names else ""
            others_of = (*names, *(f"{name}/{number}" for name in names[1:]))
            outlines.append(Outline(loops, first, others_of))


def _names(feature: dict[str, Any]) -> list[str]:
    properties = feature.get("properties")
    lower = (
        {str(key).lower(): value for key, value in properties.items()} if isinstance(properties, dict) else {}
    )
    given = [lower.get(key) for key in NAME_PROPERTIES] + [feature.get("id")]
    names = [str(name) for name in given if isinstance(name, str | int | float) and str(name).strip()]
    return list(dict.fromkeys(names))


def _polygons(geometry: Any, where: str, others: list[str]) -> Iterator[tuple[Floats, ...]]:
    """Loops of each polygon in a geometry."""
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if kind == "GeometryCollection":
        for number, member in enumerate(_list(geometry, "geometries", where)):
            yield from _polygons(member, f"{where}geometries[{number}].", others)
    elif kind == "Polygon":
        yield _loops(_list(geometry, "coordinates", where), f"{where}coordinates")
    elif kind == "MultiPolygon":
        for number, polygon in enumerate(_list(geometry, "coordinates", where)):
            yield _loops(polygon, f"{where}coordinates[{number}]")
    else:
        others.append(str(kind)[:30])


def _list(holder: dict[str, Any], key: str, where: str) -> list[Any]:
    value = holder.get(key)
    if not isinstance(value, list):
        raise UnreadableError(f"{where}{key} is no list")
    return value


def _loops(rings: Any, where: str) -> tuple[Floats, ...]:
    if not isinstance(rings, list):
        raise UnreadableError(f"{where} is not a list of rings")
    return tuple(loop_of(ring, f"{where}[{number}]") for number, ring in enumerate(rings) if ring)


def loop_of(points: Any, where: str) -> Floats:
    """Points (k, 2) of a JSON list; heights and what else follows is left out.

    Args:
        points: the list.
        where: in the file it is, for messages.

    Raises:
        UnreadableError: it is no list of numbers [x, y] or [x, y, z].

    >>> loop_of([[0, 0, 7], [1, 0, 7]], "ring").tolist()
    [[0.0, 0.0], [1.0, 0.0]]
    """
    if not isinstance(points, list):
        raise UnreadableError(f"{where} is not a list of [x, y]")
    for i, point in enumerate(points):
        if not (isinstance(point, list) and len(point) in (2, 3, 4) and all(map(is_number, point))):
            raise UnreadableError(f"{where}[{i}] is {json.dumps(point)[:30]}, not [x, y]")
    return np.array([point[:2] for point in points], dtype=np.float64).reshape(-1, 2)


def is_number(value: Any) -> bool:
    """Whether a JSON value is a number that a coordinate can have.

    >>> is_number(1.5), is_number(True), is_number(float("nan"))
    (True, False, False)
    """
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300


def _are_degrees(content: dict[str, Any], outlines: list[Outline]) -> tuple[bool, tuple[str, ...]]:
    """Whether the coordinates are degrees, and the note if they are not."""
    points = np.concatenate([np.empty((0, 2)), *(loop for one in outlines for loop in one.loops)])
    if not len(points):
        return False, ()
    system = _system(content)
    known = system_is_degrees(system, points) if system else None
    if known is False:
        return False, (
            f"Coordinates were taken for lengths in the unit of {system[:40]}, which the file names.",
        )
    why = "" if known else why_lengths(outlines)
    if not why:
        return True, ()
    return False, (
        f'Coordinates were taken for lengths although GeoJSON has degrees: {why}; a member "crs" that names '
        "EPSG:4326 says otherwise.",
    )


def _system(content: dict[str, Any]) -> str:
    """The name of the system of coordinates; empty if there is none."""
    crs = content.get("crs")
    properties = crs.get("properties") if isinstance(crs, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else None
    return name if isinstance(name, str) else ""
