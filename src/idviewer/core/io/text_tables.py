"""Tables of numbers as text, whatever marks separate their columns and stand for decimal signs."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass

from idviewer.core.io.text import UnreadableError, as_text

NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eEdD][+-]?[0-9]+)?")
"""A number as printed; Fortran's D stands for E."""

COMMA_NUMBER = re.compile(r"[+-]?([0-9]+(,[0-9]+)?|,[0-9]+)([eEdD][+-]?[0-9]+)?")
"""A number with a decimal comma, or without a decimal sign."""

NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity|1\.#\S+)", re.IGNORECASE)
"""What is printed for numbers that are not finite."""

REMARK = re.compile(r"(?:^|\s)(?:#|%|//).*")
"""A remark: at the beginning of a line, or behind a blank."""


@dataclass(frozen=True, eq=False)
class TextTable:
    """The cells of a table, as they are written.

    Attributes:
        rows: the cells of each row, as many in each; a heading is not among them.
        lines: number of the line that each row stands in, from 1.
        heading: names of the columns; empty where the table names none.
        decimal_comma: whether numbers have a comma for a decimal sign.
        separator: the mark between columns; " " for blanks.
    """

    rows: list[list[str]]
    lines: list[int]
    heading: list[str]
    decimal_comma: bool = False
    separator: str = ","

    @property
    def width(self) -> int:
        """How many columns there are."""
        return len(self.rows[0]) if self.rows else len(self.heading)

    def shown(self, row: list[str]) -> str:
        """A row as it is written, cut where it is long, for messages."""
        return ascii(self.separator.join(row)[:60])

    def number(self, cell: str) -> float | None:
        """The number that a cell holds, perhaps not finite; None if it holds none.

        >>> TextTable([], [], [], decimal_comma=True).number("1,5e3")
        1500.0
        """
        if (COMMA_NUMBER if self.decimal_comma else NUMBER).fullmatch(cell):
            return float(cell.replace(",", ".").replace("d", "e").replace("D", "e"))
        return float("nan") if NOT_FINITE.fullmatch(cell) else None


def text_of(data: bytes) -> str:
    r"""Decode text: Unicode, see `as_text`, else the Western code page of Windows.

    Args:
        data: of the file.

    Raises:
        UnreadableError: it is binary data.

    >>> text_of("x;y\n".encode("utf-16")), text_of("größe".encode("cp1252"))
    ('x;y\n', 'größe')
    """
    text = as_text(data)
    try:
        return text.decode("utf-8")
    except UnicodeDecodeError:
        return text.decode("cp1252", errors="replace")  # only names of columns and rows can be affected


def table_of(text: str) -> TextTable:
    r"""Take a text apart into cells.

    Columns are separated by semicolons, tabs, commas or blanks, in this order of precedence; beside the first
    two and blanks, a comma in a number is its decimal sign. Blank lines and remarks, from #, % or // on, are
    passed over, and so is a column that is empty throughout at the end of lines. The first line is a heading
    where it holds no number and others do, or else a remark just above the numbers with as many names.

    Args:
        text: of the file.

    Raises:
        UnreadableError: rows have different lengths, or the decimal sign is not the same in all numbers.

    >>> table = table_of("# x y\n0,5 1\n1,5 2\n")
    >>> table.heading, [[table.number(cell) for cell in row] for row in table.rows]
    (['x', 'y'], [[0.5, 1.0], [1.5, 2.0]])
    """
    lines, told, remark = _lines(text)
    if not lines:
        return TextTable([], [], [])
    body = [line for _, line in lines if _has_number(line)] or [line for _, line in lines]
    separator = told or _separator_of(body)
    cells = [_cells(line, separator) for _, line in lines]
    kept = [(number, row) for (number, _), row in zip(lines, cells, strict=True) if any(row)]
    if not kept:
        return TextTable([], [], [])
    numbers, rows = [number for number, _ in kept], [row for _, row in kept]
    decimal_comma = separator != "," and any(
        "," in cell and bool(COMMA_NUMBER.fullmatch(cell)) for row in rows for cell in row
    )
    table = TextTable(rows, numbers, [], decimal_comma, separator)
    heading = _heading(table, lines[0][1], remark)
    if heading and heading[1]:
        rows, numbers = rows[1:], numbers[1:]
    names = heading[0] if heading else []
    rows, names = _without_empty_end(rows, names)
    whole = TextTable(rows, numbers, names, decimal_comma, separator)
    _check_widths(whole)
    if decimal_comma:
        _check_decimal_signs(rows, numbers)
    return whole


def _lines(text: str) -> tuple[list[tuple[int, str]], str, str]:
    """Lines and their numbers, without remarks and blank ones; the separator told; the last remark above."""
    lines: list[tuple[int, str]] = []
    told, remark = "", ""
    for number, line in enumerate(text.splitlines(), 1):
        if number == 1 and re.fullmatch(r"\s*\"?sep=(.)\"?\s*", line, re.IGNORECASE):
            told = line.strip().strip('"')[-1]
            continue
        kept = REMARK.sub("", line) if '"' not in line else line
        if kept.strip():
            lines.append((number, kept.rstrip("\r\n ")))
        elif not lines and line.strip():
            remark = line.strip().lstrip("#%/ ")
    return lines, told, remark


def _has_number(line: str) -> bool:
    return any(NUMBER.fullmatch(word) for word in re.split(r"[\s,;\"]+", line))


def _separator_of(lines: list[str]) -> str:
    """The mark between columns: beside commas, blanks are one only where they part whole numbers."""
    for mark in (";", "\t"):
        if any(mark in line.strip() for line in lines):
            return mark
    if not any("," in line for line in lines):
        return " "
    words = [line.split() for line in lines]
    apart = all(len(row) > 1 and all(COMMA_NUMBER.fullmatch(word) for word in row) for row in words)
    return " " if apart else ","


def _cells(line: str, separator: str) -> list[str]:
    if '"' in line:
        row = next(csv.reader([line.strip()], delimiter=separator, skipinitialspace=True))
        return [cell.strip() for cell in row]
    return line.split() if separator == " " else [cell.strip() for cell in line.split(separator)]


def _heading(table: TextTable, first: str, remark: str) -> tuple[list[str], bool] | None:
    """The names of columns, and whether they are the first row; None where there are none."""
    row, others = table.rows[0], table.rows[1:]
    if _counts_columns(row, others):
        return row, True
    if not any(table.number(cell) is not None for cell in row):
        width = len(others[0]) if others else len(row)
        splits = [row, *(_cells(first, mark) for mark in ",;\t ")]
        return next((cells for cells in splits if len(cells) == width), row), True
    names = [_cells(remark, mark) for mark in (table.separator, ",", ";", "\t", " ")] if remark else []
    for cells in names:
        if len(cells) == len(row) and not any(NUMBER.fullmatch(cell) for cell in cells):
            return cells, False
    return None


def _counts_columns(row: list[str], others: list[list[str]]) -> bool:
    """Whether a first row numbers the columns, as pandas does: beside a blank, or above broken numbers."""
    first = 1 if row[0] == "" else 0
    counts = len(row) > 1 and row[first:] == [str(column) for column in range(len(row) - first)]
    broken = bool(others) and all(any(mark in cell for cell in other for mark in ".,") for other in others)
    return counts and (first == 1 or broken)


def _without_empty_end(rows: list[list[str]], names: list[str]) -> tuple[list[list[str]], list[str]]:
    """Without a last column that holds nothing, as separators at the ends of lines leave it."""
    full = max((len(row) for row in rows), default=0)
    while rows and full > 1 and all(len(row) < full or row[full - 1] == "" for row in rows):
        rows = [row[: full - 1] for row in rows]
        names = names[: full - 1] if len(names) == full and not names[-1] else names
        full -= 1
    return rows, names


def _check_widths(table: TextTable) -> None:
    for row, line in zip(table.rows, table.lines, strict=True):
        if len(row) != table.width:
            raise UnreadableError(
                f"line {line}: {table.shown(row)} has {len(row)} {'column' if len(row) == 1 else 'columns'}, "
                f"and line {table.lines[0]} has {table.width}"
            )


def _check_decimal_signs(rows: list[list[str]], lines: list[int]) -> None:
    for row, line in zip(rows, lines, strict=True):
        for cell in row:
            if "." in cell and (NUMBER.fullmatch(cell) or re.fullmatch(r"[+-]?[0-9.]+,[0-9]+", cell)):
                raise UnreadableError(
                    f"line {line}: {cell!r} has a point where other numbers have a decimal comma; "
                    "write all with points, and no mark for thousands"
                )
