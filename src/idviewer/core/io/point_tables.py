"""Tables of points as people and programs write them, and how finely their numbers are written."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.text_tables import TextTable, table_of, text_of

AXIS_NAMES = ("x", "y", "z")
COUNT_WORDS = {2: "two", 3: "three"}

AXIS_PATTERN = re.compile(
    r"(?:p|pos|position|coord|coords|coordinate|point|points|node)?[ _.:]*([xyz]|(?<=[_:])[0-2])"
)
"""Names of columns of coordinates, in lower case and without a unit: x, px, pos_x, Points:0 and the like."""

ID_NAMES = ("", "id", "index", "no", "nr", "name", "label", "vertex", "point")
"""Names of columns of ids, in lower case."""

UNIT = re.compile(r"\s*[\[(].*[\])]\s*$")
"""A unit behind a name, such as in `x [mm]`."""


@dataclass(frozen=True, eq=False)
class PointTable:
    """Points, and the table that they stand in.

    Attributes:
        points: (p, dimension).
        rounding: (p,) half a unit of the last written digit, all coordinates together: how far off a point
            may be by how it is written.
        rows: the cells of each row as they are written.
        lines: (p,) number of the line that each stands in, from 1.
        heading: names of the columns; empty where the table has none.
        columns: which of them are the coordinates.
    """

    points: Floats
    rounding: Floats
    rows: list[list[str]]
    lines: Ints
    heading: list[str]
    columns: tuple[int, ...]


def read_points(data: bytes, dimension: int) -> PointTable:
    r"""Read a table of points: a row each, with columns for x, y and z, and perhaps others, such as an id.

    A heading tells which columns are the coordinates. Without one, so many columns are the coordinates as the
    shape has dimensions, and one more is an id where it holds names, or counts from 0 or 1. For separators,
    decimal commas and remarks see `table_of`; for encodings `text_of`.

    Args:
        data: of the file.
        dimension: 2 or 3.

    Raises:
        UnreadableError: it holds no points, a row has something else than numbers, or it cannot be told
            which columns are meant.

    >>> table = read_points(b"# written by hand\nid;x;y;z\nA;0,5;1,0;2,5\n", 3)
    >>> table.points.tolist(), table.columns, table.rounding.round(3).tolist()
    ([[0.5, 1.0, 2.5]], (1, 2, 3), [0.087])
    """
    table = table_of(text_of(data))
    wanted = ",".join(AXIS_NAMES[:dimension])
    if not table.rows:
        raise UnreadableError(f"there are no points in it; write one {wanted} a line")
    columns = _columns(table, dimension, wanted)
    cells = [[row[column] for column in columns] for row in table.rows]
    numbers = [[table.number(cell) for cell in row] for row in cells]
    for row, line, found in zip(table.rows, table.lines, numbers, strict=True):
        if not all(number is not None and np.isfinite(number) for number in found):
            raise UnreadableError(
                f"line {line}: {table.shown(row)} is not {COUNT_WORDS[dimension]} numbers {wanted}"
            )
    points = np.array(numbers, dtype=np.float64)
    rounding = rounding_of(cells, points)
    return PointTable(points, rounding, table.rows, np.array(table.lines), table.heading, columns)


def _columns(table: TextTable, dimension: int, wanted: str) -> tuple[int, ...]:
    """The columns of the coordinates."""
    named = _named_columns(table.heading) if len(table.heading) == table.width else {}
    axes = AXIS_NAMES[:dimension]
    if all(axis in named for axis in axes):
        return tuple(named[axis] for axis in axes)
    ids = [name for name in table.heading if name.strip().lower() in ID_NAMES]
    if table.width == dimension and not named and not ids:
        return tuple(range(dimension))
    if table.width == dimension + 1 and not named:
        for first, other in ((1, 0), (0, dimension)):
            if _is_id(table, other):
                return tuple(range(first, first + dimension))
    comma = "; decimal commas need another mark between columns" if table.width == 2 * dimension else ""
    raise UnreadableError(
        f"line {table.lines[0]}: {table.shown(table.rows[0])} has {table.width} "
        f"{'column' if table.width == 1 else 'columns'}, not {COUNT_WORDS[dimension]} numbers {wanted}; "
        f"name them in a first line, such as id,{wanted}{comma}"
    )


def _named_columns(heading: list[str]) -> dict[str, int]:
    """The columns whose names are those of axes; none where an axis has two."""
    found: dict[str, int] = {}
    for column, name in enumerate(heading):
        axis = AXIS_PATTERN.fullmatch(UNIT.sub("", name.strip().lower()))
        if axis is not None:
            key = axis[1] if axis[1] in AXIS_NAMES else AXIS_NAMES[int(axis[1])]
            if key in found:
                return {}
            found[key] = column
    return found


def _is_id(table: TextTable, column: int) -> bool:
    """Whether a column holds names, or counts the rows where the heading calls it no coordinate."""
    cells = [row[column] for row in table.rows]
    numbers = [table.number(cell) for cell in cells]
    if all(number is None for number in numbers):
        return True
    counts = len(cells) > 1 and numbers in (list(range(len(cells))), list(range(1, len(cells) + 1)))
    whole = all(cell.isascii() and cell.isdigit() for cell in cells)
    return column == 0 and counts and whole


def rounding_of(cells: list[list[str]], points: Floats) -> Floats:
    """Half a unit of the last digit written, of all coordinates of each point together, (p,).

    Programs leave out zeros at the end, so the digits are those of the whole table: as many behind the
    decimal sign as any number has, or as many significant ones, whichever is coarser for the number.

    Args:
        cells: the coordinates of each point, as they are written.
        points: (p, dimension) the same as numbers.

    >>> rounding_of([["12.25", "0"], ["3", "4"]], np.array([[12.25, 0.0], [3.0, 4.0]])).round(4).tolist()
    [0.0071, 0.0071]
    """
    decimals, significant = 0, 1
    for row in cells:
        for cell in row:
            mantissa, _, exponent = re.sub("[dD]", "e", cell).lower().partition("e")
            whole, _, fraction = mantissa.lstrip("+-").replace(",", ".").partition(".")
            decimals = max(decimals, len(fraction) - int(exponent or 0))
            significant = max(significant, len((whole + fraction).lstrip("0")))
    with np.errstate(divide="ignore"):
        leading = np.floor(np.log10(np.abs(points)))
    with np.errstate(over="ignore", under="ignore"):
        unit = np.maximum(10.0 ** -float(min(decimals, 400)), 10.0 ** (leading + 1.0 - significant))
        return 0.5 * np.linalg.norm(np.where(points == 0.0, 10.0 ** -float(min(decimals, 400)), unit), axis=1)
