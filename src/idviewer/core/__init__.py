"""Interior distances of triangle meshes and polygons: a library that needs no window.

Source throughout: Rustamov, Lipman and Funkhouser, "Interior Distance Using Barycentric Coordinates",
Symposium on Geometry Processing 2009; "the paper" in these pages.
"""

from idviewer.core.coordinates import COORDINATES, Coordinates, Property
from idviewer.core.coordinates.mean_value import MeanValueCoordinates, mean_value_weights
from idviewer.core.distances import (
    DISTANCES,
    GPS,
    Biharmonic,
    CommuteTime,
    Diffusion,
    Distance,
    Euclidean,
    Geodesic,
    GivenDistances,
    GivenEmbedding,
    Parameter,
    SpectralFilter,
    parameters_of,
    register_distance,
)
from idviewer.core.errors import DistanceError, ShapeError
from idviewer.core.interior.barycentroid import Barycentroid
from idviewer.core.interior.discretisation_error import Discretisation, DiscretisationError
from idviewer.core.interior.discretisation_levels import discretisation
from idviewer.core.interior.equations import gram_distance, pairwise_distance
from idviewer.core.interior.single_call import interior_distance
from idviewer.core.interior.solver import InteriorDistance
from idviewer.core.io.bundled_shapes import sample_names, sample_path
from idviewer.core.io.mesh_writers import write_mesh
from idviewer.core.io.meshes import read_mesh, read_meshes
from idviewer.core.io.polygons import read_polygon, read_shape, write_polygon
from idviewer.core.sampling.basis_samples import SourceError
from idviewer.core.sampling.evaluation import slice_values
from idviewer.core.sampling.sampled_slice import SliceValues
from idviewer.core.shapes.diagnosis import diagnose
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.mesh_repair import repair_mesh, repair_meshes
from idviewer.core.shapes.plane import Plane
from idviewer.core.shapes.polygon import Polygon, PolygonError
from idviewer.core.shapes.repairs import Repairs
from idviewer.core.shapes.shape import Shape
from idviewer.core.shapes.union import Union, unite_mesh
from idviewer.core.slices.mesh_sections import Section, section
from idviewer.core.slices.polygon_sections import polygon_section
from idviewer.core.spectrum.eigen_solver import Spectrum, eigenpairs
from idviewer.core.spectrum.laplacian import (
    cotangent_laplacian,
    laplacian_of,
    masses_of,
    polygon_laplacian,
    voronoi_areas,
    voronoi_lengths,
)

__all__ = [
    "COORDINATES",
    "DISTANCES",
    "GPS",
    "Barycentroid",
    "Biharmonic",
    "CommuteTime",
    "Coordinates",
    "Diffusion",
    "Discretisation",
    "DiscretisationError",
    "Distance",
    "DistanceError",
    "Euclidean",
    "Geodesic",
    "GivenDistances",
    "GivenEmbedding",
    "InteriorDistance",
    "MeanValueCoordinates",
    "Mesh",
    "MeshError",
    "Parameter",
    "Plane",
    "Polygon",
    "PolygonError",
    "Property",
    "Repairs",
    "Section",
    "Shape",
    "ShapeError",
    "SliceValues",
    "SourceError",
    "SpectralFilter",
    "Spectrum",
    "Union",
    "cotangent_laplacian",
    "diagnose",
    "discretisation",
    "eigenpairs",
    "gram_distance",
    "interior_distance",
    "laplacian_of",
    "masses_of",
    "mean_value_weights",
    "pairwise_distance",
    "parameters_of",
    "polygon_laplacian",
    "polygon_section",
    "read_mesh",
    "read_meshes",
    "read_polygon",
    "read_shape",
    "register_distance",
    "repair_mesh",
    "repair_meshes",
    "sample_names",
    "sample_path",
    "section",
    "slice_values",
    "unite_mesh",
    "voronoi_areas",
    "voronoi_lengths",
    "write_mesh",
    "write_polygon",
]
