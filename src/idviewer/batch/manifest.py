"""Manifests: a CSV file that lists the shapes of a collection, one a row, with options of their own."""

from __future__ import annotations

import csv
import difflib
import io
from collections.abc import Collection
from pathlib import Path

from idviewer.batch.inputs import Entry

PATH, NAME, LANDMARKS = "path", "name", "landmarks"
PATH_NAMES = (PATH, "file", "shape", "filename")
"""Of the column of paths."""


def read_manifest(path: Path, options: Collection[str]) -> list[Entry]:
    """Read the shapes that a manifest lists.

    Its first row names the columns: `path` (relative to the manifest's folder), perhaps `name`, and any of
    the options; an empty cell leaves an option as it is. Other columns are labels, carried into the table.

    Args:
        path: of the manifest.
        options: names of the options that rows may have.

    Raises:
        ValueError: it is no such table, has no column of paths, or a column that looks like an option.
        OSError: it cannot be read.
    """
    rows = _rows_of(path)
    header = [cell.strip() for cell in rows[0][1]] if rows else []
    names = [cell.lower().replace("_", "-") for cell in header]
    if not (found := [one for one in names if one in PATH_NAMES]):
        raise ValueError(
            f"{path}: no column is called `path`; its first line must name the columns, "
            "such as path,name,component"
        )
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{path}: two columns are called {name!r}; leave one out")
    known = (found[0], NAME, *options)
    _refuse_near_misses(path, [name for name in names if name not in known], known)
    entries = []
    for line, cells in rows[1:]:
        if len(cells) > len(names):
            raise ValueError(
                f"{path}, line {line}: {len(cells)} cells under {len(names)} columns; quote commas"
            )
        values = {name: cell.strip() for name, cell in zip(names, cells, strict=False)}
        if not values.get(found[0]):
            raise ValueError(f"{path}, line {line}: it names no file in the column {found[0]!r}")
        entries.append(
            Entry(
                (path.parent / values[found[0]]).absolute(),
                values.get(NAME, ""),
                tuple((name, values[name]) for name in options if values.get(name)),
                {
                    title: values.get(name, "")
                    for title, name in zip(header, names, strict=True)
                    if name not in known
                },
                f"{path}, line {line}",
            )
        )
    if not entries:
        raise ValueError(f"{path}: it lists no shapes")
    return entries


def _rows_of(path: Path) -> list[tuple[int, list[str]]]:
    """Rows that are not empty, and their lines; columns are parted by what the first row parts them by."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not a text in UTF-8; save it as CSV in UTF-8") from error
    first = text.partition("\n")[0]
    delimiter = max(",;\t", key=first.count)
    rows = csv.reader(io.StringIO(text), delimiter=delimiter)
    try:
        return [(rows.line_num, row) for row in rows if any(cell.strip() for cell in row)]
    except csv.Error as error:
        raise ValueError(f"{path}, line {rows.line_num}: not a table ({error})") from error


def _refuse_near_misses(path: Path, labels: list[str], known: Collection[str]) -> None:
    """Refuse a label that is an option but for its spelling, which would silently do nothing."""
    for label in labels:
        if near := difflib.get_close_matches(label, known, 1, 0.8):
            raise ValueError(f"{path}: a column is called {label!r}; is {near[0]!r} meant? rename it")
