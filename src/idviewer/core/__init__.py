"""Interior distances of triangle meshes: a library that needs no window.

Source throughout: Rustamov, Lipman and Funkhouser, "Interior Distance Using Barycentric Coordinates",
Symposium on Geometry Processing 2009; "the paper" in these pages.
"""

from idviewer.core.barycentroid import Barycentroid
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
from idviewer.core.interior import COORDINATES, InteriorDistance
from idviewer.core.io import read_mesh
from idviewer.core.laplacian import cotangent_laplacian, voronoi_areas
from idviewer.core.mean_value import MeanValueCoordinates, mean_value_weights
from idviewer.core.mesh import Mesh, MeshError
from idviewer.core.one_off import interior_distance
from idviewer.core.plane import Plane
from idviewer.core.samples import sample_names, sample_path
from idviewer.core.shape import DistanceError
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
    "Section",
    "SpectralFilter",
    "Spectrum",
    "TruncationError",
    "cotangent_laplacian",
    "diagnose",
    "distance",
    "eigenpairs",
    "interior_distance",
    "mean_value_weights",
    "parameters_of",
    "read_mesh",
    "sample_names",
    "sample_path",
    "section",
    "truncation_error",
    "voronoi_areas",
]
