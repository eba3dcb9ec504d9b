"""Interior distances of triangle meshes and polygons: a library that needs no window.

Source throughout: Rustamov, Lipman and Funkhouser, "Interior Distance Using Barycentric Coordinates",
Symposium on Geometry Processing 2009; "the paper" in these pages.
"""

from idviewer.core.barycentroid import Barycentroid
from idviewer.core.coordinates import COORDINATES, Coordinates, Property
from idviewer.core.coordinates.mean_value import MeanValueCoordinates, mean_value_weights
from idviewer.core.diagnosis import diagnose
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
    distance,
    parameters_of,
)
from idviewer.core.interior import InteriorDistance
from idviewer.core.io import read_mesh
from idviewer.core.laplacian import (
    cotangent_laplacian,
    laplacian_of,
    masses_of,
    polygon_laplacian,
    voronoi_areas,
    voronoi_lengths,
)
from idviewer.core.mesh import Mesh, MeshError
from idviewer.core.one_off import interior_distance
from idviewer.core.plane import Plane
from idviewer.core.polygon import Polygon, PolygonError
from idviewer.core.polygon_io import read_polygon, read_shape, write_polygon
from idviewer.core.polygon_section import polygon_section
from idviewer.core.samples import sample_names, sample_path
from idviewer.core.shape import DistanceError, Shape, ShapeError
from idviewer.core.slices import Section, section
from idviewer.core.spectrum import Spectrum, eigenpairs
from idviewer.core.truncation import TruncationError, truncation_error

__all__ = [
    "COORDINATES",
    "DISTANCES",
    "GPS",
    "Barycentroid",
    "Biharmonic",
    "CommuteTime",
    "Coordinates",
    "Diffusion",
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
    "Section",
    "Shape",
    "ShapeError",
    "SpectralFilter",
    "Spectrum",
    "TruncationError",
    "cotangent_laplacian",
    "diagnose",
    "distance",
    "eigenpairs",
    "interior_distance",
    "laplacian_of",
    "masses_of",
    "mean_value_weights",
    "parameters_of",
    "polygon_laplacian",
    "polygon_section",
    "read_mesh",
    "read_polygon",
    "read_shape",
    "sample_names",
    "sample_path",
    "section",
    "truncation_error",
    "voronoi_areas",
    "voronoi_lengths",
    "write_polygon",
]
