"""Output of the command line: JSON and tables."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Mapping
from typing import Any


def as_json(content: Mapping[str, Any]) -> str:
    """JSON that every parser takes: arrays become lists, NaN and infinity null.

    >>> print(as_json({"point": (1.0, float("nan"))}))
    {"point": [1.0, null]}
    """
    return json.dumps(_plain(content), ensure_ascii=False, allow_nan=False)


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def coordinates(point: Iterable[float]) -> str:
    """A point as --source takes it, exactly.

    >>> coordinates([0.1, -2.0, 3.0])
    '0.1,-2.0,3.0'
    """
    return ",".join(repr(float(value)) for value in point)


def table(heading: Iterable[str], rows: Iterable[Iterable[str | float | None]]) -> str:
    """CSV lines with every digit of each number; an empty field where there is none.

    >>> table(("id", "x", "distance"), [["A", 1.0, None], ["B", 2.0, 0.5]])
    'id,x,distance\\nA,1.0,\\nB,2.0,0.5'
    """
    names = list(heading)
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerows([names] if names else [])
    writer.writerows([[_field(value) for value in row] for row in rows])
    return lines.getvalue().rstrip("\n")


def _field(value: str | float | None) -> str:
    return value if isinstance(value, str) else "" if value is None else repr(float(value))
