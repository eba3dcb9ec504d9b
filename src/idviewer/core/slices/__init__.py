"""Slices: sections of meshes with planes, whole polygons as sections, and their triangulation."""

from idviewer.core.slices.mesh_sections import Section, section
from idviewer.core.slices.polygon_sections import polygon_section
from idviewer.core.slices.triangulation import SliceMesh, slice_mesh, spacing_for

__all__ = ["Section", "SliceMesh", "polygon_section", "section", "slice_mesh", "spacing_for"]
