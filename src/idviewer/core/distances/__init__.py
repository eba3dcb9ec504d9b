"""Boundary distances, one file each: a file that is put here is found, and registers what it defines.

What the other layers use, and whoever adds a distance, is named in `__all__`.
"""

from importlib import import_module
from pkgutil import iter_modules

from idviewer.core.distances.biharmonic import Biharmonic
from idviewer.core.distances.commute_time import CommuteTime
from idviewer.core.distances.diffusion import Diffusion
from idviewer.core.distances.euclidean import Euclidean
from idviewer.core.distances.geodesic import Geodesic
from idviewer.core.distances.given_distances import GivenDistances
from idviewer.core.distances.given_embedding import GivenEmbedding
from idviewer.core.distances.gps import GPS
from idviewer.core.distances.parameter_values import missing_parameters, parameter_values, with_defaults
from idviewer.core.distances.parameters import Choice, Extra, File, Formula, Integer, Number, Parameter
from idviewer.core.distances.registry import (
    DISTANCES,
    Basis,
    Distance,
    QuadraticForm,
    check_dimension,
    distance_from,
    parameters_of,
    register_distance,
)
from idviewer.core.distances.spectral import Spectral, percentage
from idviewer.core.distances.spectral_filter import SpectralFilter

__all__ = [
    "DISTANCES",
    "GPS",
    "Basis",
    "Biharmonic",
    "Choice",
    "CommuteTime",
    "Diffusion",
    "Distance",
    "Euclidean",
    "Extra",
    "File",
    "Formula",
    "Geodesic",
    "GivenDistances",
    "GivenEmbedding",
    "Integer",
    "Number",
    "Parameter",
    "QuadraticForm",
    "Spectral",
    "SpectralFilter",
    "check_dimension",
    "distance_from",
    "missing_parameters",
    "parameter_values",
    "parameters_of",
    "percentage",
    "register_distance",
    "with_defaults",
]

for _module in sorted(one.name for one in iter_modules(__path__)):
    import_module(f"{__name__}.{_module}")
