"""The mesh that everything else computes on: closed, two-sided, in one piece, wound outward."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from idviewer.core.arrays import frozen
from idviewer.core.errors import ShapeError
from idviewer.core.shapes.face_boxes import Patches
from idviewer.core.shapes.labels import Labelled
from idviewer.core.shapes.mesh_bridges import Bridge, ShellBridges
from idviewer.core.shapes.mesh_refinement import refined_arrays, refined_count
from idviewer.core.validation.body_checks import shell_volumes
from idviewer.core.validation.component import Component
from idviewer.core.validation.file_numbering import FileNumbering
from idviewer.core.validation.finding_kinds import COMPONENT_KINDS
from idviewer.core.validation.findings import Finding
from idviewer.core.validation.mesh_checks import validate
from idviewer.core.validation.polygon_soup import PolygonSoup
from idviewer.core.validation.repair_choices import RepairChoices
from idviewer.core.validation.self_intersections import SelfIntersections, self_intersections_of
from idviewer.core.validation.soup_repairs import side_vectors, volume_and_area
from idviewer.core.validation.topology import Topology
from idviewer.core.validation.triangle_quality import TriangleQuality, triangle_quality_of
from idviewer.core.validation.validation_report import ValidationReport

MOST_REFINED_VERTICES = 2_000_000
"""That `Mesh.refined` makes: some minutes, and gigabytes."""


class MeshError(ShapeError):
    """A mesh that cannot be read or used; one line says what is wrong, how much of it, where, and what to do.

    Attributes:
        findings: what `diagnose` would report; empty if there was nothing to look at, as for a missing file.
        components: the pieces, the largest volume first, where choosing one is the way out; else empty.
    """

    def __init__(
        self, message: str, findings: tuple[Finding, ...] = (), components: tuple[Component, ...] = ()
    ) -> None:
        super().__init__(message)
        self.findings = findings
        self.components = components

    @classmethod
    def from_report(cls, report: ValidationReport, name: str = "") -> MeshError:
        """Tell what is fatal in a report, or else what a strict mesh refuses to have repaired.

        Args:
            report: of a validation with findings.
            name: of the mesh, to begin the message with; empty where it has none.
        """
        fatal = [finding for finding in report.findings if finding.fatal]
        if fatal:
            parts = [finding.message for finding in fatal] + [fatal[0].remedy]
            choosing = any(finding.kind in COMPONENT_KINDS for finding in fatal)
            several = report.components if choosing else ()
        else:
            parts = [finding.message for finding in report.findings if not finding.harmless]
            parts, several = [*parts, "idviewer.core.repair_mesh mends this"], ()
        message = "; ".join(part for part in parts if part)
        return cls(f"{name}: {message}" if name else message, tuple(report.findings), several)


@dataclass(frozen=True, eq=False, init=False)
class Mesh(Labelled):
    """A closed, two-sided triangle mesh in one piece, wound outward.

    A piece may have voids: closed shells inside the outer one, wound so that the solid lies behind their
    faces, too. Bridges join all shells, so that heat gets to voids and boundary distances reach them: a
    minimum spanning tree over the places where shells are nearest. A bridge has a length and a radius but no
    mass; see `Bridge`. The paper knows one shell, and then there are no bridges.

    The constructor takes copies, checks everything and repairs nothing; `idviewer.core.repair_mesh` and
    `idviewer.core.read_mesh` make a Mesh of less perfect input. Vertices in which the surface touches itself
    are accepted. Meshes compare by identity, and any thread may read them.

    Attributes:
        vertices: (n, 3) float64 points, read-only; every one belongs to a face.
        faces: (m, 3) int64 vertex indices, counter-clockwise seen from outside, read-only.
        name: for titles; file name without its suffix.
        notes: the repairs that were made, one sentence each.
        unit: of the coordinates, such as "mm"; empty where it is not known.
        numbering: which vertex of the file, or of the arrays that were given, became which of these.

    Raises:
        MeshError: the surface is open, not manifold, one-sided, in several pieces, inside out, without
            volume, ...

    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> mesh = Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> round(mesh.volume, 4), len(mesh.edges)
    (0.1667, 6)
    """

    dimension: ClassVar[int] = 3

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    name: str = ""
    notes: tuple[str, ...] = ()
    unit: str = ""
    numbering: FileNumbering = field(init=False, repr=False)

    def __init__(
        self, vertices: ArrayLike, faces: ArrayLike, name: str = "", notes: Sequence[str] = (), unit: str = ""
    ) -> None:
        object.__setattr__(self, "unit", unit)
        object.__setattr__(self, "name", name)
        try:
            polygons = PolygonSoup.of(vertices, faces)
        except (TypeError, ValueError) as error:
            raise MeshError(str(error)) from error
        if len(polygons.sizes) and np.any(polygons.sizes != 3):
            raise MeshError(
                "faces must have the shape (m, 3); idviewer.core.repair_mesh cuts polygons into triangles"
            )
        report = validate(polygons, RepairChoices(strict=True))
        if report.repaired:
            raise MeshError.from_report(report, name)
        self._fill(report, tuple(notes))

    @classmethod
    def from_report(cls, report: ValidationReport, name: str, notes: tuple[str, ...]) -> Mesh:
        """Take the mesh of a report without fatal findings; it is not validated again.

        Args:
            report: of the validation.
            name: of the mesh.
            notes: repairs made, one sentence each.
        """
        mesh = object.__new__(cls)
        object.__setattr__(mesh, "name", name)
        mesh._fill(report, notes)
        return mesh

    def _fill(self, report: ValidationReport, notes: tuple[str, ...]) -> None:
        object.__setattr__(self, "vertices", frozen(np.ascontiguousarray(report.vertices)))
        object.__setattr__(self, "faces", frozen(np.ascontiguousarray(report.faces)))
        object.__setattr__(self, "notes", tuple(notes))
        object.__setattr__(self, "numbering", report.numbering)
        for found in ("triangle_quality", "self_intersections"):  # of these arrays; they take a while
            if (value := getattr(report, found)) is not None:
                self.__dict__[found] = value

    def refined(self, edge_length: float) -> Mesh:
        """Cut edges until none is longer than asked; the surface stays where it is.

        The vertices stay, first and in order; new ones lie on the surface. Inside flat parts edges may be
        exchanged for better ones. Where no edge is longer, it is the mesh itself.

        Args:
            edge_length: the longest allowed, in the mesh's unit.

        Raises:
            MeshError: it is no positive number, or so short that there would be millions of vertices.

        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> mesh = Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        >>> len(mesh.refined(0.1).vertices), mesh.refined(2.0) is mesh
        (493, True)
        """
        if not 0.0 < edge_length < math.inf:
            raise MeshError(f"the longest edge must be a positive number, not {edge_length}")
        if self.longest_edge <= edge_length:
            return self
        count = refined_count(self.vertices, self.faces, edge_length)
        if count > MOST_REFINED_VERTICES:
            raise MeshError(
                f"{self.name or 'the mesh'}: with edges of at most {edge_length:.4g} it would have about "
                f"{count:,.0f} vertices, and {MOST_REFINED_VERTICES:,} is the limit; choose longer ones"
            )
        try:
            made = Mesh(*refined_arrays(self.vertices, self.faces, edge_length), self.name)
        except MeshError:  # rounding spoilt an exchange of edges
            made = Mesh(*refined_arrays(self.vertices, self.faces, edge_length, exchanging=False), self.name)
        object.__setattr__(made, "numbering", self.numbering.extended(len(made.vertices)))
        return made.with_labels(notes=self.notes, unit=self.unit)

    def __repr__(self) -> str:
        return f"Mesh({self.name!r}, {len(self.vertices)} vertices, {len(self.faces)} faces)"

    @property
    def file_vertices(self) -> NDArray[np.int64]:
        """Number (f,) of the vertex that each vertex of the file became; -1 where it was dropped.

        The file's own order is that in which it lists its points: in STL the three corners of each facet, one
        facet after the other; in glTF the points of each primitive in use, one primitive after the other. A
        mesh made of arrays counts as they do. `numbering.in_file_order` carries values back.

        >>> from idviewer.core import repair_mesh
        >>> corners = [[0, 0, 0], [9, 9, 9], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]
        >>> repair_mesh(corners, [[0, 3, 2], [5, 2, 4], [0, 4, 3], [2, 3, 4]]).file_vertices.tolist()
        [0, -1, 1, 2, 3, 0]
        """
        return self.numbering.became

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest corner of the bounding box, (2, 3)."""
        return frozen(np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)]))

    @cached_property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal."""
        return float(np.linalg.norm(self.bounds[1] - self.bounds[0]))

    @property
    def centre(self) -> NDArray[np.float64]:
        """Centre (3,) of the bounding box."""
        return 0.5 * (self.bounds[0] + self.bounds[1])

    @property
    def facets(self) -> NDArray[np.int64]:
        """The faces, as all shapes call the pieces of their boundaries."""
        return self.faces

    @cached_property
    def edges(self) -> NDArray[np.int64]:
        """Vertices (e, 2) of each edge, the lower index first, in ascending order."""
        return frozen(np.ascontiguousarray(Topology(self.faces, len(self.vertices)).ends))

    @cached_property
    def shells(self) -> tuple[NDArray[np.int64], ...]:
        """Faces of each closed shell: first the outer one, then those around voids, the largest first."""
        number, of_face = Topology(self.faces, len(self.vertices)).components
        if number == 1:
            return (frozen(np.arange(len(self.faces))),)
        volumes, _ = shell_volumes(self.vertices, self.faces, of_face, number)
        order = np.argsort(-np.abs(volumes), kind="stable")
        return tuple(frozen(np.flatnonzero(of_face == shell)) for shell in order.tolist())

    @cached_property
    def shell_bridges(self) -> ShellBridges:
        """The bridges, and what they conduct."""
        return ShellBridges(self.vertices, self.faces, self.shells)

    @property
    def bridges(self) -> tuple[Bridge, ...]:
        """The bridges that join the shells, one fewer than shells."""
        return self.shell_bridges.bridges if len(self.shells) > 1 else ()

    @property
    def bridge_lengths(self) -> NDArray[np.float64]:
        """Length of each bridge, (h,)."""
        return np.array([bridge.length for bridge in self.bridges], dtype=np.float64)

    @cached_property
    def longest_edge(self) -> float:
        """Length of the longest edge."""
        squares = [
            np.einsum("ij,ij->i", side, side).max() for side in side_vectors(self.vertices, self.faces)
        ]
        return math.sqrt(max(squares))

    @cached_property
    def triangle_quality(self) -> TriangleQuality:
        """Whether thin triangles spoil the cotangent Laplacian."""
        return triangle_quality_of(self.vertices, self.faces)

    @cached_property
    def self_intersections(self) -> SelfIntersections:
        """Faces that cross each other or lie on each other; false where there are none.

        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> bool(Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).self_intersections)
        False
        """
        return self_intersections_of(self.vertices, self.faces)

    @cached_property
    def patches(self) -> Patches:
        """The faces in patches that lie together; made by the first section, some 20 ms for 100,000 faces."""
        return Patches.of(self.vertices, self.faces)

    @cached_property
    def face_areas(self) -> NDArray[np.float64]:
        """Area of each face, (m,)."""
        _, b, c = side_vectors(self.vertices, self.faces)
        return frozen(np.linalg.norm(np.cross(b, c), axis=1) / 2)

    @cached_property
    def area(self) -> float:
        """Area of the surface."""
        return float(self.face_areas.sum())

    @cached_property
    def volume(self) -> float:
        """Volume enclosed."""
        return volume_and_area(self.vertices, self.faces)[0]
