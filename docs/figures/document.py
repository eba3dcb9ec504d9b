"""docs/figures.md: the places in it that tables are written to."""

from __future__ import annotations

from pathlib import Path

START, END = "<!-- numbers of {}: written by `make figures` -->", "<!-- end of the numbers of {} -->"


def markers(number: str) -> tuple[str, str]:
    """The lines between which the numbers of a figure stand."""
    return START.format(number), END.format(number)


def put_into(text: str, number: str, table: str) -> str:
    """The document with another table between a figure's markers.

    Raises:
        ValueError: the markers are not there exactly once, the first before the second.
    """
    start, end = markers(number)
    if text.count(start) != 1 or text.count(end) != 1 or text.index(end) < text.index(start):
        raise ValueError(f"put the lines {start!r} and {end!r} where the numbers shall go")
    before, rest = text.split(start)
    return f"{before}{start}\n\n{table}\n\n{end}{rest.split(end)[1]}"


def write(path: Path, number: str, table: str) -> None:
    """Put a table into a file, which is there as a whole at any time."""
    text = put_into(path.read_text(), number, table)
    beside = path.with_name(f"{path.name}.part")
    beside.write_text(text)
    beside.replace(path)
