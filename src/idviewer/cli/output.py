"""How the command line writes results: JSON, tables, and the report on a mesh."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from idviewer.core.diagnosis import Diagnosis

WIDTH = 16


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


def table(columns: tuple[str, ...], rows: Iterable[Iterable[float]], header: bool) -> str:
    """CSV lines with every digit of each number.

    >>> table(("x", "distance"), [[1.0, 0.5]], header=True)
    'x,distance\\n1.0,0.5'
    """
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerows([columns] if header else [])
    writer.writerows([[repr(float(value)) for value in row] for row in rows])
    return lines.getvalue().rstrip("\n")


def report(name: str, diagnosis: Diagnosis) -> str:
    """The sizes of a mesh, what is wrong with it, and the verdict."""
    lines = [name, *(f"  {title:<{WIDTH}}{value}" for title, value in _sizes(diagnosis))]
    for finding in diagnosis.findings:
        fate = (
            finding.remedy or "cannot be mended"
            if finding.fatal
            else f"is {finding.repair} when it is opened"
        )
        lines.append(f"  {'problem' if finding.fatal else 'note':<{WIDTH}}{finding.message}; {fate}")
    if not diagnosis.findings:
        lines.append(f"  {'faults':<{WIDTH}}none")
    lines.append(f"  {'usable':<{WIDTH}}{'yes' if diagnosis.usable else 'no'}")
    return "\n".join(lines)


def _sizes(diagnosis: Diagnosis) -> Iterable[tuple[str, str]]:
    yield "vertices", f"{diagnosis.vertices:,}"
    yield "faces", f"{diagnosis.faces:,}"
    yield "edges", f"{diagnosis.edges:,}"
    yield "components", f"{len(diagnosis.components)}"
    if diagnosis.genus is not None:
        yield "genus", f"{diagnosis.genus}"
    if diagnosis.boundary_loops:
        yield "boundary loops", f"{diagnosis.boundary_loops}"
    if diagnosis.bounds is not None:
        lower, upper = (
            "(" + ", ".join(f"{value:.6g}" for value in corner) + ")" for corner in diagnosis.bounds
        )
        yield "bounding box", f"{lower} to {upper}"
    yield "area", f"{diagnosis.area:.6g}"
    if diagnosis.volume is not None:
        yield "volume", f"{diagnosis.volume:.6g}"
