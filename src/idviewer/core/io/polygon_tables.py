"""Outlines in tables: which columns are x and y, and where one loop or one shape ends."""

from __future__ import annotations

import math
import re
from bisect import bisect
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.degrees import projected, within_degrees
from idviewer.core.io.outlines import Outline, chosen_outline
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.text_tables import TextTable, table_of, text_of

Row = tuple[int, list[str]]
"""The number of a line, and its cells."""

_AXIS = re.compile(
    r"(?:pos|position|coord|point|vertex|p)?[ _.]*([xyz])[ _.]*(?:pos|position|coord|coordinate)?$"
)
_AXIS_NAMES = {"easting": "x", "northing": "y", "lon": "lon", "long": "lon", "lng": "lon", "longitude": "lon"}
_AXIS_NAMES |= {"lat": "lat", "latitude": "lat", "height": "z", "elevation": "z", "altitude": "z"}
_UNIT = re.compile(r"[ _]*[\[(]([^\])]*)[\])]$|[ _](mm|cm|m|km|um|µm|nm|px|in|ft|deg)$")
UNITS = ("mm", "cm", "m", "km", "um", "µm", "nm", "px", "in", "ft")
"""Units of length that a column's name may end with, "x_mm" or "x [mm]"."""


@dataclass(frozen=True)
class Columns:
    """The columns that hold points.

    Attributes:
        x: number of the column.
        y: likewise.
        passed_over: what the others are, in words.
        unit: of the numbers; "degrees" for longitude and latitude.
        others: numbers of columns that a header names and that may tell shapes apart.
    """

    x: int
    y: int
    passed_over: tuple[str, ...] = ()
    unit: str = ""
    others: tuple[int, ...] = ()


def read_csv(source: FileSource) -> Contents[list[Floats]]:
    r"""Read the loops of a table, x and y a line; loops are apart by lines that are blank or hold nan.

    Columns go by a header, or else are x and y, with a running number before and a constant behind them
    perhaps. Where a column named otherwise changes its value every three lines or later, it tells several
    shapes apart. Longitude and latitude are projected.

    Args:
        source: the file, with the name of the shape to take.

    Raises:
        UnreadableError: a line does not hold two finite numbers, it is not clear which, or there are none.

    >>> from pathlib import Path
    >>> read = read_csv(FileSource(b"n;x;y\n1;0,5;0\n2;1;0\n3;0;1\n", Path("a.csv")))
    >>> read.geometry[0].tolist(), len(read.notes)
    ([[0.5, 0.0], [1.0, 0.0], [0.0, 1.0]], 2)
    """
    text = text_of(source.data)
    table = table_of(text)
    rows = list(zip(table.lines, table.rows, strict=True))
    if rows and all(table.number(cell) is None for cell in rows[0][1]):
        rows = rows[1:]  # units below the heading, or a heading alone
    if not rows:
        raise UnreadableError("it holds no points")
    columns = _named_columns(table, rows) or _unnamed_columns(table, rows)
    notes = [f"The column of {what} was passed over." for what in columns.passed_over]
    if table.decimal_comma:
        notes.append("Commas in numbers were read as decimal points.")
    groups = _groups(rows, columns)
    breaks = [number for number, line in enumerate(text.splitlines(), 1) if not line.strip(" \t,;")]
    outlines = [Outline(tuple(_loops(table, columns, rows, breaks)), name) for name, rows in groups]
    outlines = [one for one in outlines if one.loops]
    if not outlines:
        raise UnreadableError("it holds no points")
    unit = columns.unit
    if unit == "degrees":
        if not within_degrees(np.concatenate([loop for one in outlines for loop in one.loops])):
            raise UnreadableError("its longitudes or latitudes go beyond 180 or 90 degrees")
        outlines, unit = [projected(one) for one in outlines], "m"
    if len(groups) == 1:
        source.refuse_part()
    outline = chosen_outline(source, outlines, "shapes", unit)
    return Contents(list(outline.loops), (*notes, *outline.notes), unit)


def _axis_and_unit(name: str) -> tuple[str, str]:
    """The axis that a column's name tells, or an empty text, and its unit."""
    lower = name.strip().lower()
    found = _UNIT.search(lower)
    unit = (found[1] or found[2] or "").strip() if found else ""
    bare = lower[: found.start()] if found else lower
    axis = _AXIS.match(bare)
    return (axis[1] if axis else _AXIS_NAMES.get(bare, "")), unit


def _named_columns(table: TextTable, rows: Sequence[Row]) -> Columns | None:
    """The columns that a header names x and y, or longitude and latitude; None where it does not."""
    header = table.heading
    if rows and header and len(header) == len(rows[0][1]) - 1:
        header = ["", *header]  # R writes no name over the column of rows' names
    axes = [_axis_and_unit(name) for name in header]
    names = [axis for axis, _ in axes]
    for first, second in (("x", "y"), ("lon", "lat")):
        if names.count(first) == 1 and names.count(second) == 1:
            x, y = names.index(first), names.index(second)
            break
    else:
        return None
    unit = "degrees" if first == "lon" else axes[x][1] if axes[x][1] == axes[y][1] else ""
    others = tuple(i for i in range(len(header)) if i not in (x, y))
    if table.width != len(header):
        raise _row_error(*rows[0], f"has {table.width} columns, and the heading {len(header)}")
    points = [cells for _, cells in rows if cells[x] or cells[y]]
    dropped = []
    for i in others:
        values = [cells[i] for cells in points]
        if not _is_running(table, values):
            dropped.append(i)
    titles = tuple(f"{header[i].strip()[:30]!a}" if header[i].strip() else "running numbers" for i in others)
    unit = unit if unit in ("degrees", *UNITS) else ""
    return Columns(x, y, titles, unit, tuple(dropped))


def _unnamed_columns(table: TextTable, rows: Sequence[Row]) -> Columns:
    """The columns x and y by what they hold.

    Raises:
        UnreadableError: there are too few, or more without a running number or a constant.
    """
    width = table.width
    if width == 2:
        return Columns(0, 1)
    if width < 2:
        raise _row_error(*rows[0], "is not x,y")
    points = [cells for _, cells in rows if not _is_break(table, cells[-2:])]
    running = _is_running(table, [cells[0] for cells in points])
    constant = len({table.number(cells[-1]) for cells in points}) == 1
    if width == 3 and constant:
        return Columns(0, 1, ("heights, which are all the same,",))
    if width == 3 and running:
        return Columns(1, 2, ("running numbers",))
    if width == 4 and running and constant:
        return Columns(1, 2, ("running numbers", "heights, which are all the same,"))
    raise UnreadableError(
        f"its lines have {width} cells, and it is not clear which two are x and y; name them in a first line"
    )


def _is_running(table: TextTable, cells: Sequence[str]) -> bool:
    """Whether cells count up one by one, from anywhere."""
    numbers = [table.number(cell) for cell in cells]
    if len(numbers) < 3 or numbers[0] is None or not numbers[0].is_integer():
        return False
    return numbers == [numbers[0] + place for place in range(len(numbers))]


def _is_break(table: TextTable, cells: Sequence[str]) -> bool:
    """Whether x and y are left empty, or are nan."""
    return all(not cell or math.isnan(table.number(cell) or 0.0) for cell in cells)


def _groups(rows: Sequence[Row], columns: Columns) -> list[tuple[str, list[Row]]]:
    """Rows of each shape, and its name: all, or those of each value of a column that tells shapes apart."""
    for column in columns.others:
        groups: list[tuple[str, list[Row]]] = []
        for row in rows:
            value = row[1][column]
            if groups and (not value or value == groups[-1][0]):
                groups[-1][1].append(row)
            elif value:
                groups.append((value, [row]))
        names = [name for name, _ in groups]
        if len(groups) > 1 and len(set(names)) == len(names) and min(len(rows) for _, rows in groups) > 2:
            return groups
    return [("", list(rows))]


def _loops(table: TextTable, columns: Columns, rows: Sequence[Row], breaks: Sequence[int]) -> list[Floats]:
    """Points (k, 2) of each loop: a new one begins behind lines that are blank, or hold no point.

    Args:
        table: for its decimal sign.
        columns: of x and y.
        rows: of one shape.
        breaks: numbers of the blank lines of the file, ascending.
    """
    loops: list[list[tuple[float, float]]] = [[]]
    last = 0
    for number, cells in rows:
        wanted = [cells[columns.x], cells[columns.y]]
        if bisect(breaks, number) > bisect(breaks, last):
            loops.append([])
        last = number
        if _is_break(table, wanted):
            loops.append([])
            continue
        x, y = map(table.number, wanted)
        if x is None or y is None:
            raise _row_error(number, cells, "stands where two numbers belong")
        if not (math.isfinite(x) and math.isfinite(y)):
            raise _row_error(number, cells, "is not finite")
        loops[-1].append((x, y))
    return [np.array(loop) for loop in loops if loop]


def _row_error(number: int, cells: Sequence[str], problem: str) -> UnreadableError:
    return UnreadableError(f"line {number}: {','.join(cells)[:30]!a} {problem}")
