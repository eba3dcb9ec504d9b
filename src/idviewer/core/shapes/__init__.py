"""Shapes: meshes, polygons and planes, and what is done to them."""

from idviewer.core.shapes.diagnosis import Diagnosis, diagnose
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.mesh_repair import repair_mesh
from idviewer.core.shapes.plane import AXES, Plane
from idviewer.core.shapes.polygon import Polygon, PolygonError
from idviewer.core.shapes.rays import Crossings, Ray, crossings, middle_of_first_chord
from idviewer.core.shapes.shape import Shape

__all__ = [
    "AXES",
    "Crossings",
    "Diagnosis",
    "Mesh",
    "MeshError",
    "Plane",
    "Polygon",
    "PolygonError",
    "Ray",
    "Shape",
    "crossings",
    "diagnose",
    "middle_of_first_chord",
    "repair_mesh",
]
