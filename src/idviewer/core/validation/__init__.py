"""Validation: what is wrong with the vertices and faces of a boundary, and its repairs."""

from idviewer.core.validation.polygon_soup import PolygonSoup, strips

__all__ = ["PolygonSoup", "strips"]
