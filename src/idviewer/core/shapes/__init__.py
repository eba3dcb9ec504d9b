"""Shapes: meshes, polygons and planes, and what is done to them."""

from idviewer.core.shapes.diagnosis import Diagnosis, diagnose
from idviewer.core.shapes.health import Fault, FaultPlace, Health, examine, examine_steps
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.mesh_repair import repair_mesh, repair_meshes
from idviewer.core.shapes.named_repairs import NAMED_REPAIRS, NamedRepair
from idviewer.core.shapes.plane import AXES, Plane
from idviewer.core.shapes.polygon import Polygon, PolygonError
from idviewer.core.shapes.raw_body import BrokenBodyError, RawBody, RepairOutcome
from idviewer.core.shapes.rays import Crossings, Ray, crossings, middle_of_first_chord
from idviewer.core.shapes.repairs import NO_REPAIRS, RepairRecord, Repairs
from idviewer.core.shapes.shape import Shape

__all__ = [
    "AXES",
    "NAMED_REPAIRS",
    "NO_REPAIRS",
    "BrokenBodyError",
    "Crossings",
    "Diagnosis",
    "Fault",
    "FaultPlace",
    "Health",
    "Mesh",
    "MeshError",
    "NamedRepair",
    "Plane",
    "Polygon",
    "PolygonError",
    "RawBody",
    "Ray",
    "RepairOutcome",
    "RepairRecord",
    "Repairs",
    "Shape",
    "crossings",
    "diagnose",
    "examine",
    "examine_steps",
    "middle_of_first_chord",
    "repair_mesh",
    "repair_meshes",
]
