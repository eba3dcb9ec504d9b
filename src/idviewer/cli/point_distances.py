"""Distances of two points, or of a table of points from one."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from idviewer.cli import commands, discretisation, output, parsing
from idviewer.cli.options import Endpoints

if TYPE_CHECKING:
    from idviewer.cli.distance_options import ChosenDistance
    from idviewer.cli.parsing import Point
    from idviewer.core import InteriorDistance, Shape
    from idviewer.core.interior import Placement
    from idviewer.core.io import PointTable
    from idviewer.session import SpectrumCache

STANDARD_STREAM = "-"
NAMED_LINES = 8
"""So many lines of a table are named in a remark."""


@dataclass(frozen=True)
class WrittenPoint:
    """A point of the command line: the option, its text, and its coordinates."""

    option: str
    text: str
    point: Point


def of_pair(
    endpoints: Endpoints,
    shape: Callable[[], Shape],
    chosen: ChosenDistance,
    cache: SpectrumCache | None,
    json: bool,
) -> str:
    """The distance of two points, in words or JSON."""
    from idviewer.core.sampling import remarks_on_negativity

    texts = {"--from": endpoints.from_ or "", "--to": endpoints.to or ""}
    for option, text in texts.items():
        parsing.point_of(text, option)  # before a large file is read
    body = shape()
    written = [WrittenPoint(o, text, parsing.point_of(text, o, body.dimension)) for o, text in texts.items()]
    solver = commands.solver_of(body, chosen, cache)
    first, second = (placed_point(solver, one) for one in written)
    points = [one.point for one in written]
    inside, straight = float(solver.distance([first], [second])[0]), math.dist(*points)
    remarks = commands.remarks_on_weights(solver)
    levels = discretisation.discretisation_of(solver)
    error = None if levels is None else float(levels.errors([first], [second])[0])
    summary = None if levels is None else levels.summary
    negativity = solver.negativity([first, second])
    warnings = *remarks_on_negativity(negativity), *discretisation.warnings_of(summary)
    commands.print_remarks((*remarks, *warnings))
    if json:
        content = {**commands.distance_as_json(solver), "from": points[0], "to": points[1]}
        content |= {"interior": inside, "euclidean": straight, "error": error}
        content["negativity"] = negativity
        return output.as_json({**content, "discretisation": discretisation.as_json(summary)})
    within = f"; discretisation within about {error:.2g}" if error else ""
    return f"interior   {inside!r}  ({solver.description}{within})\nEuclidean  {straight!r}"


def from_source(
    endpoints: Endpoints,
    shape: Callable[[], Shape],
    chosen: ChosenDistance,
    cache: SpectrumCache | None,
    json: bool,
) -> str:
    """The distances of many points from one, as a table or JSON; null or empty where a point is outside."""
    from idviewer.core.interior import place_points
    from idviewer.core.sampling import remarks_on_negativity

    name, text = endpoints.points or "", endpoints.source or ""
    parsing.source_of(text)
    _check_out(endpoints.out)
    data = _bytes_of(name)
    body = shape()
    source = parsing.source_of(text, body.dimension)
    table = table_of(data, name, body.dimension)
    solver = commands.solver_of(body, chosen, cache)
    if source is None:
        source = tuple(solver.barycentroid().point.tolist())
        commands.print_remarks(commands.remarks_on_barycentroid(solver))
        begin = source
    else:
        begin = placed_point(solver, WrittenPoint("--source", text, source))
    placed = place_points(solver.coordinates, table.points, table.rounding)
    told = "standard input" if name == STANDARD_STREAM else name
    _tell_placement(solver, table, placed, told)
    values = [
        value if math.isfinite(value) else None for value in solver.field(begin, placed.points).tolist()
    ]
    remarks = commands.remarks_on_weights(solver)
    commands.print_remarks(_remarks_on_missing(values, table, placed, told))
    levels = discretisation.discretisation_of(solver)
    summary = None if levels is None else levels.summary
    negativity = solver.negativity(placed.points)
    warnings = *remarks_on_negativity(negativity), *discretisation.warnings_of(summary)
    commands.print_remarks((*remarks, *warnings))
    if json:
        points = table.points.tolist()
        content = {**commands.distance_as_json(solver), "source": source, "points": points}
        straight = [math.dist(source, point) for point in points]
        content |= {"interior": values, "euclidean": straight, "negativity": negativity}
        if levels is not None:
            errors = levels.errors(placed.points, [begin]).tolist()
            content["errors"] = [
                None if value is None else e for e, value in zip(errors, values, strict=True)
            ]
        return output.as_json({**content, "discretisation": discretisation.as_json(summary)})
    return _as_table(table, values)


def read_table(name: str, dimension: int) -> PointTable:
    """The points of a file, or of standard input."""
    return table_of(_bytes_of(name), name, dimension)


def _bytes_of(name: str) -> bytes:
    return sys.stdin.buffer.read() if name == STANDARD_STREAM else Path(name).read_bytes()


def placed_point(solver: InteriorDistance, written: WrittenPoint) -> Point:
    """A point of the command line; one hardly outside is taken onto the surface, which a remark tells.

    Raises:
        ValueError: it is outside.
    """
    import numpy as np

    from idviewer.core.interior import place_points
    from idviewer.core.io import rounding_of

    point = np.array([written.point])
    placed = place_points(solver.coordinates, point, rounding_of([written.text.split(",")], point))
    if len(placed.outside):
        raise ValueError(
            f"{written.option}: the point {output.coordinates(written.point)} lies outside "
            f"the {_kind(solver)}, {commands.box_in_words(solver.shape)}"
        )
    if len(placed.moved):
        commands.print_remarks([f"{written.option}: {_moved(solver, placed)}"])
    return tuple(placed.points[0].tolist())


def write(text: str, out: str | None) -> None:
    """Print a result, or write it to a file, which is there as a whole or not at all."""
    if out is None or out == STANDARD_STREAM:
        print(text)
        return
    from idviewer.core.io import atomic_path

    with atomic_path(out) as part:
        part.write_text(f"{text}\n", encoding="utf-8")


def _check_out(out: str | None) -> None:
    """Refuse a file that cannot be written before anything is computed."""
    if out is None or out == STANDARD_STREAM:
        return
    path = Path(out)
    if path.is_dir():
        raise ValueError(f"--out {out}: this is a folder; name a file in it")
    if not path.parent.is_dir():
        raise ValueError(f"--out {out}: there is no folder {path.parent}; make it first")


def table_of(data: bytes, name: str, dimension: int) -> PointTable:
    """The table of points in a file of that name.

    Raises:
        ValueError: it is none.
    """
    from idviewer.core.io import UnreadableError, read_points

    try:
        return read_points(data, dimension)
    except UnreadableError as error:
        where = "standard input" if name == STANDARD_STREAM else name
        mark = ", " if str(error).startswith("line ") else ": "
        raise ValueError(f"{where}{mark}{error}") from error


def _tell_placement(solver: InteriorDistance, table: PointTable, placed: Placement, name: str) -> None:
    """Tell which points are outside, and how many are taken for points of the surface.

    Raises:
        ValueError: all are outside.
    """
    count, outside = len(table.points), len(placed.outside)
    lines = _lines(table.lines[placed.outside].tolist())
    box = commands.box_in_words(solver.shape)
    if outside == count:
        point = output.coordinates(table.points[0])
        points = f"all {count} points, such as {point}, lie" if count > 1 else f"the point {point} lies"
        raise ValueError(f"{name}, {lines}: {points} outside the {_kind(solver)}, {box}")
    if outside:
        which = f"{outside} of {count} points {'lies' if outside == 1 else 'lie'}"
        commands.print_remarks([f"{name}, {lines}: {which} outside the {_kind(solver)}, {box}; no distance"])
    if len(placed.moved):
        commands.print_remarks([f"{name}: {_moved(solver, placed)}"])


def _moved(solver: InteriorDistance, placed: Placement) -> str:
    count = len(placed.moved)
    points = "1 point lies" if count == 1 else f"{count:,} points lie up to"
    how_far = f"{placed.farthest:.2g} outside the {_kind(solver)}"
    return f"{points} {how_far}, as far as digits round off, so the nearest point of the surface is taken"


def _remarks_on_missing(
    values: Sequence[float | None], table: PointTable, placed: Placement, name: str
) -> list[str]:
    """A remark on points that are inside and have no value all the same."""
    outside = set(placed.outside.tolist())
    missing = [row for row, value in enumerate(values) if value is None and row not in outside]
    if not missing:
        return []
    return [f"{name}, {_lines(table.lines[missing].tolist())}: no distance could be found inside there"]


def _lines(lines: list[int]) -> str:
    named = ", ".join(map(str, lines[:NAMED_LINES])) + (", ..." if len(lines) > NAMED_LINES else "")
    return f"line {named}" if len(lines) == 1 else f"lines {named}"


def _as_table(table: PointTable, values: Sequence[float | None]) -> str:
    """The rows as they were given, their coordinates with all digits, and the distances behind them."""
    place = {column: axis for axis, column in enumerate(table.columns)}
    rows: list[list[str | float | None]] = []
    for cells, point, value in zip(table.rows, table.points.tolist(), values, strict=True):
        given = [point[place[column]] if column in place else cell for column, cell in enumerate(cells)]
        rows.append([*given, value])
    names = [name.lower() if name.lower() in parsing.AXIS_NAMES else name for name in table.heading]
    own = "distance" if "distance" not in names else "interior_distance"
    return output.table([*names, own] if names else [], rows)


def _kind(solver: InteriorDistance) -> str:
    return "polygon" if solver.shape.dimension == 2 else "mesh"
