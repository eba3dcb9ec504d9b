"""The checks of how shells form bodies: voids, several components, and which of them to take."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from idviewer.core.arrays import Bools, Floats, Ints
from idviewer.core.validation.component import Component
from idviewer.core.validation.findings import Finding, counted, stated
from idviewer.core.validation.repair_choices import RepairChoices
from idviewer.core.validation.shell_nesting import Nesting, nesting_of
from idviewer.core.validation.tolerances import TOLERANCES
from idviewer.core.validation.topology import first_of_each
from idviewer.core.validation.validation_report import ValidationReport


def check_bodies(report: ValidationReport, choices: RepairChoices) -> None:
    """Find the pieces of a mesh and the voids in them, and take one of several if it was chosen.

    Args:
        report: of the checks so far.
        choices: which component to take.
    """
    number, of_face = report.topology.components
    nesting = None
    if number == 1:
        shells = np.zeros(1, np.int64)
    else:
        nesting, shells = _pieces(report, number, of_face)
    body_of_face = shells[of_face]
    report.components = _listed(report, of_face, shells)
    count, wanted = len(report.components), choices.number
    if wanted is not None and not 1 <= wanted <= count:
        have = "there is only one" if count == 1 else f"they are numbered from 1, the largest, to {count:,}"
        return report.stop(stated("no_such_component", f"no component {wanted}: {have}"))
    if count > 1 and wanted is None:
        for finding in _crossings(report, nesting, of_face):
            report.add(finding)
        report.add(several(report.components))
    elif count > 1:
        chosen = body_of_face == wanted - 1 if wanted else np.ones(len(of_face), bool)
        share = f"{np.count_nonzero(chosen):,} of {len(chosen):,} faces"
        report.add(stated("chosen_component", f"component {wanted} of {count:,} ({share})"))
        report.keep(chosen)
    return None


def several(components: tuple[Component, ...]) -> Finding:
    """The finding that names several components, the largest first.

    >>> several((Component(1, 8, 2.0), Component(2, 4, 1.0))).message
    '2 components with 8, 4 faces'
    """
    count = len(components)
    named = ", ".join(f"{one.faces:,}" for one in components[:5]) + (", ..." if count > 5 else "")
    remedy = (
        f"choose one by its number, component=1 (the largest) to component={count}, "
        "or take all, each on its own, with component='all'"
    )
    return replace(counted("several_components", count, f" with {named} faces"), remedy=remedy)


def wind_shells(report: ValidationReport) -> None:
    """Turn shells so that outer ones wind outward and those of voids inward; refuse what has no volume."""
    if report.fatal:
        return
    number, of_face = report.topology.components
    volumes, areas = shell_volumes(report.vertices, report.faces, of_face, number)
    if np.abs(volumes).max() <= TOLERANCES.volume * areas[np.abs(volumes).argmax()] ** 1.5:
        report.add(stated("no_volume", "no volume: the surface is closed but encloses nothing"))
        return
    outer = int(np.argmax(np.abs(volumes)))
    wanted = np.where(np.arange(number) == outer, 1.0, -1.0)
    wrong = np.flatnonzero(volumes * wanted < 0.0)
    if number > 1:
        voids = number - 1
        faces = int(np.count_nonzero(of_face != outer))
        report.add(counted("voids", voids, f" ({faces:,} faces)"))
    if len(wrong) == 0:
        return
    if len(wrong) == number:
        report.add(stated("inside_out", "the body, which was inside out,"))
    else:
        for one in wrong.tolist():
            size = int(np.count_nonzero(of_face == one))
            which = "outer shell" if one == outer else "shell around a void"
            vertex = report.faces[np.argmax(of_face == one), 0]
            subject = f"the {which} of {size:,} faces, which was wound the other way,"
            report.add(stated("turned_shells", subject, place=report.near(vertex)))
    turned = np.isin(of_face, wrong)
    report.faces = np.where(turned[:, None], report.faces[:, ::-1], report.faces)


def shell_volumes(vertices: Floats, faces: Ints, labels: Ints, number: int) -> tuple[Floats, Floats]:
    """Signed volume and area of each shell, (number,) each.

    Args:
        vertices: (n, 3).
        faces: (m, 3).
        labels: (m,) the shell of each face.
        number: of shells.
    """
    counts = np.bincount(labels, minlength=number)
    first = vertices[faces[first_of_each(labels, number), 0]]
    a, b, c = (vertices[faces[:, corner]] - first[labels] for corner in range(3))
    normals = np.cross(b - a, c - a)
    volumes = np.bincount(labels, np.einsum("ij,ij->i", a, normals), number) / 6.0
    areas = np.bincount(labels, np.linalg.norm(normals, axis=1), number) / 2.0
    return np.where(counts > 0, volumes, 0.0), areas


def _pieces(report: ValidationReport, number: int, of_face: Ints) -> tuple[Nesting, Ints]:
    """How the closed ones among the parts nest, and for each part the body it belongs to, by its rank."""
    faces, closed = _wound_alike(report, number, of_face)
    volumes, areas = shell_volumes(report.vertices, faces, of_face, number)
    closed &= np.abs(volumes) > TOLERANCES.volume * areas**1.5
    some = np.flatnonzero(closed)
    place = np.full(number, -1)
    place[some] = np.arange(len(some))
    chosen = closed[of_face]
    nesting = nesting_of(report.vertices, faces[chosen], place[of_face[chosen]], len(some))
    void = np.zeros(number, bool)
    void[some] = nesting.depth % 2 == 1
    body = np.arange(number)
    body[some[nesting.depth % 2 == 1]] = some[nesting.parent[nesting.depth % 2 == 1]]
    sizes = np.bincount(body, np.where(void, -1.0, 1.0) * np.abs(volumes), number)
    sizes[void] = -np.inf
    counts = np.bincount(body[of_face], minlength=number)
    # Equal up to rounding are equal: then the number of faces decides, and who comes first.
    scale = max(float(np.abs(volumes).max()), np.finfo(float).tiny)
    order = np.lexsort((np.arange(number), -counts, -np.round(sizes / scale, 9)))
    rank = np.empty(number, np.int64)
    rank[order] = np.arange(number)
    crossing = tuple((int(some[i]), int(some[j]), point) for i, j, point in nesting.crossing)
    return replace(nesting, crossing=crossing), rank[body]


def _wound_alike(report: ValidationReport, number: int, of_face: Ints) -> tuple[Ints, Bools]:
    """The faces with each part's wound alike, and which parts are closed and two-sided."""
    topology = report.topology
    edge_part = of_face[
        topology.half_edges_by_edge[np.cumsum(topology.face_counts) - topology.face_counts] // 3
    ]
    closed = np.bincount(edge_part[topology.face_counts != 2], minlength=number) == 0
    if not topology.inconsistently_oriented.any():
        return report.faces, closed
    flipped, one_sided = topology.windings()
    closed[of_face[one_sided]] = False
    return np.where(flipped[:, None], report.faces[:, ::-1], report.faces), closed


def _listed(report: ValidationReport, of_face: Ints, body: Ints) -> tuple[Component, ...]:
    """The components, by number."""
    count = len(np.unique(body))
    faces, _ = _wound_alike(report, len(body), of_face)
    volumes = np.abs(shell_volumes(report.vertices, faces, of_face, len(body))[0])
    sizes = np.bincount(body[of_face], minlength=count)
    shells = np.bincount(body, minlength=count)
    outer = np.zeros(count)
    np.maximum.at(outer, body, volumes)
    total = 2.0 * outer - np.bincount(body, volumes, count)
    return tuple(
        Component(one + 1, int(sizes[one]), float(total[one]), int(shells[one]) - 1) for one in range(count)
    )


def _crossings(report: ValidationReport, nesting: Nesting | None, of_face: Ints) -> list[Finding]:
    """The findings of shells that cross each other."""
    found = []
    crossing = () if nesting is None else nesting.crossing
    pairs = len({(min(one, other), max(one, other)) for one, other, _ in crossing})
    for one, other, point in crossing[:1]:
        sizes = [np.count_nonzero(of_face == part) for part in (one, other)]
        corner = np.flatnonzero((report.vertices[report.faces] == point).all(axis=2).any(axis=1))[0]
        subject = f"shells of {sizes[0]:,} and {sizes[1]:,} faces that cross each other at face {corner:,}"
        more = f" and {pairs - 1:,} more such pairs" if pairs > 1 else ""
        found.append(stated("crossing_shells", subject + more, count=pairs, place=(point, report.size)))
    return found
