"""Validation report: what was found in a mesh so far, and the mesh as repaired so far."""

from __future__ import annotations

import numpy as np

from idviewer.core.arrays import Bools, Floats, Ints
from idviewer.core.validation.component import Component
from idviewer.core.validation.file_numbering import FileNumbering
from idviewer.core.validation.finding_kinds import HARMLESS_KINDS
from idviewer.core.validation.findings import Finding
from idviewer.core.validation.polygon_soup import PolygonSoup
from idviewer.core.validation.precision import Precision
from idviewer.core.validation.self_intersections import SelfIntersections
from idviewer.core.validation.soup_repairs import numbers_of_used
from idviewer.core.validation.topology import Topology
from idviewer.core.validation.triangle_quality import TriangleQuality


class ValidationReport:
    """Vertices and faces as repaired so far, and all findings; the checks change it in their order.

    Attributes:
        source: the polygons that were given.
        polygons: those of them that refer to vertices, without isolated vertices.
        findings: in the order in which they were made.
        components: the pieces of the mesh, that of the largest volume first; empty until they are found.
        windings: (m,) how often each face was given as it is, less how often from behind; None for once.
        stopped: nothing can be checked behind the last finding.
        triangle_quality: of the surface; None if it was not looked at.
        self_intersections: of the surface; None if they were not looked for.
        precision: of the coordinates; None if it was not looked at.
        vertices: (n, 3); a repair that changes them goes through `renumber` or `split`.
        numbering: which vertex of the source became which of these.
    """

    def __init__(self, polygons: PolygonSoup) -> None:
        self.source = polygons
        self.polygons = polygons
        self.findings: list[Finding] = []
        self.components: tuple[Component, ...] = ()
        self.windings: Ints | None = None
        self.stopped = False
        self.triangle_quality: TriangleQuality | None = None
        self.self_intersections: SelfIntersections | None = None
        self.precision: Precision | None = None
        self.vertices = polygons.vertices
        self.numbering = FileNumbering.unchanged(len(polygons.vertices))
        self._faces = np.empty((0, 3), np.int64)
        self._topology: Topology | None = None

    @property
    def faces(self) -> Ints:
        """Triangles (m, 3)."""
        return self._faces

    @faces.setter
    def faces(self, faces: Ints) -> None:
        self._faces, self._topology = faces, None

    @property
    def topology(self) -> Topology:
        """Topology of the current faces."""
        if self._topology is None:
            self._topology = Topology(self.faces, len(self.vertices))
        return self._topology

    @property
    def size(self) -> float:
        """The bounding box's diagonal."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0)))

    @property
    def fatal(self) -> bool:
        """Whether something was found that has no repair."""
        return any(finding.fatal for finding in self.findings)

    @property
    def oriented_manifold(self) -> bool:
        """Whether the surface is closed, manifold and consistently oriented."""
        topology = self.topology
        return len(self.faces) > 0 and topology.closed and not topology.inconsistently_oriented.any()

    @property
    def repaired(self) -> bool:
        """Whether anything was found that a mesh may not have."""
        return any(finding.kind not in HARMLESS_KINDS for finding in self.findings)

    def is_closed(self) -> bool:
        """Whether two faces meet in every edge; a vertex with fewer than two faces spares the sorting."""
        return bool(np.bincount(self.faces.ravel()).min() > 1) and self.topology.closed

    def add(self, finding: Finding) -> None:
        """Note a finding."""
        self.findings.append(finding)

    def stop(self, finding: Finding) -> None:
        """Note a finding behind which nothing can be checked."""
        self.findings.append(finding)
        self.stopped = True

    def near(self, vertex: int | np.integer) -> tuple[Floats, float]:
        """A place for a finding: the vertex's position, and the size of the mesh."""
        return self.vertices[vertex], self.size

    def keep(self, chosen: Bools) -> None:
        """Go on with some of the faces and the vertices they use."""
        faces = self.faces[chosen]
        became = numbers_of_used(faces, len(self.vertices))
        self.renumber(self.vertices[became >= 0], became[faces], became)

    def renumber(self, vertices: Floats, faces: Ints, became: Ints) -> None:
        """Go on with vertices of which some were merged, dropped or moved to another place in the order.

        Args:
            vertices: (n, 3) the new ones.
            faces: (m, 3) the new ones.
            became: for each vertex so far, its new number; -1 where it is dropped.
        """
        kept = became >= 0
        with np.errstate(invalid="ignore", over="ignore"):  # coordinates are checked later
            moved = vertices[became[kept]] - self.vertices[kept]
        self.numbering = self.numbering.renumbered(became, float(np.abs(moved).max(initial=0.0)))
        self.vertices, self.faces = vertices, faces

    def split(self, vertices: Floats, faces: Ints, came_from: Ints) -> None:
        """Go on with vertices of which some are copies of others, or are new.

        Args:
            vertices: (n, 3) the new ones.
            faces: (m, 3) the new ones.
            came_from: (n,) for each of them, the vertex so far that it is or copies; -1 for a new point.
        """
        self.numbering = self.numbering.split(came_from)
        self.vertices, self.faces = vertices, faces
