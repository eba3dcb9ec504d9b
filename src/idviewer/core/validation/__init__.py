"""Validation: what is wrong with the vertices and faces of a boundary, and its repairs."""

from idviewer.core.validation.cell_surfaces import Cells, surface_of_cells
from idviewer.core.validation.component import Component
from idviewer.core.validation.file_numbering import FileNumbering
from idviewer.core.validation.findings import Finding
from idviewer.core.validation.mesh_checks import validate
from idviewer.core.validation.polygon_soup import PolygonSoup, strips
from idviewer.core.validation.repair_choices import ComponentChoice
from idviewer.core.validation.self_intersections import SelfIntersections
from idviewer.core.validation.triangle_quality import TriangleQuality, triangle_quality_of
from idviewer.core.validation.validation_report import ValidationReport

__all__ = [
    "Cells",
    "Component",
    "ComponentChoice",
    "FileNumbering",
    "Finding",
    "PolygonSoup",
    "SelfIntersections",
    "TriangleQuality",
    "ValidationReport",
    "strips",
    "surface_of_cells",
    "triangle_quality_of",
    "validate",
]
