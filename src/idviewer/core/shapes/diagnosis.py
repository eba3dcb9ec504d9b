"""Diagnosis of a mesh: its sizes and everything that is wrong with it.

`diagnose` tells of the very checks that `repair_mesh` acts on and that `Mesh` must not need, so all
three never disagree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.shape import MeshLike
from idviewer.core.validation.component import Component
from idviewer.core.validation.findings import Finding, Point
from idviewer.core.validation.mesh_checks import validate
from idviewer.core.validation.polygon_soup import PolygonSoup
from idviewer.core.validation.precision import Precision
from idviewer.core.validation.self_intersections import SelfIntersections
from idviewer.core.validation.soup_repairs import volume_and_area
from idviewer.core.validation.validation_report import ValidationReport

__all__ = ["Diagnosis", "Finding", "diagnose"]


@dataclass(frozen=True)
class Diagnosis:
    """Sizes of a mesh and everything that is wrong with it.

    Sizes are those of the surface after every repair that could be made.

    Attributes:
        vertices: how many.
        faces: how many triangles.
        edges: how many.
        components: faces of each component, that of the largest volume first; with those around its voids.
        component_list: number, faces, volume and voids of each.
        shells: faces of each connected part of the surface, the largest first.
        euler_characteristic: V - E + F; a pinched vertex counts once for every part of the surface that meets
            in it.
        genus: handles of all components together; None unless the surface is closed and two-sided.
        boundary_loops: how many holes the surface has.
        area: of the surface.
        volume: that it encloses; None unless it is closed and two-sided.
        bounds: lowest and highest corner of the bounding box; None if it has none.
        input_vertices: how many were given, before any repair.
        input_faces: how many polygons were source.
        findings: what is wrong, in the order in which it was found; empty for a faultless mesh.
        precision: to what step the coordinates are rounded; None where nobody has looked.
        notes: what the file's reader passed over or understood in some way, one sentence each.
        unit: of the coordinates; empty where the file does not say.
        advice: options of the command line for the repairs that make it usable; empty where it is, or where
            they do not, or where nobody has looked.
        self_intersections: faces that cross each other; None where something else has to be mended first.
    """

    vertices: int
    faces: int
    edges: int
    components: tuple[int, ...]
    component_list: tuple[Component, ...]
    shells: tuple[int, ...]
    euler_characteristic: int
    genus: int | None
    boundary_loops: int
    area: float
    volume: float | None
    bounds: tuple[Point, Point] | None
    input_vertices: int
    input_faces: int
    findings: tuple[Finding, ...]
    precision: Precision | None = None
    notes: tuple[str, ...] = ()
    unit: str = ""
    advice: str = ""
    self_intersections: SelfIntersections | None = field(default=None, compare=False)

    @property
    def usable(self) -> bool:
        """Whether the mesh can be used, as it is or after the repairs named."""
        return not any(finding.fatal for finding in self.findings)

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers, strings and lists, for JSON."""
        plain = asdict(self)
        crossing = self.self_intersections
        plain["self_intersections"] = None if crossing is None else crossing.as_dict()
        plain["findings"] = [finding.as_dict() for finding in self.findings]
        return {"usable": self.usable, **plain}


def diagnose(
    vertices: ArrayLike | MeshLike, faces: ArrayLike | Sequence[Sequence[int]] | None = None
) -> Diagnosis:
    """Find everything that is wrong with a mesh, and its sizes.

    Args:
        vertices: (n, 3) points, or a Mesh, or (vertices, faces) in one tuple.
        faces: (m, 3) vertex indices, counter-clockwise seen from outside; also polygons, as (m, k) indices or
            as a sequence of index sequences of any lengths. Left out for a Mesh.

    Raises:
        ValueError: the arrays do not have these shapes.

    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> diagnose(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).genus
    0
    >>> diagnose(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2]]).findings[0].message
    '3 boundary edges in 1 loop, near (1, 0, 0)'
    """
    if isinstance(vertices, Mesh):
        return diagnose(vertices.vertices, vertices.faces)
    if faces is None and isinstance(vertices, tuple) and len(vertices) == 2 and np.ndim(vertices[0]) == 2:
        return diagnose(*vertices)
    return diagnosis_of(validate(PolygonSoup.of(cast(ArrayLike, vertices), () if faces is None else faces)))


def diagnosis_of(report: ValidationReport) -> Diagnosis:
    """Summarise a finished validation."""
    source = report.source
    finite = report.vertices[np.isfinite(report.vertices).all(axis=1)]
    bounds = None if len(finite) == 0 else (_point(finite.min(axis=0)), _point(finite.max(axis=0)))
    blank = {"edges": 0, "components": (), "component_list": (), "shells": (), "euler_characteristic": 0}
    blank |= {"genus": None, "boundary_loops": 0, "area": 0.0, "volume": None}
    sizes = {
        "vertices": len(report.vertices),
        "faces": len(report.faces) or len(source.sizes),
        "bounds": bounds,
    }
    measured = _measured(report) if len(report.faces) else {}
    return Diagnosis(
        **{**blank, **sizes, **measured},
        input_vertices=len(source.vertices),
        input_faces=len(source.sizes),
        findings=tuple(report.findings),
        self_intersections=report.self_intersections,
        precision=report.precision,
    )


def _measured(report: ValidationReport) -> dict[str, Any]:
    """The sizes that need a surface."""
    topology = report.topology
    number, of_face = topology.components
    volume, area = volume_and_area(report.vertices, report.faces)
    corners = len(topology.vertex_fans()) if report.oriented_manifold else len(report.vertices)
    characteristic = corners - len(topology.ends) + len(report.faces)
    # Taken apart at its pinched vertices, a body may have more parts than components.
    parts = number if corners == len(report.vertices) else topology.edge_components()
    return {
        "edges": len(topology.ends),
        "components": tuple(one.faces for one in report.components),
        "component_list": report.components,
        "shells": tuple(np.bincount(of_face).tolist()),
        "euler_characteristic": characteristic,
        "genus": (2 * parts - characteristic) // 2 if report.oriented_manifold else None,
        "boundary_loops": topology.boundary_loops() if len(topology.boundary) else 0,
        "area": area,
        "volume": volume if report.oriented_manifold else None,
    }


def _point(values: np.ndarray) -> Point:
    x, y, z = values.tolist()
    return x, y, z
