"""The table of named repairs: what each does, what it will change, and how it is made."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from idviewer.core.arrays import Floats, Ints
from idviewer.core.shapes.repairs import RepairRecord, number_text
from idviewer.core.shapes.shell_union import unite_shells
from idviewer.core.validation.file_numbering import FileNumbering
from idviewer.core.validation.findings import Finding
from idviewer.core.validation.hole_filling import fill_holes, holes
from idviewer.core.validation.mesh_checks import validate
from idviewer.core.validation.polygon_soup import PolygonSoup
from idviewer.core.validation.welding import suggested_width, weld

WALL_KINDS = ("inner_walls", "fins")
"""Kinds of findings that tell of faces which bound no solid."""


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles under repair.

    Attributes:
        vertices: (n, 3).
        faces: (m, 3).
        numbering: which vertex of the file became which of these.
    """

    vertices: Floats
    faces: Ints
    numbering: FileNumbering


@dataclass(frozen=True)
class NamedRepair:
    """One repair that can be asked for.

    Attributes:
        name: a field of `Repairs`.
        title: for a button.
        explanation: of what it does to any shape, one sentence.
        parameter: what its value is, in words; empty where it has none.
        whole: whether the value is a whole number.
        make: the surface repaired with a value, and the account of it; None where a validation makes it.
        suggest: the value that helps a surface most; None where the repair has nothing to do.
    """

    name: str
    title: str
    explanation: str
    parameter: str
    whole: bool
    make: Callable[[Surface, Any], tuple[Surface, RepairRecord]] | None
    suggest: Callable[[Surface], Any]


def _weld(surface: Surface, width: float) -> tuple[Surface, RepairRecord]:
    welded = weld(surface.vertices, surface.faces, width)
    words = [_many(welded.merged, "vertex", "vertices") + " merged"] if welded.merged else []
    if welded.joined:
        words.append(f"{_many(welded.joined, 'vertex', 'vertices')} joined to edges they lie on")
    if welded.vanished:
        words.append(f"{_many(welded.vanished, 'face', 'faces')} collapsed")
    moved = f", moved by up to {welded.moved:.2g}" if words else ""
    sentence = f"Weld gaps up to {number_text(width)}: {', '.join(words) or 'nothing to weld'}{moved}"
    numbering = surface.numbering.renumbered(welded.became, welded.moved)
    record = RepairRecord("weld", width, welded.merged + welded.joined, sentence, welded.moved)
    return Surface(welded.vertices, welded.faces, numbering), record


def _suggest_weld(surface: Surface) -> float | None:
    return suggested_width(surface.vertices, surface.faces)


def _fill(surface: Surface, most_edges: int) -> tuple[Surface, RepairRecord]:
    filled = fill_holes(surface.vertices, surface.faces, most_edges)
    before, after = (_area(surface.vertices, surface.faces), _area(filled.vertices, filled.faces))
    words = f"no hole of at most {most_edges} edges"
    if filled.sizes:
        sizes = _range(filled.sizes)
        lids = len(filled.faces) - len(surface.faces)
        words = (
            f"{_many(len(filled.sizes), 'hole', 'holes')} of {sizes} edges filled with {lids:,} triangles, "
            f"which add {100.0 * (after - before) / before:.2g} % to the area"
        )
    if filled.left:
        words += f"; {_many(len(filled.left), 'hole', 'holes')} of {_range(filled.left)} edges left open"
    came_from = np.arange(len(filled.vertices))
    came_from[len(surface.vertices) :] = -1
    numbering = surface.numbering.split(came_from)
    record = RepairRecord("fill_holes", most_edges, len(filled.sizes), f"Fill holes: {words}")
    return Surface(filled.vertices, filled.faces, numbering), record


def _suggest_filling(surface: Surface) -> int | None:
    sizes = [len(hole) for hole in holes(surface.faces, len(surface.vertices))]
    return max(sizes) if sizes else None


def _unite(surface: Surface, _: bool) -> tuple[Surface, RepairRecord]:
    report = validate(PolygonSoup.of(surface.vertices, surface.faces))
    united = unite_shells(report.vertices, report.faces)
    if united is None:
        return surface, RepairRecord("unite", True, 0, "Unite parts: nothing overlaps")
    parts = f"{united.shells:,} {'part becomes' if united.shells == 1 else 'parts become'} {united.left:,}"
    sentence = (
        f"Unite parts: {parts}, "
        f"volume {united.before:.6g} (what is covered twice counted twice) becomes {united.after:.6g}"
    )
    if united.crossing:
        sentence += f", and {united.crossing:,} pairs of faces cross each other still"
    came_from = np.full(len(united.vertices), -1)
    distance, nearest = cKDTree(report.vertices).query(united.vertices)
    same = distance <= 1e-12 * report.size
    came_from[same] = nearest[same]
    numbering = surface.numbering.followed_by(report.numbering).split(came_from)
    record = RepairRecord("unite", True, united.shells, sentence)
    return Surface(united.vertices, united.faces, numbering), record


def _suggest_uniting(surface: Surface) -> bool:
    report = validate(PolygonSoup.of(surface.vertices, surface.faces))
    return any(finding.kind in ("crossing_shells", "self_intersections") for finding in report.findings)


def wall_record(findings: Iterable[Finding]) -> RepairRecord:
    """The account of the faces that a validation left out as walls.

    Args:
        findings: of that validation.

    >>> wall_record(()).sentence
    'Leave walls out: there is none'
    """
    walls = [finding for finding in findings if finding.kind in WALL_KINDS]
    words = ", ".join(finding.subject for finding in walls) or "there is none"
    return RepairRecord("drop_walls", True, sum(wall.count for wall in walls), f"Leave walls out: {words}")


def _suggest_dropping(surface: Surface) -> bool:
    report = validate(PolygonSoup.of(surface.vertices, surface.faces))
    return any(finding.kind in WALL_KINDS for finding in report.findings)


NAMED_REPAIRS = {
    one.name: one
    for one in (
        NamedRepair(
            "weld",
            "Weld gaps",
            "Open rims that lie within a width of each other become one, and vertices on a rim's edge are "
            "joined to it.",
            "Widest gap",
            False,
            _weld,
            _suggest_weld,
        ),
        NamedRepair(
            "fill_holes",
            "Fill holes",
            "Each hole of few edges gets a flat lid of triangles.",
            "Most edges of a hole",
            True,
            _fill,
            _suggest_filling,
        ),
        NamedRepair(
            "drop_walls",
            "Leave walls out",
            "Faces that have the solid on both sides, or on neither, are left out.",
            "",
            False,
            None,
            _suggest_dropping,
        ),
        NamedRepair(
            "unite",
            "Unite parts",
            "Closed parts that overlap, each other or themselves, become one body: nothing is covered twice.",
            "",
            False,
            _unite,
            _suggest_uniting,
        ),
    )
}
"""Repairs by name, in the order in which they are made."""


def _many(count: int, one: str, many: str) -> str:
    return f"{count:,} {one if count == 1 else many}"


def _range(sizes: tuple[int, ...]) -> str:
    low, high = min(sizes), max(sizes)
    return f"{low:,}" if low == high else f"{low:,} to {high:,}"


def _area(vertices: Floats, faces: Ints) -> float:
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(normals, axis=1).sum()) / 2.0
