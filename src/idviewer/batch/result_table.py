"""The table of a collection: one row a shape, the same columns in CSV and Parquet."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from idviewer.batch.task import Outcome
from idviewer.core.io import atomic_path

AXES_OF_POINTS = ("x", "y", "z")
LEADING = ("name", "path", "status", "reason")
"""Columns that every row has."""

LONGEST_LIST = 64
"""Numbers of a list that becomes columns."""

LEFT_OUT = ("info", "eigenvalues")
"""Parts of a result that are no columns, since shapes have them in different numbers."""

PARQUET_MISSING = "--parquet: needs the package pyarrow: pip install 'idviewer[batch]'"

Row = dict[str, Any]


def check_parquet() -> None:
    """Refuse to write Parquet where the package for it is missing.

    Raises:
        ValueError: it is; the line says which command installs it.
    """
    if find_spec("pyarrow") is None:
        raise ValueError(PARQUET_MISSING)


def row_of(outcome: Outcome) -> Row:
    """A row: a result's numbers and texts, lists of numbers over columns, and the manifest's labels."""
    task = outcome.task
    status = "failed" if outcome.status == "failed" else "done"
    row: Row = dict(zip(LEADING, (task.name, str(task.path), status, outcome.reason), strict=True))
    row |= {name: text for name, text in task.labels.items() if name not in row}
    result = outcome.content.get("result", {})
    row |= _flat({name: value for name, value in result.items() if name not in LEFT_OUT})
    return row


def _flat(values: Mapping[str, Any], before: str = "") -> Row:
    row: Row = {}
    for name, value in values.items():
        column = f"{before}{name}"
        if isinstance(value, Mapping):
            row |= _flat(value, f"{column}_")
        elif isinstance(value, list) and any(isinstance(one, str) for one in value):
            row[column] = "; ".join(map(str, value))
        elif isinstance(value, list):
            # Points are the lists of two or three.
            names = AXES_OF_POINTS if len(value) in (2, 3) else range(1, len(value) + 1)
            if len(value) <= LONGEST_LIST:
                row |= {f"{column}_{end}": one for end, one in zip(names, value, strict=False)}
        else:
            row[column] = value
    return row


def columns_of(rows: Iterable[Row]) -> list[str]:
    """All columns of some rows: those that every row has, and then others as they are met."""
    return list(dict.fromkeys([*LEADING, *(name for row in rows for name in row)]))


def write_tables(folder: Path, stem: str, outcomes: Iterable[Outcome], parquet: bool) -> list[Path]:
    """Write the table as CSV, and as Parquet where that is asked for; the paths of the files.

    Args:
        folder: where.
        stem: name of the files, without the suffix.
        outcomes: one a row, in the order of the list of shapes.
        parquet: whether it is.

    Raises:
        OSError: a file cannot be written.
    """
    rows = [row_of(outcome) for outcome in outcomes]
    columns = columns_of(rows)
    paths = [folder / f"{stem}.csv"]
    with atomic_path(paths[0]) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    if parquet:
        paths.append(folder / f"{stem}.parquet")
        _write_parquet(paths[-1], rows, columns)
    return paths


def _write_parquet(path: Path, rows: list[Row], columns: list[str]) -> None:
    import pyarrow
    from pyarrow import parquet

    table = pyarrow.table({name: _array([row.get(name) for row in rows]) for name in columns})
    with atomic_path(path) as part:
        parquet.write_table(table, part)


def _array(values: list[Any]) -> Any:
    """A column: of numbers if all are, and of texts otherwise."""
    there = [value for value in values if value is not None]
    numbers = all(isinstance(value, int | float) and not isinstance(value, bool) for value in there)
    if there and numbers:
        whole = all(isinstance(value, int) for value in there)
        return [value if value is None or whole else float(value) for value in values]
    if there and all(isinstance(value, bool) for value in there):
        return values
    return [None if value is None else str(value) for value in values]
