"""Health of a body: everything that is wrong with it, where, and the repairs that help."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from idviewer.core.arrays import Bools, Floats, Ints
from idviewer.core.shapes.raw_body import RawBody, RepairOutcome, Steps
from idviewer.core.shapes.repairs import Repairs
from idviewer.core.steps import finish
from idviewer.core.validation.findings import Finding
from idviewer.core.validation.soup_repairs import zero_area_faces
from idviewer.core.validation.topology import Topology, component_labels
from idviewer.core.validation.validation_report import ValidationReport

MOST_PLACES = 200
"""Of one fault that can be gone to, the largest first; what is left makes one more."""


@dataclass(frozen=True, eq=False)
class FaultPlace:
    """A place at which a body has a fault.

    Attributes:
        segments: (s, 2, 3) edges at fault.
        triangles: (t, 3, 3) faces at fault.
        centre: (3,) its middle.
        radius: of a ball about the middle that holds it; 0 for a point.
    """

    segments: Floats
    triangles: Floats
    centre: Floats
    radius: float

    @classmethod
    def of(cls, segments: Floats, triangles: Floats) -> FaultPlace:
        """The place of edges and faces, at least one in all.

        Args:
            segments: (s, 2, 3).
            triangles: (t, 3, 3).

        >>> place = FaultPlace.of(np.array([[[0.0, 0, 0], [2, 0, 0]]]), np.empty((0, 3, 3)))
        >>> place.centre.tolist(), place.radius
        ([1.0, 0.0, 0.0], 1.0)
        """
        points = np.concatenate([segments.reshape(-1, 3), triangles.reshape(-1, 3)])
        centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
        return cls(segments, triangles, centre, float(np.linalg.norm(points - centre, axis=1).max()))

    @classmethod
    def at(cls, point: Floats) -> FaultPlace:
        """The place of a single point (3,)."""
        return cls(np.empty((0, 2, 3)), np.empty((0, 3, 3)), np.array(point, dtype=np.float64), 0.0)


@dataclass(frozen=True, eq=False)
class Fault:
    """One thing that is to be known of a body.

    Attributes:
        kind: of the finding; "note" for what its reader, or an earlier repair, has told.
        text: one line.
        fatal: whether the body cannot be used because of it.
        places: where it is, the largest first; there may be none.
    """

    kind: str
    text: str
    fatal: bool
    places: tuple[FaultPlace, ...] = ()


@dataclass(frozen=True, eq=False)
class Health:
    """Everything that is wrong with a body.

    Attributes:
        body: as it was read.
        outcome: what is made of it without any repair by name.
        faults: the fatal ones first.
        suggested: the repairs that would help, with their values.
    """

    body: RawBody
    outcome: RepairOutcome
    faults: tuple[Fault, ...]
    suggested: Repairs

    @property
    def vertices(self) -> Floats:
        """Vertices (n, 3) of the surface that the faults are on."""
        return self.outcome.report.vertices

    @property
    def faces(self) -> Ints:
        """Triangles (m, 3) of that surface; none where the file's numbers make no surface."""
        return self.outcome.report.faces


def examine(body: RawBody) -> Health:
    """Find everything that is wrong with a body, and where.

    Args:
        body: as it was read.

    >>> from idviewer.core.validation import PolygonSoup
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> health = examine(RawBody(PolygonSoup.of(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2]])))
    >>> [(fault.kind, fault.fatal, len(fault.places)) for fault in health.faults], health.suggested.options
    ([('boundary_edges', True, 1)], '--fill-holes 3')
    """
    return finish(examine_steps(body))


def examine_steps(body: RawBody) -> Steps[Health]:
    """As `examine`, with checkpoints between.

    Args:
        body: as it was read.
    """
    outcome = yield from body.repair_steps()
    yield
    findings = sorted(outcome.report.findings, key=lambda finding: not finding.fatal)
    faults = [_fault(finding, outcome.report) for finding in findings]
    told = {finding.note for finding in outcome.report.findings}
    notes = [Fault("note", note, False) for note in body.notes if note not in told]
    suggested = yield from body.suggestion_steps()
    return Health(body, outcome, (*faults, *notes), suggested)


def _fault(finding: Finding, report: ValidationReport) -> Fault:
    text = finding.message if finding.fatal else f"{finding.message}: {finding.repair}"
    places: tuple[FaultPlace, ...] = ()
    if finding.kind in _PLACES and len(report.faces):
        places = _PLACES[finding.kind](report)
    if not places and finding.where is not None:
        places = (FaultPlace.at(np.array(finding.where)),)
    return Fault(finding.kind, text[0].upper() + text[1:], finding.fatal, places)


def _edges_at(chosen: Ints, topology: Topology, vertices: Floats) -> tuple[FaultPlace, ...]:
    """Places of edges; those that hang together are one."""
    if len(chosen) == 0:
        return ()
    ends = topology.ends[chosen]
    _, nodes = np.unique(ends, return_inverse=True)
    nodes = nodes.reshape(ends.shape)
    _, labels = component_labels(int(nodes.max()) + 1, nodes[:, 0], nodes[:, 1])
    segments = vertices[ends]
    return _grouped(labels[nodes[:, 0]], lambda group: FaultPlace.of(segments[group], np.empty((0, 3, 3))))


def _faces_at(chosen: Ints, report: ValidationReport) -> tuple[FaultPlace, ...]:
    """Places of faces; those that share a vertex are one."""
    if len(chosen) == 0:
        return ()
    faces = report.faces[chosen]
    _, nodes = np.unique(faces, return_inverse=True)
    nodes = nodes.reshape(faces.shape)
    tails, heads = nodes[:, [0, 1]].ravel(), nodes[:, [1, 2]].ravel()
    _, labels = component_labels(int(nodes.max()) + 1, tails, heads)
    triangles = report.vertices[faces]
    return _grouped(labels[nodes[:, 0]], lambda group: FaultPlace.of(np.empty((0, 2, 3)), triangles[group]))


def _grouped(labels: Ints, make: Callable[[Bools], FaultPlace]) -> tuple[FaultPlace, ...]:
    counts = np.bincount(labels)
    largest = np.argsort(-counts, kind="stable")[: np.count_nonzero(counts)]
    groups = [labels == label for label in largest[:MOST_PLACES]]
    if len(largest) > MOST_PLACES:
        groups.append(np.isin(labels, largest[MOST_PLACES:]))
    return tuple(make(group) for group in groups)


def _boundary(report: ValidationReport) -> tuple[FaultPlace, ...]:
    return _edges_at(report.topology.boundary, report.topology, report.vertices)


def _crowded_edges(report: ValidationReport) -> tuple[FaultPlace, ...]:
    return _edges_at(report.topology.non_manifold_edges, report.topology, report.vertices)


def _pieces(report: ValidationReport) -> tuple[FaultPlace, ...]:
    return _faces_at(np.arange(len(report.faces)), report)


def _flat(report: ValidationReport) -> tuple[FaultPlace, ...]:
    return _faces_at(np.flatnonzero(zero_area_faces(report.vertices, report.faces)), report)


def _crossing(report: ValidationReport) -> tuple[FaultPlace, ...]:
    found = getattr(report, "self_intersections", None)
    return () if found is None else _faces_at(found.faces, report)


_PLACES: dict[str, Callable[[ValidationReport], tuple[FaultPlace, ...]]] = {
    "boundary_edges": _boundary,
    "non_manifold_edges": _crowded_edges,
    "inner_walls": _crowded_edges,
    "fins": _crowded_edges,
    "several_components": _pieces,
    "flat_faces": _flat,
    "self_intersections": _crossing,
}
