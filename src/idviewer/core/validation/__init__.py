"""Validation: what is wrong with the vertices and faces of a boundary, and its repairs."""

from idviewer.core.validation.findings import Finding
from idviewer.core.validation.mesh_checks import validate
from idviewer.core.validation.polygon_soup import PolygonSoup, strips
from idviewer.core.validation.triangle_quality import TriangleQuality, triangle_quality_of
from idviewer.core.validation.validation_report import ValidationReport

__all__ = [
    "Finding",
    "PolygonSoup",
    "TriangleQuality",
    "ValidationReport",
    "strips",
    "triangle_quality_of",
    "validate",
]
