"""The repair of a mesh's file: what is written, and what is told of it."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from idviewer.cli import output, parsing
from idviewer.cli.options import EVERY_COMPONENT

if TYPE_CHECKING:
    from idviewer.cli.options import BodyChoice
    from idviewer.core import Repairs
    from idviewer.core.shapes import Diagnosis, RepairOutcome

SIZES = ("vertices", "faces", "components", "boundary loops", "area", "volume")


def check_output(out: Path, path: Path, overwrite: bool) -> None:
    """Refuse what cannot be written, or would replace what is read, before anything is read."""
    from idviewer.core.io import check_mesh_path

    check_mesh_path(out)
    if out.is_dir():
        raise ValueError(f"{out}: this is a folder; name a file in it")
    if not out.parent.is_dir():
        raise ValueError(f"{out}: there is no folder {out.parent}; make it first")
    if out.exists() and os.path.samefile(out, path) and not overwrite:
        raise ValueError(f"{out}: this is the file that is read; name another one, or add --overwrite")


def repaired(path: Path, out: Path, repairs: Repairs, choice: BodyChoice, json: bool) -> str:
    """Repair a mesh and write it; the report is in words or JSON.

    Args:
        path: of the mesh.
        out: where it is written.
        repairs: to make.
        choice: of a component and of a part of the file.
        json: whether the report is JSON.
    """
    from idviewer.core.io import read_body, write_mesh
    from idviewer.view.vtk_files import register_vtk_reader

    register_vtk_reader()
    if choice.component == EVERY_COMPONENT:
        raise ValueError("--component all: one file holds one component; repair them one by one, by number")
    body = read_body(path, parsing.component_of(choice.component), choice.part)
    before = body.repaired()
    outcome = body.repaired(repairs) if repairs else before
    mesh = outcome.mesh_from(f"{path}: nothing is written: it is still no closed body")
    lost = write_mesh(mesh, out)
    if json:
        return output.as_json(_as_json(path, out, before.diagnosis, outcome, lost))
    for note in lost:
        print(f"idviewer: {out}: {note}", file=sys.stderr)
    return "\n".join(_lines(path, out, before.diagnosis, outcome))


def _lines(path: Path, out: Path, before: Diagnosis, outcome: RepairOutcome) -> Iterable[str]:
    after = outcome.diagnosis
    yield f"{path} -> {out}"
    for record in outcome.records:
        yield f"  {record.sentence}."
    for finding in after.findings:
        yield f"  {finding.note}"
    if not outcome.records and not after.findings:
        yield "  Nothing was wrong with it."
    yield f"  {'':<16}{'before':>14}{'after':>14}"
    for title, *sizes in zip(SIZES, _sizes(before), _sizes(after), strict=True):
        yield f"  {title:<16}{sizes[0]:>14}{sizes[1]:>14}"
    unit = f" {after.unit}" if after.unit else ""
    yield f"  The largest distance that a vertex moved is {outcome.moved:.6g}{unit}."


def _sizes(told: Diagnosis) -> tuple[str, ...]:
    volume = "open" if told.volume is None else f"{told.volume:.8g}"
    counts = (told.vertices, told.faces, len(told.components), told.boundary_loops)
    return (*(f"{count:,}" for count in counts), f"{told.area:.8g}", volume)


def _as_json(
    path: Path, out: Path, before: Diagnosis, outcome: RepairOutcome, lost: tuple[str, ...]
) -> dict[str, Any]:
    repairs = [
        {
            "name": record.name,
            "value": record.value,
            "count": record.count,
            "moved": record.moved,
            "sentence": f"{record.sentence}.",
        }
        for record in outcome.records
    ]
    sizes = {"before": before.as_dict(), "after": outcome.diagnosis.as_dict()}
    return {
        "mesh": str(path),
        "out": str(out),
        "repairs": repairs,
        "moved": outcome.moved,
        **sizes,
        "lost": lost,
    }
