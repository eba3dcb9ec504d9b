"""The checks of faces given twice, walls inside, and edges and vertices in which a surface touches itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from idviewer.core.arrays import Bools, Ints
from idviewer.core.validation import soup_repairs as repairs
from idviewer.core.validation.edge_bisection import bisected
from idviewer.core.validation.findings import counted
from idviewer.core.validation.repair_choices import RepairChoices
from idviewer.core.validation.surface_cells import SurfaceCells, cut_corners, surface_cells
from idviewer.core.validation.topology import Topology
from idviewer.core.validation.validation_report import ValidationReport

WALL_KINDS = ("inner_walls", "fins")


def drop_copies(report: ValidationReport) -> None:
    """Leave out copies of faces, and tell how the windings of those left add up."""
    report.windings = None
    if report.stopped or report.oriented_manifold:
        return
    # The two sides of a sheet, joined at its rim alone, are no copies: its edges have two faces each.
    copies = repairs.duplicates_of_earlier(
        report.faces, either_winding=len(report.topology.non_manifold_edges) > 0
    )
    if copies.any():
        place = report.near(report.faces[np.argmax(copies), 0])
        report.add(counted("duplicate_faces", int(np.count_nonzero(copies)), place=place))
        windings = repairs.net_windings(report.faces)
        report.keep(~copies)
        report.windings = windings[~copies]


def is_double_sided(faces: Ints, count: int) -> bool:
    """Whether some faces are there twice, and form a body with the others once each is taken once.

    Args:
        faces: (m, 3).
        count: of the vertices.

    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> is_double_sided(np.concatenate([faces, faces[:, ::-1]]), 4), is_double_sided(faces, 4)
    (True, False)
    """
    copies = repairs.duplicates_of_earlier(faces, either_winding=True)
    if not copies.any():
        return False
    topology = Topology(faces[~copies], count)
    doubled = np.zeros(count, bool)
    doubled[faces[copies]] = True
    # Bodies that touch in a whole face have three faces in its edges, once it is taken once.
    return bool(np.all(topology.face_counts[doubled[topology.ends].all(axis=1)] == 2))


def check_edges(report: ValidationReport, choices: RepairChoices) -> None:
    """Cut the surface where it only touches itself, and find walls inside.

    Args:
        report: of the checks so far.
        choices: whether walls are to be left out.
    """
    if choices.strict:
        return
    if len(report.topology.non_manifold_edges):
        _separate_solids(report, choices)
    else:
        _cut_vertices(report)


def find_open_edges(report: ValidationReport) -> None:
    """Find holes, and edges with more than two faces that are left."""
    topology = report.topology
    told = any(finding.kind in WALL_KINDS and finding.fatal for finding in report.findings)
    if len(topology.non_manifold_edges) and not told:
        place = report.near(topology.ends[topology.non_manifold_edges[0], 0])
        report.add(counted("non_manifold_edges", len(topology.non_manifold_edges), place=place))
    if len(topology.boundary):
        loops = topology.boundary_loops()
        place = report.near(topology.ends[topology.boundary[0], 0])
        detail = f" in {loops:,} {'loop' if loops == 1 else 'loops'}"
        report.add(counted("boundary_edges", len(topology.boundary), detail, place))


def _separate_solids(report: ValidationReport, choices: RepairChoices) -> None:
    """Sort out edges with more than two faces, wherever it can be told on which side of a face solid is."""
    windings = report.windings
    if windings is None or len(windings) != len(report.faces):
        windings = np.ones(len(report.faces), np.int64)
    cells = surface_cells(report.vertices, report.faces, np.sign(windings))
    useless = cells.walls | cells.fins
    if useless.any():
        kind = "inner_walls" if cells.walls.any() else "fins"
        shown = cells.walls if cells.walls.any() else cells.fins
        corners = report.vertices[report.faces[np.argmax(shown)]]
        finding = counted(kind, int(np.count_nonzero(shown)), place=(corners.mean(axis=0), report.size))
        report.add(replace(finding, repair="left out") if choices.drop_walls else finding)
        if not choices.drop_walls:
            return
        kept = ~useless
        cells = SurfaceCells(*(array[kept] for array in cells))
        report.keep(kept)
    sure = cells.known & (cells.solid_behind != cells.solid_before)
    _wind_around_solid(report, sure & cells.solid_before, sure)
    edges = len(Topology(report.faces[sure], len(report.vertices)).non_manifold_edges)
    if edges:
        crowded = report.topology.non_manifold_edges
        place = report.near(report.topology.ends[crowded[0], 0])
        if _cut(report, sure):
            report.add(counted("cut_edges", edges, place=place))


def _wind_around_solid(report: ValidationReport, turned: Bools, sure: Bools) -> None:
    """Turn faces that are wound against others of their part; a part that is wound inside out stays so."""
    part = report.topology.components[1]
    sizes = np.bincount(part[sure], minlength=part.max() + 1)
    all_turned = np.bincount(part[turned], minlength=len(sizes)) == sizes
    flipped = turned & ~all_turned[part]
    if flipped.any():
        place = report.near(report.faces[np.argmax(flipped), 0])
        report.add(counted("inconsistent_winding", int(np.count_nonzero(flipped)), place=place))
        report.faces = np.where(flipped[:, None], report.faces[:, ::-1], report.faces)


def _cut_vertices(report: ValidationReport) -> None:
    """Give each part of the surface that meets others in a vertex a vertex of its own."""
    if not report.oriented_manifold:
        return
    visits = np.bincount(report.topology.vertex_fans(), minlength=len(report.vertices))
    if (visits > 1).any():
        pinched = np.flatnonzero(visits > 1)
        place = report.near(pinched[0])
        _cut(report, np.ones(len(report.faces), bool))
        report.add(counted("cut_vertices", len(pinched), place=place))


def _cut(report: ValidationReport, sure: Bools) -> bool:
    """Copy vertices in which parts of the surface meet; whether there was anything to copy."""
    copies = cut_corners(report.vertices, report.faces, sure)
    crowded = _still_crowded(report, sure, copies)
    if crowded.any():
        # Both ends stay whole, as the surface goes around them; so the copies need a vertex between.
        parts = bisected(report.vertices, report.faces, crowded)
        came_from = np.full(len(parts.vertices), -1)
        came_from[: len(report.vertices)] = np.arange(len(report.vertices))
        report.split(parts.vertices, parts.faces, came_from)
        sure = sure[parts.parents]
        copies = cut_corners(report.vertices, report.faces, sure)
    if not copies.any():
        return False
    extra, numbers = np.unique(
        np.column_stack([report.faces.ravel(), copies.ravel()])[copies.ravel() > 0],
        axis=0,
        return_inverse=True,
    )
    faces = report.faces.copy()
    faces[copies > 0] = len(report.vertices) + numbers.ravel()
    came_from = np.concatenate([np.arange(len(report.vertices)), extra[:, 0]])
    report.split(report.vertices[came_from], faces, came_from)
    return True


def _still_crowded(report: ValidationReport, sure: Bools, copies: Ints) -> Bools:
    """Tell which edges, in the order of `Topology.ends`, have more than two faces with the same copies."""
    topology = report.topology
    half = topology.half_edges_by_edge
    edge = np.repeat(np.arange(len(topology.ends)), topology.face_counts)
    upward = topology.tails[half] < topology.heads[half]
    tail = copies.ravel()
    head = copies[:, [1, 2, 0]].ravel()
    low, high = np.where(upward, tail[half], head[half]), np.where(upward, head[half], tail[half])
    kinds, counts = np.unique(np.column_stack([edge, low, high])[sure[half // 3]], axis=0, return_counts=True)
    result = np.zeros(len(topology.ends), bool)
    result[kinds[counts > 2, 0]] = True
    return result
