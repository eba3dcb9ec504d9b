"""Shapes: meshes, polygons and planes, and what is done to them."""

from idviewer.core.shapes.diagnosis import Diagnosis
from idviewer.core.shapes.plane import AXES
from idviewer.core.shapes.rays import Ray, crossings, middle_of_first_chord

__all__ = ["AXES", "Diagnosis", "Ray", "crossings", "middle_of_first_chord"]
