"""Tables in text: cells apart by commas, semicolons, tabs or spaces; headers, quotes, decimal commas."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass

from idviewer.core.io.text import UnreadableError

Row = tuple[int, tuple[str, ...]]
"""The number of a line, and its cells."""

MOST_HEADER_LINES = 2
"""Of a table: the columns' names, and perhaps their units."""

_NUMBER = r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?"
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?$")
_WHOLE = re.compile(r"[+-]?\d+([eE][+-]?\d+)?$")


@dataclass(frozen=True)
class TextTable:
    """The lines of a table as cells.

    Attributes:
        header: the columns' names; empty where there are none.
        rows: of all lines, also of those without cells, which may part what is listed.
        decimal_commas: whether numbers have a comma for their point.
    """

    header: tuple[str, ...]
    rows: tuple[Row, ...]
    decimal_commas: bool

    def number(self, cell: str) -> float | None:
        """The number in a cell, None where there is none.

        Args:
            cell: of the table.
        """
        return _number(cell, self.decimal_commas)


def text_table(text: str) -> TextTable:
    r"""Take a text apart into the cells of its lines. Remarks, from # on, are left out, with their lines.

    Args:
        text: of the file.

    Raises:
        UnreadableError: it is not clear whether commas are decimal ones.

    >>> text_table("x;y\n0,5;1\n").rows, text_table("# m\n0 1\n").rows
    (((2, ('0,5', '1')),), ((2, ('0', '1')),))
    """
    lines = []
    for number, line in enumerate(text.splitlines(), 1):
        told, mark, _ = line.partition("#")
        if (mark and not told.strip(" \t,;")) or (number == 1 and re.match(r'"?sep=.?"?$', line.strip())):
            continue
        lines.append((number, told.strip(" \r")))
    separator = _separator([line for _, line in lines if line.strip(" \t,;")])
    rows = [(number, _cells(line, separator)) for number, line in lines]
    commas = separator != "," and _has_decimal_commas(rows)
    first = next((i for i, (_, cells) in enumerate(rows) if any(cells)), 0)
    last = first
    while last - first < MOST_HEADER_LINES and last < len(rows) and _is_header(rows[last][1], commas):
        last += 1
    return TextTable(rows[first][1] if last > first else (), tuple(rows[:first] + rows[last:]), commas)


def _separator(lines: Sequence[str]) -> str | None:
    """What parts cells: a mark, or None for spaces."""
    bare = [re.sub(r'"[^"]*"', "", line) for line in lines]
    for mark in ";\t":
        if any(mark in line for line in bare):
            return mark
    if not any("," in line for line in bare):
        return None
    # Decimal commas in columns apart by spaces: each line's words are numbers, two or more.
    numeric = [line.split() for line in lines if re.search(r"\d", line)]
    spaced = all(
        len(words) > 1 and all(_DECIMAL_COMMA.match(word) or _WHOLE.match(word) for word in words)
        for words in numeric
    )
    return None if numeric and spaced else ","


def _cells(line: str, separator: str | None) -> tuple[str, ...]:
    if separator is None:
        words = [word.strip("\"'") for word in line.split()]
    else:
        words = [word.strip().strip("'") for word in next(csv.reader([line], delimiter=separator), [])]
    while words and not words[-1]:
        words.pop()
    return tuple(words)


def _number(cell: str, decimal_commas: bool) -> float | None:
    if decimal_commas and _DECIMAL_COMMA.match(cell):
        cell = cell.replace(",", ".")
    try:
        return float(cell) if "_" not in cell else None
    except ValueError:
        return None


def _has_decimal_commas(rows: Sequence[Row]) -> bool:
    """Whether numbers have decimal commas.

    Raises:
        UnreadableError: some have, and others have points.
    """
    commas, points = None, None
    for number, cells in rows:
        for cell in cells:
            if commas is None and _DECIMAL_COMMA.match(cell):
                commas = (number, cell)
            elif points is None and "." in cell and re.match(rf"{_NUMBER}$", cell):
                points = (number, cell)
    if commas and points:
        raise UnreadableError(
            f"line {commas[0]}: {commas[1]!a} has a comma and line {points[0]}: {points[1]!a} a point; "
            "write all numbers with a point"
        )
    return commas is not None


def _is_header(cells: tuple[str, ...], decimal_commas: bool) -> bool:
    return bool(cells) and any(cells) and all(_number(cell, decimal_commas) is None for cell in cells)
